"""Rule of torsional vibration: what a resonance does to the torque, from one mode in closed form."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from cranktopo.base.arrays import Array, Complex
from cranktopo.base.units import angular_speed_rad_s
from cranktopo.design.checks.engine import is_damped, speed_range_rpm
from cranktopo.design.schema import Scene
from cranktopo.design.shaft import ShaftTable
from cranktopo.engine.analysis import analyse
from cranktopo.engine.plan.context import PlanningContext
from cranktopo.engine.plan.effect import Estimate
from cranktopo.engine.vibration.shaft_chain import ShaftChain, estimated_chain
from cranktopo.engine.vibration.steady import ORDERS
from cranktopo.engine.vibration.torque_harmonics import TorqueHarmonics, torque_harmonics

_NEAR = np.linspace(0.5, 1.3, 81)
"""Frequencies looked at, over the natural one; a damper's ring lowers the peak's."""


@dataclass(frozen=True)
class _Resonance:
    """The worst order of the first mode within the range of speeds.

    Attributes:
        magnifier: torque over what the same order causes on a stiff shaft.
        percent: change of the torque amplitude.
    """

    frequency_Hz: float
    order: float
    major: bool
    speed_rpm: float
    magnifier: float
    percent: float


@dataclass(frozen=True)
class _FirstMode:
    """First mode of the crankshaft with what swings with it.

    Attributes:
        disks: of the chain that take part.
        driven: those of the throws among them.
        torque_per_Nm: static torque of the worst section behind a throw over the torque on the mode.
    """

    disks: slice
    driven: slice
    shape: Array
    stiffness: float
    inertia: float
    torque_per_Nm: float

    @property
    def frequency_rad_s(self) -> float:
        """Natural frequency without damping."""
        return math.sqrt(self.stiffness / self.inertia)


def torsional_vibration(context: PlanningContext) -> Estimate:
    """First mode of the crankshaft by Rayleigh's quotient, its damping, and the orders that meet it."""
    absent = _absent(context.scene)
    if absent:
        return Estimate(None, "", "nothing", absent=absent, impossible=absent)
    found = _resonance(context.scene)
    if found is None:
        low, high = speed_range_rpm(context.scene)
        because = f"no order meets the first natural frequency between {low:.0f} and {high:.0f} rpm"
        return Estimate(0.0, because, "nothing")
    kind = "major" if found.major else "minor"
    shaft = context.scene.shaft
    given = shaft is not None and shaft.gives_stiffness
    source = "" if given else " (throws in closed form)"
    because = (
        f"first natural frequency {found.frequency_Hz:.0f} Hz{source}, {kind} order {found.order:g} at "
        f"{found.speed_rpm:.0f} rpm, magnifier {found.magnifier:.3g}: "
        f"torque amplitude {found.percent:+z.3g} %"
    )
    without = 100 * (1 / (1 + found.percent / 100) - 1)
    return Estimate(abs(found.percent), because, f"torque amplitude {without:+z.2g} %")


def _absent(scene: Scene) -> str:
    """Why nothing can be told of the vibration; empty when it can."""
    shaft, engine = scene.shaft, scene.engine
    if shaft is None:
        return "the scene has no [shaft]"
    if engine is None or engine.gas is None:
        return "the scene tells no torque over the cycle ([engine.gas])"
    if engine.max_torque_Nm is not None or engine.min_torque_Nm is not None:
        return "engine.max_torque_Nm or min_torque_Nm is taken as it is"
    if not shaft.has_takeoff:
        return "nothing is joined to the takeoff in [shaft]"
    if not is_damped(shaft):
        return "nothing damps the shaft, so that a resonance has no limit"
    return ""


def _resonance(scene: Scene) -> _Resonance | None:
    """The order that adds most to the torque; None where none meets the first mode in the range of speeds."""
    shaft, harmonics = estimated_chain(scene), torque_harmonics(scene)
    cycle = analyse(scene).cycle
    assert harmonics is not None
    assert cycle is not None
    mode = _first_mode_of(shaft)
    frequency = mode.frequency_rad_s * _NEAR
    magnifier = _magnifier(scene, shaft, mode, frequency)
    orders = harmonics.orders[1 : ORDERS + 1, None]
    speeds = frequency / (angular_speed_rad_s(1.0) * orders)
    # Torque of the worst section without magnification, every order at the speeds of these frequencies.
    acting = _on_mode_Nm(harmonics, mode.shape[mode.driven], speeds, frequency / orders)
    static = acting * mode.torque_per_Nm
    low, high = speed_range_rpm(scene)
    added = np.where((speeds >= low) & (speeds <= high), static * (magnifier - 1), 0.0)
    order, place = (int(i) for i in np.unravel_index(int(added.argmax()), added.shape))
    if added[order, place] <= 0:
        return None
    quasi_static = float(np.ptp(cycle.torque.passed_on_Nm, axis=1).max()) / 2
    return _Resonance(
        float(mode.frequency_rad_s / (2 * np.pi)),
        float(orders[order, 0]),
        bool(harmonics.in_phase()[1 + order]),
        float(speeds[order, place]),
        float(magnifier[place]),
        100 * float(added[order, place]) / quasi_static,
    )


def _on_mode_Nm(harmonics: TorqueHarmonics, swing: Array, speeds_rpm: Array, rad_s: Array) -> Array:
    """Amplitude of all cylinders' torque on a motion of the throws, each order at its own speeds.

    Args:
        rad_s: the same speeds.
    """

    def each(at: Callable[[Array], Complex]) -> Complex:
        return np.stack([at(speeds)[:, order] for order, speeds in enumerate(speeds_rpm, start=1)])

    one = each(harmonics.gas_at_Nm) + rad_s**2 * harmonics.inertia_Nm_s2[1 : ORDERS + 1, None]
    together = (harmonics.shifts[1 : ORDERS + 1] * swing).sum(axis=1)[:, None]
    if not harmonics.misfire:
        return np.asarray(np.abs(together) * np.abs(one))
    missing = (harmonics.misfire_shifts[1 : ORDERS + 1] * swing).sum(axis=1)[:, None]
    return np.asarray(np.abs(together * one - missing * each(harmonics.lost_at_Nm)))


def _first_mode_of(shaft: ShaftChain) -> _FirstMode:
    first, last = _crankshaft(shaft)
    inertia = np.array(shaft.chain.inertia_kg_m2)[first : last + 1]
    stiffness = np.array(shaft.chain.stiffness_Nm_per_rad)[first:last]
    engine = shaft.first + shaft.throws - first
    shape = _first_shape(inertia, stiffness, engine)
    twist = shape[:-1] - shape[1:]
    return _FirstMode(
        slice(first, last + 1),
        slice(shaft.first - first, engine),
        shape,
        float((stiffness * twist**2).sum()),
        float((inertia * shape**2).sum()),
        float(np.abs(stiffness * twist)[:engine].max() / (stiffness * twist**2).sum()),
    )


def _magnifier(scene: Scene, shaft: ShaftChain, mode: _FirstMode, frequency: Array) -> Array:
    """Torque of the mode over that on a stiff shaft; the ring of a damper is an inertia of its own."""
    chain, disks = shaft.chain, mode.disks
    springs = chain.section_stiffness_Nm_per_rad(frequency)[:, disks.start : disks.stop - 1]
    absolute = (np.array(chain.absolute_damping_Nms_per_rad)[disks] * mode.shape**2).sum()
    ring = _ring_inertia(scene.shaft or ShaftTable(), frequency) * mode.shape[0] ** 2
    modal = (springs * (mode.shape[:-1] - mode.shape[1:]) ** 2).sum(axis=1) + 1j * frequency * absolute
    return np.asarray(mode.stiffness / np.abs(modal - frequency**2 * (mode.inertia + ring)))


def _crankshaft(shaft: ShaftChain) -> tuple[int, int]:
    """First and last disk that swing in the crankshaft's own first mode.

    A ring of a damper counts apart; what lies behind a spring softer than the crankshaft stands still.
    """
    first = 1 if shaft.names[0] == "damper ring" else 0
    last = shaft.first + shaft.throws
    stiffness = shaft.chain.stiffness_Nm_per_rad
    softest = 1 / sum(1 / k for k in stiffness[first:last])
    while last < len(stiffness) and stiffness[last] > softest:
        last += 1
    return first, last


def _first_shape(inertia: Array, stiffness: Array, engine: int) -> Array:
    """First mode of a free chain: its static twist by its own inertia, improved twice (Stodola).

    The first `engine` disks, up to the last throw, turn against those behind them.
    """
    shape = np.where(np.arange(len(inertia)) < engine, 1.0, 0.0)
    for _ in range(3):
        shape = shape - (inertia * shape).sum() / inertia.sum()
        torque = np.cumsum(inertia * shape)[:-1]
        shape = np.append(0.0, -np.cumsum(torque / stiffness))
        shape = shape / np.abs(shape).max()
    return np.asarray(shape - (inertia * shape).sum() / inertia.sum())


def _ring_inertia(shaft: ShaftTable, frequency: Array) -> Array:
    """Complex inertia with which the ring of the damper acts on its hub, kg m2."""
    damper = shaft.damper
    if damper is None:
        return np.zeros(len(frequency))
    spring = (damper.stiffness_Nm_per_rad or 0.0) * (1 + 1j * (damper.loss_factor or 0.0))
    joint = spring + 1j * frequency * (damper.damping_Nms_per_rad or 0.0)
    ring = damper.ring_inertia_kg_m2
    return np.asarray(ring * joint / (joint - ring * frequency**2))
