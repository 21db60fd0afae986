"""Option types that say what is allowed."""

from __future__ import annotations

import math
from typing import Any

import click

from cranktopo.errors import shown, suggest


class Number(click.FloatRange):
    """A finite number in a closed range, which help shows."""

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> float:
        """The value as a float; fails with the allowed range."""
        try:
            number = float(str(value))
        except ValueError:
            number = math.nan
        if not (self.min is not None and self.max is not None and self.min <= number <= self.max):
            allowed = f"must be a number >= {self.min:g} and <= {self.max:g}"
            self.fail(f"{shown(str(value))}: {allowed}.", param, ctx)
        return number


CELL_MM = Number(1e-3, 1000)
"""Cells of the optimiser, elements, and other small lengths; memory sets the true limit."""
VOLUME_FRACTION = Number(0.01, 0.99)


class Choice(click.Choice[str]):
    """One of a few words; a misspelt one is answered by the nearest."""

    def convert(self, value: object, param: click.Parameter | None, ctx: click.Context | None) -> str:
        """The word itself; fails with all words and the nearest."""
        words = [str(choice) for choice in self.choices]
        if value not in words:
            allowed = f"{shown(value)} is none of {', '.join(words)}."
            near = suggest(str(value)[:100], words)
            self.fail(f"{allowed} {near}" if near.startswith("Did") else allowed, param, ctx)
        return super().convert(value, param, ctx)
