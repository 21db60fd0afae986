"""What the rods on each pin of the shaft do to its webs: one rod, or the two of a V side by side."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from cranktopo.base.arrays import Array
from cranktopo.design.engine import Engine
from cranktopo.design.schema import Scene
from cranktopo.engine.forces import ThrowForces
from cranktopo.engine.kinematics import phase_shift


@dataclass(frozen=True)
class RodsOnPin:
    """The rods on a pin as one of its webs feels them.

    A throw stands on its two main bearings, and what a web carries is the reaction of the bearing beside it.
    A rod that is nearer to one web therefore counts there by more than its force, and by less at the other:
    by twice the lever rule's share, which is 1 in the middle of the pin.

    Attributes:
        name: the throw, or the web of it where the two differ; from the free end.
        throw: index of the throw, 0 at the free end.
        phase_shifts_deg: crank angles at which its rods' cylinders fire, after that of the first bank.
        shares: by how much of itself each rod's force counts.
    """

    name: str
    throw: int
    phase_shifts_deg: tuple[float, ...] = (0.0,)
    shares: tuple[float, ...] = (1.0,)

    def superpose(self, curve: Array, angle_deg: Array, cycle_deg: float) -> Array:
        """Return a force on the pin, of all its rods, from that of one rod at angles after its own firing."""
        parts = zip(self.shares, self.phase_shifts_deg, strict=True)
        return np.sum([share * phase_shift(curve, angle_deg, by, cycle_deg) for share, by in parts], axis=0)

    def forces(self, rod: ThrowForces, throw_N: float, cycle_deg: float) -> ThrowForces:
        """Forces of the throw from those of one rod; what belongs to one piston or one rod stays as it is.

        Args:
            throw_N: centrifugal force of the throw itself.
        """
        if self.shares == (1.0,):
            return rod
        radial, tangential, web = (
            self.superpose(curve, rod.angle_deg, cycle_deg)
            for curve in (rod.radial_force_N, rod.tangential_force_N, rod.web_force_N)
        )
        return replace(
            rod,
            radial_force_N=radial,
            tangential_force_N=tangential,
            web_force_N=web,
            main_journal_force_N=np.hypot(web - throw_N, tangential) / 2,
            torque_Nm=replace(self, shares=(1.0, 1.0)).superpose(rod.torque_Nm, rod.angle_deg, cycle_deg),
        )


def near_share(scene: Scene) -> float:
    """By how much of itself a rod's force counts at the web that is nearer to it; 1 in the pin's middle."""
    return 1 + scene.rod_offset_mm / scene.pitch_mm


def rods_on_pins(scene: Scene, engine: Engine) -> tuple[RodsOnPin, ...]:
    """Return the rods on the pin of every throw, or of every web where the two of a throw differ."""
    throws, fires = engine.throws, engine.firing_angles_deg
    if engine.rods_per_pin == 1:
        return tuple(RodsOnPin(f"throw {throw + 1}", throw) for throw in range(throws))
    found, near = [], near_share(scene)
    for throw in range(throws):
        after = (0.0, (fires[throw + throws] - fires[throw]) % engine.cycle_deg)
        if near == 1.0:
            found.append(RodsOnPin(f"throw {throw + 1}", throw, after, (1.0, 1.0)))
            continue
        for side, shares in enumerate(((near, 2 - near), (2 - near, near))):
            name = f"web {2 * throw + side + 1} of throw {throw + 1}"
            found.append(RodsOnPin(name, throw, after, shares))
    return tuple(found)
