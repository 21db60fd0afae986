"""The shaft on its bearings as one straight beam: what neighbouring throws do to the bending of the webs.

Each throw is a span of the mean stiffness that its closed-form bending compliance gives, alike in every
direction, with its pin force in the middle; Euler-Bernoulli, two unknowns a node in complex numbers x + iy.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from cranktopo.base.arrays import Complex
from cranktopo.base.frames import about_z_deg
from cranktopo.design.crank_throws import carried
from cranktopo.design.halves import halves
from cranktopo.design.schema import Scene
from cranktopo.engine.analysis import engine_of
from cranktopo.engine.bearings import bearing_spring_N_per_mm
from cranktopo.engine.cylinders import cylinders
from cranktopo.engine.forces import ThrowForces, by_throw
from cranktopo.engine.histories import every_degree
from cranktopo.engine.throw_compliance import throw_compliance
from cranktopo.numerics.stepped_beam import Beam, bend


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
    found = cylinders(scene)
    assert found is not None

    def on_pin_N(rod: ThrowForces) -> Complex:
        return rod.tangential_force_N - 1j * rod.web_force_N

    every = found.each(on_pin_N)
    return by_throw(every[:, :: every_degree(found.angle_deg)], engine_of(scene).throws)


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
    spans = np.full(2 * count, stiffness)
    beam = Beam(half * np.arange(2.0 * count + 1), spans, np.full_like(spans, np.inf))
    load = np.zeros((2 * count + 1, force_N.shape[1]), dtype=complex)
    load[1::2] = force_N
    bent = bend(beam, {2 * section: spring for section in borne}, load, np.zeros_like(load))
    pin = bent.before_Nmm[1::2]
    ends = bent.after_Nmm[:-1:2], bent.before_Nmm[2::2]
    webs = [end + (pin - end) * arm / half for end, arm in zip(ends, arms_mm, strict=True)]
    return np.stack(webs, axis=1)
