"""The whole crankshaft of a design: stiffness end to end, per throw, and torsional natural frequencies."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TypeVar

import numpy as np
from pydantic import Field

from cranktopo.base.arrays import Array
from cranktopo.base.frames import Span, about_z_deg
from cranktopo.base.notes import note
from cranktopo.base.result import UNLESS_NONE, Result
from cranktopo.base.units import MPA_PER_GPA
from cranktopo.bodies.crank_ends import SIDES
from cranktopo.bodies.memory import check_element_size
from cranktopo.bodies.mesh.solid_mesh import MeshedThrow
from cranktopo.design.assumed import LOADS, SHAFT, Assumption, filter_by_table
from cranktopo.design.crank_throws import carried, throw_scenes
from cranktopo.design.halves import default_element_size_mm
from cranktopo.design.misfire import misfire, misfire_words
from cranktopo.design.schema import Scene
from cranktopo.engine.analysis import at_speed
from cranktopo.engine.balance.crank import end_mass
from cranktopo.engine.bearings import required_bearing_spring_N_per_mm
from cranktopo.engine.forces import INERTIA_EFFECTS
from cranktopo.engine.gas import pressure_curve
from cranktopo.engine.plan.planning import plan
from cranktopo.engine.throw_compliance import throw_stiffness_Nm_per_rad
from cranktopo.engine.vibration.shaft_chain import bare_chain
from cranktopo.numerics.tetrahedra.elasticity import Elasticity, assemble
from cranktopo.tasks.fea.condense import Superelement
from cranktopo.tasks.fea.discretisation_error import discretisation_errors
from cranktopo.tasks.fea.error_bound import TORSION_VOLUME_FACTOR, bound_percent, change_bound_percent
from cranktopo.tasks.fea.evaluation import (
    RATIO,
    SCHEMA_VERSION,
    mesh_target,
    meshed_throw_kg,
    throw_inertia_kg_mm2,
)
from cranktopo.tasks.fea.targets import Target, TargetLike, resolve_target
from cranktopo.tasks.shaft.assembly import (
    Bearings,
    ShaftStiffness,
    shaft_matrix,
    shaft_stiffness,
    throw_blocks,
    throw_matrix,
)
from cranktopo.tasks.shaft.continuous import continuous_shafts
from cranktopo.tasks.shaft.loaded_throw import LoadedBlock, ThrowBody, loaded_throw, throw_body
from cranktopo.tasks.shaft.result import ContinuousShaft


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


_WITHOUT_SPRINGS: tuple[Bearings, ...] = ("free", "rigid")


class ShaftEvaluation(Result):
    """A whole crankshaft: the object that `shaft --json` prints."""

    schema_version: int = SCHEMA_VERSION
    design: str
    throw_angles_deg: tuple[float, ...]
    bearings: Bearings
    mass_kg: float
    stiffness: ShaftStiffness = Field(validation_alias="torsion", serialization_alias="torsion")
    error_estimate_percent: TorsionError
    natural_frequencies_Hz: tuple[float, ...]
    opentorsion: OpenTorsion
    on_bearings: tuple[ContinuousShaft, ...] = ()
    """Moments and forces on all bearings, by speed; empty without pressures or with free bearings."""
    misfire: tuple[int, ...] | None = UNLESS_NONE
    """Cylinders that do not fire in them, where there are any."""
    assumed: tuple[Assumption, ...]
    """Keys that the design does not give and the shaft depends on."""
    throw_inertias_kg_mm2: tuple[float, ...] = Field(exclude=True)
    """Inertia of each throw alone about the crank axis, kg mm2."""

    throw_by_bearings_Nm_per_rad: dict[str, float] = Field(exclude=True)
    """Torsional stiffness of a throw (the mean of unlike ones) by its bearings, and that of load cases."""
    weighed: str = Field(exclude=True)
    """What the mass is of."""
    silent: str = Field(default="", exclude=True)
    """Sentence on the cylinders that do not fire."""

    @property
    def error_percent(self) -> float:
        """Bound of the stiffnesses' discretisation error, percent."""
        return self.error_estimate_percent.torsion


def evaluate_shaft(
    target: TargetLike,
    bearings: Bearings,
    element_size_mm: float | None = None,
    *,
    speeds_rpm: Sequence[float] | None = None,
    bodies: Mapping[str, ThrowBody] | None = None,
) -> ShaftEvaluation:
    """Assemble the throws of a target by its firing order.

    Triangles are remeshed: a mesh 1.5 times coarser tells how much that matters.

    Args:
        speeds_rpm: also what its webs and bearings carry over the cycle at these speeds, where the scene
            tells the loads; an empty sequence stands for the engine's own.
        bodies: the throws by their names where they are meshed and condensed already.

    Raises:
        CranktopoError: no engine, no bearing spring for "spring", or a failed solve.
    """
    resolved = resolve_target(target, whole=True, crank=True)
    scene = resolved.scene
    angles = scene.shaft_angles_deg
    spring = required_bearing_spring_N_per_mm(scene) if bearings == "spring" else 0.0
    size = element_size_mm or default_element_size_mm(scene)
    check_element_size(scene, size)
    throws = throw_targets(resolved)
    loaded = speeds_rpm is not None and stands_on_bearings(scene, bearings)
    if bodies is None:
        meshed = {throw.name: mesh_target(throw, size) for throw in throws}
        condensed = _condensed_throws(throws, meshed, loaded=loaded)
    else:
        meshed = {name: body.meshed for name, body in bodies.items()}
        condensed = once_each(throws, lambda throw: _of_body(bodies[throw.name], throw.scene))
    stiffness, error = _on_meshes(condensed, scene, bearings, spring)
    matrices = [throw.matrix for throw in condensed]
    others = {
        f"{name} bearings": _mean(_stiffness(matrices, scene, name).throws_Nm_per_rad)
        for name in _WITHOUT_SPRINGS
    }
    if resolved.triangles:
        coarser = {resolved.name: mesh_target(resolved, size * RATIO)}
        coarse, _ = _on_meshes(_condensed_throws(throws, coarser), scene, bearings, spring)
        error = max(error, change_bound_percent(coarse.by_name(), stiffness.by_name()))
    inertias = tuple(throw_inertia_kg_mm2(meshed[throw.name], throw.scene) for throw in throws)
    disks = bare_chain(scene, inertias, stiffness.throws_Nm_per_rad)
    assumed = filter_by_table(resolved.assumed, shaft_tables(scene, bearings, loaded=loaded))
    return ShaftEvaluation(
        design=resolved.name,
        throw_angles_deg=angles,
        bearings=bearings,
        mass_kg=_mass_kg(scene, throws, meshed),
        weighed="mass of the throws" if scene.crank is None else "mass of the crank",
        stiffness=stiffness,
        error_estimate_percent=TorsionError(torsion=error),
        natural_frequencies_Hz=tuple(disks.natural_frequencies_Hz()),
        opentorsion=OpenTorsion.model_validate(disks.as_opentorsion()),
        on_bearings=_at_speeds(
            condensed,
            throws,
            of_stiffness(scene, stiffness.throws_Nm_per_rad),
            bearings,
            speeds_rpm or (),
        )
        if loaded
        else (),
        misfire=(misfire(scene) or None) if loaded else None,
        silent=misfire_words(scene) if loaded else "",
        assumed=assumed,
        throw_inertias_kg_mm2=inertias,
        throw_by_bearings_Nm_per_rad={
            **others,
            f"{bearings} bearings": _mean(stiffness.throws_Nm_per_rad),
            f"load cases, {_origin(scene)}": throw_stiffness_Nm_per_rad(scene),
        },
    )


def _origin(scene: Scene) -> str:
    """Return where plan and load cases have the stiffness of a throw from."""
    return "given" if scene.shaft is not None and scene.shaft.gives_stiffness else "closed form"


def _mass_kg(scene: Scene, throws: Sequence[Target], meshed: Mapping[str, MeshedThrow]) -> float:
    """Return the mass of all throws and of the ends of the crank."""
    count = Counter(throw.name for throw in throws)
    first = {throw.name: throw for throw in reversed(throws)}
    mass = sum(count[name] * meshed_throw_kg(meshed[name], first[name].scene) for name in count)
    return mass + sum(end_mass(scene, side).mass_kg for side in SIDES)


def with_throw_stiffness(target: Target) -> Target:
    """The target with the stiffness of its throw in its shaft table, where load cases would take an estimate.

    Only a shaft whose vibration the plan has on needs it; any other target is returned as it is.

    Raises:
        CranktopoError: a failed solve.
    """
    scene = target.scene
    if scene.shaft is None or scene.shaft.gives_stiffness:
        return target
    if "torsional_vibration" not in plan(scene).enabled:
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
    return f"finite elements, {shaft.bearings} bearings, +-{shaft.error_percent:.2g} %"


def of_stiffness(scene: Scene, throws_Nm_per_rad: Sequence[float]) -> Scene:
    """Return the scene with the stiffness of its throws in its shaft table, where that has none."""
    if scene.shaft is None or scene.shaft.gives_stiffness:
        return scene
    shaft = scene.shaft.model_copy(update={"throw_stiffnesses_Nm_per_rad": tuple(throws_Nm_per_rad)})
    return scene.model_copy(update={"shaft": shaft})


def shaft_tables(scene: Scene, bearings: Bearings, *, loaded: bool = False) -> tuple[str, ...]:
    """Paths of what a shaft uses of a scene; loads count if asked for, or for a plain bearing's spring."""
    if loaded or (bearings == "spring" and scene.supports.bearing_clearance_mm is not None):
        return (*SHAFT, LOADS)
    return SHAFT


def stands_on_bearings(scene: Scene, bearings: Bearings) -> bool:
    """Tell whether a scene and its bearings say what the shaft carries over the cycle."""
    return bearings != "free" and pressure_curve(scene) is not None


def _at_speeds(
    condensed: Sequence[_Condensed],
    throws: Sequence[Target],
    scene: Scene,
    bearings: Bearings,
    speeds_rpm: Sequence[float],
) -> tuple[ContinuousShaft, ...]:
    spring = required_bearing_spring_N_per_mm(scene) if bearings == "spring" else None
    parts = [
        (loaded_throw(throw.loaded, target.scene), target.scene)
        for throw, target in zip(condensed, throws, strict=True)
    ]
    return continuous_shafts(parts, speed_scenes(scene, speeds_rpm), spring, shaft_effects(scene))


def speed_scenes(scene: Scene, speeds_rpm: Sequence[float]) -> list[Scene]:
    """Return the scene at each speed; of no speeds at its own."""
    return [at_speed(scene, rpm) for rpm in speeds_rpm] or [scene]


def shaft_effects(scene: Scene) -> frozenset[str]:
    """Return the effects that count on bearings: all inertia, vibration where the plan has it."""
    return INERTIA_EFFECTS | (plan(scene).enabled & {"torsional_vibration"})


def throw_targets(target: Target) -> tuple[Target, ...]:
    """Return each throw of the crank as a target; equal ones, and bodies, are the target itself."""
    throws = throw_scenes(target.scene)
    if target.file is not None or all(throw is throws[0] for throw in throws):
        return (target,) * len(throws)
    return tuple(replace(target, name=throw.name, scene=throw) for throw in throws)


@dataclass(frozen=True)
class _Condensed:
    """A throw over the motions of its sections, (12, 12), and what the mesh misses of its energy.

    Attributes:
        loaded: its symmetries with the unit loads, where they were asked for.
    """

    matrix: Array
    surplus: Array
    straight: Array
    volume_error: float
    loaded: tuple[LoadedBlock, ...] = ()


def _condensed_throws(
    throws: Sequence[Target], meshed: Mapping[str, MeshedThrow], *, loaded: bool = False
) -> list[_Condensed]:
    """Condense the throws, equal ones once; `meshed` has the mesh of each by its name."""
    return once_each(throws, lambda throw: _condensed(meshed[throw.name], throw.scene, loaded))


_Found = TypeVar("_Found")


def once_each(throws: Sequence[Target], found_of: Callable[[Target], _Found]) -> list[_Found]:
    """Return what is found of every throw; of equal ones it is found once."""
    found = {throw.name: found_of(throw) for throw in dict.fromkeys(throws)}
    return [found[throw.name] for throw in throws]


def _condensed(meshed: MeshedThrow, scene: Scene, loaded: bool) -> _Condensed:
    if loaded:
        return _of_body(throw_body(meshed, scene), scene)
    model = assemble(meshed.mesh, scene.material.E_GPa * MPA_PER_GPA, scene.material.poisson)
    blocks = throw_blocks(model, scene, meshed.mesh.mirrored, whole=meshed.whole)
    return _with_errors(meshed, model, blocks, scene)


def _of_body(body: ThrowBody, scene: Scene) -> _Condensed:
    blocks = [(part.span, part.block) for part in body.blocks]
    return replace(_with_errors(body.meshed, body.model, blocks, scene), loaded=body.blocks)


def _with_errors(
    meshed: MeshedThrow, model: Elasticity, blocks: Sequence[tuple[Span, Superelement]], scene: Scene
) -> _Condensed:
    missed = discretisation_errors(model, meshed, [block for _, block in blocks], scene)
    return _Condensed(
        throw_matrix(blocks),
        throw_matrix(blocks, [m.surplus for m in missed]),
        throw_matrix(blocks, [m.straight for m in missed]),
        missed[0].volume_error,
    )


def _on_meshes(
    throws: Sequence[_Condensed], scene: Scene, bearings: Bearings, spring_N_per_mm: float
) -> tuple[ShaftStiffness, float]:
    """Stiffnesses of the shaft, and the bound of their relative error by what the meshes miss, %."""

    def stiffness(matrices: Sequence[Array]) -> ShaftStiffness:
        return _stiffness(matrices, scene, bearings, spring_N_per_mm)

    found = stiffness([throw.matrix for throw in throws])
    surplus, straight = (
        _softer(found, stiffness([throw.matrix - missed for throw, missed in zip(throws, kind, strict=True)]))
        for kind in ([throw.surplus for throw in throws], [throw.straight for throw in throws])
    )
    left = max(throw.volume_error for throw in throws)
    return found, max(
        bound_percent(surplus[name], straight[name], left, TORSION_VOLUME_FACTOR) for name in surplus
    )


def _stiffness(
    matrices: Sequence[Array], scene: Scene, bearings: Bearings, spring_N_per_mm: float = 0.0
) -> ShaftStiffness:
    """Return the stiffness of a shaft of throws of these matrices."""
    turned_deg = tuple(map(about_z_deg, scene.shaft_angles_deg))
    shaft = shaft_matrix(np.array(matrices), turned_deg)
    return shaft_stiffness(shaft, bearings, spring_N_per_mm, carried(scene))


def _mean(values: Sequence[float]) -> float:
    return sum(values) / len(values)


def _softer(found: ShaftStiffness, without: ShaftStiffness) -> dict[str, float]:
    """Share of each twist that energy which a mesh misses would add."""
    softer = without.by_name()
    return {name: value / softer[name] - 1 for name, value in found.by_name().items()}
