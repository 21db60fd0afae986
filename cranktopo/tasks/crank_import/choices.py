"""Choices of the import that its options name, light enough for `--help`."""

from __future__ import annotations

from typing import Literal, get_args

EndJournals = Literal["auto", "whole", "cut"]
"""State of the outermost main journals of a body: whole, or cut in the middle where a throw repeats."""
END_JOURNALS: tuple[str, ...] = get_args(EndJournals)
DEFAULT_MATERIAL = "42CrMo4"
