"""Orbit of a journal in its bearing under a load over a cycle: film thickness, pressure, friction."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np

from cranktopo.base.arrays import Array, Complex, Index
from cranktopo.base.errors import solver_error
from cranktopo.numerics.bearing_film.mobility import THICKNESS, Mobility, mobility
from cranktopo.numerics.planar_motion import motions

_TOLERANCE, _ROUGH = 1e-6, 1e-4
"""Of the eccentricity, a step; the latter in the first cycle, which only leads away from the start."""
_FEWEST, _CYCLES = 4, 30
"""A journal forgets its start by about 1e-4 in a cycle."""
_SAME = 1e-4
"""Part of the least film by which it may differ from that of the cycle before."""
_CLOSED = 1e-4
"""Distance, over the clearance, of begin and end of a cycle."""
_FLOOR = 2.0
"""Films of so many times the least that is resolved: below, what presses outward fades to nothing."""
LEAST_SHARE = float(THICKNESS[-1])
"""Film over the radial clearance below which nothing is resolved."""


@dataclass(frozen=True)
class JournalBearing:
    """A plain bearing and its oil; a circumferential groove makes it two bearings.

    Attributes:
        width_mm: of one film.
        films: how many of them carry side by side.
        clearance_mm: radial.
        viscosity_Pas: dynamic, of the oil in the film.
    """

    diameter_mm: float
    width_mm: float
    films: int
    clearance_mm: float
    viscosity_Pas: float

    @property
    def projected_mm2(self) -> float:
        """Projected area of all films."""
        return self.diameter_mm * self.width_mm * self.films


@dataclass(frozen=True)
class Orbit:
    """The steady cycle of a journal, at the angles of its load.

    Attributes:
        eccentricity: over the radial clearance, real and imaginary as the load.
        film_mm: least thickness.
        pressure_MPa: largest of the film.
        friction_W: power that the film takes.
        cycles: until it repeated.
    """

    angle_deg: Array
    eccentricity: Complex
    film_mm: Array
    pressure_MPa: Array
    friction_W: Array
    cycles: int


@dataclass(frozen=True)
class LoadedJournal:
    """A journal in its bearing under a load that repeats.

    Attributes:
        load_N: on the journal, toward where it moves; in a frame that stands still.
        speed_rad_s: of the shaft, over whose angle the load is given.
        surfaces_rad_s: angular speed of journal and bearing.
    """

    bearing: JournalBearing
    load_N: Complex
    speed_rad_s: float
    surfaces_rad_s: tuple[Array, Array]


def orbits(journals: Sequence[LoadedJournal], angle_deg: Array, start: complex = 0.5 + 0j) -> list[Orbit]:
    """Return the orbit of each journal, over cycles until it does the same; all of them at once.

    Args:
        angle_deg: even steps over one cycle of the shaft, from 0, the end left out.

    Raises:
        CranktopoError: one that does not become steady.
    """
    motion = _Motion.of(journals, math.radians(angle_deg[1] - angle_deg[0]))
    found: list[Orbit | None] = [None] * len(journals)
    left, least = np.arange(len(journals)), np.full(len(journals), np.inf)
    at, length = np.full(len(journals), start, dtype=complex), np.ones(len(journals))
    for number in range(1, _CYCLES + 1):
        slope, tolerance = partial(motion.slope, left), _ROUGH if number == 1 else _TOLERANCE
        path, length[left] = motions(slope, at[left], len(angle_deg), tolerance, length[left])
        before, least[left] = least[left], np.maximum(1 - np.abs(path).max(axis=0), LEAST_SHARE)
        at[left] = path[-1]
        same = np.abs(least[left] - before) <= _SAME * least[left]
        closed = np.abs(path[0] - path[-1]) < _CLOSED
        steady = same & closed & (number >= _FEWEST)
        for place in np.flatnonzero(steady):
            index = int(left[place])
            found[index] = _result(journals[index], motion, index, angle_deg, path[:-1, place], number)
        left = left[~steady]
        if not left.size:
            return [one for one in found if one is not None]
    raise solver_error(
        f"oil film: the orbit of the journal is not steady after {_CYCLES} cycles.",
        "Check load, clearance and viscosity.",
    )


@dataclass(frozen=True)
class _Motion:
    """Right-hand side of the motion of journals over the steps of their loads.

    Attributes:
        load, turning: by step and journal.
        step_rad: of the angle of the shaft.
    """

    films: Films
    load: Complex
    turning: Array
    step_rad: float

    @classmethod
    def of(cls, journals: Sequence[LoadedJournal], step_rad: float) -> _Motion:
        load = np.stack([journal.load_N for journal in journals], axis=1)
        means = [(j.surfaces_rad_s[0] + j.surfaces_rad_s[1]) / 2 / j.speed_rad_s for j in journals]
        turning = np.stack([np.broadcast_to(mean, len(load)) for mean in means], axis=1)
        films = Films.of([j.bearing for j in journals], np.array([j.speed_rad_s for j in journals]))
        return cls(films, load, turning, step_rad)

    def slope(self, left: Index, place: Array, eccentricity: Complex, which: Index) -> Complex:
        """Return the change over a step of some of the journals that are left."""
        step, one = place.astype(np.intp), left[which]
        part, i = place - step, step % len(self.load)
        j = (i + 1) % len(self.load)
        load = self.load[i, one] + part * (self.load[j, one] - self.load[i, one])
        turning = self.turning[i, one] + part * (self.turning[j, one] - self.turning[i, one])
        return self.step_rad * (self.films.squeeze(eccentricity, load, one) + 1j * turning * eccentricity)


@dataclass(frozen=True)
class Films:
    """Motion that loads give to the journals of several bearings in their oil.

    Attributes:
        per_load: of each bearing, change of the eccentricity over a radian by a unit load and mobility.
    """

    map: Mobility
    per_load: Array

    @classmethod
    def of(cls, bearings: Sequence[JournalBearing], speed_rad_s: Array) -> Films:
        """Return the films of bearings at the speeds of their shafts."""
        per_load = [_per_load(one, float(speed)) for one, speed in zip(bearings, speed_rad_s, strict=True)]
        return cls(mobility([one.width_mm / one.diameter_mm for one in bearings]), np.array(per_load))

    def squeeze(self, eccentricity: Complex, load: Complex, one: Index | int) -> Complex:
        """Change of the eccentricity by the load alone, per radian of the shaft; none outward at last."""
        change = np.abs(load) * self.per_load[one] * self.map.velocity(eccentricity, load, one)
        size = np.abs(eccentricity)
        near = size > 1 - _FLOOR * LEAST_SHARE
        if not near.any():
            return np.asarray(change)
        outward = (change * eccentricity.conj()).real / np.maximum(size, LEAST_SHARE)
        left = np.clip((1 - size) / (_FLOOR * LEAST_SHARE) - 1 / _FLOOR, 0.0, 1.0)
        faded = np.where(near & (outward > 0), (1 - left) * outward, 0.0)
        return np.asarray(change - faded * eccentricity / np.maximum(size, LEAST_SHARE))


def _per_load(bearing: JournalBearing, speed_rad_s: float) -> float:
    b = bearing
    radius_m, width_m, clearance_m = b.diameter_mm / 2e3, b.width_mm / 1e3, b.clearance_mm / 1e3
    return clearance_m**2 / (6 * b.viscosity_Pas * radius_m**3 * width_m * speed_rad_s * b.films)


def _result(
    journal: LoadedJournal, motion: _Motion, one: int, angle_deg: Array, path: Complex, cycles: int
) -> Orbit:
    size, load, bearing = np.abs(path), journal.load_N, journal.bearing
    return Orbit(
        angle_deg=angle_deg,
        eccentricity=path,
        film_mm=bearing.clearance_mm * np.maximum(1 - size, LEAST_SHARE),
        pressure_MPa=motion.films.map.peak_pressure(path, load, one) * np.abs(load) / bearing.projected_mm2,
        friction_W=_friction_W(journal, motion.films.squeeze(path, load, one), path),
        cycles=cycles,
    )


def _friction_W(journal: LoadedJournal, squeeze: Complex, path: Complex) -> Array:
    """Power that the film takes: of the oil that is sheared, and of the load on the oil that is squeezed out.

    The shear of a film all around is 2 pi mu R^3 L w^2 / (c sqrt(1 - e^2)), w the difference of the surfaces'
    speeds; journal and bearing share the moment of the load about the centre (J. F. Booker, ASME J. Basic
    Eng. 87, 1965).
    """
    bearing, load = journal.bearing, journal.load_N
    own, sleeve = journal.surfaces_rad_s
    radius_m, clearance_m = bearing.diameter_mm / 2e3, bearing.clearance_mm / 1e3
    width_m = bearing.width_mm * bearing.films / 1e3
    root = np.sqrt(np.maximum(1 - np.abs(path) ** 2, LEAST_SHARE))
    shear = 2 * math.pi * bearing.viscosity_Pas * radius_m**3 * width_m / clearance_m / root
    squeeze_m_s = squeeze * clearance_m * journal.speed_rad_s
    return np.asarray(shear * (own - sleeve) ** 2 + (np.conj(squeeze_m_s) * load).real)
