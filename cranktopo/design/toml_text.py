"""Text of a TOML document to tables, with a line for what is wrong in it."""

from __future__ import annotations

import re
import tomllib
from typing import Any

from cranktopo.base.errors import CranktopoError, decimal_comma, quoted

_TOML_HINT = "Fix that line; `cranktopo designs new FILE` writes a design to start from."
_MOST_PARTS = 30
_DEEP_KEY = re.compile(
    rf"""(?<![\w"'-])(?:(?:[\w-]++|"[^"\n]*+"|'[^'\n]*+')[ \t]*+\.[ \t]*+){{{_MOST_PARTS}}}"""
)
_TOML_PLACE = re.compile(r"at line (\d+), column")


def parse_toml(text: str, source: str) -> dict[str, Any]:
    """The tables of a TOML document as they are written; raises CranktopoError where it is malformed."""
    deep = _DEEP_KEY.search(text)
    if deep:  # the parser takes memory by the square of its length
        line = text.count("\n", 0, deep.start()) + 1
        reason = f"line {line} has a key of more than {_MOST_PARTS} parts: {quoted(deep[0], 60)}"
        raise CranktopoError(f"{source}: not valid TOML: {reason}.", hint=_TOML_HINT)
    try:
        return tomllib.loads(text)
    except (ValueError, RecursionError) as error:  # ValueError: also an integer of thousands of digits
        reason = _toml_reason(error, text)
        raise CranktopoError(f"{source}: not valid TOML: {reason}.", hint=_TOML_HINT) from None


def _toml_reason(error: Exception, text: str) -> str:
    if isinstance(error, tomllib.TOMLDecodeError):
        reason, place = quoted(str(error))[1:-1], _TOML_PLACE.search(str(error))
        lines = text.splitlines()[int(place[1]) - 1 :] if place else []
        if not lines:
            return reason
        comma = decimal_comma(lines[0].partition("=")[2]).rstrip(".").lower()
        return f"{comma or reason}: {quoted(lines[0].strip())}"
    return "its arrays are too deep" if isinstance(error, RecursionError) else "a number has too many digits"
