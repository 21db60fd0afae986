"""Lines that fit a terminal: a sentence goes on below, what belongs together stays together."""

from __future__ import annotations

import re
import textwrap
from collections.abc import Iterable

from cranktopo.base.units import UNITS

WIDTH = 80
"""Letters of a line of the terminal that tables and sentences fit in."""
_BELOW = "  "
"""Before what goes on in the next line."""
_TOGETHER = re.compile(
    r"(?:(?<=: )|(?<=^))(?:cranktopo|(?:pip|apt-get) install) .+$"  # a command to copy ends its line
    r"|(?<!\w)(?:`[^`]+`|'[^']+'|\"[^\"]+\")"
    r"|\bcranktopo [a-z]\S*(?: --?\S+)*"
    r"|[\w.\]]+ = (?:\"[^\"]*\"|\S+)"  # a key with its value
)
_UNIT = re.compile(
    rf"(?<=\d) (?:{'|'.join(map(re.escape, sorted(UNITS.values(), key=len, reverse=True)))})(?![\w/])"
)
_SPACE = "\0"
"""Space that is no place to go on: no text has it, streams show it as an escape."""


def in_width(text: str, together: Iterable[str] = ()) -> str:
    """Return a text in lines of at most `WIDTH` letters: sentences go on below, indented by two.

    Whole stay: rows of tables (known by two spaces between words), commands to copy, quoted words, keys with
    their values, numbers with their units, and words longer than a line.

    Args:
        together: more that stays whole, such as paths with spaces.
    """
    return "\n".join(_sentence(line, together) for line in text.split("\n"))


def unfolded(text: str) -> list[str]:
    """Return the sentences of a text that `in_width` has folded, a line each.

    An indented line of its own is taken for the rest of the line above it where that has no room for its
    first word.
    """
    lines: list[str] = []
    pieces = ""
    for line in text.splitlines():
        if lines and _indent(line) == _indent(lines[-1]) + _BELOW:  # else it is not its rest
            whole, folded = f"{lines[-1]} {line.lstrip()}", f"{pieces}\n{line}"
            if in_width(whole) == folded:
                lines[-1], pieces = whole, folded
                continue
        lines.append(line)
        pieces = line
    return lines


def _indent(line: str) -> str:
    return " " * (len(line) - len(line.lstrip()))


def _sentence(line: str, together: Iterable[str]) -> str:
    if len(line) <= WIDTH or "  " in line.strip():
        return line
    indent = _indent(line)
    kept = line.strip()
    for part in together:
        kept = kept.replace(part, part.replace(" ", _SPACE))
    for pattern in (_TOGETHER, _UNIT):
        kept = pattern.sub(lambda found: found[0].replace(" ", _SPACE), kept)
    folded = textwrap.fill(
        kept,
        WIDTH,
        initial_indent=indent,
        subsequent_indent=indent + _BELOW,
        break_long_words=False,
        break_on_hyphens=False,
    )
    return folded.replace(_SPACE, " ")
