"""Bounded search for the parameters: sequential quadratic programming with exact gradients."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cranktopo.remodel.family import Layout, bounds
from cranktopo.remodel.fill import fill
from cranktopo.remodel.limits import violations
from cranktopo.remodel.occupancy import Occupancy
from cranktopo.remodel.rules import Rules
from cranktopo.scene import Scene

Array = NDArray[np.float64]
_TOLERANCE = 1e-4
_FLAT = 1e-6
_FEASIBLE = 1e-6
_KEPT = 5e-3
"""Violation that rounding of the parameters absorbs."""
_EVALUATIONS = 200
_REACH = 15.0
"""How far a parameter may move in one search, mm or degrees."""


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


def compiled(problem: Problem, layout: Layout) -> Fit:
    """The functions of a fit, compiled; call them in double precision."""
    import jax
    import jax.numpy as jnp

    target, free = jnp.asarray(problem.target.filled), jnp.asarray(problem.free)[:, :, None]

    def misfit(values: jax.Array, width_mm: float) -> jax.Array:
        model = fill(layout, values, problem.target, problem.scene, width_mm) * free
        return ((model - target) ** 2).sum() / target.sum()

    def overlap(values: jax.Array, width_mm: float) -> jax.Array:
        model = fill(layout, values, problem.target, problem.scene, width_mm) * free
        return jnp.minimum(model, target).sum() / jnp.maximum(model, target).sum()

    def limits(values: jax.Array) -> jax.Array:
        return violations(layout, values, problem.scene, problem.rules)

    return Fit(
        layout,
        jax.jit(jax.value_and_grad(misfit)),
        jax.jit(overlap),
        jax.jit(limits),
        jax.jit(jax.jacfwd(limits)),
        bounds(layout, problem.scene, problem.rules),
    )


@dataclass(frozen=True)
class Fit:
    """Compiled functions of a parameter vector.

    Attributes:
        layout: the parameters.
        misfit: (values, step half-width in mm) -> squared difference of the fills over the filled volume,
            with its gradient.
        overlap: (values, step half-width in mm) -> intersection over union of the fills.
        limits: values -> constraints, kept where <= 0.
        slopes: values -> their gradients.
        bounds: lower and upper bounds of the values.
    """

    layout: Layout
    misfit: Callable[[Array, float], tuple[Any, Any]]
    overlap: Callable[[Array, float], Any]
    limits: Callable[[Array], Any]
    slopes: Callable[[Array], Any]
    bounds: tuple[Array, Array]


def search(fit: Fit, start: Array, widths_mm: tuple[float, ...]) -> tuple[Array, float]:
    """Fit the parameters from one start, with ever sharper steps; call in double precision.

    Args:
        fit: the compiled functions.
        start: first values.
        widths_mm: half-widths of the smooth step, one search each.

    Returns:
        Values that keep the constraints, and their misfit; the misfit is infinite when none were found.
    """
    values, error = start, np.inf
    for width in widths_mm:
        values, error = _minimise(fit, values, width)
        if not np.isfinite(error):
            break
    return values, error


def _minimise(fit: Fit, start: Array, width_mm: float) -> tuple[Array, float]:
    import nlopt

    best, least = start, np.inf
    low, high = np.maximum(fit.bounds[0], start - _REACH), np.minimum(fit.bounds[1], start + _REACH)

    def value(values: Array, gradient: Array) -> float:
        nonlocal best, least
        result, slope = fit.misfit(values, width_mm)
        if gradient.size:
            gradient[:] = slope
        if result < least and np.max(fit.limits(values)) < _KEPT:
            best, least = values.copy(), float(result)
        return float(result)

    def constrain(result: Array, values: Array, gradient: Array) -> None:
        if gradient.size:
            gradient[:] = fit.slopes(values)
        result[:] = fit.limits(values)

    optimiser = nlopt.opt(nlopt.LD_SLSQP, len(start))
    optimiser.set_min_objective(value)
    optimiser.add_inequality_mconstraint(constrain, np.full(len(fit.limits(start)), _FEASIBLE))
    optimiser.set_lower_bounds(low)
    optimiser.set_upper_bounds(high)
    optimiser.set_xtol_abs(_TOLERANCE)
    optimiser.set_ftol_rel(_FLAT)
    optimiser.set_maxeval(_EVALUATIONS)
    with suppress(nlopt.RoundoffLimited):
        optimiser.optimize(np.clip(start, low, high))
    return best, least
