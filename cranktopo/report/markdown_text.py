"""Text for Markdown: names of designs and files come from the user and may hold any character."""

from __future__ import annotations

import re

_SPECIAL = re.compile(r"([\\`*_|\[\]<>~&$#])")
"""What Markdown and its tables read as a sign of their own anywhere in a line."""
_LIST = re.compile(r"^(\d*)([+.)-])(?=[\s-]|$)")
"""What begins a list, or is a rule, at the start of a line."""


def escaped(text: str) -> str:
    """The text on one line, so that Markdown shows it as it is."""
    return _LIST.sub(r"\1\\\2", _SPECIAL.sub(r"\\\1", " ".join(text.split())))
