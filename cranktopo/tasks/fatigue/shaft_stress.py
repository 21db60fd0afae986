"""Stress of a throw in a shaft: fields of every way in which its neighbours and its own loads strain it."""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from cranktopo.base.arrays import Array
from cranktopo.base.notes import note
from cranktopo.tasks.fatigue.stress_model import RULE_FRACTION, StressModel, mesh_for_stress, stress_model
from cranktopo.tasks.fea.targets import Target
from cranktopo.tasks.fea.unit_fields import UnitField
from cranktopo.tasks.shaft.loaded_throw import LoadedBlock, ThrowBody, throw_body


@dataclass(frozen=True)
class ShaftStress:
    """A throw condensed for the shaft, and the stress on its surface.

    Attributes:
        shares: of each field of the model in what acts on the throw (`throw_states`), (fields, 17).
        seconds: for the mesh, the fields, and their stresses.
    """

    body: ThrowBody
    model: StressModel
    shares: Array
    seconds: tuple[float, float, float]

    def loads(self, states: Array) -> Array:
        """Return the factor of each field in states of the throw, (17, states), as (states, fields)."""
        return np.ascontiguousarray((self.shares @ states).T)


def solve_shaft_stress(target: Target, fillet_fraction: float = RULE_FRACTION) -> ShaftStress:
    """Mesh a throw for stresses, condense it with its loads, and return the stresses of all its fields.

    Raises:
        CranktopoError: a surface file, a fillet of radius 0, or a failed mesh or solve.
    """
    note(f"{target.name}: all motions of both sections, with stresses on the surface")
    times = [time.perf_counter()]
    meshed, scene = mesh_for_stress(target, fillet_fraction)
    times.append(time.perf_counter())
    body = throw_body(meshed, scene)
    times.append(time.perf_counter())
    fields, shares = zip(*(_fields(block) for block in body.blocks), strict=True)
    every = [field for of_block in fields for field in of_block]
    model = stress_model(target.name, scene, meshed, body.model, every, fillet_fraction)
    times.append(time.perf_counter())
    mesh, solve, stress = (float(taken) for taken in np.diff(times))
    quality = replace(model.quality, mesh_seconds=mesh, solve_seconds=solve + stress)
    return ShaftStress(body, replace(model, quality=quality), np.vstack(shares), (mesh, solve, stress))


def _fields(part: LoadedBlock) -> tuple[Sequence[UnitField], Array]:
    displacement, shares = part.straining_fields()
    sign_x, sign_z = -1 if part.lateral == "odd" else 1, -1 if part.span == "antisymmetric" else 1
    return [UnitField("shaft", field, sign_x, sign_z) for field in displacement.T], shares
