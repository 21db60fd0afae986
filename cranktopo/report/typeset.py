"""Text as a page sets it: signs in place of letters for them, numbers on one line with their units."""

from __future__ import annotations

import re
from collections.abc import Callable

from cranktopo.base.units import UNITS

_FIXED = "\u00a0"
"""A space at which no line ends."""
_RAISED = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")
_SIGNS: tuple[tuple[re.Pattern[str], str | Callable[[re.Match[str]], str]], ...] = (
    (re.compile(r"\+-(?=\d)"), "±"),
    (re.compile(r"(?<=\d )um\b"), "µm"),
    (re.compile(r"(?<=\d)%(?!\w)"), f"{_FIXED}%"),
    (re.compile(r"(?<= )>=(?= )"), "≥"),
    (re.compile(r"(?<= )<=(?= )"), "≤"),
    (re.compile(r"(?<= )->(?= )"), "→"),
    (re.compile(r"(?<=\b[A-Za-z]) = (?=-?\d)"), f"{_FIXED}={_FIXED}"),
    (re.compile(r"(?<![\w/.])mm([23])\b"), lambda found: f"mm{found[1].translate(_RAISED)}"),
    (
        re.compile(r"(?<![\w./])(\d(?:\.\d+)?)e(?:\+|(-))0*(\d+)(?![\w/]|\.\d)"),
        lambda found: f"{found[1]}·10{((found[2] or '') + found[3]).translate(_RAISED)}".removeprefix("1·"),
    ),
)


def _with_signs(text: str) -> str:
    for pattern, sign in _SIGNS:
        text = pattern.sub(sign, text)
    return text


_NAMED = sorted({"%", "J", "mm²", *map(_with_signs, UNITS.values())}, key=len, reverse=True)
_QUANTITY = re.compile(rf"(?<=\d) ({'|'.join(map(re.escape, _NAMED))})(?![\w/²³])")


def typeset(text: str) -> str:
    """Return a text with `±`, `µm`, `mm²` and powers of ten as signs, each number kept with its unit."""
    return _QUANTITY.sub(lambda found: _FIXED + unbroken(found[1]), _with_signs(text))


def unbroken(text: str) -> str:
    """Return a unit that stays on one line."""
    return _with_signs(text).replace(" ", _FIXED)
