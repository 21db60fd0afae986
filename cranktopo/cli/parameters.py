"""Option types that say what is allowed."""

from __future__ import annotations

import math

import click

from cranktopo.errors import suggest


class Number(click.ParamType[float]):
    """A finite number inside an open range.

    Args:
        what: name for the message.
        above: the value must be greater.
        below: the value must be smaller, if given.
    """

    name = "number"

    def __init__(self, what: str, above: float, below: float = math.inf) -> None:
        self._what, self._above, self._below = what, above, below

    def convert(self, value: object, param: click.Parameter | None, ctx: click.Context | None) -> float:
        """The value as a float; fails with the allowed range.

        Args:
            value: what the user wrote, or the default.
            param, ctx: as click gives them, for the message.
        """
        allowed = f"must be a number > {self._above:g}"
        if math.isfinite(self._below):
            allowed += f" and < {self._below:g}"
        try:
            number = float(str(value))
        except ValueError:
            self.fail(f"{self._what} = {value!r}: {allowed}.", param, ctx)
        if not (self._above < number < self._below):  # false for nan as well
            self.fail(f"{self._what} = {value}: {allowed}.", param, ctx)
        return number


class Choice(click.Choice[str]):
    """One of a few words; a misspelt one is answered by the nearest."""

    def convert(self, value: object, param: click.Parameter | None, ctx: click.Context | None) -> str:
        """The word itself; fails with all words and the nearest.

        Args:
            value: what the user wrote, or the default.
            param, ctx: as click gives them, for the message.
        """
        words = [str(choice) for choice in self.choices]
        if value not in words:
            allowed = f"{value!r} is none of {', '.join(words)}."
            near = suggest(str(value), words)
            self.fail(f"{allowed} {near}" if near.startswith("Did") else allowed, param, ctx)
        return super().convert(value, param, ctx)
