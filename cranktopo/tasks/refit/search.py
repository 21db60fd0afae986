"""Bounded search for the parameters: sequential quadratic programming with exact gradients."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from cranktopo.base.arrays import Array
from cranktopo.design.manufacturing_limits import ManufacturingLimits
from cranktopo.design.schema import Scene
from cranktopo.numerics.optimisers.gradient_search import minimise
from cranktopo.tasks.refit.family import Layout
from cranktopo.tasks.refit.model_fill import smooth_step
from cranktopo.tasks.refit.parametric_web import ParametricWeb
from cranktopo.tasks.refit.voxel_fill import VoxelFill

_TOLERANCE = 1e-4
_FLAT = 1e-8
_KEPT = 5e-3
"""Violation that rounding of the parameters absorbs."""
_EVALUATIONS = 200
_REACH = 15.0
"""How far a parameter may move in one search, mm or degrees."""


@dataclass(frozen=True)
class FitProblem:
    """A fit: what to match and what to keep.

    Attributes:
        target: fill of the cells by the extracted body.
        free: (nx, ny) share of each cell that no bore takes.
        scene, limits: what the web must keep.
    """

    target: VoxelFill
    free: Array
    scene: Scene
    limits: ManufacturingLimits


class Fit:
    """Misfit of a web, as functions of its parameters."""

    def __init__(self, problem: FitProblem, layout: Layout) -> None:
        cells = problem.target
        axes = cells.x_mm, cells.y_mm, cells.z_mm
        self.web = ParametricWeb(layout, problem.scene, problem.limits, axes)
        self._target, self._free = cells.filled, problem.free[:, :, None]

    def misfit(self, values: Array, width_mm: float) -> tuple[float, Array]:
        """Return the squared difference of the fills over the filled volume, and its gradient.

        Args:
            width_mm: half-width of the smooth step.
        """
        inside, which = self.web.inside_mm(values)
        model, steepness = smooth_step(inside, width_mm)
        off = model * self._free - self._target
        weight = 2 * off * self._free * steepness / self._target.sum()
        return float((off**2).sum() / self._target.sum()), self.web.vjp(values, which, weight)

    def fill(self, values: Array, width_mm: float) -> Array:
        """Return the fill of the cells (nx, ny, nz), bores cut out.

        Args:
            width_mm: half-width of the smooth step.
        """
        return smooth_step(self.web.inside_mm(values)[0], width_mm)[0] * self._free

    def overlap(self, values: Array, width_mm: float) -> float:
        """Return the intersection over union of the fills.

        Args:
            width_mm: half-width of the smooth step.
        """
        model = self.fill(values, width_mm)
        return float(np.minimum(model, self._target).sum() / np.maximum(model, self._target).sum())


def minimise_misfit(fit: Fit, guess: Array, widths_mm: tuple[float, ...]) -> tuple[Array, float]:
    """Fit the parameters from one initial guess, with ever sharper steps.

    Args:
        guess: initial values.
        widths_mm: half-widths of the smooth step, one search each.

    Returns:
        Values that keep the constraints, and their misfit; the misfit is infinite when none were found.
    """
    values, error = guess, np.inf
    for width in widths_mm:
        values, error = _minimise(fit, values, width)
        if not np.isfinite(error):
            break
    return values, error


def _minimise(fit: Fit, guess: Array, width_mm: float) -> tuple[Array, float]:
    best, least = guess, np.inf
    bounds = np.maximum(fit.web.bounds[0], guess - _REACH), np.minimum(fit.web.bounds[1], guess + _REACH)

    def value(values: Array) -> tuple[float, Array]:
        nonlocal best, least
        result, gradient = fit.misfit(values, width_mm)
        if result < least and np.max(fit.web.constraints(values)) < _KEPT:
            best, least = values.copy(), float(result)
        return float(result), gradient

    def constrain(values: Array) -> tuple[Array, Array]:
        return fit.web.constraints(values), fit.web.gradients(values)

    minimise(value, constrain, bounds, guess, _TOLERANCE, _EVALUATIONS, _FLAT)
    return best, least
