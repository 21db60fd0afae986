"""A crank as a body has it: main journals, crankpins, half throws, in places along its axis."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from cranktopo.base.arrays import Array
from cranktopo.base.frames import shortest_turn_deg
from cranktopo.tasks.importing.faces import from_line_mm


@dataclass(frozen=True)
class FoundJournal:
    """A main journal or crankpin as a body has it; places along the crank axis, mm.

    Attributes:
        faces_mm: the faces of the webs at its low and high end; of a body's end, that end.
        free: whether its low and its high end carry no web.
        bore_mm: diameter of the bore along it; 0 without one.
        centre_mm: a point on its axis.
    """

    radius_mm: float
    bore_mm: float
    faces_mm: tuple[float, float]
    free: tuple[bool, bool]
    centre_mm: Array

    @property
    def length_mm(self) -> float:
        """Length between the faces."""
        return self.faces_mm[1] - self.faces_mm[0]

    @property
    def middle_mm(self) -> float:
        """Place of its middle."""
        return sum(self.faces_mm) / 2


_MEET = 1e-3
"""Gap over the radius with which two half pins meet."""


def meet(low: FoundJournal, high: FoundJournal) -> bool:
    """Tell whether two crankpins meet without a web between them."""
    return abs(high.faces_mm[0] - low.faces_mm[1]) < _MEET * low.radius_mm


@dataclass(frozen=True)
class FoundKeyway:
    """A keyway along a whole step: its width, its depth below the cylinder, and the way that it opens."""

    width_mm: float
    depth_mm: float
    direction: Array


@dataclass(frozen=True)
class FoundBolts:
    """Equal holes through a step, evenly spaced on a circle about the axis; one lies in `direction`."""

    count: int
    circle_radius_mm: float
    radius_mm: float
    direction: Array


@dataclass(frozen=True)
class FoundStep:
    """A cylinder or cone of an end of the crank, beyond an outer main journal.

    Attributes:
        radius_mm: of a cone that at its inner face.
        outer_radius_mm: of a cone that at its outer face; None for a cylinder.
        bolts: the holes of a flange.
    """

    radius_mm: float
    bore_mm: float
    length_mm: float
    outer_radius_mm: float | None = None
    keyway: FoundKeyway | None = None
    bolts: FoundBolts | None = None


@dataclass(frozen=True)
class FoundHalf:
    """One web with the halves of both its journals: main and pin plane, mm along the axis.

    Attributes:
        throw: number of the throw from the low end, 1 first.
        main_length_mm, pin_length_mm: full lengths of the journals.
        web_mm: faces of the web at the main journal and at the pin.
    """

    throw: int
    main: FoundJournal
    pin: FoundJournal
    main_plane_mm: float
    pin_plane_mm: float
    web_mm: tuple[float, float]

    @property
    def main_length_mm(self) -> float:
        """Full length of the main journal."""
        return 2 * abs(self.web_mm[0] - self.main_plane_mm)

    @property
    def pin_length_mm(self) -> float:
        """Full length of the crankpin."""
        return 2 * abs(self.pin_plane_mm - self.web_mm[1])

    @property
    def thickness_mm(self) -> float:
        """Thickness of the web."""
        return abs(self.web_mm[1] - self.web_mm[0])

    @property
    def toward(self) -> float:
        """1 if the pin lies higher along the axis than the main journal, else -1."""
        return math.copysign(1.0, self.pin_plane_mm - self.main_plane_mm)


@dataclass(frozen=True)
class FoundCrank:
    """A crank as its faces show it.

    Attributes:
        origin_mm, axis: of the crank axis.
        halves: from the low end of the axis on.
        ends: steps of the low and of the high end outwards; None where the journal is cut.
        assumed: what the faces leave open, in words.
        unread: what was seen and is not in the halves, in words.
    """

    origin_mm: Array
    axis: Array
    journals: tuple[FoundJournal, ...]
    pins: tuple[FoundJournal, ...]
    halves: tuple[FoundHalf, ...]
    ends: tuple[tuple[FoundStep, ...] | None, tuple[FoundStep, ...] | None]
    assumed: tuple[str, ...]
    unread: tuple[str, ...]

    @property
    def flying(self) -> tuple[int, ...]:
        """Numbers of the pins that no main journal parts from the next one."""
        places = [(self.pins[i].middle_mm, self.pins[i + 1].middle_mm) for i in range(len(self.pins) - 1)]
        mains = [journal.middle_mm for journal in self.journals]
        return tuple(
            number
            for number, (low, high) in enumerate(places, 1)
            if not any(low < place < high for place in mains)
        )

    @property
    def split(self) -> tuple[int, ...]:
        """Numbers of the pins that meet the next one without a web between: both are one split pin."""
        return tuple(n for n in self.flying if meet(self.pins[n - 1], self.pins[n]))

    def throw_radius_mm(self, pin: FoundJournal) -> float:
        """Return the distance of a pin from the crank axis."""
        return from_line_mm(pin.centre_mm, self.origin_mm, self.axis)

    def direction(self, pin: FoundJournal) -> Array:
        """Return the unit vector from the crank axis to a pin."""
        away = pin.centre_mm - self.origin_mm
        away = away - (away @ self.axis) * self.axis
        return np.asarray(away / np.linalg.norm(away))

    def angle_deg(self, pin: FoundJournal) -> float:
        """Return the angle of a throw from the first one, 0 to 360, in the sense of a design's throw angles.

        That is left-handed about the axis, which runs from the free end.
        """
        return self.turn_deg(self.direction(pin))

    def splay_deg(self, number: int) -> float:
        """Return by how much the half pin after a number is ahead of that one, -180 to 180."""
        low, high = (self.angle_deg(self.pins[place]) for place in (number - 1, number))
        return round(shortest_turn_deg(high - low), 6)

    def turn_deg(self, own: Array) -> float:
        """Return the angle of a direction across the axis from the first throw, as `angle_deg`."""
        first = self.direction(self.pins[0])
        angle = math.degrees(math.atan2(float(np.cross(own, first) @ self.axis), float(first @ own)))
        return round(angle % 360, 6) % 360

    @property
    def words(self) -> str:
        """The crank in a line."""
        angles = ", ".join(f"{self.angle_deg(pin):g}" for pin in self.pins)
        pins = len(self.pins)
        return (
            f"{pins} throw{'s' * (pins != 1)} at {angles} deg, {len(self.journals)} main "
            f"journal{'s' * (len(self.journals) != 1)}, {len(self.halves)} web{'s' * (len(self.halves) != 1)}"
        )
