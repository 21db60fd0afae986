"""The part of a throw's inertia that varies over a turn, and the vibration with it.

Rod and piston as two masses make the inertia of a throw J(a), the sum of J_k exp(i k a). Linear in the twist,
an order m of the motion acts on order n = m + k with -w^2 J_k (m^2 + n^2) / 2, so that all orders are solved
at once; what the twist leaves, -w^2 J'(a) / 2, is the inertia torque that the excitation has already. Angles
of a throw count from its own mean twist: there is no order 0.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass

import numpy as np

from cranktopo.base.arrays import Array
from cranktopo.base.units import MM2_PER_M2
from cranktopo.design.schema import Scene
from cranktopo.engine.vibration.shaft_chain import ShaftChain
from cranktopo.engine.vibration.torque_harmonics import TorqueHarmonics
from cranktopo.numerics.disk_chain import ComplexArray, DampedMode

HARMONICS = 4
"""Harmonics of the inertia that count: the fifth is below a thousandth of a reciprocating mass."""


@dataclass(frozen=True)
class VaryingPart:
    """Whether the varying part of the inertia of rod and piston counts.

    Attributes:
        harmonics_kg_m2: of every throw, shape (HARMONICS + 1, throws).
        share_percent: of the inertia that swings in a natural vibration; the estimate of what it changes.
        included: whether the response has it.
    """

    harmonics_kg_m2: ComplexArray
    share_percent: float
    included: bool

    @property
    def counting_kg_m2(self) -> ComplexArray | None:
        """The harmonics where they count."""
        return self.harmonics_kg_m2 if self.included else None

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
    """The varying part, included where its share reaches the scene's threshold and the scene has a [shaft].

    Args:
        met: numbers of the modes with a critical speed in the range; all modes count where there is none.
    """
    varying = varying_inertia_kg_m2(scene, harmonics)
    swinging = [mode for number, mode in enumerate(modes, start=1) if number in met] or list(modes)
    share = varying_share_percent(shaft, swinging, varying)
    included = scene.shaft is not None and share >= 100 * scene.effects.threshold
    return VaryingPart(varying, share, included)


def varying_inertia_kg_m2(scene: Scene, harmonics: TorqueHarmonics) -> ComplexArray:
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


def varying_share_percent(
    shaft: ShaftChain, modes: Sequence[DampedMode], varying_kg_m2: ComplexArray
) -> float:
    """Return the largest harmonic of the varying inertia over the inertia that swings with it, in percent.

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


def coupled_response_rad(
    shaft: ShaftChain, orders: Array, speed_rad_s: float, torque_Nm: ComplexArray, varying_kg_m2: ComplexArray
) -> ComplexArray:
    """Complex amplitude of every disk with the varying inertia of the throws, shape (orders, disks).

    Orders with and without a half do not act on each other.

    Args:
        orders: of the rotation, without 0.
        torque_Nm: complex amplitudes on the disks, shape (orders, disks).
    """
    frequency = orders * speed_rad_s
    driven = np.eye(len(shaft.names))[shaft.driven].astype(complex)
    by_throw = shaft.chain.response_rad(
        np.repeat(frequency[:, None], len(driven), axis=1), np.tile(driven, (len(orders), 1, 1))
    )
    twist = shaft.chain.response_rad(frequency, torque_Nm)
    for part in np.unique(orders % 1):
        mine = orders % 1 == part
        acting = _acting_Nm(shaft, orders[mine], speed_rad_s, twist[mine], by_throw[mine], varying_kg_m2)
        twist[mine] += np.einsum("nt,ntd->nd", acting, by_throw[mine])
    return twist


def _acting_Nm(
    shaft: ShaftChain,
    orders: Array,
    speed_rad_s: float,
    twist: ComplexArray,
    by_throw: ComplexArray,
    varying: ComplexArray,
) -> ComplexArray:
    """Torques of the varying inertia on the throws, (orders, throws), by elimination of all other disks.

    With twist x of the throws they are P x + Q conj(x): Q is the negative orders of a real motion.
    """
    two_sided = np.concatenate([varying[:0:-1].conj(), varying])
    scale = speed_rad_s**2 * (orders[:, None] ** 2 + orders**2) / 2
    direct, mirrored = (
        scale[:, :, None] * _at(two_sided, place)
        for place in (orders[:, None] - orders, orders[:, None] + orders)
    )
    size = orders.size * by_throw.shape[1]
    # Twist of throw s per torque on t, (orders, s, 1, t), times torque per twist, (orders, 1, orders, t).
    compliance = by_throw[:, :, shaft.driven].transpose(0, 2, 1)[:, :, None, :]
    p, q = ((compliance * one[:, None]).reshape(size, size) for one in (direct, mirrored))
    a, b = np.eye(size) - p, -q
    matrix = np.block([[(a + b).real, (b - a).imag], [(a + b).imag, (a - b).real]])
    alone = twist[:, shaft.driven].ravel()
    real, imaginary = np.split(np.linalg.solve(matrix, np.concatenate([alone.real, alone.imag])), 2)
    x = (real + 1j * imaginary).reshape(orders.size, -1)
    return np.asarray(
        np.einsum("nmt,mt->nt", direct, x) + np.einsum("nmt,mt->nt", mirrored, x.conj()), dtype=complex
    )


def _at(two_sided: ComplexArray, places: Array) -> ComplexArray:
    """Harmonics by their number, zero beyond the last; (*places, throws)."""
    last = len(two_sided) // 2
    number = np.rint(places).astype(int)
    inside = np.abs(number) <= last
    return np.asarray(two_sided[np.where(inside, number, 0) + last] * inside[..., None])
