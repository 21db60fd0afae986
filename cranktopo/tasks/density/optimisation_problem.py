"""The optimisation problem: one thing to make small or large, and limits, all scaled alike.

Every function that an optimiser sees is of the order of 1: a goal over its reference, a limit as the share by
which it is broken. A stiffness enters through its reciprocal, which is nearly linear in what is added.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal

import jax
import jax.numpy as jnp

from cranktopo.design.goal.constraint import scale_of
from cranktopo.tasks.density.responses import Design, Response

Sense = Literal["minimise", "maximise"]


@dataclass(frozen=True)
class Objective:
    """A response to make small or large.

    Attributes:
        reference: positive value that the response is divided by, such as that of the original web.
    """

    response: Response
    sense: Sense = "minimise"
    reference: float = 1.0

    def scaled(self, design: Design) -> jax.Array:
        """Return what is minimised: the response over its reference, or its reciprocal."""
        value = self.response.value(design) / self.reference
        return value if self.sense == "minimise" else 1 / value


@dataclass(frozen=True)
class ResponseConstraint:
    """A response that must be at most (<=) or at least (>=) a bound.

    Attributes:
        original: value of the original web, by which a bound of zero is measured; 0 where there is none.
        percent: whether messages give values in percent of the original's.
        least_size: of a limit on what may be 0.
    """

    response: Response
    sense: Literal["<=", ">="]
    bound: float
    original: float = 0.0
    percent: bool = False
    least_size: float = 0.0

    def __str__(self) -> str:
        return f"{self.response.name} {self.sense} {self.shown(self.bound)}"

    def shown(self, value: float) -> str:
        """Return a value of the response with its unit, as in messages."""
        if self.percent:
            return f"{100 * value / self.original:.4g} %"
        return self.in_unit(value)

    def in_unit(self, value: float) -> str:
        """Return a value of the response in its own unit."""
        return f"{value:.6g} {self.response.unit}".rstrip()

    def scaled(self, design: Design) -> jax.Array:
        """Share by which the limit is broken: at most 0 where it holds.

        A lower bound of something positive is taken as bound / value - 1, unless that may be 0.
        """
        value = self.response.value(design)
        linear = self._sign * (value - self.bound) / self._size
        if self.sense == "<=" or self.bound <= 0 or self.least_size:
            return linear
        return jnp.where(value > 0, self.bound / jnp.where(value > 0, value, 1.0) - 1.0, linear)

    def broken(self, value: float) -> float:
        """Share of the bound by which a value of the response breaks the limit; negative where it holds."""
        return self._sign * (value - self.bound) / self._size

    @property
    def _sign(self) -> float:
        return 1.0 if self.sense == "<=" else -1.0

    @property
    def _size(self) -> float:
        return scale_of(self.bound, self.original, self.least_size)


@dataclass(frozen=True)
class OptimisationProblem:
    """Goals and limits of an optimisation; of several goals the one that is worst counts.

    Attributes:
        goals: at least one.
    """

    goals: tuple[Objective, ...]
    limits: tuple[ResponseConstraint, ...] = ()

    @property
    def responses(self) -> tuple[Response, ...]:
        """Those of the goals, then those of the limits."""
        return (*(g.response for g in self.goals), *(r.response for r in self.limits))

    @property
    def functions(self) -> tuple[Callable[[Design], jax.Array], ...]:
        """The scaled functions in the same order."""
        return (*(g.scaled for g in self.goals), *(r.scaled for r in self.limits))

    @property
    def worst_of_several(self) -> bool:
        """True where the largest of several goals is minimised."""
        return len(self.goals) > 1
