"""Balancer shafts (Lanchester): unbalance, phase and place, and what they leave free.

A shaft of order n that turns with the crank takes the forward part of the ellipse of its order, one that
turns against it the backward part; a pair takes both.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from cranktopo.base.units import MM_PER_M, W_PER_KW, angular_speed_rad_s
from cranktopo.design.arrangement import BalancerShaft, Gear
from cranktopo.engine.balance.free_forces import ForceEllipse, FreeForce, direction_deg

_ORDERS: tuple[Literal[1, 2], ...] = (1, 2)
_TURNS: tuple[Literal["with", "against"], ...] = ("with", "against")


@dataclass(frozen=True)
class GearForces:
    """Forces between a gear and its mate: around the shaft, toward its axis, along it."""

    tangential_N: float
    radial_N: float
    axial_N: float


@dataclass(frozen=True)
class SizedShaft:
    """A balancer shaft with all that the scene leaves open; not `in_scene` where the engine would need it.

    Attributes:
        unbalance_kg_mm: mass times radius of each of its masses.
        phase_deg: direction of its mass, of two that nearer to the takeoff, at firing top dead centre of the
            cylinder that fires first.
        z_mm: place of the mass of a shaft that balances a force, from the middle of the shaft.
        distance_mm: of the two masses of a shaft that balances a moment.
        force_N: centrifugal force of each mass.
        gear: forces of the gear that drives it; None where the scene has none.
    """

    order: int
    turns: str
    balances: str
    unbalance_kg_mm: float
    phase_deg: float
    z_mm: float
    distance_mm: float
    force_N: float
    in_scene: bool
    gear: GearForces | None = None


def size_shafts(
    shafts: Sequence[BalancerShaft], free: Sequence[FreeForce], w2: float
) -> tuple[tuple[SizedShaft, ...], tuple[FreeForce, ...]]:
    """Return the shafts of a scene with all that they leave open, and what remains free by order.

    Shafts whose unbalance and phase are given count first, then those against forces, then those against
    moments: each of the latter two takes what the ones before leave. `w2` is the crank's speed squared, 1/s2.
    """
    left = {force.order: force for force in free}
    sized: dict[int, SizedShaft] = {}
    for index in sorted(range(len(shafts)), key=lambda i: _turn_of(shafts[i])):
        shaft = shafts[index]
        sized[index], effect = _size(shaft, left[shaft.order], w2, in_scene=True)
        left[shaft.order] += effect
    return tuple(sized[index] for index in range(len(shafts))), tuple(left.values())


def needed_shafts(free: Sequence[FreeForce], w2: float, length_mm: float) -> tuple[SizedShaft, ...]:
    """Return the shafts that leave nothing free in the first two orders, masses of a couple so far apart."""
    found = []
    for order in _ORDERS:
        left = next(force for force in free if force.order == order)
        for turns in _TURNS:
            against_force = BalancerShaft(order=order, turns=turns)
            against_moment = BalancerShaft(order=order, turns=turns, balances="moment", distance_mm=length_mm)
            for shaft in (against_force, against_moment):
                sized, effect = _size(shaft, left, w2, in_scene=False)
                if sized.unbalance_kg_mm:
                    found.append(sized)
                    left += effect
    return tuple(found)


def weight_force_N(unbalance_kg_mm: float, speed_rpm: float) -> float:
    """Return the centrifugal force of a mass on a shaft that turns at a speed."""
    return unbalance_kg_mm / MM_PER_M * angular_speed_rad_s(speed_rpm) ** 2


def gear_forces(gear: Gear, speed_rad_s: float) -> GearForces:
    """Return the forces of a helical gear whose shaft turns at a speed.

    T / r around the shaft, times tan(helix) along it, times tan(pressure) / cos(helix) toward its axis.
    """
    helix, pressure = math.radians(gear.helix_deg), math.radians(gear.pressure_deg)
    tangential = gear.power_kW * W_PER_KW / speed_rad_s / (gear.pitch_radius_mm / MM_PER_M)
    return GearForces(
        tangential, tangential * math.tan(pressure) / math.cos(helix), tangential * math.tan(helix)
    )


def _turn_of(shaft: BalancerShaft) -> int:
    fixed = shaft.unbalance_kg_mm is not None and shaft.phase_deg is not None
    return 0 if fixed else 1 if shaft.balances == "force" else 2


def _size(
    shaft: BalancerShaft, free: FreeForce, w2: float, *, in_scene: bool
) -> tuple[SizedShaft, FreeForce]:
    """Return the shaft with what it leaves open, and the force and moment that it adds."""
    newton = shaft.order**2 * w2 / MM_PER_M
    force, moment = (_part(vector, shaft) for vector in (free.force, free.moment))
    distance = shaft.distance_mm or 0.0
    required_N = -moment / (distance / MM_PER_M) if shaft.balances == "moment" else -force
    amount = _amount(shaft, required_N / newton if newton else 0j)
    place = 0.0
    if shaft.balances == "force":
        place = _place_mm(force, moment) if shaft.z_mm is None else shaft.z_mm
    pull = amount * newton
    arm = (distance or place) / MM_PER_M
    effect = FreeForce(
        shaft.order, _ellipse(0j if shaft.balances == "moment" else pull, shaft), _ellipse(pull * arm, shaft)
    )
    sized = SizedShaft(
        shaft.order,
        shaft.turns,
        shaft.balances,
        abs(amount),
        direction_deg(amount),
        place,
        distance,
        abs(pull),
        in_scene,
        None if shaft.gear is None else gear_forces(shaft.gear, shaft.order * math.sqrt(w2)),
    )
    return sized, effect


def _amount(shaft: BalancerShaft, required_kg_mm: complex) -> complex:
    """Unbalance with its phase: as given, else as near to what is wanted as the given part allows."""
    if shaft.phase_deg is not None:
        direction = complex(np.exp(1j * np.radians(shaft.phase_deg)))
        size = shaft.unbalance_kg_mm
        return direction * (max((required_kg_mm * direction.conjugate()).real, 0.0) if size is None else size)
    if shaft.unbalance_kg_mm is not None:
        return shaft.unbalance_kg_mm * (required_kg_mm / abs(required_kg_mm) if required_kg_mm else 1.0 + 0j)
    return required_kg_mm


def _place_mm(force: complex, moment: complex) -> float:
    """Place along the shaft where a mass against the force takes most of the moment too."""
    return round((moment * force.conjugate()).real / abs(force) ** 2 * MM_PER_M, 9) if force else 0.0


def _part(vector: ForceEllipse, shaft: BalancerShaft) -> complex:
    return vector.forward if shaft.turns == "with" else vector.backward


def _ellipse(value: complex, shaft: BalancerShaft) -> ForceEllipse:
    return ForceEllipse(value, 0j) if shaft.turns == "with" else ForceEllipse(0j, value)
