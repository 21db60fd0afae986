"""Gas and inertia torque of every cylinder, and a throw's inertia that varies over a turn, by orders.

Rod and piston as two masses make the inertia of a throw J(a), the sum of J_k exp(i k a); how the orders of
the motion act on each other through it is in `order_coupling`.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from cranktopo.base.arrays import Array, Complex
from cranktopo.base.units import MM2_PER_M2, angular_speed_rad_s
from cranktopo.design.schema import Scene
from cranktopo.engine.forces import INERTIA_EFFECTS, throw_forces
from cranktopo.engine.gas import PressureCurve, mapped_curves, pressure_curve
from cranktopo.engine.motored import motored_curve, motored_map
from cranktopo.engine.vibration.shaft_chain import ShaftChain
from cranktopo.numerics.disk_chain import DampedMode

_ANY_SPEED_RPM = 1000.0
"""Inertia torque goes with the square of the speed, whatever speed it is computed at."""


@dataclass(frozen=True)
class TorqueHarmonics:
    """Torque of the cylinders: at crank angle a it is the real part of the sum of amplitude exp(i order a).

    Attributes:
        orders: of the rotation, from 0 in steps of one over the turns of a cycle.
        gas_Nm: complex amplitudes of one cylinder, a from its own firing dead centre, at the scene's speed.
        inertia_Nm_s2: the same of its reciprocating mass, over the square of the angular speed in rad/s.
        firing_deg: crank angle at which each cylinder fires, cylinder 1 first.
        gas_map: speed in rpm and `gas_Nm` of each entry of a map over speed.
        misfire: numbers of the cylinders that do not fire.
        lost_Nm: what one of them lacks of `gas_Nm`; None where all fire.
        lost_map: as `gas_map`.
    """

    orders: Array
    gas_Nm: Complex
    inertia_Nm_s2: Complex
    firing_deg: tuple[float, ...]
    throw_of: tuple[int, ...]
    gas_map: tuple[tuple[float, Complex], ...] = ()
    misfire: tuple[int, ...] = ()
    lost_Nm: Complex | None = None
    lost_map: tuple[tuple[float, Complex], ...] = ()

    def gas_at_Nm(self, speed_rpm: float | Array) -> Complex:
        """Return `gas_Nm` at speeds, between the entries of a map, shape (*speeds, orders)."""
        return _over_speed(self.gas_Nm, self.gas_map, speed_rpm)

    def lost_at_Nm(self, speed_rpm: float | Array) -> Complex:
        """Return what a cylinder that does not fire lacks at speeds, shape (*speeds, orders); 0 if all do."""
        lost = np.zeros_like(self.gas_Nm) if self.lost_Nm is None else self.lost_Nm
        return _over_speed(lost, self.lost_map, speed_rpm)

    def of_throws_Nm(self, speed_rpm: float | Array) -> Complex:
        """Complex amplitudes of the torque on every throw at speeds, one clock, (*speeds, orders, throws)."""
        square = (angular_speed_rad_s(1.0) * np.asarray(speed_rpm)[..., None]) ** 2
        single = self.gas_at_Nm(speed_rpm) + square * self.inertia_Nm_s2
        every = single[..., None] * self.shifts
        if self.lost_Nm is None:
            return np.asarray(every)
        return np.asarray(every - self.lost_at_Nm(speed_rpm)[..., None] * self.misfire_shifts)

    def of_orders_Nm(self, places: NDArray[np.int_], speeds_rpm: Array) -> Complex:
        """Return the torque on every throw of orders by number, each at its speed, (pairs, throws)."""
        speed, mine = speeds_rpm * angular_speed_rad_s(1.0), np.arange(len(places))
        single = self.gas_at_Nm(speeds_rpm)[mine, places] + speed**2 * self.inertia_Nm_s2[places]
        lost = self.lost_at_Nm(speeds_rpm)[mine, places]
        return np.asarray(single[:, None] * self.shifts[places] - lost[:, None] * self.misfire_shifts[places])

    def in_phase(self) -> NDArray[np.bool_]:
        """Of which orders the torques of all cylinders, if all fire, have the same phase: the major ones."""
        count = len(self.firing_deg)
        return np.asarray(np.abs(self.shifts.sum(axis=1)) > (1 - 1e-9) * count)

    @cached_property
    def shifts(self) -> Complex:
        """Factor of each order for the times at which the cylinders of a throw fire, (orders, throws)."""
        return self._by_throw(self._each)

    @cached_property
    def misfire_shifts(self) -> Complex:
        """The same of the cylinders that do not fire, for the times at which they should."""
        return self._by_throw(self._each * self._silent)

    def adding_up(self, swing: Complex, speeds_rpm: Array) -> Array:
        """Return the share to which the cylinders' torques add up in a motion of the throws: all help at 1.

        Args:
            speeds_rpm: one for each order from the first, shape (orders,).
        """
        order = np.arange(1, len(speeds_rpm) + 1)
        speed, mine = speeds_rpm * angular_speed_rad_s(1.0), np.arange(len(order))
        fired = self.gas_at_Nm(speeds_rpm)[mine, order] + speed**2 * self.inertia_Nm_s2[order]
        torque = fired[:, None] - self.lost_at_Nm(speeds_rpm)[mine, order][:, None] * self._silent
        moved = swing[list(self.throw_of)]
        resultant = np.abs((torque * self._each[order] * moved).sum(axis=1))
        return np.asarray(resultant / (np.abs(torque) * np.abs(moved)).sum(axis=1))

    @property
    def _silent(self) -> NDArray[np.bool_]:
        return np.isin(np.arange(1, len(self.firing_deg) + 1), self.misfire)

    @cached_property
    def _each(self) -> Complex:
        """Factor of each order for the time at which a cylinder fires, (orders, cylinders)."""
        return np.asarray(np.exp(-1j * self.orders[:, None] * np.radians(self.firing_deg)))

    def _by_throw(self, cylinders: Complex) -> Complex:
        throws = np.array(self.throw_of)
        return np.stack([cylinders[:, throws == t].sum(axis=1) for t in range(max(throws) + 1)], axis=1)


def torque_harmonics(scene: Scene, enabled: frozenset[str] = INERTIA_EFFECTS) -> TorqueHarmonics | None:
    """Return all orders of the torque that the scene's cycle resolves; None when the scene gives no cycle.

    The inertia counts with `reciprocating_inertia` among the enabled effects.
    """
    engine, curve = scene.engine, pressure_curve(scene)
    if engine is None or curve is None:
        return None

    def torque(of: PressureCurve, effects: frozenset[str]) -> Array:
        radius = scene.throw.radius_mm
        return throw_forces(engine, radius, of, _ANY_SPEED_RPM, effects).torque_Nm

    gas, both = torque(curve, frozenset()), torque(curve, enabled)
    inertia = (both - gas) / angular_speed_rad_s(_ANY_SPEED_RPM) ** 2
    of_gas, of_inertia = _amplitudes(gas), _amplitudes(inertia)
    orders = np.arange(len(of_gas), dtype=float) * 360.0 / engine.cycle_deg
    throws = tuple(engine.throw_of(cylinder) for cylinder in range(1, engine.cylinders + 1))
    over_speed = tuple((rpm, _amplitudes(torque(at, frozenset()))) for rpm, at in mapped_curves(scene))
    found = TorqueHarmonics(orders, of_gas, of_inertia, engine.firing_angles_deg, throws, over_speed)
    motored = motored_curve(scene) if engine.misfire else None
    if motored is None:
        return found
    lost_map = tuple(
        (rpm, amplitudes - _amplitudes(torque(at, frozenset())))
        for (rpm, amplitudes), (_, at) in zip(over_speed, motored_map(scene), strict=True)
    )
    lost = of_gas - _amplitudes(torque(motored, frozenset()))
    return replace(found, misfire=engine.misfire, lost_Nm=lost, lost_map=lost_map)


def _over_speed(
    gas_Nm: Complex, gas_map: tuple[tuple[float, Complex], ...], speed_rpm: float | Array
) -> Complex:
    """Amplitudes at speeds, between the entries of a map if there is one, shape (*speeds, orders)."""
    if not gas_map:
        return np.broadcast_to(gas_Nm, (*np.shape(speed_rpm), gas_Nm.size))
    speeds = np.array([speed for speed, _ in gas_map])
    shares = np.stack([np.interp(speed_rpm, speeds, one) for one in np.eye(len(speeds))], axis=-1)
    return np.asarray(shares @ np.stack([gas for _, gas in gas_map]))


def curve_of(amplitudes: Complex, points: int) -> Array:
    """Values at evenly spaced angles of a cycle from complex amplitudes of its orders, (..., points)."""
    parts = amplitudes * np.where(np.arange(amplitudes.shape[-1]) == 0, 1.0, 0.5)
    return np.asarray(np.fft.irfft(parts, n=points, axis=-1) * points)


def _amplitudes(torque: Array) -> Complex:
    """Complex amplitudes of the orders below the highest that the points resolve."""
    found = np.fft.rfft(torque) / len(torque)
    return np.asarray(np.where(np.arange(len(found)) == 0, 1.0, 2.0) * found)[: len(torque) // 2]


HARMONICS = 4
"""Harmonics of the inertia that count: the fifth is below a thousandth of a reciprocating mass."""


@dataclass(frozen=True)
class VaryingPart:
    """The varying part of the inertia of rod and piston, and whether the response has it.

    Attributes:
        harmonics_kg_m2: of every throw, shape (HARMONICS + 1, throws).
        share_percent: of the inertia that swings in a natural vibration; the estimate of what it changes.
    """

    harmonics_kg_m2: Complex
    share_percent: float
    included: bool

    @property
    def rise(self) -> float:
        """By how much of itself a natural frequency rises at most; 0 where the part does not count.

        The mean of 1 / sqrt(1 + s cos 2a) over a turn, for a slow variation: 3 s^2 / 16.
        """
        return 3 / 16 * (self.share_percent / 100) ** 2 if self.included else 0.0


def varying_part(
    scene: Scene,
    shaft: ShaftChain,
    harmonics: TorqueHarmonics,
    modes: Sequence[DampedMode],
    met: Collection[int],
) -> VaryingPart:
    """Return the varying part, included where its share reaches the threshold and the scene has a [shaft].

    Modes `met` by a critical speed in the range count, by their numbers; all modes where there is none.
    """
    varying = varying_inertia_kg_m2(scene, harmonics)
    swinging = [mode for number, mode in enumerate(modes, start=1) if number in met] or list(modes)
    share = varying_share_percent(shaft, swinging, varying)
    included = scene.shaft is not None and share >= 100 * scene.effects.threshold
    return VaryingPart(varying, share, included)


def varying_inertia_kg_m2(scene: Scene, harmonics: TorqueHarmonics) -> Complex:
    """Harmonics J_k of every throw's inertia from the inertia torque, shape (HARMONICS + 1, throws).

    J_0 is only what the exact mean adds to half the reciprocating mass at the throw radius. At dead centre a
    piston stands still, so the harmonics of one cylinder, J_0 among them, add up to zero.
    """
    whole = harmonics.orders % 1 == 0
    torque, order = harmonics.inertia_Nm_s2[whole][1:], harmonics.orders[whole][1:]
    single = 1j * torque / order
    half = scene.engine.reciprocating_kg / 2 * scene.throw.radius_mm**2 / MM2_PER_M2 if scene.engine else 0.0
    added = -2 * single.real.sum() - half if single.any() else 0.0
    every = np.append(added, single[:HARMONICS])
    return np.asarray(every[:, None] * harmonics.shifts[whole][: HARMONICS + 1])


def varying_share_percent(shaft: ShaftChain, modes: Sequence[DampedMode], varying_kg_m2: Complex) -> float:
    """Largest harmonic of the varying inertia over the inertia that swings with it, of all modes, percent.

    All disks count with the square of the mode shape; the throws' parts count as if in phase.
    """
    swing = 2 * np.abs(varying_kg_m2[1:])
    inertia = np.array(shaft.chain.inertia_kg_m2)
    shares = [
        (swing * np.abs(mode.shape[shaft.driven]) ** 2).sum(axis=1).max()
        / (inertia * np.abs(mode.shape) ** 2).sum()
        for mode in modes
    ]
    return 100 * float(max(shares, default=0.0))
