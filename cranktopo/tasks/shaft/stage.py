"""The whole crankshaft of a design: stiffness end to end, per throw, and torsional natural frequencies."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

from cranktopo.base.errors import CranktopoError, ExitCode
from cranktopo.base.notes import note
from cranktopo.bodies.memory import check_element_size
from cranktopo.bodies.mesh.solid_mesh import MeshedThrow
from cranktopo.design.assumed import LOADS, SHAFT, filter_by_table
from cranktopo.design.crank_throws import throw_scenes
from cranktopo.design.halves import default_element_size_mm
from cranktopo.design.misfire import misfire, misfire_words
from cranktopo.design.schema import Scene
from cranktopo.engine.analysis import at_speed, at_worst_speed, engine_of
from cranktopo.engine.balance.crank import beyond_throws_kg
from cranktopo.engine.bearings import required_bearing_spring_N_per_mm
from cranktopo.engine.forces import INERTIA_EFFECTS
from cranktopo.engine.gas import pressure_curve
from cranktopo.engine.performance import pressure_words
from cranktopo.engine.plan.planning import left_off, plan
from cranktopo.engine.throw_compliance import throw_stiffness_Nm_per_rad
from cranktopo.engine.vibration.shaft_chain import bare_chain
from cranktopo.numerics.tetrahedra.mesh import RATIO
from cranktopo.tasks.film.permitted import permitted_films
from cranktopo.tasks.shaft.assembly import Bearings, ShaftBearings, ShaftStiffness, linear_bearings
from cranktopo.tasks.shaft.condensed_throw import (
    CondensedThrow,
    condensed_throws,
    matrix_of,
    of_body,
    once_each,
    stiffness_and_error,
    stiffness_of,
)
from cranktopo.tasks.shaft.continuous import continuous_shafts
from cranktopo.tasks.shaft.loaded_throw import ThrowBody, loaded_throw
from cranktopo.tasks.shaft.on_film import Support
from cranktopo.tasks.shaft.result import ContinuousShaft, OpenTorsion, ShaftEvaluation, TorsionError
from cranktopo.tasks.throw_fea.error_bound import change_bound_percent
from cranktopo.tasks.throw_fea.evaluation import mesh_target, meshed_throw_kg, throw_inertia_kg_mm2
from cranktopo.tasks.throw_fea.targets import Target, TargetLike, resolve_target

_SAME_RPM = 0.5
"""Difference up to which a speed is that at which the torque swings most."""
_WITHOUT_SPRINGS: tuple[Bearings, ...] = ("free", "rigid")
_VIBRATION = "torsional_vibration"


def evaluate_shaft(
    target: TargetLike,
    bearings: ShaftBearings,
    element_size_mm: float | None = None,
    *,
    speeds_rpm: Sequence[float] | None = None,
    bodies: Mapping[str, ThrowBody] | None = None,
    add_worst_speed: bool = False,
) -> ShaftEvaluation:
    """Assemble the throws of a target by its firing order.

    Triangles are remeshed: a mesh 1.5 times coarser tells how much that matters.

    Args:
        speeds_rpm: also what its webs and bearings carry over the cycle at these speeds, where the scene
            tells the loads; an empty sequence stands for the engine's own.
        bodies: the throws by their names where they are meshed and condensed already.
        add_worst_speed: between the lowest and the highest of several speeds also that at which the torque
            of the vibrating shaft swings most.

    Raises:
        CranktopoError: no engine, no bearing spring for "spring", or a failed solve.
    """
    resolved = resolve_target(target, whole=True, crank=True)
    scene = resolved.scene
    _ = scene.shaft_angles_deg  # refuses a scene without an engine before anything is solved
    spring = required_bearing_spring_N_per_mm(scene) if bearings == "spring" else 0.0
    held = linear_bearings(bearings)
    size = element_size_mm or default_element_size_mm(scene)
    check_element_size(scene, size)
    loaded = speeds_rpm is not None and stands_on_bearings(scene, bearings)
    shaft = _condensed_shaft(resolved, size, bodies, loaded=loaded)
    stiffness, error = _stiffness_and_error(shaft, resolved, held, spring, size)
    disks = bare_chain(scene, shaft.inertias_kg_mm2, stiffness.throws_Nm_per_rad)
    stiff_scene = of_stiffness(scene, stiffness.throws_Nm_per_rad)
    speeds, added = tuple(speeds_rpm or ()), None
    if loaded and add_worst_speed:
        speeds, added = _with_worst_speed(stiff_scene, speeds)
    on_bearings = _at_speeds(shaft, stiff_scene, bearings, speeds) if loaded else ()
    return ShaftEvaluation(
        design=resolved.name,
        throw_angles_deg=scene.shaft_angles_deg,
        bearings=bearings,
        mass_kg=_mass_kg(scene, shaft),
        weighed="mass of the throws" if scene.crank is None else "mass of the crank",
        stiffness=stiffness,
        error_estimate_percent=TorsionError(torsion=error),
        natural_frequencies_Hz=tuple(disks.natural_frequencies_Hz()),
        opentorsion=OpenTorsion.model_validate(disks.as_opentorsion()),
        on_bearings=on_bearings,
        added_speed_rpm=added,
        **permitted_films(scene.bearings, [film for at in on_bearings for film in at.least_films]),
        misfire=(misfire(scene) or None) if loaded else None,
        silent=misfire_words(scene) if loaded else "",
        pressure=pressure_words(scene, _speeds(scene, speeds)) if loaded else "",
        assumed=filter_by_table(resolved.assumed, shaft_tables(scene, bearings, loaded=loaded)),
        throw_inertias_kg_mm2=shaft.inertias_kg_mm2,
        throw_by_bearings_Nm_per_rad=_throw_by_bearings(shaft, scene, held, stiffness),
    )


@dataclass(frozen=True)
class _Shaft:
    """Throws along a shaft, the mesh of each by its name, and each over the motions of its sections."""

    throws: tuple[Target, ...]
    meshed: Mapping[str, MeshedThrow]
    condensed: Sequence[CondensedThrow]

    @cached_property
    def inertias_kg_mm2(self) -> tuple[float, ...]:
        """Inertia of each throw alone about the crank axis, kg mm2."""
        return tuple(self._of_each(throw_inertia_kg_mm2))

    @property
    def throws_kg(self) -> float:
        """Mass of all throws."""
        return sum(self._of_each(meshed_throw_kg))

    def _of_each(self, found_of: Callable[[MeshedThrow, Scene], float]) -> list[float]:
        return once_each(self.throws, lambda throw: found_of(self.meshed[throw.name], throw.scene))


def _condensed_shaft(
    target: Target,
    size_mm: float,
    bodies: Mapping[str, ThrowBody] | None,
    *,
    loaded: bool,
) -> _Shaft:
    throws = throw_targets(target)
    if bodies is not None:
        known = once_each(throws, lambda throw: of_body(bodies[throw.name], throw.scene))
        return _Shaft(throws, {name: body.meshed for name, body in bodies.items()}, known)
    meshed = {throw.name: mesh_target(throw, size_mm) for throw in throws}
    return _Shaft(throws, meshed, condensed_throws(throws, meshed, loaded=loaded))


def _stiffness_and_error(
    shaft: _Shaft, target: Target, bearings: Bearings, spring_N_per_mm: float, size_mm: float
) -> tuple[ShaftStiffness, float]:
    """Return the stiffnesses and the bound of their error, %; of triangles also by a coarser mesh."""
    on = target.scene, bearings, spring_N_per_mm
    stiffness, error = stiffness_and_error(shaft.condensed, *on)
    if not target.triangles:
        return stiffness, error
    coarser = {target.name: mesh_target(target, size_mm * RATIO)}
    coarse, _ = stiffness_and_error(condensed_throws(shaft.throws, coarser), *on)
    return stiffness, max(error, change_bound_percent(coarse.by_name(), stiffness.by_name()))


def _throw_by_bearings(
    shaft: _Shaft, scene: Scene, bearings: Bearings, stiffness: ShaftStiffness
) -> dict[str, float]:
    """Return the mean stiffness of a throw by its bearings, and that of load cases, N m/rad."""
    matrices = [throw.matrix for throw in shaft.condensed]
    others = {
        f"{name} bearings": _mean(stiffness_of(matrices, scene, name).throws_Nm_per_rad)
        for name in _WITHOUT_SPRINGS
    }
    return {
        **others,
        f"{bearings} bearings": _mean(stiffness.throws_Nm_per_rad),
        f"load cases, {_origin(scene)}": throw_stiffness_Nm_per_rad(scene),
    }


def _mean(values: Sequence[float]) -> float:
    return sum(values) / len(values)


def _origin(scene: Scene) -> str:
    """Return where plan and load cases have the stiffness of a throw from."""
    return "given" if scene.shaft is not None and scene.shaft.gives_stiffness else "closed form"


def _mass_kg(scene: Scene, shaft: _Shaft) -> float:
    """Return the mass of all throws and of the ends of the crank."""
    return shaft.throws_kg + beyond_throws_kg(scene)


def with_throw_stiffness(target: Target) -> Target:
    """The target with the stiffness of its throw in its shaft table, where load cases would take an estimate.

    Only a shaft whose vibration the plan has on needs it; any other target is returned as it is.

    Raises:
        CranktopoError: a failed solve.
    """
    scene = target.scene
    if scene.shaft is None or scene.shaft.gives_stiffness:
        return target
    if _VIBRATION not in plan(scene).enabled:
        return target
    shaft = evaluate_shaft(target, "rigid")
    throws = shaft.stiffness.throws_Nm_per_rad
    stiffness = sum(throws) / len(throws)
    note(
        f"{target.name}: torque of the vibrating shaft with {stiffness:,.0f} N m/rad for a throw, by elements"
    )
    return replace(target, scene=of_stiffness(scene, throws), throw_stiffness_source=stiffness_source(shaft))


def stiffness_source(shaft: ShaftEvaluation) -> str:
    """Return where the stiffness of the throws comes from, in words."""
    return f"finite elements, {shaft.stiffness_bearings} bearings, +-{shaft.error_percent:.2g} %"


def of_stiffness(scene: Scene, throws_Nm_per_rad: Sequence[float]) -> Scene:
    """Return the scene with the stiffness of its throws in its shaft table, where that has none."""
    if scene.shaft is None or scene.shaft.gives_stiffness:
        return scene
    shaft = scene.shaft.model_copy(update={"throw_stiffnesses_Nm_per_rad": tuple(throws_Nm_per_rad)})
    return scene.model_copy(update={"shaft": shaft})


def with_stiffness_of(target: Target, bearings: Bearings, bodies: Mapping[str, ThrowBody]) -> Scene:
    """Return the scene of a shaft with the stiffness of its throws, which are condensed, by their names.

    Only a shaft table that has none needs it; any other scene is returned as it is.
    """
    scene = target.scene
    if scene.shaft is None or scene.shaft.gives_stiffness:
        return scene
    matrices = [matrix_of(bodies[throw.name]) for throw in throw_targets(target)]
    spring = required_bearing_spring_N_per_mm(scene) if bearings == "spring" else 0.0
    return of_stiffness(scene, stiffness_of(matrices, scene, bearings, spring).throws_Nm_per_rad)


def shaft_tables(scene: Scene, bearings: ShaftBearings, *, loaded: bool = False) -> tuple[str, ...]:
    """Paths of what a shaft uses of a scene; loads count if asked for, or for a plain bearing's spring."""
    if loaded or (bearings == "spring" and scene.supports.bearing_clearance_mm is not None):
        return (*SHAFT, LOADS)
    return SHAFT


def stands_on_bearings(scene: Scene, bearings: ShaftBearings) -> bool:
    """Tell whether a scene and its bearings say what the shaft carries over the cycle."""
    return bearings != "free" and pressure_curve(scene) is not None


def not_on_bearings(what: str) -> CranktopoError:
    """Return the refusal of an option where a shaft does not; `what` says what needs it, up to the verb."""
    return CranktopoError(
        f"{what} [engine.gas], and bearings that are not free.",
        hint="Leave it out, or choose --bearings rigid, spring, clearance or film.",
        code=ExitCode.USAGE,
    )


def _at_speeds(
    shaft: _Shaft, scene: Scene, bearings: ShaftBearings, speeds_rpm: Sequence[float]
) -> tuple[ContinuousShaft, ...]:
    parts = [
        (loaded_throw(throw.loaded, target.scene), target.scene)
        for throw, target in zip(shaft.condensed, shaft.throws, strict=True)
    ]
    support = support_of(scene, bearings)
    return continuous_shafts(parts, speed_scenes(scene, speeds_rpm), support, shaft_effects(scene))


def support_of(scene: Scene, bearings: ShaftBearings) -> Support:
    """Return what holds the journals of a shaft over the cycle."""
    if bearings == "clearance" or bearings == "film":
        return bearings
    return required_bearing_spring_N_per_mm(scene) if bearings == "spring" else None


def _with_worst_speed(scene: Scene, speeds_rpm: tuple[float, ...]) -> tuple[tuple[float, ...], float | None]:
    """Return speeds with that between them at which the torque of the vibrating shaft swings most, and that.

    It is None where the shaft does not vibrate, or where it is one of several speeds, to half a rpm.
    """
    effects = shaft_effects(scene)
    if len(speeds_rpm) < 2 or scene.shaft is None or _VIBRATION not in effects:
        return speeds_rpm, None
    span = {"speed_min_rpm": min(speeds_rpm), "speed_max_rpm": max(speeds_rpm)}
    between = scene.model_copy(update={"shaft": scene.shaft.model_copy(update=span)})
    worst = engine_of(at_worst_speed(between, effects)).speed_rpm
    if min(abs(worst - speed) for speed in speeds_rpm) < _SAME_RPM:
        return speeds_rpm, None
    return tuple(sorted((*speeds_rpm, worst))), worst


def speed_scenes(scene: Scene, speeds_rpm: Sequence[float]) -> list[Scene]:
    """Return the scene at each speed; of no speeds at its own."""
    return [at_speed(scene, rpm) for rpm in speeds_rpm] or [scene]


def shaft_effects(scene: Scene) -> frozenset[str]:
    """Return the effects that count on bearings: all inertia, vibration where the plan has it."""
    return INERTIA_EFFECTS | (plan(scene).enabled & {_VIBRATION})


def shaft_left_off(scene: Scene) -> str:
    """Name the vibration where it is off although above the threshold; on bearings all other loads count."""
    return left_off(scene, plan(scene), {_VIBRATION})


def throw_targets(target: Target) -> tuple[Target, ...]:
    """Return each throw of the crank as a target; equal ones, and bodies, are the target itself."""
    throws = throw_scenes(target.scene)
    if target.file is not None or all(throw is throws[0] for throw in throws):
        return (target,) * len(throws)
    return tuple(replace(target, name=throw.name, scene=throw) for throw in throws)


def _speeds(scene: Scene, speeds_rpm: Sequence[float]) -> list[float]:
    return [engine_of(at).speed_rpm for at in speed_scenes(scene, speeds_rpm)]
