"""Orbit of a journal in a film that keeps its oil: the steady cycle of a bearing with hole or groove."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from cranktopo.base.arrays import Array, Complex
from cranktopo.base.errors import CranktopoError, solver_error
from cranktopo.base.units import MM2_PER_M2
from cranktopo.numerics.bearing_film.conserving import EULER, FilmState, FilmStep, Supply, advanced, inside
from cranktopo.numerics.bearing_film.film_cells import FilmCells
from cranktopo.numerics.bearing_film.orbit import JournalBearing, LoadedJournal, Orbit

_AROUND, _ALONG = (180, 720), 12
"""Least and most cells around, and those along half of a film."""
_ACROSS = 4.0
"""Cells in the angle over which the least film of the mobility method doubles: as many as carry, or more."""
_CYCLES = 30
_SAME = 2e-3
"""Part of the least film and of the largest pressure by which they may differ from the cycle before."""
_FEEDS = 1e3
"""Conductance of hole or groove to a cell, dimensionless: films have less than a tenth of it."""
_LEFT_OUT = 1e-8
"""Most oil, over that of a full film, that the balance of a step may leave out; it is below 1e-10."""
_LANDED, _PARTS = 2.0, (4, 2, 1)
"""Thickness of a cell that carries before a step, over that after it, above which the journal lands; numbers
of parts of such a step, the first that finds its balance taken."""
_PA_PER_MPA = 1e6


@dataclass(frozen=True)
class OilFeed:
    """Oil that a bearing is fed with, by a groove all around that parts its films, or by a hole.

    Attributes:
        pressure_MPa: above that of cavitated oil and of the ends.
        groove_mm: width of the groove.
        hole_mm: diameter of the hole in the middle of the width.
        hole_rad: angle of the hole over the cycle, from where the eccentricity is real, in a frame that
            stands still.
    """

    pressure_MPa: float
    groove_mm: float = 0.0
    hole_mm: float = 0.0
    hole_rad: Array | None = None


@dataclass(frozen=True)
class ConservedOrbit:
    """The steady cycle of a journal in a film that keeps its oil, at the angles of its load.

    Attributes:
        eccentricity: over the radial clearance, in the middle of the width.
        film_mm: least thickness of the whole film.
        pressure_MPa: largest, in the middle of the step that ends at the angle.
        filled: part of the film's room that holds oil.
        fed_mm3_per_s: oil that hole or groove feeds.
        left_out: oil that the balance of a step does not account for, over that of a full film.
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
    start: Orbit,
    tilt: Complex | None = None,
    cells: tuple[int, int] | None = None,
) -> ConservedOrbit:
    """Return the cycle, over cycles until film and pressure are those of the cycle before.

    Args:
        angle_deg: even steps over one cycle of the shaft, from 0, the end left out.
        start: by the mobility method, from 0 deg; the bearing is full there in the first cycle.
        tilt: eccentricity at the end of the bearing less that in its middle, in the frame of the load, less
            than 1; none of a journal that stays parallel to its bearing.
        cells: around the journal, an even number, and along half of a film; by default as the least film of
            the start needs them.

    Raises:
        CranktopoError: one that does not become steady, or a film or oil without balance.
    """
    share = float(start.film_mm.min()) / journal.bearing.clearance_mm
    case = _Case.of(journal, angle_deg, feed, tilt, cells or (_cells_around(share), _ALONG))
    begin = complex(case.tilt[0])
    place = inside(complex(start.eccentricity[0]), begin)
    full = case.cells.thickness(place, begin).cell
    state = FilmState(full, np.zeros_like(full), place, begin)
    last: tuple[float, float] | None = None
    for number in range(1, _CYCLES + 1):
        found = []
        for end in range(1, len(angle_deg) + 1):
            parts = _passed(case, state, end, number)
            state = parts[-1]
            found.append(case.reading(parts, end, number))
        table = np.roll(np.array(found), 1, axis=0)
        now = float(table[:, 1].real.min()), float(table[:, 2].real.max())
        if last is not None and all(abs(a - b) <= _SAME * b for a, b in zip(now, last, strict=True)):
            return _kept(case.result(table, number))
        last = now
    raise solver_error(
        f"oil film: the mass-conserving film is not steady after {_CYCLES} cycles.",
        "Feed more oil (supply_pressure_MPa, feed_hole_mm, feed_hole_deg), or check load and viscosity.",
    )


def _passed(case: _Case, before: FilmState, place: int, cycle: int) -> tuple[FilmState, ...]:
    """Return the film after a step, or after each of its parts where the journal lands on oil.

    Where its load turns, a journal crosses the void within a step. In the middle of that the film is thick
    and yields: by the midpoint rule the journal goes far too near to its bearing.
    """
    after = advanced(case.cells, before, case.step(place, cycle))
    if not _lands(case.cells, before, after):
        return (after,)
    for count in _PARTS[:-1]:
        try:
            return _in_parts(case, before, place, cycle, count)
        except CranktopoError:
            continue  # in a very short step a void resists next to nothing; a longer one finds its balance
    return _in_parts(case, before, place, cycle, _PARTS[-1])


def _in_parts(case: _Case, state: FilmState, place: int, cycle: int, count: int) -> tuple[FilmState, ...]:
    found = []
    for part in range(count):
        state = advanced(case.cells, state, case.step(place, cycle, part, count), (EULER,))
        found.append(state)
    return tuple(found)


def _lands(cells: FilmCells, before: FilmState, after: FilmState) -> bool:
    """Tell whether a cell that carries is far thinner than before the step."""
    was = cells.thickness(before.eccentricity, before.tilt).cell
    now = cells.thickness(after.eccentricity, after.tilt).cell
    return bool((was > _LANDED * now)[after.pressure > 0].any())


def _kept(found: ConservedOrbit) -> ConservedOrbit:
    """Return a cycle that keeps its oil; raises CranktopoError for one that loses some."""
    if found.left_out > _LEFT_OUT:
        raise solver_error(
            f"oil film: the mass-conserving film loses {found.left_out:.1e} of its oil in a step, above "
            f"{_LEFT_OUT:g}.",
            "Check clearance and viscosity; with ones of usual size, report this with the design.",
        )
    return found


def _cells_around(share: float) -> int:
    """Return an even number of cells for a least film over the clearance."""
    wanted = 2 * round(math.pi * _ACROSS / math.sqrt(2 * share))
    return min(max(wanted, _AROUND[0]), _AROUND[1])


def _cells(
    bearing: JournalBearing, feed: OilFeed, tilted: bool, counts: tuple[int, int]
) -> tuple[FilmCells, Array]:
    """Return the cells of a film, and those among them along the width that lie in a groove.

    A groove lies between the cells of parallel films; of tilted ones it takes whole cells, and the films keep
    their width.
    """
    (around, along), ratio = counts, bearing.width_mm / bearing.diameter_mm
    if not tilted:
        if feed.groove_mm:
            return FilmCells(around, 2 * along, ratio, "groove"), np.zeros(2 * along)
        return FilmCells(around, along, ratio, "symmetric"), np.zeros(along)
    if not feed.groove_mm:
        return FilmCells(around, 2 * along, ratio, "open"), np.zeros(2 * along)
    films = bearing.width_mm * bearing.films
    half = max(1, round(along * feed.groove_mm / (films + feed.groove_mm)))
    cells = FilmCells(around, 2 * along, films / bearing.diameter_mm * along / (along - half), "open")
    return cells, (np.abs(cells.middles) < half / along).astype(np.float64)


@dataclass(frozen=True)
class _Case:
    """Everything of a cycle in the frame of the mean speed of journal and bearing.

    Attributes:
        groove: 1 of the cells along the width in a groove, else 0.
        tilt: of the journal at each state, in the frame of the load.
        frame: angle of this frame at each state, and at the first of the next cycle, rad.
        unit_Pa: pressure of the dimensionless unit.
    """

    journal: LoadedJournal
    feed: OilFeed
    cells: FilmCells
    groove: Array
    angle_deg: Array
    tilt: Complex
    frame: Array
    step_rad: float
    unit_Pa: float

    @classmethod
    def of(
        cls,
        journal: LoadedJournal,
        angle_deg: Array,
        feed: OilFeed,
        tilt: Complex | None,
        counts: tuple[int, int],
    ) -> _Case:
        step, bearing = math.radians(angle_deg[1] - angle_deg[0]), journal.bearing
        own, sleeve = journal.surfaces_rad_s
        mean = np.broadcast_to((own + sleeve) / 2 / journal.speed_rad_s, len(angle_deg))
        frame = step * np.concatenate([[0.0], np.cumsum((mean + np.roll(mean, -1)) / 2)])
        slender = bearing.diameter_mm / 2 / bearing.clearance_mm
        unit = 12 * bearing.viscosity_Pas * journal.speed_rad_s * slender**2
        cells, groove = _cells(bearing, feed, tilt is not None, counts)
        tilt = np.zeros(len(angle_deg), dtype=complex) if tilt is None else tilt
        return cls(journal, feed, cells, groove, angle_deg, tilt, frame, step, unit)

    @property
    def alike(self) -> int:
        """Number of films side by side of which the cells are one."""
        return self.journal.bearing.films if self.cells.sides == "groove" else 1

    def turn(self, place: int, cycle: int) -> complex:
        """Return where the frame's axis points at a state of a cycle."""
        return complex(np.exp(1j * (self.frame[place] + (cycle - 1) * self.frame[-1])))

    def step(self, place: int, cycle: int, part: int = 0, parts: int = 1) -> FilmStep:
        """Return one of some equal parts of the step that ends at a state of a cycle, 1 to their number."""
        middle, end = (part + 0.5) / parts, (part + 1) / parts
        area_mm2 = self.cells.width_over_diameter * self.journal.bearing.diameter_mm**2 / 2
        per_unit_N = self.unit_Pa * area_mm2 / MM2_PER_M2 * self.alike
        load = self._within(self.journal.load_N, place, cycle, middle) / per_unit_N
        tilt = self._within(self.tilt, place, cycle, end)
        return FilmStep(self.step_rad / parts, load, tilt, self._supply(place, cycle, middle))

    def _within(self, values: Complex, place: int, cycle: int, share: float) -> complex:
        """Value at a share of a step, as the frame sees it, of one that stands still at both ends."""
        begin, end = (complex(values[n % len(values)]) / self.turn(n, cycle) for n in (place - 1, place))
        return (1 - share) * begin + share * end

    def _supply(self, place: int, cycle: int, share: float) -> Supply:
        pressure = self.feed.pressure_MPa * _PA_PER_MPA / self.unit_Pa
        cells, bearing, hole = self.cells, self.journal.bearing, self.feed.hole_rad
        if hole is None:
            strip = _FEEDS * self.groove * np.ones((cells.around, 1))
            return Supply(pressure, strip, at_begin=cells.sides == "groove")
        toward = self._within(np.exp(1j * hole), place, cycle, share)
        away = np.abs(np.angle(np.exp(1j * cells.angle) / toward))
        around = _overlap(away, self.feed.hole_mm / bearing.diameter_mm, cells.step)
        along = _overlap(np.abs(cells.middles), self.feed.hole_mm / bearing.width_mm, cells.length)
        return Supply(pressure, _FEEDS * np.outer(around, along), at_begin=False)

    def reading(self, parts: Sequence[FilmState], place: int, cycle: int) -> tuple[complex, ...]:
        """Return what is told of a step, of the films after its parts.

        Eccentricity, least film, pressure, filling, fed oil, and oil that is not accounted for.
        """
        after = parts[-1]
        filled = after.oil.sum() / self.cells.thickness(after.eccentricity, after.tilt).cell.sum()
        least = min(1 - abs(one.eccentricity + way * one.tilt) for one in parts for way in (-1, 1))
        pressure = max(float(one.pressure.max()) for one in parts)
        fed = sum(one.fed for one in parts) / len(parts)
        there = after.eccentricity * self.turn(place, cycle)
        return there, least, pressure, filled, fed, max(one.left_out for one in parts)

    def result(self, table: Complex, cycles: int) -> ConservedOrbit:
        """Return the readings of a cycle with their units."""
        bearing = self.journal.bearing
        width_mm = self.cells.width_over_diameter * bearing.diameter_mm * self.alike
        flow = bearing.clearance_mm * bearing.diameter_mm * width_mm / 2 * self.journal.speed_rad_s
        return ConservedOrbit(
            angle_deg=self.angle_deg,
            eccentricity=table[:, 0],
            film_mm=bearing.clearance_mm * table[:, 1].real,
            pressure_MPa=table[:, 2].real * self.unit_Pa / _PA_PER_MPA,
            filled=table[:, 3].real,
            fed_mm3_per_s=table[:, 4].real * flow / self.cells.half_widths,
            left_out=float(table[:, 5].real.max()),
            cycles=cycles,
        )


def _overlap(distance: Array, half: float, cell: float) -> Array:
    """Part of each cell that something covers, half as long as told, at distances of the middles."""
    return np.asarray(np.clip((half + cell / 2 - distance) / cell, 0.0, min(1.0, 2 * half / cell)))
