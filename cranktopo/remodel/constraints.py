"""Manufacturing constraints of the fit, each kept where it is <= 0: walls, radii, access of a tool."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import combinations
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cranktopo.remodel.family import ROUNDING_MM, Bevel, FittedFeature, Pocket, named_parts
from cranktopo.remodel.manufacturing_limits import ManufacturingLimits
from cranktopo.remodel.model_fill import bevel_arc_of
from cranktopo.scene import Scene
from cranktopo.scene.bevel import BevelArc
from cranktopo.scene.checks_web import SHOULDER_MM
from cranktopo.scene.profile import Flank

Array = NDArray[np.float64]
_CHECKS, _POINTS = 8, 16
_LEAST_RISE = 0.01
"""Least rise in y per mm along the outline, which keeps its half-width single-valued."""
_CLEAR_MM = 2 * ROUNDING_MM
_BEND_MARGIN = 0.99
_ENDLESS_MM = 1e4


def outline_limits(flank: Flank, scene: Scene, rules: ManufacturingLimits) -> Array:
    """Constraints on the outline alone: curvature times the least radius less 1, rise, reach over journals.

    Analytic in the flank, so that a complex step differentiates them.

    Args:
        flank: right flank of the outline.
        scene: the journals.
        rules: least wall and least radius.
    """
    u = (np.arange(_CHECKS) + 0.5) / _CHECKS
    points = flank.at(np, (np.arange(_POINTS) + 0.5) / _POINTS).reshape(-1, 2)
    bend = flank.curvature_per_mm(np, np.linspace(0, 1, _CHECKS)).ravel() * rules.min_radius_mm
    (main, main_reach), (pin, pin_reach) = reaches = reaches_mm(scene, rules)
    low, high = flank.points_mm[0, 1], flank.points_mm[-1, 1]
    found = [bend - _BEND_MARGIN, -bend - _BEND_MARGIN, _LEAST_RISE - _rises(flank, u)]
    found += [reach - np.sqrt(points[:, 0] ** 2 + (points[:, 1] - y) ** 2) for y, reach in reaches]
    return np.concatenate([*found, [main_reach - main + low, pin_reach + pin - high]])


def _rises(flank: Flank, u: Array) -> Any:
    """Rise in y per mm along the outline, which must not turn: at u of the inner pieces, at both ends.

    At a round end the rise starts from 0 and is quadratic, so its first slope and its value at the piece's
    other end bound it.
    """
    inner = flank.derivatives(np, u)[0][1:-1, :, 1].ravel()
    first, second = flank.derivatives(np, np.array([0.0, 1.0]))
    lengths = flank.lengths_mm
    ends = [second[0, 0, 1] * lengths[0], first[0, 1, 1], -second[-1, 1, 1] * lengths[-1], first[-1, 0, 1]]
    return np.concatenate([inner, np.stack(ends)])


def part_limits(
    parts: tuple[FittedFeature, ...], points: Array, values: Array, scene: Scene, rules: ManufacturingLimits
) -> Array:
    """Constraints on bevels and pockets: walls, shoulders, access, mm.

    Args:
        parts: bevels and pockets.
        points: (n, 2) points of the outline's right half, mm.
        values: parameters of the parts.
        scene, rules: what is to be kept.
    """
    ends = points[[0, -1], 1]
    arcs = [
        (part, bevel_arc_of(part, named, ends))
        for part, named in named_parts(parts, values)
        if isinstance(part, Bevel)
    ]
    terms = [term for bevel, arc in arcs for term in _bevel(bevel, arc, scene, rules)]
    for part, named in named_parts(parts, values):
        if isinstance(part, Pocket) and part.face == "side":
            terms += _side(named, points[:, 0].max(), arcs, scene, rules)
        elif isinstance(part, Pocket):
            terms += _pocket(part, named, points, scene, rules)
    boxes = [
        _box(part, named, points[:, 0].max(), scene)
        for part, named in named_parts(parts, values)
        if isinstance(part, Pocket)
    ]
    terms += [rules.min_wall_mm + _CLEAR_MM - _apart(*pair) for pair in combinations(boxes, 2)]
    return np.array(terms, dtype=np.float64)


def reaches_mm(scene: Scene, rules: ManufacturingLimits) -> list[tuple[float, float]]:
    """Axes along the throw and the least distance of the outline from each: wall of the bore, fillet.

    Args:
        scene: the journals.
        rules: least wall.
    """
    return [
        (y, max(j.bore_radius_mm + rules.min_wall_mm, j.radius_mm + j.fillet_mm + SHOULDER_MM) + _CLEAR_MM)
        for j, y in scene.throw.journals
    ]


def _bevel(part: Bevel, arc: BevelArc, scene: Scene, rules: ManufacturingLimits) -> Iterator[Any]:
    """Clear of the journal on its face, a wall under the other journal's edge, no turning back."""
    main, pin = scene.throw.main_journal, scene.throw.crankpin
    journal, other = (main, pin) if part.face == "journal" else (pin, main)
    offset = 0.0 if part.face == "journal" else -scene.throw.radius_mm
    far = scene.throw.radius_mm if part.face == "journal" else 0.0
    yield offset + journal.radius_mm + journal.fillet_mm + SHOULDER_MM + _CLEAR_MM - arc.start_mm
    yield rules.min_wall_mm + arc.start_mm - arc.end_mm
    wall = scene.web.thickness_mm - rules.min_wall_mm
    yield -arc.distance_mm(np, wall, far + other.radius_mm)
    rise, run = arc.end_mm - arc.start_mm, arc.depth_mm
    yield 4 * arc.crown_mm - 0.95 * _twice_tangent(rise, run)


def _twice_tangent(rise: Any, run: Any) -> Any:
    """2 L tan(min(slope, 90 deg - slope) / 2): four times a crown this large makes the arc turn back."""
    chord = np.hypot(rise, run)
    shorter, longer = np.minimum(rise, run), np.maximum(rise, run)
    return 2 * chord * shorter / (chord + longer)


def _side(
    named: dict[str, Any],
    widest: Any,
    arcs: list[tuple[Bevel, BevelArc]],
    scene: Scene,
    rules: ManufacturingLimits,
) -> Iterator[Any]:
    """Flanges on both sides, walls toward bores and, unless it runs through them, bevels."""
    slope = np.tan(np.deg2rad(named["draft"]))
    deep = widest - named["floor"]
    tall = named["height"] / 2 + slope * deep
    wall = rules.min_wall_mm + _CLEAR_MM
    through = "length" not in named
    yield 1.0 - deep
    offset = named["offset"]
    yield tall + np.abs(offset) + wall - scene.web.thickness_mm / 2
    for journal, y in scene.throw.journals:
        if journal.bore_radius_mm:
            beyond = 0.0 if through else np.maximum(np.abs(y - named["y"]) - named["length"] / 2, 0.0)
            yield journal.bore_radius_mm + wall - np.hypot(named["floor"], beyond)
    for part, arc in () if through else arcs:
        reach = arc.outward * named["y"] + named["length"] / 2 + slope * deep
        depth = scene.web.thickness_mm / 2 + offset * (1.0 if part.face == "journal" else -1.0)
        yield wall - arc.distance_mm(np, depth - tall, reach)


def _box(part: Pocket, named: dict[str, Any], widest: Any, scene: Scene) -> Array:
    """Corners of the box around a pocket on the side x > 0, (2, 3), mm; z from the web's journal face."""
    thickness = scene.web.thickness_mm
    if part.face == "side":
        opening = np.tan(np.deg2rad(named["draft"])) * (widest - named["floor"])
        length, height = named.get("length", _ENDLESS_MM) / 2 + opening, named["height"] / 2 + opening
        y, z = named.get("y", 0.0), thickness / 2 + named["offset"]
        return np.array([[named["floor"], y - length, z - height], [_ENDLESS_MM, y + length, z + height]])
    x, y = named.get("x", 0.0), named["y"]
    sizes = ("diameter", "diameter") if part.shape == "cylinder" else ("size_x", "size_y")
    half_x, half_y = (named[size] / 2 for size in sizes)
    depth = named.get("depth", thickness)
    low = thickness - depth if part.face == "pin" else 0.0
    return np.array([[x - half_x, y - half_y, low], [x + half_x, y + half_y, low + depth]])


def _apart(one: Array, other: Array) -> Any:
    """Distance of two boxes along the axis that parts them most, mm; negative where they meet."""
    return np.maximum(one[0] - other[1], other[0] - one[1]).max()


def _pocket(
    part: Pocket, named: dict[str, Any], points: Any, scene: Scene, rules: ManufacturingLimits
) -> Iterator[Any]:
    """Walls toward bores and the outline, between twins, and journals out of the tool's way."""
    x, y = named.get("x", 0.0), named["y"]
    wall = rules.min_wall_mm + _CLEAR_MM

    def gap(px: Any, py: Any) -> Any:
        if part.shape == "cylinder":
            return np.sqrt((px - x) ** 2 + (py - y) ** 2 + 1e-12) - named["diameter"] / 2
        over_x, over_y = np.abs(px - x) - named["size_x"] / 2, np.abs(py - y) - named["size_y"] / 2
        outside = np.sqrt(np.maximum(over_x, 0.0) ** 2 + np.maximum(over_y, 0.0) ** 2 + 1e-12)
        return outside + np.minimum(np.maximum(over_x, over_y), 0.0)

    gaps = gap(points[:, 0], points[:, 1])
    yield wall - gaps[np.argmin(gaps)]
    if part.pair:
        yield wall / 2 + (named["diameter"] if part.shape == "cylinder" else named["size_x"]) / 2 - x
    for face, (journal, axis) in zip(("journal", "pin"), scene.throw.journals, strict=True):
        yield journal.bore_radius_mm + wall - gap(0.0, axis)
        if part.face in (face, "through"):
            yield journal.radius_mm + journal.fillet_mm + SHOULDER_MM - gap(0.0, axis)
