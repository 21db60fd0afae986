"""The shaft that vibrates beside the one without mass: `dynamics` in the JSON object of `shaft --dynamic`."""

from __future__ import annotations

from pydantic import Field, InstanceOf
from pydantic.json_schema import SkipJsonSchema

from cranktopo.base.result import UNLESS_NONE, Result
from cranktopo.tasks.film.permitted import LeastFilm
from cranktopo.tasks.shaft.result import FilmedBearing, worst_beyond
from cranktopo.tasks.shaft.web_sections import WebSections


class MomentRanges(Result):
    """Largest less smallest moments in the middle of a web over the cycle, N m."""

    bending: float
    """In the plane of its throw."""
    side_bending: float
    """Across it."""
    torque: float
    """About the crank axis."""
    equivalent: float
    """Root of the sum of the squares of bending, side bending and 0.866 times the torque."""


class DynamicWeb(Result):
    """A web at a speed, with and without the mass of the shaft."""

    web: int
    """Its number from the free end, 1 first."""
    throw: int
    range_Nm: MomentRanges
    """Of the shaft that vibrates."""
    quasi_static_Nm: MomentRanges
    """Of the shaft without mass, as told above."""
    ratio: float
    """The equivalent of the first over that of the second."""


class DynamicBearing(FilmedBearing):
    """A main bearing at a speed; with its film where the shaft vibrates in oil films."""

    bearing: int
    """Its number from the free end, 1 first."""
    largest_N: float
    """Largest force on it."""
    at_deg: float
    """Crank angle of that."""
    quasi_static_N: float
    """The largest force of the shaft without mass."""
    ratio: float
    """The first over the second."""
    quasi_static_film_um: float | None = UNLESS_NONE
    """Least film of the shaft without mass; mass-conserving where that is computed."""

    @property
    def name(self) -> str:
        """The bearing in words."""
        return f"main {self.bearing}"


class SectionSwing(Result):
    """Motion of the middle of a main journal over the cycle: half its largest less its smallest value."""

    section: int
    """Number of the main journal from the free end, 1 first."""
    twist_deg: float
    """About the crank axis."""
    axial_um: float
    """Along it."""
    tilt_mrad: float
    """Largest angle to the axis, its mean included."""
    offset_um: float
    """Largest distance from the axis, its mean included; 0 in rigid bearings."""


class DynamicSpeed(Result):
    """The shaft that vibrates, at a speed."""

    speed_rpm: float
    webs: tuple[DynamicWeb, ...]
    main_bearings: tuple[DynamicBearing, ...]
    sections: tuple[SectionSwing, ...]
    work_in_J: float
    """Work of the forces on the pins in the vibration over a cycle."""
    damping_work_J: float
    """Work that all damping takes over a cycle: it is the same, but for that of films."""
    film_work_J: float | None = UNLESS_NONE
    """Work that the oil films take of the vibration over a cycle, where the shaft is in films; what they
    take of the even rotation is not in it."""
    curves: SkipJsonSchema[InstanceOf[WebSections] | None] = Field(default=None, exclude=True)
    """Forces and moments in the webs at every angle."""

    @property
    def least_films(self) -> list[LeastFilm]:
        """Film and pressure of every main bearing; none without films."""
        films = [one.least(self.speed_rpm) for one in self.main_bearings]
        return [film for film in films if film is not None]

    @property
    def worst_web(self) -> DynamicWeb:
        """The web with the largest equivalent moment."""
        return max(self.webs, key=lambda web: web.range_Nm.equivalent)

    @property
    def worst_bearing(self) -> DynamicBearing:
        """The main bearing with the largest force."""
        return max(self.main_bearings, key=lambda one: one.largest_N)


class Resonance(Result):
    """A speed at which an order of the forces meets a mode of the shaft and is felt in a web."""

    speed_rpm: float
    order: float
    mode: int
    """Number of the mode, the slowest first."""
    frequency_Hz: float
    """Of the mode at that speed, in the frame that turns with the shaft."""
    kind: str
    """Kind of the mode in words."""
    web: int
    """The web whose equivalent moment grows most."""
    ratio: float
    """That moment over the one without the mass of the shaft."""


class ShaftDynamics(Result):
    """The steady vibration of the whole shaft: bending, torsion and axial motion together."""

    loss_factor: float
    """Of the material of throws and ends, in bending too."""
    turns_freely: bool
    """True where the last section swings with what the shaft drives; else it turns evenly."""
    highest_order: float
    """Of the forces; all of them are solved."""
    unknowns: int
    """Of each order."""
    torsion_only: tuple[str, ...]
    """Parts whose mass the design does not give: they count in torsion alone."""
    speeds: tuple[DynamicSpeed, ...]
    """At the speeds of the cycle."""
    resonances: tuple[Resonance, ...]
    """Between several speeds, the slowest first."""
    films_hold: bool | None = UNLESS_NONE
    """True where the films of the shaft that vibrates are within what `[bearings]` permits at all speeds."""
    permitted_film_um: float | None = Field(default=None, exclude=True)
    """Least film that `[bearings]` permits, of a shaft in films."""
    permitted_pressure_MPa: float | None = Field(default=None, exclude=True)
    """Largest pressure of a film that it permits."""
    added_speed_rpm: float | None = UNLESS_NONE
    """The resonance with the largest equivalent moment of a web, where no speed asked for is as bad: it is
    among the speeds."""

    @property
    def worst(self) -> DynamicSpeed:
        """The speed with the largest equivalent moment of a web."""
        return max(self.speeds, key=lambda at: at.worst_web.range_Nm.equivalent)

    @property
    def in_films(self) -> bool:
        """True of a shaft that vibrates in its oil films."""
        return self.speeds[0].film_work_J is not None

    @property
    def beyond_permitted(self) -> list[str]:
        """Lines on the films that are not as the design permits, each bearing at its worst speed."""
        films = [film for at in self.speeds for film in at.least_films]
        return worst_beyond(self.permitted_film_um, self.permitted_pressure_MPa, films)
