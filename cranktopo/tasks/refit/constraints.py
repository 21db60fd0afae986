"""Manufacturing constraints of the fit, each kept where it is <= 0: walls, radii, access of a tool."""

from __future__ import annotations

from itertools import combinations
from typing import Any

import numpy as np

from cranktopo.base.arrays import Array
from cranktopo.design.manufacturing_limits import ManufacturingLimits
from cranktopo.design.schema import Scene
from cranktopo.tasks.refit.family import named_parts
from cranktopo.throw.drilling.walls import drilling_rules
from cranktopo.throw.feature import least_shoulder_mm
from cranktopo.throw.fitted import (
    CLEAR_MM,
    JOURNALS,
    FittedFeature,
    Rule,
    Surroundings,
    shoulder_rule,
    wall_rule,
)
from cranktopo.throw.flank import Flank

_CHECKS, _POINTS = 8, 16
_LEAST_RISE = 0.01
"""Least rise in y per mm along the outline, which keeps its half-width single-valued."""
_BEND_MARGIN = 0.99
_RADIUS, _RISE = "least radius of the outline", "the outline does not fold back"
NO_LENGTHS = _RADIUS, _RISE
"""How the names of rules begin whose excess is no length."""


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
        if journal.bore_radius_mm + limits.min_wall_mm > journal.radius_mm + journal.fillet_mm + least
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


def part_rules(
    parts: tuple[FittedFeature, ...], points: Array, values: Array, scene: Scene, limits: ManufacturingLimits
) -> list[Rule]:
    """Return the rules of the features, mm: walls, shoulders, access; points of the outline's right half."""
    named = list(named_parts(parts, values))
    arcs = (part.arc(own, points[[0, -1], 1]) for part, own in named)
    around = Surroundings(scene, limits, points, tuple(arc for arc in arcs if arc is not None))
    found = [rule for part, own in named for rule in part.rules(own, around)]
    every = ((part.title, part.box_mm(own, around)) for part, own in named)
    boxes = [(title, box) for title, box in every if box is not None]
    found += drilling_rules(around, boxes)
    for (one, low), (other, high) in combinations(boxes, 2):
        between = wall_rule(f"between the {one} and the {other}", limits.min_wall_mm)
        found.append((between, around.wall_mm - _apart(low, high)))
    return found


def reaches_mm(scene: Scene, limits: ManufacturingLimits) -> list[tuple[float, float]]:
    """Return the axes along the throw and the outline's minimum distance from each: bore wall, fillet."""
    least = least_shoulder_mm(scene.throw)
    return [
        (y, max(j.bore_radius_mm + limits.min_wall_mm, j.radius_mm + j.fillet_mm + least) + CLEAR_MM)
        for j, y in scene.throw.journals
    ]


def _apart(one: Array, other: Array) -> Any:
    """Return the distance of two boxes along the axis that parts them most, mm; negative where they meet."""
    return np.maximum(one[0] - other[1], other[0] - one[1]).max()
