"""Bounded search for the parameters: sequential quadratic programming with exact gradients."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cranktopo.remodel.family import Layout, fill, violations
from cranktopo.remodel.occupancy import Occupancy
from cranktopo.remodel.rules import Rules
from cranktopo.scene import Scene

Array = NDArray[np.float64]
_TOLERANCE_MM = 1e-4
_FEASIBLE = 1e-6
_EVALUATIONS = 300
_REACH_MM = 15.0
"""How far a parameter may move from its start."""


@dataclass(frozen=True)
class Problem:
    """A fit: what to match and what to keep.

    Attributes:
        target: fill of the cells by the extracted body.
        free: (nx, ny) share of each cell that no bore takes.
        scene, rules: bounds.
    """

    target: Occupancy
    free: Array
    scene: Scene
    rules: Rules


def misfit(problem: Problem, layout: Layout, width_mm: float) -> Callable[[Array], tuple[float, Array]]:
    """Squared difference of the fills over the filled volume, with its gradient; call in double precision.

    Args:
        problem: the fit.
        layout: the parameters.
        width_mm: half-width of the smooth step.
    """
    import jax
    import jax.numpy as jnp

    target, free = jnp.asarray(problem.target.filled), jnp.asarray(problem.free)[:, :, None]

    def value(values: jax.Array) -> jax.Array:
        model = fill(layout, values, problem.target, width_mm) * free
        return ((model - target) ** 2).sum() / target.sum()

    both = jax.jit(jax.value_and_grad(value))

    def numpy_both(values: Array) -> tuple[float, Array]:
        result, gradient = both(jnp.asarray(values))
        return float(result), np.asarray(gradient)

    return numpy_both


def search(
    problem: Problem, layout: Layout, start: Array, widths_mm: tuple[float, ...]
) -> tuple[Array, float]:
    """Fit the parameters from one start, with ever sharper steps; call in double precision.

    Args:
        problem: the fit.
        layout: the parameters.
        start: first values.
        widths_mm: half-widths of the smooth step, one search each.

    Returns:
        Values and the last misfit.
    """
    import jax
    import jax.numpy as jnp

    limits = jax.jit(lambda v: violations(layout, v, problem.scene, problem.rules))
    slopes = jax.jit(jax.jacfwd(lambda v: violations(layout, v, problem.scene, problem.rules)))
    values, error = start, np.inf
    for width in widths_mm:
        values, error = _minimise(
            misfit(problem, layout, width),
            lambda v: np.asarray(limits(jnp.asarray(v))),
            lambda v: np.asarray(slopes(jnp.asarray(v))),
            values,
        )
    return values, error


def _minimise(
    objective: Callable[[Array], tuple[float, Array]],
    limits: Callable[[Array], Array],
    slopes: Callable[[Array], Array],
    start: Array,
) -> tuple[Array, float]:
    import nlopt

    def value(values: Array, gradient: Array) -> float:
        result, slope = objective(values)
        if gradient.size:
            gradient[:] = slope
        return result

    def constrain(result: Array, values: Array, gradient: Array) -> None:
        if gradient.size:
            gradient[:] = slopes(values)
        result[:] = limits(values)

    count = len(limits(start))
    optimiser = nlopt.opt(nlopt.LD_SLSQP, len(start))
    optimiser.set_min_objective(value)
    optimiser.add_inequality_mconstraint(constrain, np.full(count, _FEASIBLE))
    optimiser.set_lower_bounds(start - _REACH_MM)
    optimiser.set_upper_bounds(start + _REACH_MM)
    optimiser.set_xtol_abs(_TOLERANCE_MM)
    optimiser.set_maxeval(_EVALUATIONS)
    try:
        values = optimiser.optimize(start)
    except nlopt.RoundoffLimited:
        return start, objective(start)[0]
    return values, float(optimiser.last_optimum_value())
