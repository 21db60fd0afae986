"""Choices of the import that its options name, light enough for `--help`."""

from __future__ import annotations

from typing import Literal, get_args

EndJournals = Literal["auto", "whole", "cut"]
"""State of the outermost main journals of a body: whole, or cut in the middle where a throw repeats."""
END_JOURNALS: tuple[str, ...] = get_args(EndJournals)
DEFAULT_MATERIAL = "42CrMo4"
Unit = Literal["mm", "cm", "m", "in"]
"""Unit of the numbers in a file that tells none, or a wrong one."""
UNITS: tuple[str, ...] = get_args(Unit)
UNIT_MM: dict[Unit, float] = {"mm": 1.0, "cm": 10.0, "m": 1e3, "in": 25.4}
