"""Orbit of a journal in a film that keeps its oil: the steady cycle of a finite bearing fed by hole or groove."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from cranktopo.base.arrays import Array, Complex
from cranktopo.base.errors import solver_error
from cranktopo.numerics.bearing_film.conserving import FilmState, Step, Supply, advanced
from cranktopo.numerics.bearing_film.film_cells import FilmCells
from cranktopo.numerics.bearing_film.orbit import JournalBearing, LoadedJournal

AROUND, ALONG = 180, 12
"""Cells around and along a half width."""
_CYCLES = 12
_SAME = 2e-3
"""Part of the least film and of the largest pressure by which they may differ from those of the cycle before."""
_HOLE = 1e3
"""Conductance of a hole to a cell, dimensionless: films have less than a tenth of it."""
_MM_PER_M = 1e3
_PA_PER_MPA = 1e6


@dataclass(frozen=True)
class OilFeed:
    """Oil that a bearing is fed with.

    Attributes:
        pressure_MPa: above that of cavitated oil and of the ends.
        hole_mm: diameter of a hole in the middle of the width; None: a groove all around parts the films.
        hole_rad: angle of the hole over the cycle, from where the eccentricity is real, in a frame that
            stands still.
    """

    pressure_MPa: float
    hole_mm: float | None = None
    hole_rad: Array | None = None


@dataclass(frozen=True)
class ConservedOrbit:
    """The steady cycle of a journal in a film that keeps its oil, at the angles of its load.

    Attributes:
        eccentricity: over the radial clearance, in the middle of the width.
        film_mm: least thickness of the whole film.
        pressure_MPa: largest.
        filled: part of the film's room that holds oil.
        fed_mm3_per_s: oil that hole or groove feeds.
        left_out: oil that no balance of a step accounts for, over that which a full film holds.
        cycles: until it repeated.
    """

    angle_deg: Array
    eccentricity: Complex
    film_mm: Array
    pressure_MPa: Array
    filled: Array
    fed_mm3_per_s: Array
    left_out: float
    cycles: int


def conserved_orbit(
    journal: LoadedJournal,
    angle_deg: Array,
    feed: OilFeed,
    start: complex,
    cells: FilmCells | None = None,
) -> ConservedOrbit:
    """Return the cycle, over cycles until film and pressure are those of the cycle before.

    Args:
        angle_deg: even steps over one cycle of the shaft, from 0, the end left out.
        start: eccentricity at 0 deg; the bearing is full there in the first cycle.

    Raises:
        CranktopoError: one that does not become steady, or a film without balance.
    """
    case = _Case.of(journal, angle_deg, feed, cells or _cells(journal.bearing, feed))
    full = case.cells.thickness(start, 0j).cell
    state = FilmState(full, np.zeros_like(full), start)
    last: tuple[float, float] | None = None
    for number in range(1, _CYCLES + 1):
        found = []
        for place in range(1, len(angle_deg) + 1):
            before, state = state, advanced(case.cells, state, case.step(place, number))
            found.append(case.reading(before, state, place, number))
        table = np.roll(np.array(found), 1, axis=0)
        now = float(table[:, 1].real.min()), float(table[:, 2].real.max())
        if last is not None and all(abs(a - b) <= _SAME * b for a, b in zip(now, last, strict=True)):
            return case.result(table, number)
        last = now
    raise solver_error(
        f"oil film: the mass-conserving film is not steady after {_CYCLES} cycles.",
        "Check load, clearance, viscosity and supply.",
    )


def _cells(bearing: JournalBearing, feed: OilFeed) -> FilmCells:
    ratio = bearing.width_mm / bearing.diameter_mm
    if feed.hole_mm is None:
        return FilmCells(AROUND, 2 * ALONG, ratio, "groove")
    return FilmCells(AROUND, ALONG, ratio, "symmetric")


@dataclass(frozen=True)
class _Case:
    """Everything of a cycle in the frame of the mean speed of journal and bearing.

    Attributes:
        frame: angle of this frame at each state, and at the first of the next cycle, rad.
        unit_Pa: pressure of the dimensionless unit.
    """

    journal: LoadedJournal
    feed: OilFeed
    cells: FilmCells
    angle_deg: Array
    frame: Array
    step_rad: float
    unit_Pa: float

    @classmethod
    def of(cls, journal: LoadedJournal, angle_deg: Array, feed: OilFeed, cells: FilmCells) -> _Case:
        step = math.radians(angle_deg[1] - angle_deg[0])
        own, sleeve = journal.surfaces_rad_s
        mean = np.broadcast_to((own + sleeve) / 2 / journal.speed_rad_s, len(angle_deg))
        frame = step * np.concatenate([[0.0], np.cumsum((mean + np.roll(mean, -1)) / 2)])
        bearing = journal.bearing
        slender = bearing.diameter_mm / 2 / bearing.clearance_mm
        unit = 12 * bearing.viscosity_Pas * journal.speed_rad_s * slender**2
        return cls(journal, feed, cells, angle_deg, frame, step, unit)

    def turn(self, place: int, cycle: int) -> complex:
        """Return where the frame's axis points at a state of a cycle."""
        return complex(np.exp(1j * (self.frame[place] + (cycle - 1) * self.frame[-1])))

    def step(self, place: int, cycle: int) -> Step:
        """Return the step that ends at a state of a cycle, 1 to their number."""
        states = len(self.angle_deg)
        area_m2 = self.journal.bearing.projected_mm2 / 2 / _MM_PER_M**2
        load = sum(self.journal.load_N[n % states] / self.turn(n, cycle) for n in (place - 1, place)) / 2
        return Step(self.step_rad, complex(load) / (self.unit_Pa * area_m2), 0j, self._supply(place, cycle))

    def _supply(self, place: int, cycle: int) -> Supply:
        pressure = self.feed.pressure_MPa * _PA_PER_MPA / self.unit_Pa
        cells = self.cells
        if self.feed.hole_mm is None or self.feed.hole_rad is None:
            return Supply(pressure, np.zeros((cells.around, cells.along)), at_begin=True)
        bearing = self.journal.bearing
        states = len(self.angle_deg)
        middle = sum(np.exp(1j * self.feed.hole_rad[n % states]) / self.turn(n, cycle) for n in (place - 1, place))
        away = np.abs(np.angle(np.exp(1j * cells.angle) / middle))
        around = _overlap(away, self.feed.hole_mm / bearing.diameter_mm, cells.step)
        along = _overlap(np.abs(cells.middles), self.feed.hole_mm / bearing.width_mm, cells.length)
        return Supply(pressure, _HOLE * np.outer(around, along), at_begin=False)

    def reading(self, before: FilmState, after: FilmState, place: int, cycle: int) -> tuple[complex, ...]:
        """Return eccentricity, least film, pressure, filling, fed oil, and oil that is not accounted for."""
        step, cells = self.step(place, cycle), self.cells
        film = cells.thickness(after.eccentricity, after.tilt)
        middle = cells.thickness((before.eccentricity + after.eccentricity) / 2, (before.tilt + after.tilt) / 2)
        g = cells.conductance(middle.around**3, middle.along**3)
        fed = float((step.supply.feed * (step.supply.pressure - after.pressure)).sum())
        begin = g.along[:, 0] * (step.supply.edge - after.pressure[:, 0])
        end = g.along[:, -1] * after.pressure[:, -1]
        grown = (after.oil - before.oil).sum() * cells.area / step.length
        kept = (fed + begin.sum() - end.sum() - grown) * step.length
        return (
            after.eccentricity * self.turn(place, cycle),
            1 - abs(after.eccentricity),
            after.pressure.max(),
            after.oil.sum() / film.cell.sum(),
            fed + begin.sum(),
            abs(kept) / (2 * math.pi * cells.half_widths),
        )

    def result(self, table: Complex, cycles: int) -> ConservedOrbit:
        bearing, speed = self.journal.bearing, self.journal.speed_rad_s
        half_mm = bearing.width_mm / 2
        flow = bearing.clearance_mm * bearing.diameter_mm / 2 * half_mm * speed
        flow *= bearing.films * 2 / self.cells.half_widths
        if self.cells.half_widths == 2:
            flow *= 1.0
        return ConservedOrbit(
            angle_deg=self.angle_deg,
            eccentricity=table[:, 0],
            film_mm=bearing.clearance_mm * table[:, 1].real,
            pressure_MPa=table[:, 2].real * self.unit_Pa / _PA_PER_MPA,
            filled=table[:, 3].real,
            fed_mm3_per_s=table[:, 4].real * flow,
            left_out=float(table[:, 5].real.max()),
            cycles=cycles,
        )


def _overlap(distance: Array, half: float, cell: float) -> Array:
    """Part of each cell that something covers, half as long as told, at distances of the middles."""
    return np.asarray(np.clip((half + cell / 2 - distance) / cell, 0.0, min(1.0, 2 * half / cell)))
