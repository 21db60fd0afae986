"""The shaft on its bearings as one straight beam: what neighbouring throws do to the bending of the webs.

Each throw is a span of the mean stiffness that its closed-form bending compliance gives, alike in every
direction, with its pin force, and the couple of its rods, in the middle; Euler-Bernoulli, two unknowns a node
in complex numbers x + iy.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from cranktopo.base.arrays import Array, Complex
from cranktopo.base.frames import about_z_deg
from cranktopo.base.units import MM_PER_M, angular_speed_rad_s
from cranktopo.design.crank_throws import carried
from cranktopo.design.halves import halves
from cranktopo.design.misfire import all_firing
from cranktopo.design.schema import Scene
from cranktopo.engine.analysis import engine_of
from cranktopo.engine.balance.layout import engine_layout
from cranktopo.engine.balance.throw import splayed_throw_kg_mm
from cranktopo.engine.bearings import bearing_spring_N_per_mm, bearing_tilt_spring_Nmm_per_rad
from cranktopo.engine.cylinders import cylinders
from cranktopo.engine.forces import by_throw
from cranktopo.engine.histories import every_degree
from cranktopo.engine.throw_compliance import throw_compliance
from cranktopo.numerics.stepped_beam import Beam, bend

_SAME = 1e-6
"""Difference of the forces of two bearings that are alike but for the rounding."""


@dataclass(frozen=True)
class SpanBending:
    """Bending of the webs of a shaft, and forces on its bearings, beside those of throws alone on rigid ones.

    Attributes:
        spring_N_per_mm: radial stiffness of each main bearing; None: rigid.
        least, largest: range of the bending moment in the middle of a web over that of its throw alone, of
            the web with the least and of that with the most.
        bearing: number of the main bearing that carries most, 1 at the free end.
        bearing_share: its largest force over the largest that throws alone put on any bearing.
    """

    spring_N_per_mm: float | None
    least: float
    largest: float
    bearing: int
    bearing_share: float


@dataclass(frozen=True)
class Spans:
    """Throws of a shaft as equal spans.

    Attributes:
        bending_Nmm2: E I of a span.
        arms_mm: distance of the middle of either web from the section beside it.
        tilt_Nmm_per_rad: stiffness by which bearings resist the tilt of their journals.
    """

    bending_Nmm2: float
    pitch_mm: float
    arms_mm: Sequence[float]
    tilt_Nmm_per_rad: float = 0.0


@dataclass(frozen=True)
class PinLoads:
    """Loads on the pins, in one plane of complex numbers or in the axes of each throw, (throws, states).

    Attributes:
        couple_Nmm: of the rods of a pin about its middle, as `bend` counts it.
        turning_N: centrifugal force of each throw, (throws, 1); it bends no web more or less over the cycle.
    """

    force_N: Complex
    couple_Nmm: Complex
    turning_N: Complex

    def turned(self, turn: Complex) -> PinLoads:
        """Return the loads turned by the angle of each throw."""
        return PinLoads(self.force_N * turn, self.couple_Nmm * turn, self.turning_N * turn)

    @property
    def of_one_throw(self) -> PinLoads:
        """The loads of all throws as states of one, those of the first throw first."""
        every = self.force_N, self.couple_Nmm, np.broadcast_to(self.turning_N, self.force_N.shape)
        return PinLoads(*(loads.reshape(1, -1) for loads in every))


def span_bending(scene: Scene) -> SpanBending:
    """Return how the shaft of a scene changes the bending of its webs; it must tell pressures.

    In the throws alone all cylinders fire, as they are judged.
    """
    spring, arms = bearing_spring_N_per_mm(scene), [sum(half.web_z_mm) / 2 for half in halves(scene)]
    stiffness = scene.pitch_mm**3 / (48 * throw_compliance(scene).bending_mm_per_N)
    spans, borne = Spans(stiffness, scene.pitch_mm, arms), carried(scene)
    tilting = replace(spans, tilt_Nmm_per_rad=bearing_tilt_spring_Nmm_per_rad(scene))
    turn = np.exp(1j * np.radians([about_z_deg(angle) for angle in scene.shaft_angles_deg]))[:, None]
    moments, reactions_N = bend_spans(tilting, _pin_loads(scene).turned(turn), dict.fromkeys(borne, spring))
    alone = _alone(spans, _pin_loads(all_firing(scene)), turn)
    share = np.ptp((moments / turn[:, None]).imag, axis=2) / alone.range_Nmm
    largest_N = np.abs(reactions_N).max(axis=1)
    most = int((largest_N > largest_N.max() * (1 - _SAME)).argmax())
    of_throws_N = np.abs(alone.bearing_N[list(borne)]).max()
    return SpanBending(
        spring, float(share.min()), float(share.max()), borne[most] + 1, float(largest_N[most] / of_throws_N)
    )


@dataclass(frozen=True)
class _Alone:
    """Throws alone: range of the moment of each web, and the sum of their forces on each bearing."""

    range_Nmm: Array
    bearing_N: Complex


def _alone(spans: Spans, loads: PinLoads, turn: Complex) -> _Alone:
    moments, ends_N = bend_spans(spans, loads.of_one_throw, dict.fromkeys((0, 1)))
    first_N, last_N = turn * ends_N.reshape(2, len(turn), -1)
    bearing = np.zeros((len(turn) + 1, loads.force_N.shape[1]), dtype=complex)
    bearing[:-1] += first_N
    bearing[1:] += last_N
    return _Alone(np.ptp(moments.imag.reshape(2, len(turn), -1), axis=2).T, bearing)


def _pin_loads(scene: Scene) -> PinLoads:
    """Return the loads of all pins in the axes of each throw."""
    found, layout, engine = cylinders(scene), engine_layout(scene), engine_of(scene)
    assert found is not None

    every = found.pin_forces_N[:, :: every_degree(found.angle_deg)]
    every = every * np.exp(1j * np.radians(about_z_deg(1.0) * layout.pin_deg))[:, None]
    beyond_mm = (layout.cylinder_z_mm - layout.throw_z_mm[list(layout.throw_of)])[:, None]
    turning_N = splayed_throw_kg_mm(scene).real * angular_speed_rad_s(engine.speed_rpm) ** 2 / MM_PER_M
    return PinLoads(
        by_throw(every, engine.throws),
        by_throw(beyond_mm * every, engine.throws),
        np.full((engine.throws, 1), 1j * turning_N),
    )


def bend_spans(
    spans: Spans, loads: PinLoads, supports: Mapping[int, float | None]
) -> tuple[Complex, Complex]:
    """Return bending moments in the middle of both webs of every throw, (throws, 2, states), and reactions.

    Args:
        supports: by section, the stiffness of its bearing; None is rigid.
    """
    count, half = len(loads.force_N), spans.pitch_mm / 2
    stiffness = np.full(2 * count, spans.bending_Nmm2)
    beam = Beam(half * np.arange(2.0 * count + 1), stiffness, np.full_like(stiffness, np.inf))
    force = np.zeros((2 * count + 1, loads.force_N.shape[1]), dtype=complex)
    couple = np.zeros_like(force)
    force[1::2], couple[1::2] = loads.force_N + loads.turning_N, loads.couple_Nmm
    nodes = {2 * section: spring for section, spring in supports.items()}
    bent = bend(beam, nodes, force, couple, spans.tilt_Nmm_per_rad)
    ends = bent.after_Nmm[:-1:2], bent.before_Nmm[2::2]
    pins = bent.before_Nmm[1::2], bent.after_Nmm[1::2]
    webs = [end + (pin - end) * arm / half for end, pin, arm in zip(ends, pins, spans.arms_mm, strict=True)]
    return np.stack(webs, axis=1), np.array([bent.reaction_N[2 * section] for section in supports])
