"""The oil film of the bearings: the JSON object of `film --json`."""

from __future__ import annotations

from pydantic import Field

from cranktopo.base.result import UNLESS_NONE, Result
from cranktopo.design.assumed import Assumption
from cranktopo.tasks.film.permitted import LeastFilm

BIG_END = "big end"
"""Name of the big-end bearings, which are told as one."""


class EdgeFilm(Result):
    """The film that keeps its oil under a journal that is tilted in its bearing.

    Attributes:
        film_um: least thickness, at an end of the bearing; 0 where the journal touches it, as stiff and sharp
            ends without a film's moment let it; `film_deg` is then where the tilt is largest.
        pressure_MPa: largest pressure; null where it touches.
        tilt_um: half of what the tilt takes from end to end, where it is largest.
        cylinder: whose big end it is: the one that comes nearest to its journal; null of a main bearing.
    """

    film_um: float
    film_deg: float
    pressure_MPa: float | None
    tilt_um: float
    cylinder: int | None = UNLESS_NONE


class ConservingFilm(Result):
    """The film of one bearing that keeps its oil: fed at one place, cavitated where it is not full.

    Attributes:
        film_um: least thickness.
        pressure_MPa: largest pressure.
        least_filled: part of the room between journal and bearing that holds oil, where it is least.
        oil_cm3_per_s: mean flow into the bearing.
        oil_left_out: most oil that the balance of a step does not account for, over that of a full film.
        edge: with the journal tilted as the shaft is bent; of a whole shaft.
    """

    film_um: float
    film_deg: float
    pressure_MPa: float
    pressure_deg: float
    least_filled: float
    oil_cm3_per_s: float
    oil_left_out: float
    edge: EdgeFilm | None = UNLESS_NONE


class BearingFilm(Result):
    """The film of one bearing over the cycle, by the mobility method.

    Attributes:
        bearing: "main 1" is at the free end; the big-end bearings are all alike but for their time.
        number: how many bearings are like it.
        max_N: largest load, at the crank angle `deg`.
        film_um: least thickness; where it is `below_um` it is below what is resolved.
        pressure_MPa: largest pressure of the film.
        eccentricity: largest, over the radial clearance.
        friction_W: mean power that the film of one of them takes.
        conserving: the mass-conserving film, of a bearing near what is permitted.
    """

    bearing: str
    number: int
    diameter_mm: float
    width_mm: float
    films: int
    max_N: float
    deg: float
    film_um: float
    film_deg: float
    below_um: float
    pressure_MPa: float
    pressure_deg: float
    eccentricity: float
    friction_W: float
    conserving: ConservingFilm | None = UNLESS_NONE

    @property
    def judged(self) -> BearingFilm | ConservingFilm:
        """The film that counts: the mass-conserving one where it is computed."""
        return self.conserving or self

    def least(self, rpm: float) -> LeastFilm:
        """Return film and pressure at a speed, of the film that counts."""
        return LeastFilm(self.bearing, rpm, self.judged.film_um, self.below_um, self.judged.pressure_MPa)


class FilmsAtSpeed(Result):
    """The films of all bearings at a speed."""

    rpm: float
    bearings: tuple[BearingFilm, ...]

    @property
    def thinnest(self) -> BearingFilm:
        """The bearing of the least film, of equal ones the first; mass-conserving where computed."""
        return min(self.bearings, key=lambda one: round(one.judged.film_um, 6))

    @property
    def hardest(self) -> BearingFilm:
        """The bearing of the largest pressure, of equal ones the first; mass-conserving where computed."""
        return max(self.bearings, key=lambda one: round(one.judged.pressure_MPa, 6))

    @property
    def conserving(self) -> list[BearingFilm]:
        """The bearings with a mass-conserving film."""
        return [one for one in self.bearings if one.conserving is not None]

    @property
    def least_films(self) -> list[LeastFilm]:
        """Film and pressure of every bearing, as what is permitted asks; mass-conserving where computed."""
        return [one.least(self.rpm) for one in self.bearings]

    @property
    def friction_W(self) -> float:
        """Mean power that the films of all bearings take."""
        return sum(one.number * one.friction_W for one in self.bearings)


class FilmResult(Result):
    """Oil films of a design.

    Attributes:
        viscosity_mPas: dynamic, of the oil in the film.
        loads: what the bearings carry.
        gas: whether the pressure of the gas is among the loads.
        pressure: sentence on the pressure at speeds other than the engine's own.
        misfire: cylinders that do not fire, where there are any; the big end is of one that fires.
        permitted_film_um, permitted_pressure_MPa: null where the scene gives none.
        near: films within so many times of what is permitted, or limited by the goal, have a mass-conserving
            one beside, which is the one that counts.
        holds: whether all films are within what is permitted; null where nothing is.
    """

    design: str
    oil: str | None
    temperature_C: float | None
    viscosity_mPas: float
    loads: str
    gas: bool
    pressure: str = Field(default="", exclude=True)
    misfire: tuple[int, ...] | None = UNLESS_NONE
    speeds: tuple[FilmsAtSpeed, ...]
    permitted_film_um: float | None
    permitted_pressure_MPa: float | None
    near: float | None = UNLESS_NONE
    holds: bool | None
    assumed: tuple[Assumption, ...]
