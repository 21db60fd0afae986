"""Option types that say what is allowed."""

from __future__ import annotations

import math
from typing import Any

import click

from cranktopo.base.errors import quoted, suggest


class Number(click.FloatRange):
    """A finite number in a closed range, which help shows."""

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> float:
        """Return the value as a float; fails with the allowed range."""
        try:
            number = float(str(value))
        except ValueError:
            number = math.nan
        if not (self.min is not None and self.max is not None and self.min <= number <= self.max):
            allowed = f"must be a number >= {self.min:g} and <= {self.max:g}"
            self.fail(f"{quoted(str(value))}: {allowed}.", param, ctx)
        return number


CELL_MM = Number(1e-3, 1000)
"""Cells of the optimiser, elements, and other small lengths; memory sets the true limit."""
VOLUME_FRACTION = Number(0.01, 0.99)


class Choice(click.Choice[str]):
    """One of a few words; a misspelt one is answered by the nearest."""

    def convert(self, value: object, param: click.Parameter | None, ctx: click.Context | None) -> str:
        """Return the word itself; fails with all words and the nearest."""
        words = [str(choice) for choice in self.choices]
        if value not in words:
            allowed = f"{quoted(value)} is none of {', '.join(words)}."
            near = suggest(str(value)[:100], words)
            self.fail(f"{allowed} {near}" if near.startswith("Did") else allowed, param, ctx)
        return super().convert(value, param, ctx)


class Speeds(click.ParamType[list[float]]):
    """Speeds (rpm): one, or both ends of a sweep and its step."""

    name = "RPM|FROM:TO:STEP"
    most = 1000

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> list[float]:
        """Return the speeds, both ends of a sweep included; fails with the allowed form."""
        try:
            numbers = [float(part) for part in str(value).split(":")]
        except ValueError:
            numbers = []
        if len(numbers) == 1 and 0 <= numbers[0] < math.inf:
            return numbers
        if len(numbers) == 3:
            start, stop, step = numbers
            if 0 <= start <= stop < math.inf and step > 0 and (stop - start) / step < self.most:
                return [start + index * step for index in range(int((stop - start) / step + 1e-9) + 1)]
        form = f"must be RPM or FROM:TO:STEP with 0 <= FROM <= TO and at most {self.most} steps"
        self.fail(f"{quoted(str(value))}: {form}.", param, ctx)
