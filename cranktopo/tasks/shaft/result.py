"""A whole crankshaft as `shaft --json` has it: stiffness, frequencies, moments in webs, bearing forces."""

from __future__ import annotations

from collections.abc import Sequence

from pydantic import Field, InstanceOf
from pydantic.json_schema import SkipJsonSchema

from cranktopo.base.result import UNLESS_NONE, Result
from cranktopo.design.assumed import Assumption
from cranktopo.tasks.film.permitted import LeastFilm, beyond_permitted
from cranktopo.tasks.film.result import BIG_END, ConservingFilm
from cranktopo.tasks.shaft.assembly import Bearings, ShaftBearings, ShaftStiffness, linear_bearings
from cranktopo.tasks.shaft.web_sections import WebSections
from cranktopo.tasks.throw_fea.evaluation import SCHEMA_VERSION


class WebMoment(Result):
    """Moments and forces in the middle of a web over the cycle, largest less smallest values.

    Attributes:
        web: from the free end, 1 first.
        range_Nm: of the bending moment in the plane of its throw, in the shaft on all its bearings.
        alone_Nm: the same of a throw that stands alone between its two bearings.
    """

    web: int
    throw: int
    range_Nm: float
    alone_Nm: float
    share: float
    """The first of these over the second."""
    side_range_Nm: float
    """Of the bending moment across the throw, in the shaft as all below."""
    torque_range_Nm: float
    """Of the torque about the crank axis."""
    journal_torque_range_Nm: float
    """Of the torque in the main journal beside it: another one where the mass of a vibrating shaft adds."""
    shear_range_N: float
    """Of the force along the throw."""
    side_shear_range_N: float
    """Of the force across the throw."""


class FilmedBearing(Result):
    """The oil film of a bearing, where the design has `[bearings]`.

    Attributes:
        film_um, pressure_MPa: least thickness and largest pressure; a thickness that is `film_below_um` is
            below what is resolved.
        conserving: the mass-conserving film of one near what is permitted, also with the journal tilted.
    """

    film_um: float | None = UNLESS_NONE
    film_below_um: float | None = UNLESS_NONE
    pressure_MPa: float | None = UNLESS_NONE
    conserving: ConservingFilm | None = UNLESS_NONE

    @property
    def name(self) -> str:
        """The bearing in words."""
        raise NotImplementedError

    def least(self, rpm: float) -> LeastFilm | None:
        """Return film and pressure, of the mass-conserving one where it is computed; None without a film."""
        if self.film_um is None or self.film_below_um is None or self.pressure_MPa is None:
            return None
        own = self.conserving
        film, pressure = (own.film_um, own.pressure_MPa) if own else (self.film_um, self.pressure_MPa)
        return LeastFilm(self.name, rpm, film, self.film_below_um, pressure)


class ShaftBearing(FilmedBearing):
    """A main bearing over the cycle.

    Attributes:
        largest_N: force on it, in the shaft on all its bearings.
        at_deg: crank angle of that, after firing of the cylinder that fires first.
        halves_N: the largest force if each throw stood alone: half of either neighbour's.
        tilt_mrad: largest angle between journal and bearing axis.
        offset_um: largest distance of the journal from the bearing axis; 0 in rigid bearings.
        life_h: basic rating life of `supports.roller_bearing` under these forces at this speed (ISO 281).
        reference_life_h: its basic reference rating life with the tilt of the journal (ISO/TS 16281), where
            the sizes of its rollers are given.
    """

    bearing: int
    largest_N: float
    at_deg: float
    halves_N: float
    tilt_mrad: float
    offset_um: float
    life_h: float | None = UNLESS_NONE
    reference_life_h: float | None = UNLESS_NONE

    @property
    def name(self) -> str:
        """The bearing in words."""
        return f"main {self.bearing}"


class ShaftBigEnds(FilmedBearing):
    """The big-end bearings over the cycle: alike but for their time, and for the tilt of their crankpins.

    Attributes:
        tilt_mrad: largest angle between crankpin and crank axis, by throw; a rod stays in its plane.
    """

    tilt_mrad: tuple[float, ...]

    @property
    def name(self) -> str:
        """The bearing in words."""
        return BIG_END

    @property
    def most_tilted(self) -> tuple[int, float]:
        """The throw whose crankpin tilts most, of nearly equal ones the first, and by how much, mrad."""
        throw = max(range(len(self.tilt_mrad)), key=lambda index: round(self.tilt_mrad[index], 6))
        return throw + 1, self.tilt_mrad[throw]


class CarriedMotion(Result):
    """Motion of a part that an end of the shaft carries, in the shaft without mass.

    Attributes:
        part: its name; one whose `mass_kg` the design gives.
        offset_um: largest distance of its centre of mass from the crank axis.
        tilt_mrad: largest angle of its axis to the crank axis.
    """

    part: str
    offset_um: float
    tilt_mrad: float


class ContinuousShaft(Result):
    """Moments and forces of the shaft on all its bearings, at one speed."""

    speed_rpm: float
    spring_N_per_mm: float | None
    """Of each bearing; none of rigid ones."""
    tilt_spring_Nm_per_rad: float | None = UNLESS_NONE
    """By which each bearing resists the tilt of its journal, where it does."""
    webs: tuple[WebMoment, ...]
    main_bearings: tuple[ShaftBearing, ...]
    big_ends: ShaftBigEnds
    carried: tuple[CarriedMotion, ...] = ()
    """Motions of the parts that the ends carry, from the free end."""
    sections: SkipJsonSchema[InstanceOf[WebSections] | None] = Field(default=None, exclude=True)
    """Forces and moments in the webs at every angle."""

    @property
    def worst_web(self) -> WebMoment:
        """The web whose bending moment has the largest range."""
        return max(self.webs, key=lambda web: web.range_Nm)

    @property
    def bearings(self) -> tuple[FilmedBearing, ...]:
        """All that may have a film: the main bearings from the free end, then the big ends."""
        return (*self.main_bearings, self.big_ends)

    @property
    def least_films(self) -> list[LeastFilm]:
        """Film and pressure of every bearing, as what is permitted asks for them; none without films."""
        films = [one.least(self.speed_rpm) for one in self.bearings]
        return [film for film in films if film is not None]

    @property
    def worst_bearing(self) -> ShaftBearing:
        """The main bearing with the largest force."""
        return max(self.main_bearings, key=lambda bearing: bearing.largest_N)


def worst_beyond(
    permitted_film_um: float | None, permitted_pressure_MPa: float | None, films: Sequence[LeastFilm]
) -> list[str]:
    """Return lines on the films that are not as permitted, each bearing at its worst speed."""
    names = dict.fromkeys(film.bearing for film in films)
    of_each = [[film for film in films if film.bearing == name] for name in names]
    thinnest = [min(own, key=lambda film: film.film_um) for own in of_each]
    hardest = [max(own, key=lambda film: film.pressure_MPa) for own in of_each]
    return [
        *beyond_permitted(permitted_film_um, None, thinnest),
        *beyond_permitted(None, permitted_pressure_MPa, hardest),
    ]


class TorsionError(Result):
    """Bound of the discretisation error of the stiffnesses, percent."""

    torsion: float


class OpenTorsionDisk(Result):
    """Arguments of openTorsion's `Disk`, SI units."""

    node: int
    I: float  # noqa: E741 - the name that openTorsion has for it


class OpenTorsionShaft(Result):
    """Arguments of openTorsion's `Shaft`, SI units."""

    nl: int
    nr: int
    k: float
    I: float  # noqa: E741 - the name that openTorsion has for it


class OpenTorsion(Result):
    """The shaft as openTorsion takes it."""

    disks: tuple[OpenTorsionDisk, ...]
    shafts: tuple[OpenTorsionShaft, ...]


class ShaftEvaluation(Result):
    """A whole crankshaft: the object that `shaft --json` prints."""

    schema_version: int = SCHEMA_VERSION
    design: str
    throw_angles_deg: tuple[float, ...]
    bearings: ShaftBearings
    mass_kg: float
    stiffness: ShaftStiffness = Field(validation_alias="torsion", serialization_alias="torsion")
    error_estimate_percent: TorsionError
    natural_frequencies_Hz: tuple[float, ...]
    opentorsion: OpenTorsion
    on_bearings: tuple[ContinuousShaft, ...] = ()
    """Moments and forces on all bearings, by speed; empty without pressures or with free bearings."""
    added_speed_rpm: float | None = UNLESS_NONE
    """Speed among them at which the torque of the vibrating shaft varies most; only where it was added."""
    permitted_film_um: float | None = UNLESS_NONE
    """Least film that `[bearings]` permits, where the bearings have films."""
    permitted_pressure_MPa: float | None = UNLESS_NONE
    """Largest pressure of a film that `[bearings]` permits, where they have."""
    films_hold: bool | None = UNLESS_NONE
    """True where the films of all bearings, big ends too, are within that at all speeds."""
    misfire: tuple[int, ...] | None = UNLESS_NONE
    """Cylinders that do not fire in them, where there are any."""
    assumed: tuple[Assumption, ...]
    """Keys that the design does not give and the shaft depends on."""
    throw_inertias_kg_mm2: tuple[float, ...] = Field(default=(), exclude=True)
    """Inertia of each throw alone about the crank axis, kg mm2."""

    throw_by_bearings_Nm_per_rad: dict[str, float] = Field(default_factory=dict, exclude=True)
    """Torsional stiffness of a throw (the mean of unlike ones) by its bearings, and that of load cases."""
    weighed: str = Field(default="", exclude=True)
    """Object of the mass, in words."""
    silent: str = Field(default="", exclude=True)
    """Sentence on the cylinders that do not fire."""
    pressure: str = Field(default="", exclude=True)
    """Sentence on the pressure at speeds other than the engine's own."""

    @property
    def stiffness_bearings(self) -> Bearings:
        """Bearings in which the torsional stiffness is told: rigid ones for play and oil films."""
        return linear_bearings(self.bearings)

    @property
    def added_words(self) -> str:
        """Sentence on the speed that was added to those asked for; empty where none was."""
        if self.added_speed_rpm is None:
            return ""
        speeds = [at.speed_rpm for at in self.on_bearings]
        return (
            f"{self.added_speed_rpm:,.0f} rpm is added to the {len(speeds) - 1} speeds: there the torque of "
            f"the vibrating shaft swings most between {min(speeds):,.0f} and {max(speeds):,.0f} rpm."
        )

    @property
    def beyond_permitted(self) -> list[str]:
        """Lines on the films of bearings that are not as the design permits, each at its worst speed."""
        films = [film for at in self.on_bearings for film in at.least_films]
        return [*worst_beyond(self.permitted_film_um, self.permitted_pressure_MPa, films), *self._thin_edges]

    @property
    def _thin_edges(self) -> list[str]:
        """Films at edges in a line, each bearing at its thinnest, if below the permitted; of no verdict."""
        least, edges = self.permitted_film_um or 0.0, dict[str, tuple[float, float]]()
        for at in self.on_bearings:
            for own in at.bearings:
                if own.conserving is not None and own.conserving.edge is not None:
                    found = own.conserving.edge.film_um, at.speed_rpm
                    edges[own.name] = min(edges.get(own.name, found), found)
        thin = [
            f"{name} {f'{film_um:.2f} um' if film_um else 'no film'} at {rpm:g} rpm"
            for name, (film_um, rpm) in edges.items()
            if film_um < least
        ]
        told = "at the edge, by the tilt of journals in rigid bearings"
        return [f"{told}: {', '.join(thin)}; {least:g} um is asked of parallel journals"] if thin else []

    @property
    def error_percent(self) -> float:
        """Bound of the stiffnesses' discretisation error, percent."""
        return self.error_estimate_percent.torsion
