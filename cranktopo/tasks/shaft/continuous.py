"""Loads of the webs and bearings of a whole shaft over the cycle, beside throws that stand alone."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from cranktopo.base.arrays import Complex
from cranktopo.base.frames import about_z_deg
from cranktopo.base.notes import Pace, warn
from cranktopo.base.units import NMM_PER_NM, UM_PER_MM
from cranktopo.design.crank_throws import carried
from cranktopo.design.schema import Scene
from cranktopo.engine.analysis import engine_of
from cranktopo.engine.balance.layout import unit_vectors
from cranktopo.engine.bearings import bearing_tilt_spring_Nmm_per_rad, life_over_cycle_h, reference_life_h
from cranktopo.engine.forces import INERTIA_EFFECTS
from cranktopo.engine.kinematics import phase_shift
from cranktopo.numerics.tetrahedra.rigid_motions import RX, RY, UX, UY
from cranktopo.tasks.film.result import BearingFilm
from cranktopo.tasks.film.stage import (
    LoadedBearing,
    films_of,
    loaded_big_end,
    main_bearing,
    plain_bearings,
)
from cranktopo.tasks.shaft.assembly import turned
from cranktopo.tasks.shaft.carried_parts import carried_motions
from cranktopo.tasks.shaft.cycle import (
    CycleForces,
    ShaftCycle,
    cycle_forces,
    journal_loads_N,
    journal_tilts,
    pin_tilts,
    shaft_cycle,
)
from cranktopo.tasks.shaft.loaded_throw import LoadedThrow
from cranktopo.tasks.shaft.on_film import Support, carried_cycle
from cranktopo.tasks.shaft.result import ContinuousShaft, ShaftBearing, ShaftBigEnds, WebMoment
from cranktopo.tasks.shaft.web_sections import web_sections

_MRAD_PER_RAD = 1000.0

_MOMENTS_AND_SHEARS = (
    "bending_Nm",
    "side_bending_Nm",
    "torque_Nm",
    "journal_torque_Nm",
    "shear_N",
    "side_shear_N",
)


def continuous_shaft(
    throws: Sequence[tuple[LoadedThrow, Scene]],
    scene: Scene,
    support: Support,
    enabled: frozenset[str] = INERTIA_EFFECTS,
) -> ContinuousShaft:
    """Return what the webs and bearings of a shaft carry over a cycle; see `continuous_shafts`."""
    return continuous_shafts(throws, [scene], support, enabled)[0]


def continuous_shafts(
    throws: Sequence[tuple[LoadedThrow, Scene]],
    scenes: Sequence[Scene],
    support: Support,
    enabled: frozenset[str] = INERTIA_EFFECTS,
) -> tuple[ContinuousShaft, ...]:
    """Return what the webs and bearings of a shaft carry over a cycle, beside throws that stand alone.

    Args:
        throws: each with its own scene.
        scenes: of the shaft, one for each speed; the oil films of all are found at once.
        enabled: as of `cycle_forces`.

    Raises:
        CranktopoError: no engine, or no pressures.
    """
    pace = Pace("shaft on its bearings", len(scenes))
    found: list[_AtSpeed] = []
    for at in scenes:
        pace.begin(f"{engine_of(at).speed_rpm:g} rpm")
        found.append(_at_speed(throws, at, support, enabled))
    return _with_films(found)


@dataclass(frozen=True)
class _AtSpeed:
    """A shaft at the speed of its scene, without films yet.

    Attributes:
        pin_tilts: as of `cycle.pin_tilts`.
    """

    scene: Scene
    shaft: ContinuousShaft
    cycle: ShaftCycle
    pin_tilts: Complex


def _at_speed(
    throws: Sequence[tuple[LoadedThrow, Scene]],
    scene: Scene,
    support: Support,
    enabled: frozenset[str],
) -> _AtSpeed:
    forces, angles, scenes = cycle_forces(scene, enabled), scene.shaft_angles_deg, [own for _, own in throws]
    loaded = [throw for throw, _ in throws]
    cycle = carried_cycle(loaded, scene, forces, support)
    tilts = pin_tilts(loaded, angles, forces, cycle)
    single = [
        shaft_cycle([throw], (0.0,), _of_throw(forces, index), None)
        for index, (throw, _) in enumerate(throws)
    ]
    sections = web_sections(cycle, scenes, forces.swing)
    bending, aside, torque, journal, shear, shear_aside = (
        sections.range_of(name) for name in _MOMENTS_AND_SHEARS
    )
    alone = [
        web_sections(one, [own]).range_of("bending_Nm")[0] for one, own in zip(single, scenes, strict=True)
    ]
    webs = tuple(
        WebMoment(
            web=2 * index + side + 1,
            throw=index + 1,
            range_Nm=float(bending[index, side]),
            alone_Nm=float(alone[index][side]),
            share=float(bending[index, side] / alone[index][side]),
            side_range_Nm=float(aside[index, side]),
            torque_range_Nm=float(torque[index, side]),
            journal_torque_range_Nm=float(journal[index, side]),
            shear_range_N=float(shear[index, side]),
            side_shear_range_N=float(shear_aside[index, side]),
        )
        for index in range(len(angles))
        for side in (0, 1)
    )
    shaft = ContinuousShaft(
        speed_rpm=engine_of(scene).speed_rpm,
        spring_N_per_mm=support if isinstance(support, float) else None,
        tilt_spring_Nm_per_rad=bearing_tilt_spring_Nmm_per_rad(scene) / NMM_PER_NM or None,
        webs=webs,
        main_bearings=_main_bearings(cycle, single, angles, scene),
        big_ends=ShaftBigEnds(tilt_mrad=tuple((np.abs(tilts).max(axis=1) * _MRAD_PER_RAD).tolist())),
        carried=carried_motions(cycle, scene),
        sections=sections,
    )
    return _AtSpeed(scene, shaft, cycle, tilts)


def _of_throw(forces: CycleForces, index: int) -> CycleForces:
    one = slice(index, index + 1)
    return CycleForces(
        forces.angle_deg,
        forces.radial_N[one],
        forces.tangential_N[one],
        forces.radial_aside_N_mm[one],
        forces.tangential_aside_N_mm[one],
        forces.angular_speed_rad_s,
    )


def _main_bearings(
    cycle: ShaftCycle, single: Sequence[ShaftCycle], angles_deg: Sequence[float], scene: Scene
) -> tuple[ShaftBearing, ...]:
    sections, roller, speed = len(cycle.bearing_N), scene.supports.roller_bearing, engine_of(scene).speed_rpm
    size = np.hypot(cycle.bearing_N[:, 0], cycle.bearing_N[:, 1])
    added = np.zeros_like(cycle.bearing_N)
    for index, (one, angle) in enumerate(zip(single, angles_deg, strict=True)):
        added[index : index + 2] += turned(about_z_deg(angle))[:2, :2] @ one.bearing_N
    halves_N = np.hypot(added[:, 0], added[:, 1]).max(axis=1)
    motion = cycle.motion.reshape(sections, 6, -1)
    tilt = np.hypot(motion[:, RX], motion[:, RY]).max(axis=1) * _MRAD_PER_RAD
    leads = np.stack([motion[:, RY], -motion[:, RX]], axis=1)
    offset = np.hypot(motion[:, UX], motion[:, UY]).max(axis=1) * UM_PER_MM
    return tuple(
        ShaftBearing(
            bearing=number + 1,
            largest_N=float(size[number].max()),
            at_deg=float(cycle.angle_deg[size[number].argmax()]),
            halves_N=float(halves_N[number]),
            tilt_mrad=float(tilt[number]),
            offset_um=float(offset[number]),
            life_h=life_over_cycle_h(roller, size[number], speed),
            reference_life_h=reference_life_h(roller, -cycle.bearing_N[number], leads[number], speed),
        )
        for number in carried(scene)
    )


def _with_films(found: Sequence[_AtSpeed]) -> tuple[ContinuousShaft, ...]:
    """Return shafts with the oil films of their bearings, where the scene has bearings and turns."""
    shafts, cases = [at.shaft for at in found], {}
    for place, at in enumerate(found):
        if at.scene.bearings is not None and engine_of(at.scene).speed_rpm:
            cases[place] = (
                at.scene,
                [*loaded_journals(at.scene, at.cycle), _loaded_big_end(at)],
                at.cycle.angle_deg,
            )
    _tell_touching([one for _, loaded, _ in cases.values() for one in loaded])
    for place, films in zip(cases, films_of(list(cases.values()), conserving=True), strict=True):
        shafts[place] = _filled(shafts[place], films)
    return tuple(shafts)


def _tell_touching(loaded: Sequence[LoadedBearing]) -> None:
    """Warn of journals that lean on the edge of their bearing: films of parallel journals do not show it."""
    worst: dict[str, float] = {}
    for one in loaded:
        tilt = 0.0 if one.tilts is None else float(np.abs(one.tilts).max())
        if tilt > 1:
            ends_um = tilt * one.bearing.clearance_mm * UM_PER_MM
            worst[one.name] = max(ends_um, worst.get(one.name, 0.0))
    if worst:
        ends = ", ".join(f"{name} {ends_um:.0f} um" for name, ends_um in worst.items())
        warn(
            "the ends of journals move by more than the radial clearance of their bearing, and touch it: "
            f"{ends}. Films are told for journals that lie parallel."
        )


def loaded_journals(scene: Scene, cycle: ShaftCycle) -> list[LoadedBearing]:
    """Return the main bearings of a scene with the forces on their journals and the tilts of these."""
    loads, tilts, still = journal_loads_N(cycle), journal_tilts(cycle), np.zeros_like(cycle.angle_deg)
    found = []
    for number in carried(scene):
        bearing = main_bearing(scene, number)
        half_mm = (bearing.width_mm * bearing.films + plain_bearings(scene).groove_mm) / 2
        tilt = tilts[number] * (half_mm / bearing.clearance_mm)
        found.append(LoadedBearing(f"main {number + 1}", bearing, loads[number], still, tilts=tilt[None]))
    return found


def _loaded_big_end(at: _AtSpeed) -> LoadedBearing:
    """The big end of a cylinder that fires, with the tilt of the pin of every big end at its own time."""
    engine, angle, one = engine_of(at.scene), at.cycle.angle_deg, loaded_big_end(at.scene)
    fires = engine.firing_angles_deg[: engine.throws * at.scene.big_ends]
    tilts = [
        phase_shift(at.pin_tilts[index % engine.throws], angle, -fire, engine.cycle_deg)
        for index, fire in enumerate(fires)
    ]
    half = one.bearing.width_mm / 2 / one.bearing.clearance_mm
    return replace(one, tilts=half * np.array(tilts) * unit_vectors(angle))


def filmed_by(film: BearingFilm) -> dict[str, Any]:
    """Return the values of a `FilmedBearing` by their names."""
    return {
        "film_um": film.film_um,
        "film_below_um": film.below_um,
        "pressure_MPa": film.pressure_MPa,
        "conserving": film.conserving,
    }


def _filled(shaft: ContinuousShaft, films: Sequence[BearingFilm]) -> ContinuousShaft:
    *bearings, big_ends = (
        one.model_copy(update=filmed_by(film)) for one, film in zip(shaft.bearings, films, strict=True)
    )
    return shaft.model_copy(update={"main_bearings": tuple(bearings), "big_ends": big_ends})
