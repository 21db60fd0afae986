"""A throw that has mass: condensed as for the shaft on its bearings, with what its inertia adds between."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from cranktopo.base.arrays import Array
from cranktopo.base.units import NMM_PER_NM
from cranktopo.design.schema import Scene
from cranktopo.numerics.harmonic_balance import DampedBody
from cranktopo.numerics.turning_body import TurningBody
from cranktopo.tasks.modes.reduced_throw import HeldFields, ReducedThrow, reduced_throw
from cranktopo.tasks.modes.stage import moving_kg
from cranktopo.tasks.shaft.assembly import SECTIONS
from cranktopo.tasks.shaft.loaded_throw import LOADS, LoadedThrow, ThrowBody, loaded_throw, section_warps
from cranktopo.tasks.throw_fea.unit_fields import UnitField

_STEPS = 1
"""Steps of inertia: fields of the loads stand beside them."""


@dataclass(frozen=True)
class MovingThrow:
    """A throw over motions and warps of its sections, then the fields of its loads, then those of inertia.

    Its stiffness and loads without its mass are those of `LoadedThrow`.

    Attributes:
        loads: unit loads over the unknowns, (unknowns, loads).
        loss_factor: of its material.
        still: what it is without mass.
        reduced: of which it is made, its unknowns in another order.
    """

    damped: DampedBody
    loads: Array
    loss_factor: float
    still: LoadedThrow
    reduced: ReducedThrow

    def inertial_fields(self) -> list[UnitField]:
        """Return the fields of inertia as displacements of the model, in the order of their unknowns."""
        return [
            UnitField(
                "shaft",
                held.fields[:, column],
                -1 if held.lateral == "odd" else 1,
                -1 if held.span == "antisymmetric" else 1,
            )
            for held in self.reduced.held
            for column in range(_own(held))
        ]


def pin_friction_Ns_per_mm(scene: Scene, throw: Scene) -> float:
    """Return the force of the cylinders' friction on the pin of a throw, along its circle, over its velocity.

    Args:
        scene: of the whole shaft.
    """
    if scene.shaft is None or scene.engine is None:
        return 0.0
    torque = scene.engine.rods_per_pin * scene.shaft.cylinder_damping_Nms_per_rad * NMM_PER_NM
    return torque / throw.throw.radius_mm**2


def moving_throw(
    body: ThrowBody, scene: Scene, loss_factor: float, friction_Ns_per_mm: float = 0.0
) -> MovingThrow:
    """Return a meshed and condensed throw with its mass, and that of rods and pistons on its pin.

    Args:
        friction_Ns_per_mm: as of `pin_friction_Ns_per_mm`.

    Raises:
        CranktopoError: a failed solve.
    """
    reduced = reduced_throw(body, scene, section_warps(scene), _STEPS, moving_kg(scene), with_loads=True)
    own = reduced.body.over(np.eye(len(reduced.step_of))[:, _order(reduced.held)])
    still = loaded_throw(body.blocks, scene)
    return _of_reduced(own, still, reduced, loss_factor, friction_Ns_per_mm)


def _of_reduced(
    body: TurningBody, still: LoadedThrow, reduced: ReducedThrow, loss_factor: float, friction: float
) -> MovingThrow:
    """Return a throw whose unknowns are in the order of `MovingThrow`.

    A field with held sections does no work on the static ones; what the solver leaves of that is taken out.
    """
    stiffness, at = body.stiffness.copy(), slice(SECTIONS, SECTIONS + len(LOADS))
    stiffness[:SECTIONS, :SECTIONS] = still.stiffness
    stiffness[:SECTIONS, SECTIONS:] = 0.0
    stiffness[SECTIONS:, :SECTIONS] = 0.0
    body = TurningBody(stiffness, body.mass, body.coriolis, body.lateral, body.stiffening)
    section_loads = np.stack([still.loads[name] for name in LOADS], axis=1)
    loads = np.vstack([section_loads, stiffness[SECTIONS:, at]])
    along = loads[:, LOADS.index("tangential")]  # what does the work of that force is the pin's way along it
    damped = DampedBody(body, loss_factor * stiffness, friction * np.outer(along, along))
    return MovingThrow(damped, loads, loss_factor, still, reduced)


def _own(held: HeldFields) -> int:
    """Number of fields of inertia among the fields."""
    return held.fields.shape[1] - len(held.loads)


def _order(held: Sequence[HeldFields]) -> list[int]:
    """Return the unknowns of a reduced throw as those of a `MovingThrow` follow each other."""
    loads = {
        name: int(one.unknowns[_own(one) + place]) for one in held for place, name in enumerate(one.loads)
    }
    inertial = [int(unknown) for one in held for unknown in one.unknowns[: _own(one)]]
    return [*range(SECTIONS), *(loads[name] for name in LOADS), *inertial]
