"""Response of all orders at once to the torques of the cylinders, with the inertia that varies over a turn.

With the inertia J(a) of a throw, the sum of J_k exp(i k a), and linear in the twist, an order m of the motion
acts on order n = m + k with -w^2 J_k (m^2 + n^2) / 2; what the twist leaves, -w^2 J'(a) / 2, is the inertia
torque that the excitation has already. Angles of a throw count from its own mean twist: there is no order 0.
Orders with and without a half do not act on each other.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from cranktopo.base.arrays import Array, Complex, Index
from cranktopo.engine.vibration.shaft_chain import ShaftChain


@dataclass(frozen=True)
class _Part:
    """Orders that act on each other; what of it no speed changes.

    Attributes:
        places: of these orders among all, (n,).
        direct: torque on an order by the twist of one at each distance from it, at 1 rad/s; 0 where there is
            none; (n, distances, throws).
        mirrored: the same by the conjugate of the twist, which is that of the negative order.
        filled: positions of their blocks in the band, flat, (n, distances, 2 throws, 2 throws).
    """

    places: Index
    direct: Complex
    mirrored: Complex
    filled: Index

    @property
    def reach(self) -> int:
        """Largest distance of two orders that act on each other."""
        return self.direct.shape[1] // 2

    def acting_Nm(self, twist: Complex, compliance: Complex, square: float) -> Complex:
        """Torques of the varying inertia on the throws, (n, throws), by elimination of all other disks.

        With twist x of the throws they are P x + Q conj(x): Q is the negative orders of a real motion.

        Args:
            twist: of the throws by the cylinders' torques alone, (n, throws).
            compliance: twist of every throw by a torque on each, (n, throws, throws).
            square: of the speed in rad/s.
        """
        from scipy.linalg import solve_banded

        count, throws = twist.shape
        p, q = (compliance[:, None] * (square * part)[:, :, None] for part in self._sums)
        blocks = np.empty(self.filled.shape)
        blocks[..., :throws, :throws], blocks[..., :throws, throws:] = p.real, -q.imag
        blocks[..., throws:, :throws], blocks[..., throws:, throws:] = p.imag, q.real
        width, aside = 2 * throws, 2 * throws * self.reach  # columns of orders that there are not
        beside = (self.reach + 1) * width - 1
        band = np.zeros((2 * beside + 1, count * width + 2 * aside))
        band.ravel()[self.filled] = -blocks
        band[beside] += 1.0
        alone, banded = np.hstack([twist.real, twist.imag]), band[:, aside : aside + count * width]
        x = solve_banded((beside, beside), banded, alone.ravel(), check_finite=False)
        real, imaginary = np.split(x.reshape(count, width), 2, axis=1)
        found = np.pad(real + 1j * imaginary, ((self.reach, self.reach), (0, 0)))
        near = found[np.arange(count)[:, None] + np.arange(2 * self.reach + 1)]
        return np.asarray(square * (self.direct * near + self.mirrored * near.conj()).sum(axis=1))

    @cached_property
    def _sums(self) -> tuple[Complex, Complex]:
        return self.direct + self.mirrored, self.direct - self.mirrored


@dataclass(frozen=True)
class OrderCoupling:
    """Coupling of the orders of the motion by the varying inertia, at any speed."""

    orders: Array
    parts: tuple[_Part, ...]

    def response_rad(self, shaft: ShaftChain, speed_rad_s: float, torque_Nm: Complex) -> Complex:
        """Return the complex amplitude of every disk under torques on the disks, (orders, disks)."""
        driven = np.eye(len(shaft.names), dtype=complex)[:, shaft.driven]
        every = np.broadcast_to(driven, (len(self.orders), *driven.shape))
        torques = np.concatenate([torque_Nm[..., None], every], axis=-1)
        found = shaft.chain.responses_rad(self.orders * speed_rad_s, torques)
        twist, by_throw = found[..., 0], found[..., 1:]
        for part in self.parts:
            of_part = by_throw[part.places]
            throws = twist[part.places][:, shaft.driven], of_part[:, shaft.driven]
            acting = part.acting_Nm(*throws, speed_rad_s**2)
            twist[part.places] += np.einsum("nt,ndt->nd", acting, of_part)
        return twist


def order_coupling(orders: Array, varying_kg_m2: Complex) -> OrderCoupling:
    """Return the coupling of orders, without order 0, by harmonics of every throw's inertia."""
    parts = (np.flatnonzero(orders % 1 == part) for part in np.unique(orders % 1))
    return OrderCoupling(orders, tuple(_part(orders, places, varying_kg_m2) for places in parts))


def _part(orders: Array, places: Index, varying: Complex) -> _Part:
    reach, width, count = len(varying) - 1, 2 * varying.shape[1], len(places)
    two_sided = np.concatenate([varying[:0:-1].conj(), varying])
    distance, own = np.arange(-reach, reach + 1), np.arange(count)[:, None]
    there = (own + distance >= 0) & (own + distance < count)
    n, m = orders[places][:, None], orders[places][:, None] + distance
    scale = (there * (n**2 + m**2) / 2)[..., None]
    row, column = np.indices((width, width))
    at = (own + distance + reach)[..., None, None] * width + column
    below = (reach + 1) * width - 1 + (reach - np.arange(2 * reach + 1))[:, None, None] * width + row - column
    return _Part(
        places,
        scale * _harmonics(two_sided, n - m),
        scale * _harmonics(two_sided, n + m),
        below * (count + 2 * reach) * width + at,
    )


def _harmonics(two_sided: Complex, numbers: Array) -> Complex:
    """Harmonics by their number, zero beyond the last; (*numbers, throws)."""
    last = len(two_sided) // 2
    number = np.rint(numbers).astype(int)
    inside = np.abs(number) <= last
    return np.asarray(two_sided[np.where(inside, number, 0) + last] * inside[..., None])
