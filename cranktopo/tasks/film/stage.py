"""Films of main and big-end bearings over the cycle, under the forces of throws that stand alone."""

from __future__ import annotations

from collections.abc import Sequence, Set
from dataclasses import dataclass

import numpy as np

from cranktopo.base.arrays import Array, Complex
from cranktopo.base.errors import CranktopoError
from cranktopo.base.units import MM_PER_M, UM_PER_MM, angular_speed_rad_s
from cranktopo.design.assumed import Assumption, assumptions
from cranktopo.design.bearing_room import BETWEEN_FILLETS, main_journals, main_room_mm, widest_big_end_mm
from cranktopo.design.crank_throws import carried
from cranktopo.design.misfire import misfire
from cranktopo.design.named import DesignLike, as_scene
from cranktopo.design.plain_bearings import PlainBearings
from cranktopo.design.schema import Scene
from cranktopo.engine.analysis import at_speed, engine_of
from cranktopo.engine.balance.free_forces import turning_masses
from cranktopo.engine.balance.layout import unit_vectors
from cranktopo.engine.balance.whole_engine import main_bearings, rod_force
from cranktopo.engine.forces import rods_on_pins
from cranktopo.engine.gas import pressure_curve
from cranktopo.engine.performance import note_pressure, pressure_words
from cranktopo.numerics.bearing_film.orbit import LEAST_SHARE, JournalBearing, LoadedJournal, Orbit, orbits
from cranktopo.tasks.film.conserving import (
    NEAR,
    hole_assumptions,
    with_conserving,
)
from cranktopo.tasks.film.permitted import films_hold
from cranktopo.tasks.film.result import BIG_END, BearingFilm, FilmResult, FilmsAtSpeed

BEARINGS = "bearings"
ALONE = "throws that stand alone between two bearings"
_STEP_DEG = 1.0


@dataclass(frozen=True)
class LoadedBearing:
    """A bearing with its load over the cycle.

    Attributes:
        load_N: on the journal, toward where it moves, in a frame that stands still.
        sleeve: angular speed of what is around the journal, over that of the shaft.
        number: how many bearings are like it.
        largest: largest load, N, and its angle, deg, where `load_N` is of fewer angles than are known.
        tilts: of each bearing under this load, the place of its journal at the end of the bearing less that
            in its middle, over the clearance, (bearings, angles); None where no shaft is bent.
    """

    name: str
    bearing: JournalBearing
    load_N: Complex
    sleeve: Array
    number: int = 1
    largest: tuple[float, float] | None = None
    tilts: Complex | None = None


Case = tuple[Scene, Sequence[LoadedBearing], Array]
"""A scene at its speed, its bearings, and the angles of their loads."""
BearingOrbits = tuple[tuple[LoadedBearing, Orbit], ...]


def oil_films(scene: DesignLike, speeds_rpm: Sequence[float] | None = None) -> FilmResult:
    """Return the oil films of a design at some speeds, by default at the engine's.

    Raises:
        CranktopoError: no `[bearings]`, no engine, or an engine that stands still.
    """
    return films_and_orbits(scene, speeds_rpm)[0]


def films_and_orbits(
    scene: DesignLike, speeds_rpm: Sequence[float] | None = None
) -> tuple[FilmResult, BearingOrbits]:
    """Return the films as `oil_films` does, and the orbits of the journals at the last speed."""
    scene = as_scene(scene)
    table, engine = plain_bearings(scene), engine_of(scene)
    speeds = speeds_rpm or [engine.speed_rpm]
    if min(speeds) <= 0:
        raise CranktopoError(
            f"{scene.name}: a film carries only where the engine turns.", hint="Give a speed."
        )
    note_pressure(scene.name, scene, every_speed=speeds_rpm is not None)
    cases = _cases([at_speed(scene, rpm) for rpm in speeds])
    every = orbits_of(cases)
    films_at_speeds = _films_along(cases, every, conserving=True)
    found = tuple(
        FilmsAtSpeed(rpm=rpm, bearings=films) for rpm, films in zip(speeds, films_at_speeds, strict=True)
    )
    conserving = {one.bearing for at in found for one in at.conserving}
    result = FilmResult(
        design=scene.name,
        oil=table.oil if table.takes_grade else None,
        temperature_C=None if table.viscosity_mPas else table.temperature_C,
        viscosity_mPas=1e3 * table.dynamic_viscosity_Pas,
        loads=ALONE,
        gas=pressure_curve(scene) is not None,
        pressure=pressure_words(scene, speeds),
        misfire=misfire(scene) or None,
        speeds=found,
        permitted_film_um=table.permitted_film_um,
        permitted_pressure_MPa=table.permitted_pressure_MPa,
        holds=films_hold(table, (one for at in found for one in at.least_films)),
        near=NEAR if conserving else None,
        assumed=_assumed(scene, table, conserving),
    )
    return result, tuple(zip(cases[-1][1], every[-1], strict=True))


def plain_bearings(scene: Scene) -> PlainBearings:
    """Return the scene's bearings; raises CranktopoError where it gives none."""
    if scene.bearings is None:
        raise CranktopoError(
            f"{scene.name}: [bearings] is missing; clearance and oil make the film.",
            hint='Add [bearings] with clearance_mm = 0.05 and oil = "ISO VG 46", for example.',
        )
    return scene.bearings


def film_change(before: Scene, after: Scene) -> str:
    """Return one line with the least films of a design beside those before; empty without `[bearings]`."""
    if before.bearings is None or before.engine is None or not before.engine.speed_rpm:
        return ""
    every = films_at([after, before], conserving=True)
    (main, big), (old_main, old_big) = (_least_um(films) for films in every)
    return (
        f"oil film at {before.engine.speed_rpm:g} rpm: main bearings {main:.2f} um at least "
        f"({old_main:.2f} before), big ends {big:.2f} um ({old_big:.2f})"
    )


def _least_um(films: Sequence[BearingFilm]) -> tuple[float, float]:
    """Least film of the main bearings, and of the big end."""
    return min(one.judged.film_um for one in films[:-1]), films[-1].judged.film_um


def films_at(scenes: Sequence[Scene], *, conserving: bool = False) -> list[tuple[BearingFilm, ...]]:
    """Return the films of each scene at its speed: main bearings from the free end, then a big end.

    Args:
        conserving: also the mass-conserving films of those near what is permitted or limited.
    """
    return films_of(_cases(scenes), conserving=conserving)


def films_of(cases: Sequence[Case], *, conserving: bool = False) -> list[tuple[BearingFilm, ...]]:
    """Return the films of the bearings of each scene, at its speed, with the angles of their loads."""
    return _films_along(cases, orbits_of(cases), conserving=conserving)


def _cases(scenes: Sequence[Scene]) -> list[Case]:
    return [(scene, *_loaded_bearings(scene)) for scene in scenes]


def _films_along(
    cases: Sequence[Case], orbits: Sequence[Sequence[Orbit]], *, conserving: bool
) -> list[tuple[BearingFilm, ...]]:
    every = []
    for (scene, loaded, angle), own in zip(cases, orbits, strict=True):
        films = tuple(_film(one, steady) for one, steady in zip(loaded, own, strict=True))
        if conserving:
            journals = [_journal(one, scene, angle) for one in loaded]
            films = with_conserving(scene, films, journals, own, [one.tilts for one in loaded])
        every.append(films)
    return every


def orbits_of(cases: Sequence[Case]) -> list[list[Orbit]]:
    """Return the orbits of the bearings of each scene; those over the same angles all at once."""
    found: list[list[Orbit]] = [[] for _ in cases]
    for count in dict.fromkeys(len(angle) for _, _, angle in cases):
        alike = [index for index, (_, _, angle) in enumerate(cases) if len(angle) == count]
        every = [_journal(one, *cases[index][::2]) for index in alike for one in cases[index][1]]
        steady = iter(orbits(every, cases[alike[0]][2]))
        for index in alike:
            found[index] = [next(steady) for _ in cases[index][1]]
    return found


def _loaded_bearings(scene: Scene) -> tuple[list[LoadedBearing], Array]:
    """Main bearings from the free end, then a big end; and the angles of their loads."""
    loads = main_bearings(scene, turning_masses(scene))
    step = _stride(loads.angle_deg)
    angle = loads.angle_deg[::step]
    still = np.zeros_like(angle)
    every = [
        LoadedBearing(
            f"main {number + 1}",
            main_bearing(scene, number),
            load[::step],
            still,
            largest=_largest(load, loads.angle_deg),
        )
        for number, load in zip(carried(scene), loads.load_N, strict=True)
    ]
    every.append(loaded_big_end(scene))
    return every, angle


def _stride(angle_deg: Array) -> int:
    return round(_STEP_DEG / float(angle_deg[1] - angle_deg[0]))


def _largest(load_N: Complex, angle_deg: Array) -> tuple[float, float]:
    most = int(np.abs(load_N).argmax())
    return float(np.abs(load_N[most])), float(angle_deg[most])


def _journal(loaded: LoadedBearing, scene: Scene, angle_deg: Array) -> LoadedJournal:
    speed = angular_speed_rad_s(engine_of(scene).speed_rpm)
    surfaces = np.full_like(angle_deg, speed), loaded.sleeve * speed
    return LoadedJournal(loaded.bearing, loaded.load_N, speed, surfaces)


def _film(loaded: LoadedBearing, steady: Orbit) -> BearingFilm:
    bearing, angle = loaded.bearing, steady.angle_deg

    def at(values: Array, index: int) -> tuple[float, float]:
        return float(values[index]), float(angle[index])

    most, most_deg = loaded.largest or _largest(loaded.load_N, angle)
    film, film_deg = at(steady.film_mm, int(steady.film_mm.argmin()))
    pressure, pressure_deg = at(steady.pressure_MPa, int(steady.pressure_MPa.argmax()))
    return BearingFilm(
        bearing=loaded.name,
        number=loaded.number,
        diameter_mm=bearing.diameter_mm,
        width_mm=bearing.width_mm,
        films=bearing.films,
        max_N=most,
        deg=most_deg,
        film_um=film * UM_PER_MM,
        film_deg=film_deg,
        below_um=LEAST_SHARE * bearing.clearance_mm * UM_PER_MM,
        pressure_MPa=pressure,
        pressure_deg=pressure_deg,
        eccentricity=float(np.abs(steady.eccentricity).max()),
        friction_W=float(steady.friction_W.mean()),
    )


def main_bearing(scene: Scene, number: int) -> JournalBearing:
    """Return a main bearing of a scene, 0 at the free end; a groove parts its film."""
    table = plain_bearings(scene)
    width = table.width_mm or main_room_mm(scene, number)
    films = 2 if table.groove_mm else 1
    diameter = min(journal.outer_diameter_mm for journal in main_journals(scene, number))
    return _bearing(diameter, (width - table.groove_mm) / films, films, table.clearance_mm, table)


def big_end(scene: Scene) -> JournalBearing:
    """Return a big-end bearing of a scene."""
    table, pin = plain_bearings(scene), scene.throw.crankpin
    width = table.big_end_width_mm or widest_big_end_mm(scene)[0]
    clearance = table.big_end_clearance_mm or table.clearance_mm
    return _bearing(pin.outer_diameter_mm, width, 1, clearance, table)


def _bearing(
    diameter_mm: float, width_mm: float, films: int, clearance_mm: float, table: PlainBearings
) -> JournalBearing:
    """A bearing by the clearance of its diameters; it may be short of room where its journal is its own."""
    if width_mm <= 0:
        raise CranktopoError(
            "bearings: a main journal is too short for a bearing between its fillets.",
            hint="Give bearings.width_mm and groove_mm that leave a film, or a longer journal.",
        )
    return JournalBearing(diameter_mm, width_mm, films, clearance_mm / 2, table.dynamic_viscosity_Pas)


def loaded_big_end(scene: Scene) -> LoadedBearing:
    """Return the big end of the first cylinder, its axis real; its rod swings against the crank.

    A master rod is that of the first cylinder of its throw: its big end carries all rods of the pin.
    """
    engine = engine_of(scene)
    angle_deg, rod, _ = rod_force(scene, engine)
    step = _stride(angle_deg)
    angle = np.radians(angle_deg[::step])
    w2 = angular_speed_rad_s(engine.speed_rpm) ** 2
    spinning = engine.rod_rotating_kg * scene.throw.radius_mm / MM_PER_M * w2
    on_pin = rod + spinning
    if scene.has_master_rod:
        every = [pin.superpose(on_pin, angle_deg, engine.cycle_deg) for pin in rods_on_pins(scene, engine)]
        on_pin = max(every, key=lambda one: round(float(np.abs(one).max()), 6))
    on_pin = on_pin * unit_vectors(angle_deg)
    ratio = scene.throw.radius_mm / engine.rod_length_mm
    swing = -ratio * np.cos(angle) / np.sqrt(1 - (ratio * np.sin(angle)) ** 2)
    largest = _largest(on_pin, angle_deg)
    number = engine.throws * scene.big_ends
    return LoadedBearing(BIG_END, big_end(scene), -on_pin[::step], swing, number, largest)


def _assumed(scene: Scene, table: PlainBearings, conserving: Set[str]) -> tuple[Assumption, ...]:
    """Values that the scene does not give; those of the supply only where a mass-conserving film takes them.

    Args:
        conserving: names of the bearings with such a film.
    """
    widths = [
        Assumption(f"bearings.{key}", round(width, 3), source)
        for key, (width, source) in (
            ("width_mm", (main_bearing(scene, 1).width_mm, BETWEEN_FILLETS)),
            ("big_end_width_mm", widest_big_end_mm(scene)),
        )
        if getattr(table, key) is None
    ]
    unused = {"bearings.groove_mm"}
    unused |= set() if table.takes_grade else {"bearings.oil"}
    unused |= {"bearings.temperature_C"} if table.viscosity_mPas else set()
    holes = hole_assumptions(scene, conserving)
    unused |= set() if conserving else {"bearings.supply_pressure_MPa"}
    unused |= {"bearings.feed_hole_deg"} if table.groove_mm or not conserving - {BIG_END} else set()
    found = [one for one in assumptions(scene, (BEARINGS, "engine")) if one.key not in unused]
    return (*found, *widths, *holes)
