"""The zero of a function: that of SciPy, to the last digit."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
import pytest
from scipy.optimize import brentq

from cranktopo.base.root import root

FUNCTIONS: dict[str, tuple[Callable[[float], float], float, float]] = {
    "line": (lambda x: 3 * x - 1, 0.0, 1.0),
    "cubic": (lambda x: x**3 - 2 * x - 5, 2.0, 3.0),
    "cosine": (lambda x: math.cos(x) - x, 0.0, 1.0),
    "flat at the zero": (lambda x: (x - 0.3) ** 9, -1.0, 2.0),
    "step": (lambda x: math.copysign(1.0, x - 0.7), 0.0, 1.0),
    "pole beside": (lambda x: 1 / (x + 0.01) - 50, 0.0, 1.0),
    "falling": (lambda x: math.exp(-x) - 0.1, 0.0, 30.0),
    "ends turned about": (lambda x: x - 0.25, 1.0, 0.0),
}


@pytest.mark.parametrize("name", FUNCTIONS)
def test_it_is_that_of_scipy(name: str) -> None:
    function, low, high = FUNCTIONS[name]
    asked: list[float] = []

    def told(x: float) -> float:
        asked.append(x)
        return function(x)

    found = root(told, low, high, 1e-12)
    assert found == brentq(function, low, high, xtol=1e-12, maxiter=500)
    assert min(low, high) <= min(asked) <= max(asked) <= max(low, high)


def test_smooth_functions_take_few_steps() -> None:
    rng, steps = np.random.default_rng(3), 0
    for a, b, c in rng.uniform(0.1, 3.0, size=(200, 3)):
        asked: list[float] = []

        def told(x: float, a: float = a, b: float = b, c: float = c, asked: list[float] = asked) -> float:
            asked.append(x)
            return float(a * x**3 + b * x + math.sin(x) - c)

        found = root(told, 0.0, 30.0, 1e-12)
        assert found == brentq(told, 0.0, 30.0, xtol=1e-12)
        steps += len(asked)
    assert steps / 200 < 40


def test_an_end_may_be_the_zero() -> None:
    assert root(lambda x: x, 0.0, 1.0, 1e-9) == 0.0
    assert root(lambda x: x - 1, 0.0, 1.0, 1e-9) == 1.0


def test_without_a_change_of_sign_there_is_none() -> None:
    with pytest.raises(ValueError, match="no change of sign"):
        root(lambda x: x * x + 1, -1.0, 1.0, 1e-9)
