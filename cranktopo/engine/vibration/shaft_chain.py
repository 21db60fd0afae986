"""The turning shaft of a scene as a chain of disks: damper, pulley, throws, flywheel, coupling, takeoff."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np

from cranktopo.base.units import MM2_PER_M2, NMM_PER_NM
from cranktopo.design.crank_throws import throw_scenes
from cranktopo.design.halves import halves
from cranktopo.design.schema import Scene
from cranktopo.design.shaft import Damper, Propeller, Rotor, ShaftTable
from cranktopo.engine.balance.throw import throw_balance
from cranktopo.engine.kinematics import exact_motion
from cranktopo.engine.throw_compliance import (
    first_half_share,
    journal_torsion_modulus_mm3,
    throw_stiffness_Nm_per_rad,
)
from cranktopo.engine.vibration.end_chain import EndChain, end_chain
from cranktopo.numerics.disk_chain import DiskChain

_TURN_POINTS = 720


@dataclass(frozen=True)
class ShaftChain:
    """The chain of a shaft, from the free end to the takeoff.

    Attributes:
        first: index of the disk of throw 1; those of the other throws follow.
        modulus_mm3: smallest modulus of a journal in torsion, for the stress of the crankshaft's sections.
        throws_Nm_per_rad: stiffness of each throw; empty where only the chain is known.
    """

    chain: DiskChain
    names: tuple[str, ...]
    first: int
    throws: int
    modulus_mm3: float
    throws_Nm_per_rad: tuple[float, ...] = ()

    @property
    def driven(self) -> slice:
        """The disks of the throws."""
        return slice(self.first, self.first + self.throws)

    @property
    def behind(self) -> slice:
        """The sections behind the throws; behind the last one only where something follows it."""
        return slice(self.first, min(self.first + self.throws, len(self.names) - 1))

    @property
    def sections(self) -> tuple[str, ...]:
        """Names of the sections between the disks."""
        return tuple(f"{a} - {b}" for a, b in zip(self.names, self.names[1:], strict=False))

    @property
    def in_crankshaft(self) -> tuple[bool, ...]:
        """Tell of each section whether it is a journal of the crankshaft."""
        start = max(self.first - 1, 0)
        return tuple(start <= i < self.behind.stop for i in range(len(self.sections)))

    def shear_MPa(self, torque_Nm: float) -> float:
        """Nominal shear stress of a torque in the weaker of main journal and crankpin, MPa."""
        return torque_Nm * NMM_PER_NM / self.modulus_mm3


@dataclass
class _Row:
    """A chain in the making: disks, and the spring behind each disk but the last.

    A stiffness is complex: its imaginary part is the loss factor's.
    """

    names: list[str] = field(default_factory=list)
    inertia: list[float] = field(default_factory=list)
    absolute: list[float] = field(default_factory=list)
    stiffness: list[complex] = field(default_factory=list)
    relative: list[float] = field(default_factory=list)

    def add(
        self, name: str, inertia: float, stiffness: complex, relative: float = 0.0, absolute: float = 0.0
    ) -> None:
        """A disk at the end, joined to the last one if there is one."""
        if self.names:
            self.stiffness.append(stiffness)
            self.relative.append(relative)
        self.names.append(name)
        self.inertia.append(inertia)
        self.absolute.append(absolute)

    def chain(self) -> DiskChain:
        return DiskChain(
            tuple(self.inertia),
            tuple(k.real for k in self.stiffness),
            tuple(k.imag / k.real if k.real else 0.0 for k in self.stiffness),
            tuple(self.relative),
            tuple(self.absolute),
        )


def moving_inertia_kg_mm2(scene: Scene) -> float:
    """Return what rod and piston add to a throw: rotating mass and half the reciprocating one at its radius.

    The mean of a slider crank (Ker Wilson, Practical Solution of Torsional Vibration Problems).
    """
    engine = scene.engine
    if engine is None:
        return 0.0
    moving_kg = engine.rods_per_pin * (engine.rod_rotating_kg + engine.reciprocating_kg / 2)
    return moving_kg * scene.throw.radius_mm**2


def rods_shares(scene: Scene) -> tuple[float, ...]:
    """Return the share of rods and pistons in the inertia of each throw's disk in `estimated_chain`."""
    shaft = estimated_chain(scene)
    moving = moving_inertia_kg_mm2(scene) / MM2_PER_M2
    return tuple(moving / inertia for inertia in shaft.chain.inertia_kg_m2[shaft.driven])


def lossy_factor(scene: Scene) -> complex:
    """Return the complex stiffness of a throw over its real one."""
    return 1 + 1j * (scene.shaft or ShaftTable()).throw_loss_factor


def varying_inertia_percent(scene: Scene, throw_inertia_kg_mm2: float) -> float:
    """Return half the range of a throw's inertia over a turn, in percent of its mean.

    Each reciprocating mass counts by the square of its velocity over that of the crankpin, which swings twice
    a turn, and once and thrice because its rod is finite: rods of two banks may cancel the first of these.
    """
    engine = scene.engine
    if engine is None:
        return 0.0
    angle, radius = np.linspace(0.0, 2 * math.pi, _TURN_POINTS, endpoint=False), scene.throw.radius_mm
    banks = [engine.axis_deg(c) - engine.pin_deg(c) for c in range(1, engine.cylinders + 1, engine.throws)]
    swing = sum(
        exact_motion(angle - math.radians(bank), radius, engine.rod_length_mm).velocity_ratio ** 2
        for bank in sorted(banks)
    )
    half_range = engine.reciprocating_kg * radius**2 * float(np.ptp(swing)) / 2
    return 100 * half_range / (throw_inertia_kg_mm2 + moving_inertia_kg_mm2(scene))


def estimated_chain(scene: Scene) -> ShaftChain:
    """Return the chain with inertia of the throws in closed form, and stiffness unless the scene gives it."""
    _ = scene.shaft_angles_deg  # refuses a scene without an engine
    throws = throw_scenes(scene)
    different = {throw.name: throw for throw in throws}
    inertias = {name: throw_balance(throw).inertia_kg_mm2 for name, throw in different.items()}
    stiffnesses = {name: throw_stiffness_Nm_per_rad(throw) for name, throw in different.items()}
    scene_stiffnesses = scene.shaft.throw_stiffnesses_Nm_per_rad if scene.shaft else None
    return shaft_chain(
        scene,
        tuple(inertias[throw.name] for throw in throws),
        scene_stiffnesses or tuple(stiffnesses[throw.name] for throw in throws),
    )


def bare_chain(
    scene: Scene, throw_inertia_kg_mm2: float | tuple[float, ...], throws_Nm_per_rad: tuple[float, ...]
) -> DiskChain:
    """Return the chain of the crankshaft alone, with its moving masses and what `[crank]` has at its ends."""
    alone = scene.model_copy(update={"shaft": None})
    return shaft_chain(alone, throw_inertia_kg_mm2, throws_Nm_per_rad).chain


def shaft_chain(
    scene: Scene, throw_inertia_kg_mm2: float | tuple[float, ...], throws_Nm_per_rad: tuple[float, ...]
) -> ShaftChain:
    """Return the chain of a scene's shaft: one disk per throw in the plane of its crankpin.

    The halves of neighbouring throws are springs in series; a half throw joins the ends, with the end of the
    crank where it has one. Halves that differ share the twist of their throw as their closed form has it.
    What is joined rigidly is one disk.
    """
    shaft, throws = scene.shaft or ShaftTable(), throw_scenes(scene)
    inertias = np.broadcast_to(np.array(throw_inertia_kg_mm2), (len(throws_Nm_per_rad),)).tolist()
    moving, lossy = moving_inertia_kg_mm2(scene), lossy_factor(scene)
    shares = [first_half_share(throw) for throw in throws]
    first_halves = [k / share * lossy for k, share in zip(throws_Nm_per_rad, shares, strict=True)]
    second_halves = [k / (1 - share) * lossy for k, share in zip(throws_Nm_per_rad, shares, strict=True)]
    free = end_chain(scene, "free", 1 / first_halves[0].real)
    output = end_chain(scene, "output", 1 / second_halves[-1].real)
    rods = scene.engine.rods_per_pin if scene.engine else 1
    absolute = rods * shaft.cylinder_damping_Nms_per_rad
    row = _Row()
    free_end = _add_free_end(row, shaft, free)
    first = len(row.names)
    for number, half in enumerate(first_halves, start=1):
        spring = _series(free_end if number == 1 else second_halves[number - 2], half)
        relative = shaft.throw_damping_Nms_per_rad if number > 1 else 0.0
        inertia = (inertias[number - 1] + moving) / MM2_PER_M2
        row.add(f"throw {number}", inertia, spring, relative, absolute)
    row.inertia[first] += free.inner_kg_m2 if free else 0.0
    row.inertia[-1] += output.inner_kg_m2 if output else 0.0
    _add_output_end(row, shaft, second_halves[-1], output)
    journals = (journal for throw in throws for half in halves(throw) for journal, _ in half.throw.journals)
    modulus = min(journal_torsion_modulus_mm3(journal) for journal in journals if journal.length_mm)
    return ShaftChain(row.chain(), tuple(row.names), first, len(first_halves), modulus, throws_Nm_per_rad)


def _add_free_end(row: _Row, shaft: ShaftTable, end: EndChain | None) -> complex | None:
    """Ring and hub; returns the stiffness between the hub and the first journal, None where it is rigid.

    The stiffness that a pulley gives is that of the whole shaft between it and the journal, with its own loss
    factor; an end of the crank has that of the crankshaft.
    """
    pulley, damper = shaft.pulley, shaft.damper
    inertia = (pulley.inertia_kg_m2 if pulley else 0.0) + (damper.hub_inertia_kg_m2 if damper else 0.0)
    inertia += end.tip_kg_m2 if end else 0.0
    if damper is not None:
        row.add("damper ring", damper.ring_inertia_kg_m2, 0.0)
    if inertia:
        parts = [part for part, has in (("hub", damper), ("pulley", pulley)) if has is not None]
        spring, relative = _damper(damper) if damper else (0j, 0.0)
        row.add(" + ".join(parts) or "free end", inertia, spring, relative)
    own = _own_spring(pulley) if pulley else None
    return _end_spring(shaft, end) if own is None else own


def _own_spring(rotor: Rotor) -> complex | None:
    """Complex stiffness of the shaft that a part gives between it and its neighbour; None is rigid."""
    stiffness = rotor.stiffness_Nm_per_rad
    return None if stiffness is None else stiffness * (1 + 1j * rotor.loss_factor)


def _end_spring(shaft: ShaftTable, end: EndChain | None) -> complex | None:
    """Complex stiffness of an end of the crank; None where it has none."""
    return None if end is None else end.stiffness_Nm_per_rad * (1 + 1j * shaft.throw_loss_factor)


def _damper(damper: Damper) -> tuple[complex, float]:
    """Complex stiffness and viscous damping between hub and ring."""
    stiffness = damper.stiffness_Nm_per_rad or 0.0
    return stiffness * (1 + 1j * (damper.loss_factor or 0.0)), damper.damping_Nms_per_rad or 0.0


def _add_output_end(row: _Row, shaft: ShaftTable, half: complex, end: EndChain | None) -> None:
    """Add the parts that follow the last throw; a part without stiffness of its own turns with its neighbour.

    The end of the crank is the spring of the first part where it gives none itself.
    """
    parts: tuple[tuple[str, Rotor | None], ...] = (
        ("flywheel", shaft.flywheel),
        ("coupling", shaft.coupling),
        ("driven machine", shaft.driven),
        ("propeller", shaft.propeller),
    )
    joint: complex | None = half
    of_end = _end_spring(shaft, end)
    tip = end.tip_kg_m2 if end else 0.0
    for name, part in parts:
        if part is None:
            continue
        absolute = part.damping_Nms_per_rad if isinstance(part, Propeller) else 0.0
        own = _own_spring(part)
        spring = of_end if own is None else own
        if joint is None and spring is None:
            row.names[-1] += f" + {name}"
            row.inertia[-1] += part.inertia_kg_m2
            row.absolute[-1] += absolute
        else:
            row.add(name, part.inertia_kg_m2 + tip, _series(joint, spring), absolute=absolute)
        joint, of_end, tip = None, None, 0.0
    if end is not None and tip:
        row.add("output end", tip, _series(half, of_end))


def _series(one: complex | None, other: complex | None) -> complex:
    """Two springs one behind the other; None is rigid, and not both are."""
    springs = [k for k in (one, other) if k is not None]
    return 1 / sum(1 / k for k in springs)
