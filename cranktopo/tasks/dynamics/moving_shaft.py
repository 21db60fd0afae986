"""The whole shaft with its mass under the forces of a cycle: every harmonic of them by itself.

All is in the frame that turns with the shaft: there rigid bearings, and springs alike in every direction, are
constant, and so are the forces' places on the pins. A spring without damping does not feel that its bearing
stands still; what damps the shaft is its own material, what it carries, and friction by cylinder. Journals in
oil films lie as `on_film` finds.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cranktopo.base.arrays import Array, Complex
from cranktopo.base.frames import about_z_deg
from cranktopo.base.units import NMM_PER_NM
from cranktopo.bodies.crank_ends import SIDES
from cranktopo.design.crank_throws import carried
from cranktopo.design.schema import Scene
from cranktopo.design.shaft import ShaftTable
from cranktopo.engine.bearings import bearing_tilt_spring_Nmm_per_rad
from cranktopo.numerics.bearing_film.in_motion import CarriedShaft
from cranktopo.numerics.harmonic_balance import (
    CondensedBody,
    DampedBody,
    condensed,
    curves_of,
    damping_work,
    harmonics_of,
)
from cranktopo.numerics.tetrahedra.rigid_motions import RX, RY, RZ, UX, UY, UZ
from cranktopo.tasks.dynamics.moving_throw import MovingThrow
from cranktopo.tasks.modes.shaft_model import damped_end
from cranktopo.tasks.shaft.assembly import SECTIONS, own_unknowns, turned
from cranktopo.tasks.shaft.cycle import CycleForces, ShaftCycle, load_shares, warps_of
from cranktopo.tasks.shaft.on_film import rigid_sections


@dataclass(frozen=True)
class MovingShaft:
    """A shaft on rigid bearings, springs or oil films, with what its ends carry.

    Attributes:
        throws: from the free end; equal ones are the same object.
        ends: both ends over the six motions of the outer section first, then their own unknowns.
        viscous: damping of the unknowns of all sections by what is none of these bodies, (n, n).
        spring_N_per_mm: radial stiffness of every main bearing; None: rigid, or a film.
        borne_by: sections that sit in a bearing.
        turns_freely: the last section swings with what it drives; else it turns evenly.
        loss_factor: of the throws' material.
        rigid_at: sections that stay rigid.
    """

    throws: tuple[MovingThrow, ...]
    angles_deg: tuple[float, ...]
    ends: tuple[DampedBody, DampedBody]
    viscous: Array
    spring_N_per_mm: float | None
    tilt_Nmm_per_rad: float
    borne_by: tuple[int, ...]
    turns_freely: bool
    loss_factor: float
    rigid_at: tuple[int, ...]

    @property
    def unknowns(self) -> int:
        """Number of unknowns of every harmonic, those of the bodies included."""
        inner = sum(len(throw.loads) - SECTIONS for throw in self.throws)
        return len(self.viscous) + inner + sum(len(end.loss) - 6 for end in self.ends)


@dataclass(frozen=True)
class MovingCycle:
    """A shaft that vibrates steadily.

    Attributes:
        shaft: motions and forces of its sections, as of one without mass.
        within: the unknowns of every throw beyond those of its sections, (unknowns, states) each.
        strains: all unknowns of every throw, in its axes, as they strain it: with what its material's loss
            adds to the stress, (unknowns, states) each.
        work_in_J: what the forces on the pins do over the cycle.
        damping_work_J: what all damping takes over it.
        film_work_J: what the oil films take of it, in the turning frame; None without films.
    """

    shaft: ShaftCycle
    within: tuple[Array, ...]
    strains: tuple[Array, ...]
    work_in_J: float
    damping_work_J: float
    film_work_J: float | None = None


def moving_shaft(throws: Sequence[MovingThrow], scene: Scene, spring_N_per_mm: float | None) -> MovingShaft:
    """Return the shaft of a scene; `throws` are its throws from the free end."""
    shaft = scene.shaft or ShaftTable()
    free, output = (damped_end(scene, side) for side in SIDES)
    return MovingShaft(
        tuple(throws),
        tuple(scene.shaft_angles_deg),
        (free, output),
        _between_throws(shaft, len(throws)),
        spring_N_per_mm,
        bearing_tilt_spring_Nmm_per_rad(scene),
        tuple(carried(scene)),
        shaft.has_takeoff,
        throws[0].loss_factor,
        tuple(rigid_sections(scene)),
    )


def _between_throws(shaft: ShaftTable, throws: int) -> Array:
    """Return the damping between neighbouring throws: each turns by the mean of both its sections."""
    turns = np.zeros((throws, SECTIONS // 2 * (throws + 1)))
    for throw in range(throws):
        turns[throw, [6 * throw + RZ, 6 * throw + 6 + RZ]] = 0.5
    against = np.diff(turns, axis=0)
    return np.asarray(shaft.throw_damping_Nms_per_rad * NMM_PER_NM * against.T @ against)


def moving_cycle(shaft: MovingShaft, forces: CycleForces) -> MovingCycle:
    """Solve the steady vibration under the forces of a cycle, in rigid bearings or on springs."""
    return ShaftHarmonics(shaft, forces).cycle()


class ShaftHarmonics:
    """A shaft at all frequencies of a cycle that its states resolve.

    The mean holds the last section in rotation and along the axis, as a shaft without mass is held; all other
    harmonics leave the shaft free along its axis.
    """

    def __init__(self, shaft: MovingShaft, forces: CycleForces) -> None:
        self._shaft, self._angle_deg, states = shaft, forces.angle_deg, forces.angle_deg.size
        cycle_rad = states * np.radians(forces.angle_deg[1] - forces.angle_deg[0])
        number = np.arange(states // 2 + 1)
        self._frequency = forces.angular_speed_rad_s * 2 * np.pi / cycle_rad * number
        self._speed = about_z_deg(1.0) * forces.angular_speed_rad_s
        self._about_z = [turned(about_z_deg(angle), SECTIONS) for angle in shaft.angles_deg]
        count = len(shaft.throws)
        self._at = [own_unknowns(index, count, SECTIONS) for index in range(count)]
        self._end_at = slice(0, 6), slice(6 * count, 6 * count + 6)
        self._shares = [
            harmonics_of(load_shares(throw.still, forces, index)) for index, throw in enumerate(shaft.throws)
        ]
        once: dict[int, CondensedBody] = {}
        for throw in shaft.throws:
            if id(throw) not in once:
                once[id(throw)] = self._condensed(throw.damped, throw.loads, SECTIONS)
        self._throws = [once[id(throw)] for throw in shaft.throws]
        self._ends = [self._condensed(end, np.zeros((len(end.loss), 0)), 6) for end in shaft.ends]
        self._own = [
            np.einsum("kml,lk->mk", throw.loads, shares)
            for throw, shares in zip(self._throws, self._shares, strict=True)
        ]
        self._stiffness = self._joined()

    def cycle(self, lying_mm: Array | None = None) -> MovingCycle:
        """Return the steady vibration.

        Args:
            lying_mm: y and x of every journal that is borne, (2 bearings, states); without it they are in
                the middle of rigid bearings, or on springs.
        """
        motion = self._motions(None if lying_mm is None else harmonics_of(lying_mm))
        states = self._angle_deg.size
        sections, warps = np.split(motion, [6 * len(self._shaft.throws) + 6])
        cycle = ShaftCycle(
            self._angle_deg,
            curves_of(sections, states),
            curves_of(self._bearing_forces(motion), states),
            curves_of(self._throw_forces(motion), states),
            curves_of(warps, states),
        )
        within = self._within(motion)
        work, lost = self._works(motion, within)
        inner, strains = (
            tuple(curves_of(one, states) for one in every)
            for every in (within, self._strains(motion, within))
        )
        return MovingCycle(cycle, inner, strains, work, lost)

    def _condensed(self, body: DampedBody, loads: Array, joined: int) -> CondensedBody:
        return condensed(body.dynamic_stiffness(self._frequency, self._speed), loads, joined)

    def _joined(self) -> Complex:
        """Return the dynamic stiffness of all sections without that of radial springs, (harmonics, n, n)."""
        total = 1j * self._frequency[:, None, None] * self._shaft.viscous
        for index, (throw, turn) in enumerate(zip(self._throws, self._about_z, strict=True)):
            at = self._at[index]
            total[:, at[:, None], at] += turn @ throw.stiffness @ turn.T
        for end, motions in zip(self._ends, self._end_at, strict=True):
            total[:, motions, motions] += end.stiffness
        tilting = self._of_bearings(RX, RY)
        total[:, tilting, tilting] += self._shaft.tilt_Nmm_per_rad
        return np.asarray(total)

    def _of_bearings(self, *motions: int) -> NDArray[np.intp]:
        return np.array([6 * section + motion for section in self._shaft.borne_by for motion in motions])

    def _motions(self, lying: Complex | None = None) -> Complex:
        """Return the amplitudes of motions and warps of all sections, (unknowns, harmonics)."""
        load, stiffness, borne = self._load(), self._stiffness.copy(), self._of_bearings(UY, UX)
        moved, held = np.zeros_like(load), borne
        if lying is not None:
            moved[borne] = lying
            load -= np.einsum("kmb,bk->mk", stiffness[:, :, borne], lying)
        elif self._shaft.spring_N_per_mm is not None:
            stiffness[:, borne, borne] += self._shaft.spring_N_per_mm
            held = borne[:0]
        for which, free in self._free(held):
            matrix = stiffness[np.ix_(which, free, free)]
            right = load[np.ix_(free, which)].T[..., None]
            moved[np.ix_(free, which)] = np.linalg.solve(matrix, right)[..., 0].T
        return moved

    def _free(self, held: NDArray[np.intp]) -> list[tuple[NDArray[np.intp], NDArray[np.intp]]]:
        """Return the mean and all other harmonics, each with the motions that nothing holds."""
        sections, every = len(self._shaft.throws) + 1, np.arange(len(self._shaft.viscous))
        last, rigid = 6 * sections - 6, warps_of(self._shaft.rigid_at, sections, len(every))
        turning = [] if self._shaft.turns_freely else [last + RZ]
        return [
            (np.flatnonzero(which), np.setdiff1d(every, [*held, *rigid, *fixed]))
            for which, fixed in (
                (self._frequency == 0, [last + RZ, last + UZ]),
                (self._frequency > 0, turning),
            )
        ]

    def on_bearings(self) -> CarriedShaft:
        """Return what the shaft does to its bearings, y and x of each that is borne."""
        borne, load = self._of_bearings(UY, UX), self._load()
        held = load[borne]
        bent = self._stiffness[:, borne[:, None], borne].copy()
        for which, free in self._free(borne):
            across = self._stiffness[np.ix_(which, free, borne)]
            right = np.concatenate([across, load[np.ix_(free, which)].T[..., None]], axis=2)
            led = np.linalg.solve(self._stiffness[np.ix_(which, free, free)], right)
            lever = self._stiffness[np.ix_(which, borne, free)]
            bent[which] -= lever @ led[..., :-1]
            held[:, which] -= (lever @ led[..., -1:])[..., 0].T
        return CarriedShaft(held, bent)

    def _load(self) -> Complex:
        load = np.zeros((len(self._shaft.viscous), len(self._frequency)), dtype=complex)
        for index, (own, turn) in enumerate(zip(self._own, self._about_z, strict=True)):
            load[self._at[index]] += turn @ own
        return load

    def _bearing_forces(self, motion: Complex) -> Complex:
        """Return x and y of what holds every section, (sections, 2, harmonics)."""
        left = np.einsum("kmn,nk->mk", self._stiffness, motion, optimize=True) - self._load()
        motions = left[: 6 * len(self._shaft.throws) + 6]
        return np.asarray(motions.reshape(-1, 6, left.shape[1])[:, [UX, UY]])

    def _in_throw(self, motion: Complex, index: int) -> Complex:
        """Return motions and warps of both sections of a throw in its own axes, (`SECTIONS`, harmonics)."""
        return np.asarray(self._about_z[index].T @ motion[self._at[index]])

    def _throw_forces(self, motion: Complex) -> Complex:
        """Return what neighbours do to both sections of every throw in its axes, (throws, 12, harmonics)."""
        found = [
            (np.einsum("kmn,nk->mk", throw.stiffness, self._in_throw(motion, index)) - self._own[index])[:12]
            for index, throw in enumerate(self._throws)
        ]
        return np.stack(found)

    def _within(self, motion: Complex) -> list[Complex]:
        """Return the other unknowns of every throw, (unknowns, harmonics) each."""
        return [
            np.einsum("kmn,nk->mk", throw.by_motion, self._in_throw(motion, index))
            + np.einsum("kml,lk->mk", throw.by_load, self._shares[index])
            for index, throw in enumerate(self._throws)
        ]

    def _strains(self, motion: Complex, within: Sequence[Complex]) -> list[Complex]:
        """Return all unknowns of every throw, with the part of the stress ahead of the strain by loss."""
        lost = 1 + 1j * np.where(self._frequency > 0, self._shaft.loss_factor, 0.0)
        return [lost * np.vstack([self._in_throw(motion, index), own]) for index, own in enumerate(within)]

    def _works(self, motion: Complex, within: Sequence[Complex]) -> tuple[float, float]:
        """Return the work of all pin forces over the cycle, and what damping takes of it, J."""
        number, work = np.arange(len(self._frequency)), 0.0
        lost = self._lost(motion, np.zeros_like(self._shaft.viscous), self._shaft.viscous)
        for index, (throw, inner) in enumerate(zip(self._shaft.throws, within, strict=True)):
            whole = np.vstack([self._in_throw(motion, index), inner])
            given = (self._shares[index] * (throw.loads.T @ whole).conj()).imag
            work += float(4 * np.pi * (number * given).sum())
            lost += self._lost(whole, throw.damped.loss, throw.damped.viscous)
        for end, small, at in zip(self._shaft.ends, self._ends, self._end_at, strict=True):
            inner = np.einsum("kmn,nk->mk", small.by_motion, motion[at])
            lost += self._lost(np.vstack([motion[at], inner]), end.loss, end.viscous)
        return work / NMM_PER_NM, lost / NMM_PER_NM

    def _lost(self, motion: Complex, loss: Array, viscous: Array) -> float:
        return damping_work(self._frequency, motion, loss, viscous)
