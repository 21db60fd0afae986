"""The shaft on its bearings as one straight beam: what neighbouring throws do to the bending of the webs.

Each throw is a span of the mean stiffness that its closed-form bending compliance gives, alike in every
direction, with its pin force in the middle; Euler-Bernoulli, two unknowns a node in complex numbers x + iy.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cranktopo.base.arrays import Array
from cranktopo.base.frames import about_z_deg
from cranktopo.design.crank_throws import carried
from cranktopo.design.halves import halves
from cranktopo.design.schema import Scene
from cranktopo.engine.analysis import engine_of
from cranktopo.engine.balance.throw import throw_balance
from cranktopo.engine.bearings import bearing_spring_N_per_mm
from cranktopo.engine.forces import throw_forces
from cranktopo.engine.gas import pressure_curve
from cranktopo.engine.histories import every_degree
from cranktopo.engine.kinematics import phase_shift
from cranktopo.engine.throw_compliance import throw_compliance

Complex = NDArray[np.complex128]


@dataclass(frozen=True)
class SpanBending:
    """Bending of the webs of a shaft beside that of a throw alone on rigid bearings.

    Attributes:
        spring_N_per_mm: radial stiffness of each main bearing; None: rigid.
        least, largest: range of the bending moment in the middle of a web over that of a throw alone, of the
            web with the least and of that with the most.
    """

    spring_N_per_mm: float | None
    least: float
    largest: float


def span_bending(scene: Scene) -> SpanBending:
    """Return how the shaft of a scene changes the bending of its webs; it must tell pressures."""
    spring, arms = bearing_spring_N_per_mm(scene), [sum(half.web_z_mm) / 2 for half in halves(scene)]
    pitch = scene.pitch_mm
    stiffness = pitch**3 / (48 * throw_compliance(scene).bending_mm_per_N)
    turn = np.exp(1j * np.radians([about_z_deg(angle) for angle in scene.shaft_angles_deg]))[:, None]
    force = _pin_forces_N(scene)
    moments = _web_moments(stiffness, pitch, arms, force * turn, spring, carried(scene)) / turn[:, None]
    alone = np.array([np.ptp(force.imag) / 2 * arm for arm in arms])
    share = np.ptp(moments.imag, axis=2) / alone
    return SpanBending(spring, float(share.min()), float(share.max()))


def _pin_forces_N(scene: Scene) -> Complex:
    """Forces on the pins in the axes of each throw, (throws, states)."""
    engine, curve = engine_of(scene), pressure_curve(scene)
    assert curve is not None
    rod = throw_forces(engine, scene.throw.radius_mm, curve, throw_balance(scene), engine.speed_rpm)
    one = rod.tangential_force_N - 1j * rod.web_force_N
    fires = engine.firing_angles_deg
    every = np.array(
        [
            phase_shift(one.real, curve.angle_deg, at, engine.cycle_deg)
            + 1j * phase_shift(one.imag, curve.angle_deg, at, engine.cycle_deg)
            for at in fires
        ]
    )[:, :: every_degree(curve.angle_deg)]
    return np.asarray(every.reshape(-1, engine.throws, every.shape[1]).sum(axis=0))


def _web_moments(
    stiffness: float,
    pitch_mm: float,
    arms_mm: Sequence[float],
    force_N: Complex,
    spring: float | None,
    borne: Sequence[int],
) -> Complex:
    """Bending moment in the middle of both webs of every throw, (throws, 2, states)."""
    count, half = len(force_N), pitch_mm / 2
    bar = _bar(stiffness, half)
    unknowns = 2 * (2 * count + 1)
    matrix, load = np.zeros((unknowns, unknowns)), np.zeros((unknowns, force_N.shape[1]), dtype=complex)
    for element in range(2 * count):
        own = slice(2 * element, 2 * element + 4)
        matrix[own, own] += bar
    load[2::4] = force_N
    sections = [4 * number for number in borne]
    free = np.setdiff1d(np.arange(unknowns), sections if spring is None else [])
    if spring is not None:
        matrix[sections, sections] += spring
    moved = np.zeros_like(load)
    moved[free] = np.linalg.solve(matrix[np.ix_(free, free)], load[free])
    found = np.empty((count, 2, force_N.shape[1]), dtype=complex)
    for throw in range(count):
        near, far = (bar @ moved[4 * throw + shift : 4 * throw + shift + 4] for shift in (0, 2))
        found[throw, 0] = near[0] * arms_mm[0] - near[1]
        found[throw, 1] = far[2] * arms_mm[1] + far[3]
    return found


def _bar(stiffness: float, length: float) -> Array:
    """Stiffness of a beam over deflection and slope of both ends."""
    a, b, c, d = 12.0, 6 * length, 4 * length**2, 2 * length**2
    form = np.array([[a, b, -a, b], [b, c, -b, d], [-a, -b, a, -b], [b, d, -b, c]])
    return np.asarray(stiffness / math.pow(length, 3) * form)
