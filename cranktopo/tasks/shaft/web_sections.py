"""Forces and moments in the middle of every web over the cycle, and their table for other programs."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from cranktopo.base.arrays import Array
from cranktopo.base.files import replacing
from cranktopo.base.frames import about_z_deg
from cranktopo.base.units import NMM_PER_NM
from cranktopo.design.halves import halves
from cranktopo.design.schema import Scene
from cranktopo.engine.balance.throw import throw_balance
from cranktopo.numerics.tetrahedra.rigid_motions import RX, RY, RZ, UX, UY, UZ
from cranktopo.tasks.shaft.cycle import ShaftCycle, ShaftSwing


@dataclass(frozen=True)
class WebSections:
    """Loads by the part of the shaft ahead of each web on its middle, in the axes of its throw.

    Of the section forces alone: the web's own centrifugal force between section and web, constant over the
    cycle, is left out. Shapes (throws, 2 webs, states).

    Attributes:
        bending_Nm: moment in the plane of the throw.
        side_bending_Nm: moment across it.
        torque_Nm: that the shaft ahead passes on toward the takeoff, positive as in `cranktopo loads`; of a
            shaft whose disks vibrate with half of what the mass of its side of the throw adds: the other
            half lies beyond.
        shear_N: along the throw, away from the crank axis.
        side_shear_N: across it.
        axial_N: along the crank axis.
        journal_torque_Nm: that in the main journal beside the web.
    """

    angle_deg: Array
    bending_Nm: Array
    side_bending_Nm: Array
    torque_Nm: Array
    shear_N: Array
    side_shear_N: Array
    axial_N: Array
    journal_torque_Nm: Array

    def curves(self) -> dict[str, Array]:
        """Return the curves by name, without the angles."""
        return {name: curve for name, curve in vars(self).items() if name != "angle_deg"}

    def range_of(self, name: str) -> Array:
        """Return the largest less the smallest value of a curve in each web, (throws, 2)."""
        return np.ptp(self.curves()[name], axis=2)


def web_sections(cycle: ShaftCycle, scenes: Sequence[Scene], swing: ShaftSwing | None = None) -> WebSections:
    """Return the forces and moments in the webs of throws, each with its own scene.

    Args:
        swing: of the forces of that cycle.
    """
    near, far = (
        np.array([sum(halves(scene)[side].web_z_mm) / 2 for scene in scenes])[:, None] for side in (0, 1)
    )
    ends = ((cycle.throw_N[:, :6], near, 1.0), (cycle.throw_N[:, 6:], -far, -1.0))

    def both(motion: int, lever: int | None = None, turn: float = 0.0) -> Array:
        found = []
        for forces, arm_mm, side in ends:
            about = 0.0 if lever is None else turn * arm_mm * forces[:, lever]
            found.append(side * (forces[:, motion] + about))
        return np.stack(found, axis=1)

    journal = -both(RZ) / NMM_PER_NM
    return WebSections(
        cycle.angle_deg,
        both(RX, UY, 1.0) / NMM_PER_NM,
        both(RY, UX, -1.0) / NMM_PER_NM,
        journal if swing is None else journal - _to_the_middle_Nm(swing, scenes),
        both(UY),
        both(UX),
        both(UZ),
        journal,
    )


def _to_the_middle_Nm(swing: ShaftSwing, scenes: Sequence[Scene]) -> Array:
    """Return what throws add between each journal and the middle of its web, (throws, 2, states)."""
    own = np.array([[throw_balance(half).inertia_kg_mm2 for half in halves(scene)] for scene in scenes])
    share = own / own.sum(axis=1, keepdims=True) / 2 * [1.0, -1.0]
    return np.asarray(about_z_deg(1.0) * share[:, :, None] * swing.throw_Nm[:, None])


def write_web_sections(
    sections_by_speed: Sequence[tuple[float, WebSections]], path: Path, moving: Sequence[WebSections] = ()
) -> None:
    """Write the curves of every web at every speed as CSV, one row an angle.

    Args:
        sections_by_speed: speed, rpm, and curves at it.
        moving: the curves of the shaft that vibrates at the same speeds, in columns beside them.

    Raises:
        CranktopoError: the file cannot be written.
    """
    rows, names = [], list(sections_by_speed[0][1].curves())
    if moving:
        names += [f"dynamic_{name}" for name in names]
    for number, (speed_rpm, sections) in enumerate(sections_by_speed):
        beside = moving[number].curves().values() if moving else ()
        curves = np.stack([*sections.curves().values(), *beside], axis=-1)
        throws, webs, states, _ = curves.shape
        throw, web, state = np.indices((throws, webs, states)).reshape(3, -1)
        place = np.stack([np.full(throw.size, speed_rpm), 2 * throw + web + 1, throw + 1], axis=1)
        angle = sections.angle_deg[state][:, None]
        rows.append(np.hstack([place, angle, curves.reshape(throw.size, -1)]))
    head = ",".join(["speed_rpm", "web", "throw", "angle_deg", *names])
    with replacing(path) as temporary:
        np.savetxt(temporary, np.vstack(rows), fmt="%.8g", delimiter=",", header=head, comments="")
