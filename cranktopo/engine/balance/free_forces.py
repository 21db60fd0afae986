"""Free forces and moments of a whole engine by order, about the middle of the shaft, and counterweights.

A force across the shaft is a complex number, real along the engine's plane of symmetry, imaginary ahead of it
in the sense of rotation. Each order runs around an ellipse: one part turns with the crank, one against it.
Masses are those of a rigid engine at constant speed; a rod counts as two masses, one at each end.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from cranktopo.base.arrays import Array, Complex, Index
from cranktopo.base.units import MM_PER_M, angular_speed_rad_s
from cranktopo.design.crank_throws import throw_scenes
from cranktopo.design.schema import Scene
from cranktopo.engine.analysis import engine_of
from cranktopo.engine.balance.crank import ROUNDING, JournalMass, journal_masses, unless_rounding
from cranktopo.engine.balance.layout import EngineLayout, engine_layout, unit_vectors
from cranktopo.engine.balance.throw import throw_balance, turning_throw
from cranktopo.engine.kinematics import acceleration_harmonics

ORDERS = (1, 2, 4, 6)
"""Orders of the oscillating masses; odd ones above 1 do not exist, those above 6 are below lam^7."""


@dataclass(frozen=True)
class ForceEllipse:
    """A vector across the shaft that turns: forward exp(i n a) + backward exp(-i n a), a the crank angle."""

    forward: complex = 0j
    backward: complex = 0j

    def __add__(self, other: ForceEllipse) -> ForceEllipse:
        return ForceEllipse(
            _sum(np.array([self.forward, other.forward])), _sum(np.array([self.backward, other.backward]))
        )

    @property
    def largest(self) -> float:
        """Its largest magnitude over a turn."""
        return abs(self.forward) + abs(self.backward)

    @property
    def smallest(self) -> float:
        """Its smallest magnitude over a turn."""
        return abs(abs(self.forward) - abs(self.backward))

    @property
    def axis_deg(self) -> float | None:
        """Direction in which it is largest, deg in [0, 180); None where it is a circle or nothing."""
        if self.smallest >= (1 - 1e-9) * self.largest:
            return None
        twice = np.degrees(np.angle(self.forward) + np.angle(self.backward))
        return float(round(twice / 2 % 180.0, 9) % 180.0)

    def over_turn(self, order: int, angle_deg: Array) -> Complex:
        """Its values at crank angles."""
        turning = unit_vectors(order * angle_deg)
        return np.asarray(self.forward * turning + self.backward * turning.conj())


@dataclass(frozen=True)
class FreeForce:
    """Free force and moment of one order: force, N, and moment about the middle of the shaft, N m.

    The moment is the sum of place times force, so its direction is that of the force at the takeoff end.
    """

    order: int
    force: ForceEllipse
    moment: ForceEllipse

    def __add__(self, other: FreeForce) -> FreeForce:
        return FreeForce(self.order, self.force + other.force, self.moment + other.moment)


@dataclass(frozen=True)
class NeededCounterweight:
    """Unbalance that a web needs beyond what it has, kg mm and deg from the first throw, fixed in the shaft.

    Attributes:
        web_kg_mm: unbalance of the web alone as it is, along its throw.
        own_kg_mm: what its counterweight in the scene takes already.
        unbalance_kg_mm, deg: so that each throw is balanced on its own, its couple included. Balanced are the
            rotating masses and, as if it turned with the crankpin, the share of the oscillating ones.
        shaft_unbalance_kg_mm, shaft_deg: the least (sum of squares) with which the same masses leave the
            whole shaft without free force and moment, whatever it bends.
    """

    web: int
    throw: int
    web_kg_mm: float
    own_kg_mm: float
    unbalance_kg_mm: float
    deg: float
    shaft_unbalance_kg_mm: float
    shaft_deg: float


@dataclass(frozen=True)
class TurningMasses:
    """Masses that turn with the shaft and that move with the pistons.

    What is of a throw is one value where all throws are alike, else one for each.

    Attributes:
        throw_kg_mm: rotating unbalance of each throw with its rods, real along the throw.
        couple_kg_mm2: its moment about the plane of the cylinder, toward the takeoff; 0 with equal halves and
            a straight pin.
        web_kg_mm: unbalance of either web of a throw with its counterweight.
        own_kg_mm: unbalance that the counterweight of either web takes already.
        rod_kg_mm: mass of one rod that turns, times the throw radius.
        piston_kg_mm: oscillating mass of one cylinder times the throw radius.
        counterweight_kg_mm, counterweight_couple_kg_mm2: what both counterweights of a throw balance, real
            along the throw.
        harmonics: Fourier coefficients of the pistons' acceleration for `ORDERS`.
        w2: angular speed squared, 1/s2.
        journals: what each main journal has beside the throws, from the free end; counterweights leave it as
            it is.
    """

    layout: EngineLayout
    throw_kg_mm: complex | Complex
    couple_kg_mm2: complex | Complex
    web_kg_mm: tuple[float | Array, float | Array]
    own_kg_mm: tuple[float | Array, float | Array]
    rod_kg_mm: float
    piston_kg_mm: float
    counterweight_kg_mm: complex | Complex
    counterweight_couple_kg_mm2: complex | Complex
    harmonics: Array
    w2: float
    journals: tuple[JournalMass, ...]

    @property
    def beside_throws_kg_mm(self) -> tuple[complex, complex]:
        """Unbalance of all that journals have beside throws, and its moment about the middle, kg mm2.

        Fixed in the shaft, real along throw 1.
        """
        pairs = list(zip(self.journals, self.layout.journal_z_mm.tolist(), strict=True))
        moment = sum((one.couple_kg_mm2 + z * one.unbalance_kg_mm for one, z in pairs), 0j)
        return sum((one.unbalance_kg_mm for one, _ in pairs), 0j), moment

    def on_webs(self, force: Any, couple: Any) -> tuple[Any, Any]:
        """Return what both webs of a throw carry of a force in its cylinder's plane and a couple about it."""
        near, far = self.layout.web_places_mm
        apart = far - near
        return far / apart * force - couple / apart, -near / apart * force + couple / apart


def turning_masses(scene: Scene) -> TurningMasses:
    """Return the masses of a scene's engine at its speed; raises CranktopoError where there is no engine."""
    engine, radius, throws = engine_of(scene), scene.throw.radius_mm, throw_scenes(scene)
    alike = all(throw is throws[0] for throw in throws)
    different = throws[:1] if alike else throws
    balances = [throw_balance(throw) for throw in different]
    turning = [turning_throw(throw) for throw in different]

    def of_throws(values: Iterable[Any]) -> Any:
        found = list(values)
        return found[0] if alike else np.array(found)

    def of_webs(name: str) -> tuple[Any, Any]:
        near, far = (of_throws(getattr(balance, name)[web] for balance in balances) for web in (0, 1))
        return near, far

    return TurningMasses(
        layout=engine_layout(scene),
        throw_kg_mm=of_throws(one.unbalance_kg_mm for one in turning),
        couple_kg_mm2=of_throws(one.couple_kg_mm2 for one in turning),
        web_kg_mm=of_webs("web_kg_mm"),
        own_kg_mm=of_webs("own_counterweights_kg_mm"),
        rod_kg_mm=engine.rod_rotating_kg * radius,
        piston_kg_mm=engine.reciprocating_kg * radius,
        counterweight_kg_mm=of_throws(one.balanced_kg_mm for one in turning),
        counterweight_couple_kg_mm2=of_throws(one.balanced_couple_kg_mm2 for one in turning),
        harmonics=acceleration_harmonics(radius, engine.rod_length_mm, ORDERS),
        w2=angular_speed_rad_s(engine.speed_rpm) ** 2,
        journals=journal_masses(scene),
    )


def rotating_force(masses: TurningMasses, counterweighted: bool = False) -> FreeForce:
    """Free force and moment of all that turns with the shaft, with its counterweights or as it is."""
    throw = masses.throw_kg_mm - (masses.counterweight_kg_mm if counterweighted else 0.0)
    parts = unit_vectors(masses.layout.throw_deg) * throw * masses.w2 / MM_PER_M
    found = _free_force(1, parts, np.zeros_like(parts), masses.layout.throw_z_mm) + _force_beside_throws(
        masses
    )
    return found + _couple_of_product(masses, counterweighted)


def _force_beside_throws(masses: TurningMasses) -> FreeForce:
    """Return what is free of ends and drillings beyond throws; counterweights of throws do not take it."""
    turned = complex(unit_vectors(masses.layout.throw_deg[:1])[0]) * masses.w2 / MM_PER_M
    force, moment = masses.beside_throws_kg_mm
    return FreeForce(1, ForceEllipse(turned * force), ForceEllipse(turned * moment / MM_PER_M))


def _couple_of_product(masses: TurningMasses, counterweighted: bool) -> FreeForce:
    """Return the couples of all throws, or what their counterweights leave of them."""
    left = masses.couple_kg_mm2 - (masses.counterweight_couple_kg_mm2 if counterweighted else 0.0)
    couples = unit_vectors(masses.layout.throw_deg) * left * masses.w2 / MM_PER_M**2
    return FreeForce(1, ForceEllipse(), ForceEllipse(_sum(couples)))


def oscillating_force(masses: TurningMasses, order: int) -> FreeForce:
    """Free force and moment of all pistons of one order: m r w^2 c_n cos(n a) along each cylinder.

    With a = crank angle - g, g by which the throw is behind its cylinder, and the cylinder's axis at the
    angle b, half of it is exp(i (b - n g)) with the crank and half exp(i (b + n g)) against it.
    """
    layout = masses.layout
    axis = unit_vectors(layout.axis_deg)
    behind = layout.axis_deg - layout.crank_deg
    half = masses.piston_kg_mm * masses.w2 / MM_PER_M * masses.harmonics[ORDERS.index(order)] / 2
    turned = unit_vectors(order * behind)
    return _free_force(order, half * axis * turned.conj(), half * axis * turned, layout.cylinder_z_mm)


def free_forces(masses: TurningMasses, counterweighted: bool = False) -> tuple[FreeForce, ...]:
    """Free force and moment by order, rotating and oscillating masses together."""
    first, *others = (oscillating_force(masses, order) for order in ORDERS)
    return (first + rotating_force(masses, counterweighted), *others)


def counterweights(masses: TurningMasses) -> tuple[NeededCounterweight, ...]:
    """Return what every web needs, from the free end.

    For the shaft, u = a + b z at each web, z its place from the middle of all webs, is the least of all that
    leave neither force nor moment of the rotating masses and the share of the oscillating ones.
    """
    layout, along = masses.layout, unit_vectors(masses.layout.throw_angle_deg)
    throw, couple = -masses.counterweight_kg_mm * along, -masses.counterweight_couple_kg_mm2 * along
    on_webs = masses.on_webs(-masses.counterweight_kg_mm, -masses.counterweight_couple_kg_mm2)
    own = (along[:, None] * np.stack(on_webs, axis=-1)).ravel()
    middle = _sum(layout.web_z_mm.astype(np.complex128)).real / len(own)
    z = layout.web_z_mm - middle
    beside, of_beside = masses.beside_throws_kg_mm
    moment = _sum(np.array([_sum(throw * (layout.throw_z_mm - middle)), _sum(couple)]))
    moment -= of_beside - middle * beside
    shaft = (_sum(throw) - beside) / len(z) + moment / (z**2).sum() * z
    web_kg_mm, own_kg_mm = (
        np.broadcast_to(np.stack(of_webs, axis=-1), (len(along), 2)).ravel()
        for of_webs in (masses.web_kg_mm, masses.own_kg_mm)
    )
    return tuple(
        NeededCounterweight(
            index + 1,
            index // 2 + 1,
            float(web_kg_mm[index]),
            float(own_kg_mm[index]),
            *_polar(own[index]),
            *_polar(shaft[index]),
        )
        for index in range(len(z))
    )


@dataclass(frozen=True)
class InnerMoment:
    """Largest bending moment inside the shaft by what turns with it, its place and direction in the shaft."""

    moment_Nm: float
    z_mm: float
    deg: float


def inner_moment(masses: TurningMasses, weights: Sequence[NeededCounterweight] = ()) -> InnerMoment:
    """Return the largest inner bending moment of the shaft as a beam on its two outer main bearings.

    The ends of the crank beyond them, and what drillings take out beyond their throw, are left out.

    Where the shaft is balanced as a whole these carry nothing and it is the textbook's inner moment.
    Rods pull in the planes of their cylinders, crankpins in the middle between these, webs with their
    counterweights in their own middles, these with the couple of their throw, so that the moment is largest
    at one of them. `weights` come on top.
    """
    layout, per_kg_mm = masses.layout, masses.w2 / MM_PER_M
    z = np.concatenate([layout.throw_z_mm, layout.cylinder_z_mm, layout.web_z_mm])
    along = unit_vectors(layout.throw_angle_deg)
    throw_of = np.array(layout.throw_of)
    ends = unit_vectors(layout.pin_deg[[0, -1]])
    near, far = (web * end for web, end in zip(masses.web_kg_mm, ends, strict=True))
    rods = masses.rod_kg_mm * unit_vectors(layout.pin_deg)
    of_rods = _by_throw(rods * (layout.cylinder_z_mm - layout.throw_z_mm[throw_of]), throw_of)
    couple = near * layout.web_places_mm[0] + far * layout.web_places_mm[1] + of_rods
    pair = masses.on_webs(0j, masses.couple_kg_mm2 - couple)
    webs = (along[:, None] * (np.stack(pair, axis=-1) + np.stack([near, far], axis=-1))).ravel()
    for weight in weights:
        webs[weight.web - 1] += weight.unbalance_kg_mm * np.exp(1j * np.radians(weight.deg))
    pins = (masses.throw_kg_mm - near - far - _by_throw(rods, throw_of)) * along
    force = np.concatenate([pins, rods * along[throw_of], webs]) * per_kg_mm
    first = layout.bearing_z_mm[0]
    reaction = (force * (layout.bearing_z_mm[-1] - z)).sum() / layout.length_mm
    arms = np.maximum(z[:, None] - z[None, :], 0.0)
    moment = (reaction * (z - first) - arms @ force) / MM_PER_M
    scale = float(np.abs(force).sum()) * layout.length_mm / MM_PER_M
    size = np.where(np.abs(moment) > ROUNDING * scale, np.abs(moment), 0.0)
    worst = int(np.flatnonzero(size >= size.max() * (1 - 1e-9))[0])
    return InnerMoment(float(size[worst]), float(z[worst]), _polar(moment[worst] if size[worst] else 0j)[1])


def _by_throw(of_cylinders: Complex, throw_of: Index) -> Complex:
    """Return the sum of the cylinders of each throw."""
    return np.bincount(throw_of, of_cylinders.real) + 1j * np.bincount(throw_of, of_cylinders.imag)


def direction_deg(value: complex) -> float:
    """Direction of a vector across the shaft, deg in [0, 360); 0 of nothing."""
    return float(round(np.degrees(np.angle(value)) % 360.0, 9) % 360.0) if value else 0.0


def _free_force(order: int, forward: Complex, backward: Complex, z_mm: Array) -> FreeForce:
    return FreeForce(
        order,
        ForceEllipse(_sum(forward), _sum(backward)),
        ForceEllipse(_sum(forward * z_mm) / MM_PER_M, _sum(backward * z_mm) / MM_PER_M),
    )


def _sum(parts: Complex) -> complex:
    """Return the sum, 0 where only rounding is left of it."""
    return unless_rounding(complex(parts.sum()), float(np.abs(parts).sum()))


def _polar(value: complex) -> tuple[float, float]:
    """Magnitude and angle, deg in [0, 360); 0 where there is nothing."""
    return float(abs(value)), direction_deg(value)
