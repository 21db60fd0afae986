"""Stress of a throw in a shaft: fields of every way in which its neighbours and its own loads strain it."""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from cranktopo.base.arrays import Array
from cranktopo.base.notes import note
from cranktopo.design.misfire import all_firing
from cranktopo.design.schema import Scene
from cranktopo.engine.analysis import engine_of
from cranktopo.engine.bearings import bearing_spring_N_per_mm
from cranktopo.engine.histories import speed_words
from cranktopo.engine.judged_speeds import speeds_of_range
from cranktopo.numerics.tetrahedra.solver import RESIDUAL_LIMIT
from cranktopo.tasks.fatigue.criteria import LOCAL_METHODS
from cranktopo.tasks.shaft.cycle import CycleForces, ShaftCycle, cycle_forces, throw_states
from cranktopo.tasks.shaft.loaded_throw import LoadedBlock, LoadedThrow, ThrowBody, loaded_throw, throw_body
from cranktopo.tasks.shaft.on_film import Support, carried_cycle
from cranktopo.tasks.shaft.stage import shaft_effects
from cranktopo.tasks.throw_fatigue.least import least_safeties
from cranktopo.tasks.throw_fatigue.safety_field import FatigueField, field_of_states
from cranktopo.tasks.throw_fatigue.stress_mesh import RULE_FRACTION, mesh_for_stress
from cranktopo.tasks.throw_fatigue.stress_model import StressModel, stress_model
from cranktopo.tasks.throw_fea.targets import Target
from cranktopo.tasks.throw_fea.unit_fields import UnitField


@dataclass(frozen=True)
class ShaftStress:
    """A throw condensed for the shaft, and the stress on its surface.

    Attributes:
        shares: of each field of the model in what acts on the throw (`throw_states`), (fields, 18).
        seconds: for the mesh, the fields, and their stresses.
    """

    body: ThrowBody
    model: StressModel
    shares: Array
    seconds: tuple[float, float, float]

    def loads(self, states: Array) -> Array:
        """Return the factor of each field in states of the throw, (18, states), as (states, fields)."""
        return np.ascontiguousarray((self.shares @ states).T)


def solve_shaft_stress(
    target: Target, fillet_fraction: float = RULE_FRACTION, residual: float = RESIDUAL_LIMIT
) -> ShaftStress:
    """Mesh a throw for stresses, condense it with its loads, and return the stresses of all its fields.

    Args:
        residual: relative one of the fields.

    Raises:
        CranktopoError: a surface file, a fillet of radius 0, or a failed mesh or solve.
    """
    note(f"{target.name}: all motions of both sections, with stresses on the surface")
    times = [time.perf_counter()]
    meshed, scene = mesh_for_stress(target, fillet_fraction)
    times.append(time.perf_counter())
    body = throw_body(meshed, scene, residual)
    times.append(time.perf_counter())
    fields, shares = zip(*(_fields(block) for block in body.blocks), strict=True)
    every = [field for of_block in fields for field in of_block]
    model = stress_model(target.name, scene, meshed, body.model, every, fillet_fraction)
    times.append(time.perf_counter())
    mesh, solve, stress = (float(taken) for taken in np.diff(times))
    quality = replace(model.quality, mesh_seconds=mesh, solve_seconds=solve + stress)
    return ShaftStress(body, replace(model, quality=quality), np.vstack(shares), (mesh, solve, stress))


def shaft_loads(
    throws: Sequence[ShaftStress], scene: Scene, at: Scene, support: Support
) -> tuple[Array, Array]:
    """Return the angles of the cycle, and the factors of the fields of every throw, (throws, states, fields).

    Args:
        at: the scene at the speed of the cycle.

    Raises:
        CranktopoError: no engine, or no pressures.
    """
    return factors_of(throws, scene, solved_cycle(throws, scene, at, support))


SolvedCycle = tuple[list[LoadedThrow], CycleForces, ShaftCycle]
"""The throws with their loads, the forces on their pins, and the shaft under these."""


def solved_cycle(throws: Sequence[ShaftStress], scene: Scene, at: Scene, support: Support) -> SolvedCycle:
    """Solve the shaft at one speed; arguments and errors as of `shaft_loads`."""
    loaded = [loaded_throw(one.body.blocks, one.model.scene) for one in throws]
    forces = cycle_forces(at, shaft_effects(scene))
    return loaded, forces, carried_cycle(loaded, at, forces, support)


def factors_of(throws: Sequence[ShaftStress], scene: Scene, solved: SolvedCycle) -> tuple[Array, Array]:
    """Return what `shaft_loads` does, of a cycle that is solved."""
    loaded, forces, cycle = solved
    states = throw_states(loaded, scene.shaft_angles_deg, forces, cycle)
    return forces.angle_deg, np.stack([one.loads(own) for one, own in zip(throws, states, strict=True)])


def worst_throw(target: Target, methods: Sequence[str], fillet_fraction: float) -> tuple[FatigueField, ...]:
    """Return the safety by each method of the throw that the shaft on all its bearings loads worst.

    All throws are that of the target, and all cylinders fire. Every angle of the cycle counts, over the range
    of speeds, at the overspeed and where the shaft vibrates most: each speed by itself, as no cycle has
    states of two.

    Raises:
        CranktopoError: missing material data or loads, sharp fillets, or a failed solve.
    """
    scene = all_firing(target.scene)
    stress = solve_shaft_stress(target, fillet_fraction)
    throws, spring = [stress] * len(scene.shaft_angles_deg), bearing_spring_N_per_mm(scene)
    speeds = speeds_of_range(scene, shaft_effects(scene))
    rpm = [engine_of(at).speed_rpm for at in speeds]
    note(f"{target.name}: {len(throws)} throws at {len(rpm)} speeds from {rpm[0]:,.0f} to {rpm[-1]:,.0f} rpm")
    angles, loads = zip(*(shaft_loads(throws, scene, at, spring) for at in speeds), strict=True)
    of_throws = list(np.stack(loads, axis=1))  # (throws, speeds, states, fields)

    def field(method: str, throw: int, speed: int) -> FatigueField:
        words = speed_words(rpm[speed])
        labels = tuple(f"throw {throw + 1}, {angle:g} deg{words}" for angle in angles[speed])
        judged = field_of_states(stress.model, method, of_throws[throw][speed], labels)
        return replace(judged, on_bearings=True)

    def worst(method: str) -> FatigueField:
        cycles = _cycles_to_judge(stress.model, of_throws, method)
        return min((field(method, *one) for one in cycles), key=lambda found: found.critical.safety)

    return tuple(map(worst, methods))


def _cycles_to_judge(model: StressModel, loads: Sequence[Array], method: str) -> list[tuple[int, int]]:
    """Return throw and speed of the least safety; by critical planes those of every cycle.

    Arguments as of `least_safeties`.
    """
    if method not in LOCAL_METHODS:
        return [(throw, speed) for throw, own in enumerate(loads) for speed in range(len(own))]
    least = np.stack([np.min(list(parts.values()), axis=0) for parts in least_safeties(model, loads, method)])
    throw, speed = np.unravel_index(int(least.argmin()), least.shape)
    return [(int(throw), int(speed))]


def _fields(part: LoadedBlock) -> tuple[Sequence[UnitField], Array]:
    displacement, shares = part.straining_fields()
    sign_x, sign_z = -1 if part.lateral == "odd" else 1, -1 if part.span == "antisymmetric" else 1
    return [UnitField("shaft", field, sign_x, sign_z) for field in displacement.T], shares
