"""Orbit of a journal in its bearing under a load over a cycle: film thickness, pressure, friction."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

from cranktopo.base.arrays import Array
from cranktopo.base.errors import solver_error
from cranktopo.numerics.bearing_film.mobility import THICKNESS, Mobility, mobility

_RELATIVE, _ABSOLUTE = 1e-6, 1e-8
_CYCLES = 30
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
    eccentricity: NDArray[np.complex128]
    film_mm: Array
    pressure_MPa: Array
    friction_W: Array
    cycles: int


def orbit(
    bearing: JournalBearing,
    angle_deg: Array,
    load_N: NDArray[np.complex128],
    speed_rad_s: float,
    surfaces_rad_s: tuple[Array, Array],
    start: complex = 0.5 + 0j,
) -> Orbit:
    """Return the orbit under a load that repeats, over cycles until it does the same.

    Args:
        angle_deg: even steps over one cycle of the shaft, from 0, the end left out.
        load_N: on the journal, toward where it moves; in a frame that stands still.
        speed_rad_s: of the shaft, which `angle_deg` is of.
        surfaces_rad_s: angular speed of journal and bearing.

    Raises:
        CranktopoError: it does not become steady.
    """
    cycle = math.radians(angle_deg[1] * len(angle_deg))
    steady = _Motion.of(bearing, cycle, load_N, speed_rad_s, (surfaces_rad_s[0] + surfaces_rad_s[1]) / 2)
    angle, at, least = np.radians(angle_deg), start, math.inf
    for number in range(1, _CYCLES + 1):
        solved = solve_ivp(
            steady.slope, (0.0, cycle), [at.real, at.imag], "LSODA", np.append(angle, cycle),
            rtol=_RELATIVE, atol=_ABSOLUTE, max_step=cycle / 90,
        )  # fmt: skip
        path = solved.y[0] + 1j * solved.y[1]
        at, before, least = complex(path[-1]), least, max(float(1 - np.abs(path).max()), LEAST_SHARE)
        if number > 1 and abs(least - before) <= _SAME * least and abs(path[0] - path[-1]) < _CLOSED:
            return _result(bearing, steady, angle_deg, path[:-1], surfaces_rad_s, number)
    raise solver_error(
        f"oil film: the orbit of the journal is not steady after {_CYCLES} cycles.",
        "Check load, clearance and viscosity.",
    )


@dataclass(frozen=True)
class _Motion:
    """Right-hand side of the journal's motion over the angle of the shaft, lists for speed."""

    map: Mobility
    cycle: float
    load: list[complex]
    turning: list[float]
    per_load: float
    speed_rad_s: float

    @classmethod
    def of(
        cls,
        bearing: JournalBearing,
        cycle: float,
        load_N: NDArray[np.complex128],
        speed_rad_s: float,
        mean_rad_s: Array,
    ) -> _Motion:
        b = bearing
        radius_m, width_m, clearance_m = b.diameter_mm / 2e3, b.width_mm / 1e3, b.clearance_mm / 1e3
        per_load = clearance_m**2 / (6 * b.viscosity_Pas * radius_m**3 * width_m * speed_rad_s * b.films)
        turning = np.broadcast_to(mean_rad_s / speed_rad_s, load_N.shape)
        own = mobility(b.width_mm / b.diameter_mm)
        return cls(own, cycle, load_N.tolist(), turning.tolist(), per_load, speed_rad_s)

    def slope(self, angle: float, at: Array) -> list[float]:
        place = angle / self.cycle * len(self.load)
        i = int(place)
        part, i = place - i, i % len(self.load)
        j = (i + 1) % len(self.load)
        load = self.load[i] + part * (self.load[j] - self.load[i])
        turning = self.turning[i] + part * (self.turning[j] - self.turning[i])
        eccentricity = complex(at[0], at[1])
        change = self.squeeze(eccentricity, load) + 1j * turning * eccentricity
        return [change.real, change.imag]

    def squeeze(self, eccentricity: complex, load: complex) -> complex:
        """Change of the eccentricity by the load alone, per radian of the shaft; none outward at last."""
        if not load:
            return 0j
        change = abs(load) * self.per_load * self.map.velocity(eccentricity, load)
        size = abs(eccentricity)
        outward = (change * eccentricity.conjugate()).real / size if size else 0.0
        if outward > 0 and size > 1 - _FLOOR * LEAST_SHARE:
            left = max((1 - size) / (_FLOOR * LEAST_SHARE) - 1 / _FLOOR, 0.0)
            change -= (1 - min(left, 1.0)) * outward * eccentricity / size
        return change


def _result(
    bearing: JournalBearing,
    motion: _Motion,
    angle_deg: Array,
    path: NDArray[np.complex128],
    surfaces_rad_s: tuple[Array, Array],
    cycles: int,
) -> Orbit:
    size, load = np.abs(path), np.array(motion.load)
    peak = np.array([motion.map.peak_pressure(complex(e), f) for e, f in zip(path, motion.load, strict=True)])
    return Orbit(
        angle_deg=angle_deg,
        eccentricity=path,
        film_mm=bearing.clearance_mm * np.maximum(1 - size, LEAST_SHARE),
        pressure_MPa=peak * np.abs(load) / bearing.projected_mm2,
        friction_W=_friction_W(bearing, motion, path, load, surfaces_rad_s),
        cycles=cycles,
    )


def _friction_W(
    bearing: JournalBearing,
    motion: _Motion,
    path: NDArray[np.complex128],
    load: NDArray[np.complex128],
    surfaces_rad_s: tuple[Array, Array],
) -> Array:
    """Power that the film takes: of the oil that is sheared, and of the load on the oil that is squeezed out.

    The shear of a film all around is 2 pi mu R^3 L w^2 / (c sqrt(1 - e^2)), w the difference of the surfaces'
    speeds; journal and bearing share the moment of the load about the centre (J. F. Booker, ASME J. Basic
    Eng. 87, 1965).
    """
    journal, sleeve = surfaces_rad_s
    radius_m, clearance_m = bearing.diameter_mm / 2e3, bearing.clearance_mm / 1e3
    width_m = bearing.width_mm * bearing.films / 1e3
    root = np.sqrt(np.maximum(1 - np.abs(path) ** 2, LEAST_SHARE))
    shear = 2 * math.pi * bearing.viscosity_Pas * radius_m**3 * width_m / clearance_m / root
    squeeze_m_s = np.array([motion.squeeze(complex(e), f) for e, f in zip(path, motion.load, strict=True)])
    squeeze_m_s *= clearance_m * motion.speed_rad_s
    return np.asarray(shear * (journal - sleeve) ** 2 + (np.conj(squeeze_m_s) * load).real)
