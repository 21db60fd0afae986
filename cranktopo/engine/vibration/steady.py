"""Steady torsional vibration of a shaft over a range of speeds: by order, and summed over the cycle."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cranktopo.base.arrays import Array, Complex, Mask
from cranktopo.base.units import angular_speed_rad_s, number_text
from cranktopo.design.shaft import passed_through
from cranktopo.engine.vibration.order_coupling import OrderCoupling, order_coupling
from cranktopo.engine.vibration.shaft_chain import ShaftChain
from cranktopo.engine.vibration.torque_harmonics import (
    HARMONICS,
    TorqueHarmonics,
    curve_of,
)
from cranktopo.numerics.disk_chain import DampedMode

ORDERS = 24
"""Orders that are solved at least."""
_MOST_ORDERS = 240
"""Orders that are looked at: to 120 of the rotation, where no torque of gas is left."""
_LEAST_SHARE = 1e-3
"""Torque of an order over the largest of any order in a section, below which it is left out."""
TELLING_SHARE = 0.01
"""Torque of an order at a critical speed over the largest of its section, below which it is not told."""
_SPEEDS = 200
_STEPS_OF_RISE = 5
_POINTS_PER_ORDER = 16
"""Angles of a cycle for each order of a sum whose range is looked for."""
_TOGETHER = 32
"""Speeds that are solved at once: more take memory and gain nothing."""


@dataclass(frozen=True)
class CriticalSpeed:
    """A speed at which an order of the torque meets a natural frequency.

    Attributes:
        mode: number of the natural frequency, 1 is the lowest.
        share: how far the cylinders' torques of this order add up in this mode: 1 where all of them help.
        major: whether all cylinders, if all fire, have the same phase.
    """

    speed_rpm: float
    order: float
    mode: int
    share: float
    major: bool


@dataclass(frozen=True)
class Worst:
    """Place where the torque of the crankshaft swings most, and the largest order there with its torque."""

    speed_index: int
    section: int
    order: float
    order_Nm: float


@dataclass(frozen=True)
class Vibration:
    """Steady vibration at every speed; amplitudes are half the range over the cycle.

    Attributes:
        orders: those that are solved, without the mean.
        twist_rad: complex amplitudes of the disks, shape (speeds, orders, disks).
        torque_Nm: complex amplitudes of the sections, shape (speeds, orders, sections).
        mean_torque_Nm: of the sections, toward the takeoff, at the speed where the engine's is largest.
        highest_Nm, lowest_Nm: ends of the torque over the cycle, its mean included, shape (speeds, sections).
        twist_amplitude_deg: of each section, one end against the other, shape (speeds, sections).
        free_end_deg: amplitude of the first disk of the crankshaft, ring of the damper apart, (speeds,).
        barred_rpm: ranges that the engine only passes through; extremes are those of other speeds.
    """

    shaft: ShaftChain
    harmonics: TorqueHarmonics
    speeds_rpm: Array
    orders: Array
    twist_rad: Complex
    torque_Nm: Complex
    mean_torque_Nm: Array
    highest_Nm: Array
    lowest_Nm: Array
    twist_amplitude_deg: Array
    free_end_deg: Array
    barred_rpm: tuple[tuple[float, float], ...] = ()

    @property
    def running(self) -> Mask:
        """Tell of each speed whether the engine runs at it, (speeds,)."""
        return ~passed_through(self.barred_rpm, self.speeds_rpm)

    @property
    def torque_amplitude_Nm(self) -> Array:
        """Half the range of the torque over the cycle, shape (speeds, sections)."""
        return (self.highest_Nm - self.lowest_Nm) / 2

    @property
    def extreme_speeds_rpm(self) -> tuple[float, ...]:
        """Speeds of the largest and of the smallest torque in the crankshaft, mean included, each once.

        Neither need be that of the largest amplitude, which is often in a section with little mean torque.
        """
        inside = np.array(self.shaft.in_crankshaft)
        high, low = self.highest_Nm[:, inside].max(axis=1), self.lowest_Nm[:, inside].min(axis=1)
        ends = np.where(self.running, high, -np.inf).argmax(), np.where(self.running, low, np.inf).argmin()
        return tuple(float(self.speeds_rpm[at]) for at in sorted({int(at) for at in ends}))

    @property
    def worst(self) -> Worst:
        """Speed and section of the largest torque amplitude in the crankshaft; the lowest speed of equals."""
        inside = np.array(self.shaft.in_crankshaft)
        amplitude = np.where(inside & self.running[:, None], self.torque_amplitude_Nm, -1.0)
        speed, section = (int(i) for i in np.unravel_index(int(amplitude.argmax()), amplitude.shape))
        return Worst(speed, section, *self.largest_order(speed, section))

    def largest_order(self, speed: int, section: int) -> tuple[float, float]:
        """Return the order with the largest torque in a section at a speed, by their numbers, and it, N m."""
        torque = np.abs(self.torque_Nm[speed, :, section])
        return float(self.orders[int(torque.argmax())]), float(torque.max())

    @property
    def worst_Nm(self) -> float:
        """That largest torque amplitude."""
        return float(self.torque_amplitude_Nm[self.worst.speed_index, self.worst.section])

    @property
    def crankshaft_amplitude_Nm(self) -> Array:
        """Largest torque amplitude of the crankshaft's sections at each speed, (speeds,)."""
        return np.asarray(self.torque_amplitude_Nm[:, np.array(self.shaft.in_crankshaft)].max(axis=1))

    @property
    def shear_MPa(self) -> Array:
        """Largest nominal alternating shear stress of the crankshaft's sections, (speeds,)."""
        return np.asarray(self.shaft.shear_MPa(1.0) * self.crankshaft_amplitude_Nm)


def order_words(order: float, order_Nm: float, amplitude_Nm: float) -> str:
    """Return of which orders a swing of torque is, by its largest order and the torque of that alone."""
    if order_Nm > amplitude_Nm / 2:
        return f"mostly of order {order:g}"
    return f"of many orders, the largest of them order {order:g} with {number_text(order_Nm)} N m"


def critical_speeds(
    shaft: ShaftChain,
    modes: Sequence[DampedMode],
    harmonics: TorqueHarmonics,
    range_rpm: tuple[float, float],
    orders: int = ORDERS,
) -> tuple[CriticalSpeed, ...]:
    """Return crossings of orders with natural frequencies in a range of speeds, the slowest first.

    Orders above the first 24 meet many modes: their crossings count where their torque is felt beside that
    of the other crossings, so that few speeds have to be solved.
    """
    shifts = harmonics.shifts[1 : orders + 1]
    majors = harmonics.in_phase()[1 : orders + 1]
    rods = len(harmonics.firing_deg) / shaft.throws
    found = []
    for number, mode in enumerate(modes, start=1):
        swing = mode.shape[shaft.driven]
        if harmonics.misfire:
            met = 60.0 * mode.frequency_Hz / harmonics.orders[1 : orders + 1]
            shares = harmonics.adding_up(swing, met)
        else:
            shares = np.abs((shifts * swing).sum(axis=1)) / (rods * np.abs(swing).sum())
        for order, share, major in zip(harmonics.orders[1:], shares, majors, strict=False):
            speed = 60.0 * mode.frequency_Hz / float(order)
            if range_rpm[0] <= speed <= range_rpm[1]:
                found.append(CriticalSpeed(speed, float(order), number, float(share), bool(major)))
    felt = _felt(shaft, harmonics, found) if orders > ORDERS else [True] * len(found)
    kept = [one for one, counts in zip(found, felt, strict=True) if counts]
    return tuple(sorted(kept, key=lambda c: (c.speed_rpm, c.order)))


def _felt(shaft: ShaftChain, harmonics: TorqueHarmonics, criticals: Sequence[CriticalSpeed]) -> list[bool]:
    """Tell of each crossing whether it is of the first 24 orders, or its torque counts in a section."""
    places = np.rint([one.order / harmonics.orders[1] for one in criticals]).astype(int)
    swing = _order_torques_Nm(shaft, harmonics, places, np.array([one.speed_rpm for one in criticals]))
    counting = (swing > TELLING_SHARE * swing.max(axis=0, initial=0.0)).any(axis=1)
    return [bool(counts) for counts in counting | (places <= ORDERS)]


def orders_to_solve(
    shaft: ShaftChain, modes: Sequence[DampedMode], harmonics: TorqueHarmonics, range_rpm: tuple[float, float]
) -> int:
    """Return up to which order the shaft is solved: the last that counts in a section, at least 24.

    Each is looked at where it meets a natural frequency and at both ends of the range, with the mean inertia.
    """
    if not shaft.sections:
        return ORDERS
    most = min(_MOST_ORDERS, len(harmonics.orders) - 1)
    every = np.arange(1, most + 1)
    met = np.array([60.0 * mode.frequency_Hz / harmonics.orders[every] for mode in modes]).reshape(-1, most)
    inside = (met >= range_rpm[0]) & (met <= range_rpm[1])
    places = np.concatenate([np.broadcast_to(every, met.shape)[inside], every, every])
    speeds = np.concatenate([met[inside], np.repeat(range_rpm, most)])
    swing = _order_torques_Nm(shaft, harmonics, places, speeds)
    counting = (swing > _LEAST_SHARE * swing.max(axis=0)).any(axis=1)
    return max(ORDERS, int(places[counting].max(initial=0)))


def _order_torques_Nm(
    shaft: ShaftChain, harmonics: TorqueHarmonics, places: NDArray[np.int_], speeds_rpm: Array
) -> Array:
    """Torque amplitudes of the sections by single orders, by number, each at its speed, (pairs, sections)."""
    frequency = angular_speed_rad_s(1.0) * speeds_rpm * harmonics.orders[places]
    twist = shaft.chain.response_rad(frequency, on_disks(shaft, harmonics.of_orders_Nm(places, speeds_rpm)))
    return np.abs(shaft.chain.section_torque_Nm(frequency, twist))


def speeds_to_solve(
    range_rpm: tuple[float, float], critical: Sequence[CriticalSpeed], count: int = _SPEEDS, rise: float = 0.0
) -> Array:
    """Return even steps over a range and its critical speeds, with steps up to `rise` of each above it."""
    steps = 1 + rise * np.linspace(0, 1, _STEPS_OF_RISE if rise else 1)
    peaks = np.outer([c.speed_rpm for c in critical], steps).ravel()
    return np.unique(np.concatenate([np.linspace(*range_rpm, count), peaks[peaks <= range_rpm[1]]]))


def vibration(
    shaft: ShaftChain,
    harmonics: TorqueHarmonics,
    speeds_rpm: Array,
    orders: int = ORDERS,
    varying_kg_m2: Complex | None = None,
) -> Vibration:
    """Return the steady vibration of a shaft at each speed.

    Orders above the solved ones are left out: above the natural frequencies the throws' own inertia takes
    them up, and `orders_to_solve` tells how many count. Without harmonics of the throws' inertia it is their
    mean alone.
    """
    # The last orders feel those above them: as many more are solved as the inertia reaches.
    more = harmonics.orders[1 : 1 + orders + round(HARMONICS / float(harmonics.orders[1]))]
    coupling = None if varying_kg_m2 is None else order_coupling(more, varying_kg_m2)
    solved, count = harmonics.orders[1 : orders + 1], max(1, math.ceil(len(speeds_rpm) / _TOGETHER))
    found = [_solved(shaft, harmonics, some, solved, coupling) for some in np.array_split(speeds_rpm, count)]
    means, twist, torque, high, low, twisted, free_end = (np.concatenate(p) for p in zip(*found, strict=True))
    mean = np.cumsum(means[means.sum(axis=1).argmax()])[:-1]
    return Vibration(shaft, harmonics, speeds_rpm, solved, twist, torque, mean, high, low, twisted, free_end)


def _solved(
    shaft: ShaftChain,
    harmonics: TorqueHarmonics,
    speeds_rpm: Array,
    orders: Array,
    coupling: OrderCoupling | None,
) -> tuple[NDArray[Any], ...]:
    """Mean torques on the disks, then the fields of `Vibration` that have a row for every speed."""
    excited, speeds = (
        on_disks(shaft, harmonics.of_throws_Nm(speeds_rpm)),
        angular_speed_rad_s(1.0) * speeds_rpm,
    )
    frequency = speeds[:, None] * orders
    if coupling is None:
        twist = shaft.chain.response_rad(frequency, excited[:, 1 : len(orders) + 1])
    else:
        torques = zip(speeds.tolist(), excited[:, 1 : 1 + len(coupling.orders)], strict=True)
        twist = np.stack([coupling.response_rad(shaft, w, one)[: len(orders)] for w, one in torques])
    torque = shaft.chain.section_torque_Nm(frequency, twist)
    curves = section_curves_Nm(shaft, excited, torque)
    twisted = np.degrees(_half_range(_summed(twist[..., :-1] - twist[..., 1:])))
    end = 1 if shaft.names[0] == "damper ring" else 0
    free_end = np.degrees(_half_range(_summed(twist[..., [end]])))[:, 0]
    return excited[:, 0].real, twist, torque, curves.max(axis=-1), curves.min(axis=-1), twisted, free_end


def on_disks(shaft: ShaftChain, throws_Nm: Complex) -> Complex:
    """Torques on the throws as torques on the disks of the chain, shape (..., orders, disks)."""
    torque = np.zeros((*throws_Nm.shape[:-1], len(shaft.names)), dtype=complex)
    torque[..., shaft.driven] = throws_Nm
    return torque


def section_curves_Nm(shaft: ShaftChain, excited: Complex, solved: Complex) -> Array:
    """Return the torque of every section over the cycle, its mean included, shape (..., sections, angles).

    Args:
        excited: torques on the disks, all orders.
        solved: torques of the sections, the orders from the first one that were solved; others are left out.
    """
    mean = np.cumsum(excited[..., :1, :], axis=-1)[..., :-1]
    every = np.concatenate([mean, solved], axis=-2)
    return curve_of(np.swapaxes(every, -1, -2), 2 * excited.shape[-2])


def _summed(solved: Complex) -> Array:
    """Curves over the cycle of the solved orders alone."""
    every = np.concatenate([np.zeros_like(solved[..., :1, :]), solved], axis=-2)
    return curve_of(np.swapaxes(every, -1, -2), _POINTS_PER_ORDER * solved.shape[-2])


def _half_range(curves: Array) -> Array:
    return np.asarray((curves.max(axis=-1) - curves.min(axis=-1)) / 2)
