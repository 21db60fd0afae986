"""Holes in the ends of a crank that no tool reaches: bores and bolt holes with solid steps at both faces."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from cranktopo.throw.crank_end import BodyStep, EndStep, Slot
from cranktopo.throw.journal import Journal

_JOURNAL = -1


@dataclass(frozen=True)
class EndHole:
    """A hole along the crank through a step of an end.

    Attributes:
        step: number of its step from the main journal outwards; -1 for the journal's own bore.
        key: the step's key of its diameter.
        axis_mm: x and y of its axis.
    """

    step: int
    key: str
    axis_mm: tuple[float, float]
    radius_mm: float

    @property
    def reach_mm(self) -> float:
        """Distance of its farthest point from the crank axis."""
        return math.hypot(*self.axis_mm) + self.radius_mm

    def meets(self, other: EndHole) -> bool:
        """Tell whether both are one hollow where their steps meet."""
        apart = math.dist(self.axis_mm, other.axis_mm)
        return abs(self.step - other.step) == 1 and apart < self.radius_mm + other.radius_mm


def closed_hole(journal: Journal, steps: Sequence[EndStep]) -> EndHole | None:
    """Return the first hole of an end, beyond its outer main journal, that is open nowhere, if there is one.

    The bore of the main journal is open: it runs through the web. What a body from CAD covers is unknown,
    and taken as open.
    """
    closed = [hole for number, step in enumerate(steps) for hole in _holes(number, step)]
    reached = [hole for hole in closed if _at_air(hole, journal, steps)]
    if journal.bore_diameter_mm:
        reached.append(EndHole(_JOURNAL, "bore_diameter_mm", (0.0, 0.0), journal.bore_diameter_mm / 2))
    while reached:
        closed = [hole for hole in closed if hole not in reached]
        reached = [hole for hole in closed if any(hole.meets(other) for other in reached)]
    return next(iter(closed), None)


def _holes(number: int, step: EndStep) -> list[EndHole]:
    bore = [EndHole(number, "bore_diameter_mm", (0.0, 0.0), step.bore_radius_mm)]
    bolts = [EndHole(number, "bolt_diameter_mm", (x, y), radius) for x, y, radius in step.bolt_holes_mm]
    return [*(bore if step.bore_radius_mm else []), *bolts]


def _at_air(hole: EndHole, journal: Journal, steps: Sequence[EndStep]) -> bool:
    """Tell whether a neighbour leaves a part of the hole uncovered, or there is none outside."""
    if hole.step == len(steps) - 1 or _leaves(steps[hole.step + 1], 0, hole):
        return True
    if hole.step == 0:
        return hole.reach_mm > journal.outer_diameter_mm / 2
    return _leaves(steps[hole.step - 1], 1, hole)


def _leaves(neighbour: EndStep, face: int, hole: EndHole) -> bool:
    """Tell whether a step's inner (0) or outer (1) face, or its keyway, leaves a part of a hole uncovered."""
    if isinstance(neighbour, BodyStep) or hole.reach_mm > neighbour.radii_mm[face]:
        return True
    return neighbour.slot is not None and _in_keyway(neighbour.slot, hole)


def _in_keyway(slot: Slot, hole: EndHole) -> bool:
    x, y = hole.axis_mm
    sine, cosine = math.sin(math.radians(slot.angle_deg)), math.cos(math.radians(slot.angle_deg))
    aside, along = abs(x * cosine - y * sine), x * sine + y * cosine
    gap = math.hypot(max(aside - slot.width_mm / 2, 0.0), max(slot.bottom_mm - along, 0.0))
    return gap < hole.radius_mm
