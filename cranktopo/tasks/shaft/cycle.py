"""The shaft on all its main bearings over the cycle, quasi-static: motions and forces of its sections.

In the frame that turns with the shaft the bearings, alike in every direction, are constant; loads of a cycle
are right-hand sides of one matrix of six motions and six warps a section. The last section holds the shaft
in rotation and along its axis.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from cranktopo.base.arrays import Array, Complex
from cranktopo.base.errors import invalid
from cranktopo.base.frames import about_z_deg
from cranktopo.base.units import NMM_PER_NM, angular_speed_rad_s
from cranktopo.design.schema import Scene
from cranktopo.engine.analysis import engine_of
from cranktopo.engine.balance.layout import engine_layout, unit_vectors
from cranktopo.engine.cylinders import cylinders
from cranktopo.engine.forces import INERTIA_EFFECTS, ShaftTorque, by_throw
from cranktopo.engine.histories import every_degree
from cranktopo.engine.vibration.shaft_chain import rods_shares
from cranktopo.engine.vibration.vibrating_shaft import vibrating_torque
from cranktopo.numerics.tetrahedra.rigid_motions import RX, RY, RZ, UX, UY, UZ
from cranktopo.tasks.shaft.assembly import own_unknowns, shaft_matrix, turned
from cranktopo.tasks.shaft.loaded_throw import LOADS, SWING, LoadedThrow


@dataclass(frozen=True)
class ShaftSwing:
    """Loads of its own inertia on a vibrating shaft over the cycle, in the sense of rotation.

    Attributes:
        ahead_Nm: torque on the first section, by what vibrates at the free end, (states,).
        pin_N: along the circle of the pin, by the masses of its rods and pistons, (throws, states).
        throw_Nm: torque of the throw's own mass, spread over it, (throws, states).
    """

    ahead_Nm: Array
    pin_N: Array
    throw_Nm: Array


@dataclass(frozen=True)
class CycleForces:
    """Forces of the rods on the pins over the cycle, in the axes of each throw.

    Attributes:
        radial_N, tangential_N: shape (throws, states).
        radial_aside_N_mm, tangential_aside_N_mm: their moments about the middle of the pin, positive where
            the rod nearer to the free end has more, shape (throws, states).
        swing: what the vibrating shaft's inertia adds; None where it does not vibrate.
    """

    angle_deg: Array
    radial_N: Array
    tangential_N: Array
    radial_aside_N_mm: Array
    tangential_aside_N_mm: Array
    angular_speed_rad_s: float
    swing: ShaftSwing | None = None


@dataclass(frozen=True)
class ShaftCycle:
    """Motions and forces of the sections over the cycle, in axes that turn with the shaft.

    Attributes:
        motion: of every section, shape (6 sections, states), mm and rad.
        warps: of every section, shape (`WARPS` sections, states), mm; none where sections stay rigid.
        bearing_N: x and y of the force of every bearing on the shaft, shape (sections, 2, states).
        throw_N: forces on both sections of every throw in its own axes, shape (throws, 12, states).
    """

    angle_deg: Array
    motion: Array
    bearing_N: Array
    throw_N: Array
    warps: Array = field(default_factory=lambda: np.zeros((0, 1)))

    def of_throw(self, index: int, angle_deg: float) -> Array:
        """Return motions and warps of both sections of a throw in its own axes, (12 or more, states)."""
        count, states = len(self.throw_N), self.motion.shape[1]
        warps = self.warps if len(self.warps) else np.zeros((0, states))
        own = 2 * (6 + len(warps) // (count + 1))
        every = np.vstack([self.motion, warps])
        return np.asarray(turned(about_z_deg(angle_deg), own).T @ every[own_unknowns(index, count, own)])


def cycle_forces(scene: Scene, enabled: frozenset[str] = INERTIA_EFFECTS) -> CycleForces:
    """Return the forces on all pins at the engine's speed.

    Args:
        enabled: with `torsional_vibration` also what its swinging does to the sections.

    Raises:
        CranktopoError: no engine, or no pressures.
    """
    engine, rods = engine_of(scene), cylinders(scene)
    if rods is None:
        raise invalid(
            "engine.gas", None, "must be given for forces over the cycle", "Add an [engine.gas] table."
        )
    stride, layout = every_degree(rods.angle_deg), engine_layout(scene)
    radial = rods.each(lambda rod: rod.web_force_N)[:, ::stride]
    tangential = rods.each(lambda rod: rod.tangential_force_N)[:, ::stride]
    aside = (layout.throw_z_mm[list(layout.throw_of)] - layout.cylinder_z_mm)[:, None]
    forces = CycleForces(
        rods.angle_deg[::stride],
        by_throw(radial, engine.throws),
        by_throw(tangential, engine.throws),
        by_throw(aside * radial, engine.throws),
        by_throw(aside * tangential, engine.throws),
        angular_speed_rad_s(engine.speed_rpm),
    )
    if "torsional_vibration" not in enabled:
        return forces
    return replace(forces, swing=_of_inertia(vibrating_torque(scene, enabled), forces, scene))


def _of_inertia(torque: ShaftTorque, forces: CycleForces, scene: Scene) -> ShaftSwing:
    """Return what lies between the torques ahead of a throw and behind it, beside that of its rods.

    Rods and pistons have the share in it that they have in the mean inertia of the throw's disk.
    """

    def over_cycle(curves: Array) -> Array:
        cycle_deg = engine_of(scene).cycle_deg
        return np.array([np.interp(forces.angle_deg, torque.angle_deg, c, period=cycle_deg) for c in curves])

    assert torque.ahead_Nm is not None
    ahead, behind = over_cycle(torque.ahead_Nm), over_cycle(torque.passed_on_Nm)
    per_Nm = NMM_PER_NM / scene.throw.radius_mm
    inertia = behind - ahead - forces.tangential_N / per_Nm
    rods = np.array(rods_shares(scene))[:, None]
    return ShaftSwing(ahead[0], rods * inertia * per_Nm, (1 - rods) * inertia)


def shaft_cycle(
    throws: Sequence[LoadedThrow],
    angles_deg: Sequence[float],
    forces: CycleForces,
    spring_N_per_mm: float | None,
    borne_by: Sequence[int] | None = None,
    offset_mm: Array | None = None,
    tilt_Nmm_per_rad: float = 0.0,
    rigid_at: Sequence[int] = (),
) -> ShaftCycle:
    """Solve the shaft for all states of a cycle.

    Args:
        angles_deg: of the throws, in the sense of rotation.
        spring_N_per_mm: radial stiffness of every main bearing; None: rigid.
        borne_by: sections that sit in a bearing; all by default.
        offset_mm: x and y of each of them in rigid bearings, shape (2 bearings, states); none by default.
        tilt_Nmm_per_rad: stiffness by which each of them resists the tilt of its journal.
        rigid_at: sections that stay rigid.
    """
    about_z = [about_z_deg(angle) for angle in angles_deg]
    sections, states = len(about_z) + 1, forces.angle_deg.size
    own = np.stack([_pin_loads(throw, forces, index) for index, throw in enumerate(throws)])
    load = np.zeros((own.shape[1] // 2 * sections, states))
    at = [own_unknowns(index, len(about_z), own.shape[1]) for index in range(len(about_z))]
    for index, angle in enumerate(about_z):
        load[at[index]] += turned(angle, own.shape[1]) @ own[index]
    if forces.swing is not None:
        load[RZ] += about_z_deg(1.0) * forces.swing.ahead_Nm * NMM_PER_NM
    stiffness = shaft_matrix(np.stack([throw.stiffness for throw in throws]), about_z)
    radial = _radial(range(sections))
    in_bearings = range(sections) if borne_by is None else borne_by
    borne, tilting = _radial(in_bearings), _tilting(in_bearings)
    held = {6 * (sections - 1) + RZ, 6 * (sections - 1) + UZ, *warps_of(rigid_at, sections, len(load))}
    stiffness[tilting, tilting] += tilt_Nmm_per_rad
    sprung = stiffness.copy()
    if spring_N_per_mm is None:
        held |= set(borne.tolist())
    else:
        sprung[borne, borne] += spring_N_per_mm
    free = np.array([i for i in range(len(load)) if i not in held])
    motion = np.zeros_like(load)
    pushed = load[free]
    if offset_mm is not None:
        motion[borne] = offset_mm
        pushed = pushed - stiffness[np.ix_(free, borne)] @ offset_mm
    motion[free] = np.linalg.solve(sprung[np.ix_(free, free)], pushed)
    bearing = (stiffness @ motion - load)[radial].reshape(sections, 2, states)
    ends = [
        (throw.stiffness @ turned(angle, own.shape[1]).T @ motion[at[index]] - own[index])[:12]
        for index, (throw, angle) in enumerate(zip(throws, about_z, strict=True))
    ]
    motion, warps = np.split(motion, [6 * sections])
    return ShaftCycle(forces.angle_deg, motion, bearing, np.stack(ends), warps)


def warps_of(sections: Iterable[int], count: int, unknowns: int) -> list[int]:
    """Return which of the unknowns of a shaft, so many, are the warps of some of its sections."""
    each = unknowns // count - 6
    return [6 * count + each * section + warp for section in sections for warp in range(each)]


def _radial(sections: Iterable[int]) -> NDArray[np.int_]:
    """Numbers of the motions along x and y of some sections."""
    return np.array([6 * section + motion for section in sections for motion in (UX, UY)])


def _tilting(sections: Iterable[int]) -> NDArray[np.int_]:
    """Numbers of the rotations about x and y of some sections."""
    return np.array([6 * section + motion for section in sections for motion in (RX, RY)])


def bent_into_bearings_N_per_mm(
    throws: Sequence[LoadedThrow],
    angles_deg: Sequence[float],
    borne_by: Sequence[int],
    tilt_Nmm_per_rad: float = 0.0,
    rigid_at: Sequence[int] = (),
) -> Array:
    """Return what bearings must push where journals lie off their axes, x and y of each, (2 n, 2 n)."""
    about_z = [about_z_deg(angle) for angle in angles_deg]
    stiffness = shaft_matrix(np.stack([throw.stiffness for throw in throws]), about_z)
    borne, tilting, last = _radial(borne_by), _tilting(borne_by), 6 * len(about_z)
    stiffness[tilting, tilting] += tilt_Nmm_per_rad
    stiff = warps_of(rigid_at, len(about_z) + 1, len(stiffness))
    free = np.setdiff1d(np.arange(len(stiffness)), [*borne, last + RZ, last + UZ, *stiff])
    across = stiffness[np.ix_(free, borne)]
    led = np.linalg.solve(stiffness[np.ix_(free, free)], across)
    return np.asarray(stiffness[np.ix_(borne, borne)] - across.T @ led)


def _pin_loads(throw: LoadedThrow, forces: CycleForces, index: int) -> Array:
    """Section forces that do the work of all loads of a throw, (`SECTIONS`, states)."""
    loads = np.stack([throw.loads[name] for name in LOADS], axis=1)
    found = np.asarray(loads @ load_shares(throw, forces, index))
    if forces.swing is None:
        return found
    return np.asarray(found + np.outer(throw.loads[SWING], _swing_Nmm(forces, index)))


def _swing_Nmm(forces: CycleForces, index: int) -> Array:
    """Return the number of unit loads "swing" that act on a throw, (states,)."""
    if forces.swing is None:
        return np.zeros(forces.angle_deg.size)
    return np.asarray(forces.swing.throw_Nm[index] * NMM_PER_NM)


def load_shares(throw: LoadedThrow, forces: CycleForces, index: int) -> Array:
    """Return the number of unit loads, in the order of `LOADS`, that act on a throw, (loads, states)."""
    across = forces.tangential_N[index]
    return np.stack(
        [
            forces.radial_N[index],
            across if forces.swing is None else across + forces.swing.pin_N[index],
            forces.radial_aside_N_mm[index] / throw.aside_moment_mm,
            forces.tangential_aside_N_mm[index] / throw.aside_moment_mm,
            np.full(forces.angle_deg.size, forces.angular_speed_rad_s**2),
        ]
    )


def throw_states(
    throws: Sequence[LoadedThrow], angles_deg: Sequence[float], forces: CycleForces, cycle: ShaftCycle
) -> Array:
    """Return what acts on every throw in its own axes, (throws, `SECTIONS` and `ACTING`, states)."""
    found = []
    for index, (throw, angle) in enumerate(zip(throws, angles_deg, strict=True)):
        own = cycle.of_throw(index, angle)
        found.append(np.vstack([own, load_shares(throw, forces, index), _swing_Nmm(forces, index)]))
    return np.stack(found)


def loads_on_bearings_N(cycle: ShaftCycle) -> Array:
    """Return the force of the shaft on every bearing in the axes of the engine, (sections, x and y, states).

    The throws stand there as their angles say when the crank angle is 0.
    """
    turn = np.radians([about_z_deg(angle) for angle in cycle.angle_deg])
    x, y = -cycle.bearing_N[:, 0], -cycle.bearing_N[:, 1]
    return np.stack([np.cos(turn) * x - np.sin(turn) * y, np.sin(turn) * x + np.cos(turn) * y], axis=1)


def journal_loads_N(cycle: ShaftCycle) -> Complex:
    """Return the same forces as y + i x: the way journals in films are turned, (sections, states)."""
    loads = loads_on_bearings_N(cycle)
    return np.asarray(loads[:, 1] + 1j * loads[:, 0])  # the shaft turns from y to x


def journal_tilts(cycle: ShaftCycle) -> Complex:
    """Return how far each journal leads off its axis per length, turned as its force, (sections, states)."""
    motion = cycle.motion.reshape(len(cycle.bearing_N), 6, -1)
    return np.asarray((-motion[:, RX] + 1j * motion[:, RY]) * unit_vectors(cycle.angle_deg))


def pin_tilts(
    throws: Sequence[LoadedThrow], angles_deg: Sequence[float], forces: CycleForces, cycle: ShaftCycle
) -> Complex:
    """Return how far each crankpin leads off the crank axis per length, (throws, states).

    Real along the throw, imaginary ahead of it, as the force of a rod on the pin.
    """
    states = throw_states(throws, angles_deg, forces, cycle)
    turned_about = [throw.pin_tilt @ own for throw, own in zip(throws, states, strict=True)]
    return np.array([1j * about_y - about_x for about_x, about_y in turned_about])
