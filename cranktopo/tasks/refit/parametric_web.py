"""A web of the family on cells: signed distances, manufacturing constraints, and their exact derivatives."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Iterable, Iterator
from dataclasses import dataclass
from itertools import combinations
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cranktopo.base.arrays import Array
from cranktopo.design.free_dimensions import is_of_counterweight
from cranktopo.design.schema import Scene
from cranktopo.numerics.optimisers.gradient_search import central_difference, complex_step
from cranktopo.tasks.refit.family import Layout, all_bounds, flank_of, named_parts, scene_at, size_rules
from cranktopo.tasks.refit.model_fill import ADDED, CHORDS, FILLET, Fill, MovedFillet, added_mm, moved_fillet
from cranktopo.tasks.refit.seat_rules import seat_rules
from cranktopo.tasks.refit.zone_rules import zone_points, zone_rules
from cranktopo.throw.drilling.table import drilling_rules
from cranktopo.throw.feature import least_shoulder_mm
from cranktopo.throw.fitted import (
    CLEAR_MM,
    JOURNALS,
    Axes,
    FittedFeature,
    Named,
    Rule,
    Surroundings,
    shoulder_rule,
    wall_rule,
)
from cranktopo.throw.manufacturing_limits import ManufacturingLimits
from cranktopo.throw.profile import Flank

_CHECKS, _POINTS = 8, 16
_LEAST_RISE = 0.01
"""Least rise in y per mm along the outline, which keeps its half-width single-valued."""
_BEND_MARGIN = 0.99
_RADIUS, _RISE = "least radius of the outline", "the outline does not fold back"
NO_LENGTHS = _RADIUS, _RISE
"""Beginnings of the names of rules whose excess is no length."""


def outline_rules(flank: Flank, scene: Scene, limits: ManufacturingLimits) -> list[Rule]:
    """Return rules of the outline alone, each an array: curvature times the least radius less 1, rise, reach.

    Analytic in the flank, so that a complex step differentiates them.
    """
    u = (np.arange(_CHECKS) + 0.5) / _CHECKS
    points = flank.at((np.arange(_POINTS) + 0.5) / _POINTS).reshape(-1, 2)
    bend = flank.curvature_per_mm(np.linspace(0, 1, _CHECKS)).ravel() * limits.min_radius_mm
    (main, main_reach), (pin, pin_reach) = reaches = reaches_mm(scene, limits)
    low, high = flank.points_mm[0, 1], flank.points_mm[-1, 1]
    radius = f"{_RADIUS}, {limits.min_radius_mm:.3g} mm"
    beside = _reach_names(scene, limits)
    found: list[Rule] = [(radius, bend - _BEND_MARGIN), (radius, -bend - _BEND_MARGIN)]
    found.append((_RISE, _LEAST_RISE - _rises(flank, u)))
    for name, (y, reach) in zip(beside, reaches, strict=True):
        found.append((name, reach - np.sqrt(points[:, 0] ** 2 + (points[:, 1] - y) ** 2)))
    ends = np.stack([main_reach - main + low]), np.stack([pin_reach + pin - high])
    return [*found, *zip(beside, ends, strict=True)]


def _reach_names(scene: Scene, limits: ManufacturingLimits) -> list[str]:
    least = least_shoulder_mm(scene.throw)
    return [
        wall_rule(f"between the outline and the bore of the {name}", limits.min_wall_mm)
        if journal.bore_radius_mm + limits.min_wall_mm > journal.clear_radius_mm + least
        else shoulder_rule(name)
        for name, (journal, _) in zip(JOURNALS, scene.throw.journals, strict=True)
    ]


def _rises(flank: Flank, u: Array) -> Any:
    """Return rise in y per mm along the outline, which must not turn: at u of the inner pieces, at both ends.

    At a round end the rise starts from 0 and is quadratic, so its first slope and its value at the piece's
    other end bound it.
    """
    inner = flank.derivatives(u)[0][1:-1, :, 1].ravel()
    first, second = flank.derivatives(np.array([0.0, 1.0]))
    lengths = flank.lengths_mm
    ends = [second[0, 0, 1] * lengths[0], first[0, 1, 1], -second[-1, 1, 1] * lengths[-1], first[-1, 0, 1]]
    return np.concatenate([inner, np.stack(ends)])


def _rules_of(part: FittedFeature, own: Named, around: Surroundings) -> Iterator[Rule]:
    return part.rules(own, around)


def part_rules(
    parts: tuple[FittedFeature, ...],
    points: Array,
    values: Array,
    scene: Scene,
    limits: ManufacturingLimits,
    rules_of: Callable[[FittedFeature, Named, Surroundings], Iterable[Rule]] = _rules_of,
) -> list[Rule]:
    """Return the rules of the features, mm: walls, shoulders, access; points of the outline's right half."""
    named = list(named_parts(parts, values))
    arcs = (part.arc(own, points[[0, -1], 1]) for part, own in named)
    around = Surroundings(scene, limits, points, tuple(arc for arc in arcs if arc is not None))
    found = [rule for part, own in named for rule in rules_of(part, own, around)]
    every = ((part.title, part.box_mm(own, around)) for part, own in named)
    boxes = [(title, box) for title, box in every if box is not None]
    found += drilling_rules(around, boxes)
    for (one, low), (other, high) in combinations(boxes, 2):
        between = wall_rule(f"between the {one} and the {other}", limits.min_wall_mm)
        found.append((between, around.wall_mm - _apart(low, high)))
    return found


def _edge_rules(scene: Scene, points: Array, fillet: MovedFillet | None) -> Iterator[Rule]:
    """Yield that outline and fillet end before the bevelled edge of a counterweight, where it has one."""
    weight, apart = scene.web.counterweight, least_shoulder_mm(scene.throw) + CLEAR_MM
    for cut in weight.bevels(scene)[:1] if weight is not None else ():
        inside = cut.inside_section_mm(cut.side * points[:, 0], points[:, 1]).max()
        yield "the outline stays clear of the bevelled edge", inside + apart
        if fillet is not None:
            reach = fillet.circle.reach_mm
            yield (
                "the fillet of the counterweight ends before its bevelled edge",
                reach + apart - cut.start_mm,
            )


def reaches_mm(scene: Scene, limits: ManufacturingLimits) -> list[tuple[float, float]]:
    """Return the axes along the throw and the outline's minimum distance from each: bore wall, fillet."""
    least = least_shoulder_mm(scene.throw)
    return [
        (y, max(j.bore_radius_mm + limits.min_wall_mm, j.clear_radius_mm + least) + CLEAR_MM)
        for j, y in scene.throw.journals
    ]


def _apart(one: Array, other: Array) -> Any:
    """Return the distance of two boxes along the axis that parts them most, mm; negative where they meet."""
    return np.maximum(one[0] - other[1], other[0] - one[1]).max()


_DIFFERENCE = 1e-6
"""Step of the derivatives of walls by dimensions of the throw, mm or degrees."""


@dataclass(frozen=True)
class _Shape:
    """Points of an outline and its constraints, with their derivatives by its parameters (last axis)."""

    points: Array
    constraints: Array
    point_gradients: Array
    constraint_gradients: Array


class _Outline:
    """The outline of a parameter vector, the last one kept; derivatives by complex steps."""

    def __init__(self, layout: Layout, scene: Scene, limits: ManufacturingLimits) -> None:
        self._layout, self._scene, self._limits = layout, scene, limits
        self._last: tuple[bytes, _Shape] | None = None

    def at(self, values: Array) -> _Shape:
        own = np.concatenate([values[: self._layout.stations], self._layout.sizes(values)])
        if self._last is None or self._last[0] != own.tobytes():
            self._last = own.tobytes(), self._shape(own[: self._layout.stations], values)
        return self._last[1]

    def _shape(self, own: Array, values: Array) -> _Shape:
        scene = scene_at(self._scene, self._layout, values)
        points, constraints = self._raw(own, scene)
        both = complex_step(lambda v: np.concatenate([part.ravel() for part in self._raw(v, scene)]), own)
        point_gradients, constraint_gradients = np.split(both, [points.size])
        point_gradients = point_gradients.reshape(*points.shape, len(own))
        by_sizes = self._by_sizes(own, values)
        return _Shape(points, constraints, point_gradients, np.hstack([constraint_gradients, by_sizes]))

    def _by_sizes(self, own: Array, values: Array) -> Array:
        """Return the derivatives of the constraints by the parameters after those of the outline."""
        places = range(len(values) - len(self._layout.dimensions), len(values))

        def constraints(moved: Array) -> Array:
            found: Array = self._raw(own, scene_at(self._scene, self._layout, moved))[1]
            return found

        return central_difference(constraints, values, _DIFFERENCE, places)[:, len(own) :]

    def _raw(self, own: Any, scene: Scene) -> tuple[Any, Any]:
        flank = flank_of(self._layout, own)
        rules = outline_rules(flank, scene, self._limits)
        return flank.along(CHORDS), np.concatenate([values for _, values in rules])

    def rule_names(self, values: Array) -> list[str]:
        """Return the name of each constraint."""
        scene = scene_at(self._scene, self._layout, values)
        rules = outline_rules(flank_of(self._layout, values), scene, self._limits)
        return [name for name, values in rules for _ in values]


_Known = dict[tuple[Hashable, ...], tuple[Rule, ...]]
"""Rules of features by feature, values and surroundings."""


class ParametricWeb:
    """A web of the family on a grid of cells, as functions of its parameters, with their bounds."""

    def __init__(self, layout: Layout, scene: Scene, limits: ManufacturingLimits, axes: Axes) -> None:
        self.layout, self.bounds = layout, all_bounds(layout, scene, limits)
        self._scene, self._limits, self._zones = scene, limits, zone_points(scene)
        self._grid = Fill(layout.parts, axes, scene.web_z_mm)
        self._weight = [name for name in layout.dimensions if is_of_counterweight(name)]
        self._own_added = added_mm(scene, axes)
        self._outline = _Outline(layout, scene, limits)
        self._last: tuple[bytes, MovedFillet | None] = b"", None

    def points(self, values: Array) -> tuple[Array, Array]:
        """Return points of the outline's right half, (n, 2), mm, and derivatives by its values, (n, 2, m)."""
        shape = self._outline.at(values)
        return shape.points, shape.point_gradients

    def inside_mm(self, values: Array) -> tuple[Array, NDArray[np.int8]]:
        """Return the signed distance of every cell, (nx, ny, nz), mm, and which field it is of."""
        return self._grid.inside_mm(self._outline.at(values).points, self._parts(values), self._added(values))

    def vjp(self, values: Array, which: NDArray[np.int8], weight: Array) -> Array:
        """Return the derivative of sum(weight * inside_mm) by the parameters."""
        shape = self._outline.at(values)
        by_points, by_parts = self._grid.vjp(shape.points, self._parts(values), which, weight)
        by_sizes = self._by_sizes(values, np.where(which == ADDED, weight, 0.0))
        result = np.concatenate([np.tensordot(by_points, shape.point_gradients, 2), by_parts, by_sizes])
        fillet = self.fillet(values)
        if fillet is not None:
            result += fillet.vjp(self._grid.axes, np.where(which == FILLET, weight, 0.0))
        return result

    def _added(self, values: Array) -> dict[int, Array]:
        """Return the signed distances from the counterweight and its fillets, by number of the field."""
        sector = self._moved_added(values) if self._weight else self._own_added
        fillet = self.fillet(values)
        fields = {} if sector is None else {ADDED: sector}
        return fields if fillet is None else {**fields, FILLET: fillet.inside_mm(self._grid.axes)}

    def fillet(self, values: Array) -> MovedFillet | None:
        """Return the counterweight's fillet, the last one kept."""
        if self._last[0] != values.tobytes():
            self._last = values.tobytes(), moved_fillet(self._scene, self.layout, values)
        return self._last[1]

    def _moved_added(self, values: Array) -> Array:
        found = added_mm(scene_at(self._scene, self.layout, values), self._grid.axes)
        assert found is not None
        return found

    def _by_sizes(self, values: Array, weight: Array) -> Array:
        """Return the derivative of sum(weight * counterweight distance) by the dimensions of the throw."""
        result = np.zeros(len(self.layout.dimensions))
        for name in self._weight:
            step = _DIFFERENCE * np.eye(len(values))[self.layout.names.index(name)]
            above, below = (np.sum(weight * self._moved_added(values + s * step)) for s in (1, -1))
            result[self.layout.dimensions.index(name)] = (above - below) / (2 * _DIFFERENCE)
        return result

    def constraints(self, values: Array) -> Array:
        """Return the manufacturing constraints, kept where <= 0."""
        shape = self._outline.at(values)
        fillet = self.fillet(values)
        own = [] if fillet is None else [fillet.rule[1]]
        return np.concatenate([shape.constraints, self._part_constraints(shape.points, values), own])

    def rule_names(self, values: Array) -> tuple[str, ...]:
        """Return the name of each constraint in plain English, several parts of one rule alike."""
        points = self._outline.at(values).points
        names = [name for name, each in self._part_rules(points, values) for _ in range(np.size(each))]
        fillet = self.fillet(values)
        return (*self._outline.rule_names(values), *names, *([] if fillet is None else [fillet.rule[0]]))

    def gradients(self, values: Array) -> Array:
        """Return the gradients of the constraints (constraints, parameters)."""
        shape, n = self._outline.at(values), self.layout.stations
        known: _Known = {}

        def parts(step: Array) -> Array:
            points = shape.points + shape.point_gradients @ step[:n]
            return self._part_constraints(points, values + step, known)

        steps = _DIFFERENCE * np.eye(len(values))
        below = np.stack([(parts(step) - parts(-step)) / (2 * _DIFFERENCE) for step in steps], axis=1)
        fillet = self.fillet(values)
        own = [] if fillet is None else [fillet.rule_gradients]
        return np.vstack([shape.constraint_gradients, below, *own])

    def _parts(self, values: Array) -> Array:
        return values[self.layout.stations :]

    def _part_constraints(self, points: Array, values: Array, known: _Known | None = None) -> Array:
        rules = self._part_rules(points, values, known)
        return np.hstack([np.zeros(0), *(value for _, value in rules)])

    def _part_rules(self, points: Array, values: Array, known: _Known | None = None) -> list[Rule]:
        """Return the rules of the features and of the dimensions of the throw.

        Args:
            known: rules of features found before, which a step of another one's parameter leaves as they are.
        """
        scene = scene_at(self._scene, self.layout, values)
        outline = points.tobytes(), self.layout.sizes(values).tobytes()
        found: _Known = {} if known is None else known

        def rules_of(part: FittedFeature, own: Named, around: Surroundings) -> tuple[Rule, ...]:
            key = part, own, around.arcs, outline
            if key not in found:
                found[key] = tuple(part.rules(own, around))
            return found[key]

        parts = part_rules(self.layout.parts, points, self._parts(values), scene, self._limits, rules_of)
        sizes = size_rules(self.layout, values, self._scene, self._limits)
        own = [*parts, *_edge_rules(scene, points, self.fillet(values)), *sizes]
        named = list(named_parts(self.layout.parts, self._parts(values)))
        own += seat_rules(scene, points, named)
        if self._zones is None:
            return own
        return [*own, *zone_rules(self._zones, scene, points, named, self.fillet(values))]
