"""Mass-conserving films of those bearings whose film by the mobility method is near what it may be."""

from __future__ import annotations

import math
import time
from collections.abc import Iterator, Sequence, Set
from contextlib import contextmanager
from dataclasses import replace

import numpy as np

from cranktopo.base.arrays import Array, Complex
from cranktopo.base.errors import CranktopoError, ExitCode
from cranktopo.base.notes import note, warn
from cranktopo.base.units import UM_PER_MM
from cranktopo.design.assumed import Assumption
from cranktopo.design.goal.scene_goal import goal_of
from cranktopo.design.schema import Scene
from cranktopo.numerics.bearing_film.conserving import TouchingError
from cranktopo.numerics.bearing_film.conserving_orbit import ConservedOrbit, OilFeed, conserved_orbit
from cranktopo.numerics.bearing_film.orbit import LEAST_SHARE, LoadedJournal, Orbit
from cranktopo.tasks.film.result import BIG_END, BearingFilm, ConservingFilm, EdgeFilm

NEAR = 1.5
"""A film below so many times the least thickness it may have, or above the most pressure over it, is near."""
HOLE_SHARE, PIN_HOLE_DEG = 0.1, 90.0
"""Diameter of a feed hole over that of its journal, and a pin's angle ahead of its throw, if not given."""
_LACKING = 0.5
"""Film over that of the mobility method below which it is warned of."""
_STEP_DEG = 2.0
_MM3_PER_CM3 = 1e3


def near_limit(scene: Scene, films: Sequence[BearingFilm]) -> list[bool]:
    """Tell of each film of the mobility method whether it is near, or beyond, what it may be.

    That is what `[bearings]` permits and what the goal limits. In percent of another web the goal tells no
    thickness: then the least film, or the largest pressure, is at its limit.
    """
    assert scene.bearings is not None
    goal, table = goal_of(scene), scene.bearings
    limits = goal.limits if goal else ()
    thinnest, hardest = min(one.film_um for one in films), max(one.pressure_MPa for one in films)
    least = [thinnest if one.percent else one.value for one in limits if one.quantity == "oil_film"]
    most = [hardest if one.percent else one.value for one in limits if one.quantity == "bearing_pressure"]
    thin = NEAR * max((*least, table.permitted_film_um or 0.0))
    hard = min((*most, table.permitted_pressure_MPa or math.inf)) / NEAR
    return [one.film_um < thin or one.pressure_MPa > hard for one in films]


def with_conserving(
    scene: Scene,
    films: Sequence[BearingFilm],
    journals: Sequence[LoadedJournal],
    found: Sequence[Orbit],
    tilts: Sequence[Complex | None],
) -> tuple[BearingFilm, ...]:
    """Return the films of a scene at its speed, those near their limit with the film that keeps its oil.

    Args:
        tilts: as of `LoadedBearing`, over the angles of the orbits; of several the worst is taken.

    A film that does not become steady stays that of the mobility method, with a warning.
    """
    start, every, done, near = time.perf_counter(), list(films), 0, near_limit(scene, films)
    for place, (film, journal, orbit, leaning) in enumerate(zip(films, journals, found, tilts, strict=True)):
        if near[place]:
            feed = oil_feed(scene, film.bearing, orbit.angle_deg, journal.bearing.diameter_mm)
            every[place] = film.model_copy(
                update={"conserving": _conserving(film, journal, orbit, feed, leaning)}
            )
            _warn_of_thin(scene, every[place])
            done += 1
    if done:
        names = "bearing" if done == 1 else "bearings"
        note(f"mass-conserving film of {done} {names}: {time.perf_counter() - start:.0f} s")
    return tuple(every)


def _warn_of_thin(scene: Scene, film: BearingFilm) -> None:
    """Warn of a film far thinner than that of the mobility method: its bearing lacks oil."""
    if film.conserving is None or film.conserving.film_um > _LACKING * film.film_um:
        return
    thinner = 100 * (1 - film.conserving.film_um / film.film_um)
    warn(
        f"{scene.name}: {film.bearing}: its mass-conserving film is {thinner:.0f} % thinner than that of the "
        f"mobility method, {film.film_um:.2f} um; usual are 20 to 30 %. It lacks oil; look at "
        "supply_pressure_MPa and at the place of its feed"
    )


def oil_feed(scene: Scene, bearing: str, angle_deg: Array, diameter_mm: float) -> OilFeed:
    """Return how a bearing is fed: groove or hole of the main bearings, hole of the pin."""
    assert scene.bearings is not None
    table = scene.bearings
    hole_mm = table.feed_hole_mm or HOLE_SHARE * diameter_mm
    if bearing == BIG_END:
        hole_mm, at_deg = pin_hole(scene) or (hole_mm, PIN_HOLE_DEG)
        return OilFeed(table.supply_pressure_MPa, hole_mm=hole_mm, hole_rad=np.radians(angle_deg + at_deg))
    if table.groove_mm:
        return OilFeed(table.supply_pressure_MPa, groove_mm=table.groove_mm)
    still = np.radians(np.full_like(angle_deg, table.feed_hole_deg))
    return OilFeed(table.supply_pressure_MPa, hole_mm=hole_mm, hole_rad=still)


def pin_hole(scene: Scene) -> tuple[float, float] | None:
    """Return diameter and angle, deg, of the first drilling that ends on the crankpin; None for no such."""
    return next(_pin_holes(scene), None)


def hole_assumptions(scene: Scene, bearings: Set[str]) -> tuple[Assumption, ...]:
    """Return the diameters of feed holes that these bearings take and the scene does not give."""
    assert scene.bearings is not None
    grooved = scene.bearings.groove_mm > 0
    taken = [name for name in bearings if (pin_hole(scene) is None if name == BIG_END else not grooved)]
    if not taken or scene.bearings.feed_hole_mm is not None:
        return ()
    return (Assumption("bearings.feed_hole_mm", HOLE_SHARE, "times the diameter of the journal"),)


def _pin_holes(scene: Scene) -> Iterator[tuple[float, float]]:
    for drilling in scene.throw.drilling:
        for _, end in drilling.ends:
            if end.on == "crankpin":
                yield drilling.diameter_mm, end.angle_deg


def _conserving(
    film: BearingFilm, journal: LoadedJournal, orbit: Orbit, feed: OilFeed, tilts: Complex | None
) -> ConservingFilm | None:
    stride = max(1, round(_STEP_DEG / float(orbit.angle_deg[1] - orbit.angle_deg[0])))
    own, sleeve = journal.surfaces_rad_s
    coarse = LoadedJournal(
        journal.bearing, journal.load_N[::stride], journal.speed_rad_s, (own[::stride], sleeve[::stride])
    )
    if feed.hole_rad is not None:
        feed = replace(feed, hole_rad=feed.hole_rad[::stride])
    angle = orbit.angle_deg[::stride]
    with _or_by_mobility(film.bearing, "it is judged by the mobility method"):
        found = _read(conserved_orbit(coarse, angle, feed, orbit))
        if tilts is None:
            return found
        worst = _worst(orbit, tilts)
        with _or_by_mobility(film.bearing, "its edge is not told"):
            edge = _edge(coarse, angle, feed, orbit, tilts[worst, ::stride])
            if film.bearing == BIG_END:
                edge = edge.model_copy(update={"cylinder": worst + 1})
            return found.model_copy(update={"edge": edge})
        return found
    return None


def _worst(orbit: Orbit, tilts: Complex) -> int:
    """Return which bearing has its journal nearest to the wall at an end; of nearly equal ones the first."""
    middle = orbit.eccentricity
    ends = np.maximum(np.abs(middle + tilts), np.abs(middle - tilts))
    return int(np.round(ends.max(axis=1), 6).argmax())


@contextmanager
def _or_by_mobility(bearing: str, instead: str) -> Iterator[None]:
    """Warn of a mass-conserving film that has no answer: the others of the command have one."""
    try:
        yield
    except CranktopoError as error:
        if error.code != ExitCode.SOLVER:
            raise
        warn(f"{bearing}: mass-conserving film: {error.message} So {instead}.")


def _edge(journal: LoadedJournal, angle_deg: Array, feed: OilFeed, orbit: Orbit, tilt: Complex) -> EdgeFilm:
    most = int(np.abs(tilt).argmax())
    tilt_um = float(np.abs(tilt[most])) * journal.bearing.clearance_mm * UM_PER_MM
    touching = EdgeFilm(film_um=0.0, film_deg=float(angle_deg[most]), pressure_MPa=None, tilt_um=tilt_um)
    if np.abs(tilt[most]) >= 1 - LEAST_SHARE:
        return touching
    try:
        found = conserved_orbit(journal, angle_deg, feed, orbit, tilt)
    except TouchingError:
        return touching
    thin = int(found.film_mm.argmin())
    return EdgeFilm(
        film_um=float(found.film_mm[thin]) * UM_PER_MM,
        film_deg=float(angle_deg[thin]),
        pressure_MPa=float(found.pressure_MPa.max()),
        tilt_um=tilt_um,
    )


def _read(found: ConservedOrbit) -> ConservingFilm:
    thin, hard = int(found.film_mm.argmin()), int(found.pressure_MPa.argmax())
    half = float(found.angle_deg[1]) / 2  # the pressure is that of the middle of a step
    cycle = len(found.angle_deg) * 2 * half
    return ConservingFilm(
        film_um=float(found.film_mm[thin]) * UM_PER_MM,
        film_deg=float(found.angle_deg[thin]),
        pressure_MPa=float(found.pressure_MPa[hard]),
        pressure_deg=(float(found.angle_deg[hard]) - half) % cycle,
        least_filled=float(found.filled.min()),
        oil_cm3_per_s=float(found.fed_mm3_per_s.mean()) / _MM3_PER_CM3,
        oil_left_out=found.left_out,
    )
