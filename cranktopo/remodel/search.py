"""Bounded search for the parameters: sequential quadratic programming with exact gradients."""

from __future__ import annotations

from contextlib import suppress
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cranktopo.remodel.constraints import outline_constraints, part_constraints
from cranktopo.remodel.family import Layout, bounds, flank_of
from cranktopo.remodel.manufacturing_limits import ManufacturingLimits
from cranktopo.remodel.model_fill import CHORDS, Fill, smooth_step
from cranktopo.remodel.voxel_fill import VoxelFill
from cranktopo.scene import Scene

Array = NDArray[np.float64]
_TOLERANCE = 1e-4
_FLAT = 1e-8
_FEASIBLE = 1e-6
_KEPT = 5e-3
"""Violation that rounding of the parameters absorbs."""
_EVALUATIONS = 200
_COMPLEX = 1e-30
_DIFFERENCE = 1e-6
"""Steps of the derivatives of outline and walls, mm or degrees."""
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


@dataclass(frozen=True)
class _Shape:
    """Points of an outline and its constraints, with their derivatives by its parameters (last axis)."""

    points: Array
    constraints: Array
    point_slopes: Array
    constraint_slopes: Array


class _Outline:
    """The outline of a parameter vector, the last one kept; derivatives by complex steps."""

    def __init__(self, problem: FitProblem, stations: int) -> None:
        self._problem, self._layout = problem, Layout(stations)
        self._last: tuple[bytes, _Shape] | None = None

    def at(self, values: Array) -> _Shape:
        own = np.asarray(values[: self._layout.stations], dtype=np.float64)
        if self._last is None or self._last[0] != own.tobytes():
            self._last = own.tobytes(), self._shape(own)
        return self._last[1]

    def _shape(self, own: Array) -> _Shape:
        points, constraints = self._raw(own)
        sides = [self._raw(own + 1j * _COMPLEX * unit) for unit in np.eye(len(own))]
        point_slopes = np.stack([side[0].imag for side in sides], axis=-1) / _COMPLEX
        constraint_slopes = np.stack([side[1].imag for side in sides], axis=-1) / _COMPLEX
        return _Shape(points, constraints, point_slopes, constraint_slopes)

    def _raw(self, own: Any) -> tuple[Any, Any]:
        flank = flank_of(self._layout, own)
        constraints = outline_constraints(flank, self._problem.scene, self._problem.limits)
        return flank.along(CHORDS), constraints


class Fit:
    """How well a web fits, as functions of its parameters.

    Attributes:
        bounds: lower and upper bounds of their values, mm or degrees.
    """

    def __init__(self, problem: FitProblem, layout: Layout) -> None:
        self.layout = layout
        self.bounds = bounds(layout, problem.scene, problem.limits)
        cells = problem.target
        self._problem, self._target, self._free = problem, cells.filled, problem.free[:, :, None]
        self._grid = Fill(layout.parts, (cells.x_mm, cells.y_mm, cells.z_mm), problem.scene.web_z_mm)
        self._outline = _Outline(problem, layout.stations)

    def misfit(self, values: Array, width_mm: float) -> tuple[float, Array]:
        """Squared difference of the fills over the filled volume, and its gradient.

        Args:
            width_mm: half-width of the smooth step.
        """
        shape, parts = self._outline.at(values), self._parts(values)
        inside, which = self._grid.inside_mm(shape.points, parts)
        model, slope = smooth_step(inside, width_mm)
        off = model * self._free - self._target
        weight = 2 * off * self._free * slope / self._target.sum()
        by_points, by_parts = self._grid.pulled_back(shape.points, parts, which, weight)
        by_outline = np.tensordot(by_points, shape.point_slopes, 2)
        return float((off**2).sum() / self._target.sum()), np.concatenate([by_outline, by_parts])

    def fill(self, values: Array, width_mm: float) -> Array:
        """Fill of the cells (nx, ny, nz), bores cut out.

        Args:
            width_mm: half-width of the smooth step.
        """
        inside, _ = self._grid.inside_mm(self._outline.at(values).points, self._parts(values))
        return smooth_step(inside, width_mm)[0] * self._free

    def overlap(self, values: Array, width_mm: float) -> float:
        """Intersection over union of the fills.

        Args:
            width_mm: half-width of the smooth step.
        """
        model = self.fill(values, width_mm)
        return float(np.minimum(model, self._target).sum() / np.maximum(model, self._target).sum())

    def constraints(self, values: Array) -> Array:
        """Constraints, kept where <= 0."""
        shape = self._outline.at(values)
        return np.concatenate([shape.constraints, self._part_constraints(shape.points, values)])

    def slopes(self, values: Array) -> Array:
        """Gradients of the constraints (constraints, parameters)."""
        shape, n = self._outline.at(values), self.layout.stations

        def parts(step: Array) -> Array:
            return self._part_constraints(shape.points + shape.point_slopes @ step[:n], values + step)

        steps = _DIFFERENCE * np.eye(len(values))
        below = np.stack([(parts(step) - parts(-step)) / (2 * _DIFFERENCE) for step in steps], axis=1)
        above = np.hstack([shape.constraint_slopes, np.zeros((len(shape.constraints), len(values) - n))])
        return np.vstack([above, below])

    def _parts(self, values: Array) -> Array:
        return values[self.layout.stations :]

    def _part_constraints(self, points: Array, values: Array) -> Array:
        problem = self._problem
        return part_constraints(self.layout.parts, points, self._parts(values), problem.scene, problem.limits)


def search(fit: Fit, guess: Array, widths_mm: tuple[float, ...]) -> tuple[Array, float]:
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
    import nlopt

    best, least = guess, np.inf
    low, high = np.maximum(fit.bounds[0], guess - _REACH), np.minimum(fit.bounds[1], guess + _REACH)

    def value(values: Array, gradient: Array) -> float:
        nonlocal best, least
        result, slope = fit.misfit(values, width_mm)
        if gradient.size:
            gradient[:] = slope
        if result < least and np.max(fit.constraints(values)) < _KEPT:
            best, least = values.copy(), float(result)
        return float(result)

    def constrain(result: Array, values: Array, gradient: Array) -> None:
        if gradient.size:
            gradient[:] = fit.slopes(values)
        result[:] = fit.constraints(values)

    optimiser = nlopt.opt(nlopt.LD_SLSQP, len(guess))
    optimiser.set_min_objective(value)
    optimiser.add_inequality_mconstraint(constrain, np.full(len(fit.constraints(guess)), _FEASIBLE))
    optimiser.set_lower_bounds(low)
    optimiser.set_upper_bounds(high)
    optimiser.set_xtol_abs(_TOLERANCE)
    optimiser.set_ftol_rel(_FLAT)
    optimiser.set_maxeval(_EVALUATIONS)
    with suppress(nlopt.RoundoffLimited):
        optimiser.optimize(np.clip(guess, low, high))
    return best, least
