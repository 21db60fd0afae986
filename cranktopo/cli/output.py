"""The one place where what a command says leaves the program: sentences in lines of 80 letters, or JSON.

A file or a pipe gets the same lines as a terminal.
"""

from __future__ import annotations

import json
import os
import re
import sys
from collections.abc import Iterator, Mapping
from typing import Any

import click

from cranktopo.base.line_width import WIDTH, in_width

_COLON = re.compile(": ")


def tell(said: str | Mapping[str, Any], *, err: bool = False, indent: int | None = 2) -> None:
    """Print words for people, folded, or a result for programs as one JSON object, with that indent."""
    words = json.dumps(said, indent=indent) if isinstance(said, Mapping) else _folded(said)
    click.echo(words, err=err)


def pass_on(text: str) -> None:
    """Print a text for programs, such as CSV, as it is."""
    click.echo(text)


def tell_error(message: str) -> None:
    """Print what is wrong on stderr in one line, however long: logs and other programs look for it."""
    click.echo(f"{coloured('error:', 'red', err=True)} {message}", err=True)


def coloured(text: str, colour: str, err: bool = False) -> str:
    """Return text in a colour on a terminal; plain in a pipe and where NO_COLOR is set (no-color.org)."""
    stream = sys.stderr if err else sys.stdout
    return text if os.environ.get("NO_COLOR") or not stream.isatty() else click.style(text, fg=colour)


def _folded(text: str) -> str:
    return in_width(text, list(_paths(text)))


def _paths(text: str) -> Iterator[str]:
    """Yield files and folders whose names have spaces, at the end of a line or before a colon in it."""
    for line in text.splitlines():
        ends = [line, *(line[: at.start()] for at in _COLON.finditer(line))] if len(line) > WIDTH else []
        for words in (end.split(" ") for end in ends):
            tails = (" ".join(words[first:]) for first in range(len(words) - 1))
            yield from (tail for tail in tails if os.path.exists(tail))
