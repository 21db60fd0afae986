"""Text of a page as one would type it."""

from __future__ import annotations

from pathlib import Path


def typed(text: str) -> str:
    """Return a text of a page with plain spaces where numbers are kept with their units."""
    return text.replace("\u00a0", " ")


def typed_page(path: Path) -> str:
    """Return the text of an HTML file with plain spaces."""
    return typed(path.read_text(encoding="utf-8"))
