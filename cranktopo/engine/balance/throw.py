"""Mass, unbalance, inertia and couple of a throw in closed form, and what counterweight it still needs.

Journals, bores and fillets are exact, the web and oil drillings to 1e-9. A fillet that reaches beyond the
web's edge is counted whole.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from cranktopo.base.arrays import Array
from cranktopo.base.quadrature import gauss_legendre
from cranktopo.base.units import density_kg_per_mm3
from cranktopo.bodies.volume import bolted_mass, counterweight_mass, web_moments
from cranktopo.design.balance_factor import balance_factor_percent, rods_kg_mm
from cranktopo.design.halves import difference, of_halves
from cranktopo.design.schema import Optimise, Scene
from cranktopo.throw.drilling.moments import drilled
from cranktopo.throw.journal import Journal
from cranktopo.throw.moments import Moments

_AS_NEEDED = 2e-3
"""Share of its counterweights to which a throw is balanced: what a radius in 0.01 mm leaves."""


@dataclass(frozen=True)
class ThrowBalance:
    """Mass properties of the throw between its two mid-journal planes, and its balance with the rod.

    Attributes:
        web_kg, second_web_kg: each web with its counterweight.
        journal_kg: both halves of the main journal.
        crankpin_kg: between the web faces.
        throw_unbalance_kg_mm, lateral_unbalance_kg_mm: mass times y and x of the throw's centre of mass.
        rotating_unbalance_kg_mm: with the rotating mass of the rods on the pin.
        inertia_kg_mm2: of the throw about the crank axis.
        rod_inertia_kg_mm2: what the rotating mass of the rod adds to it.
        counterweight_kg_mm: mass times radius that counterweights of both webs need beside their own for the
            rotating masses and the scene's share of the oscillating ones; negative where they are too heavy.
        balance_factor_percent: of the oscillating mass, what the throw as it is balances; None without any.
        web_kg_mm: unbalance of each web with its counterweight, first and second.
        own_counterweights_kg: mass that its counterweight adds to each web.
        own_counterweights_kg_mm: unbalance that its counterweight takes away from each web.
        bolted_kg: mass of what is bolted to each web or let in, of another material than the throw.
    """

    mass_kg: float
    web_kg: float
    second_web_kg: float
    journal_kg: float
    crankpin_kg: float
    throw_unbalance_kg_mm: float
    lateral_unbalance_kg_mm: float
    rotating_unbalance_kg_mm: float
    inertia_kg_mm2: float
    rod_inertia_kg_mm2: float
    counterweight_kg_mm: float
    balance_factor_percent: float | None
    web_kg_mm: tuple[float, float]
    own_counterweights_kg: tuple[float, float]
    own_counterweights_kg_mm: tuple[float, float]
    bolted_kg: tuple[float, float]

    @property
    def own_counterweight_kg_mm(self) -> float:
        """Unbalance that the counterweights of both webs take away, kg mm."""
        return sum(self.own_counterweights_kg_mm)


def is_as_needed(needed_kg_mm: float, own_kg_mm: float) -> bool:
    """Tell whether counterweights differ from what a throw needs by no more than a radius in 0.01 mm does."""
    return abs(needed_kg_mm) <= _AS_NEEDED * own_kg_mm


@lru_cache(maxsize=8)
def throw_balance(scene: Scene) -> ThrowBalance:
    """Return the mass properties of the scene's throw; the rod counts when the scene has an engine.

    U = m_pin r + m_web,1 e_web,1 + m_web,2 e_web,2 + m_rod,rot r, with the fillets among them.
    """
    radius, (first, second) = scene.throw.radius_mm, of_halves(scene, _half)
    journal, crankpin = first.journal + second.journal, first.crankpin + second.crankpin
    total = _total(first, second)
    rotating_rods, oscillating = rods_kg_mm(scene)
    rotating = total.first_y + rotating_rods
    share = scene.engine.arranged.balanced_share if scene.engine else 0.0
    own = of_halves(scene, _counterweight)
    return ThrowBalance(
        mass_kg=total.volume,
        web_kg=first.web.volume,
        second_web_kg=second.web.volume,
        journal_kg=journal.volume,
        crankpin_kg=crankpin.volume,
        throw_unbalance_kg_mm=total.first_y,
        lateral_unbalance_kg_mm=total.first_x,
        rotating_unbalance_kg_mm=rotating,
        inertia_kg_mm2=total.polar,
        rod_inertia_kg_mm2=rotating_rods * radius,
        counterweight_kg_mm=rotating + share * oscillating,
        balance_factor_percent=balance_factor_percent(scene, total.first_y),
        web_kg_mm=(first.web.first_y, second.web.first_y),
        own_counterweights_kg=(own[0].volume, own[1].volume),
        own_counterweights_kg_mm=(0.0 - own[0].first_y, 0.0 - own[1].first_y),
        bolted_kg=(first.bolted.volume, second.bolted.volume),
    )


def throw_factor_percent(scene: Scene) -> float | None:
    """Return the balance factor alone; what its counterweight adds to a web takes most of the time of all."""
    return balance_factor_percent(scene, _total(*of_halves(scene, _half)).first_y)


@dataclass(frozen=True)
class _Half:
    """Mass moments of the parts of a half throw, kg and mm; its counterweight is part of the web."""

    web: Moments
    journal: Moments
    crankpin: Moments
    fillets: Moments
    bolted: Moments


def _total(first: _Half, second: _Half) -> Moments:
    journal, crankpin = first.journal + second.journal, first.crankpin + second.crankpin
    return journal + crankpin + (first.fillets + second.fillets) + first.web + second.web


def _half(scene: Scene) -> _Half:
    return _half_alone(_alone(scene))


def _counterweight(scene: Scene) -> Moments:
    return _counterweight_alone(_alone(scene))


def _alone(scene: Scene) -> Scene:
    """Return the throw without what a plan changes: it asks for one with several engines and weights."""
    return scene.model_copy(update={"engine": None, "optimise": Optimise()})


@lru_cache(maxsize=8)
def _half_alone(scene: Scene) -> _Half:
    """Return the moments of the parts of a half throw."""
    throw, radius = scene.throw, scene.throw.radius_mm
    density = density_kg_per_mm3(scene.material.density_kg_m3)
    journal = _cylinder(throw.main_journal, 0.0).times(0.5) - drilled(scene, "main_journal")
    crankpin = _cylinder(throw.crankpin, radius).times(0.5) - drilled(scene, "crankpin")
    fillets = _fillets(throw.main_journal, 0.0) + _fillets(throw.crankpin, radius)
    return _Half(
        web=(web_moments(scene) - drilled(scene, "web")).times(density) + bolted_mass(scene),
        journal=journal.times(density),
        crankpin=crankpin.times(density),
        fillets=fillets.times(density / 2),
        bolted=bolted_mass(scene),
    )


@lru_cache(maxsize=8)
def _counterweight_alone(scene: Scene) -> Moments:
    return counterweight_mass(scene)


def _cylinder(journal: Journal, y: float) -> Moments:
    """Moments of the hollow cylinder of a journal, its axis at (0, y)."""
    outer, bore = journal.radius_mm, journal.bore_radius_mm
    area = math.pi * (outer**2 - bore**2)
    own_polar = math.pi / 2 * (outer**4 - bore**4)
    return Moments(area, 0.0, area * y, own_polar + area * y**2).times(journal.length_mm)


def _fillet_ring(journal: Journal) -> tuple[Array, Array, Array]:
    """Sections of a fillet ring for its integrals, mm: outer radius, height, distance from the web's face."""
    fillet = journal.fillet
    nodes, weights = gauss_legendre(32)
    turn = (np.pi / 2 - fillet.start_rad) / 2
    angle = fillet.start_rad + turn * (nodes + 1)
    # Along the arc the ring reaches from the journal to `edge`, over the axial step dz = axial sin(a) da.
    edge = journal.radius_mm + fillet.radial_mm * (1 - np.sin(angle))
    dz = fillet.axial_mm * np.sin(angle) * weights * turn
    return edge, dz, fillet.axial_mm * (1 - np.cos(angle)) - fillet.recess_mm


def _fillets(journal: Journal, y: float) -> Moments:
    """Moments of the two fillet rings of a journal: a corner less a quarter ellipse, revolved."""
    radius, (edge, dz, _) = journal.radius_mm, _fillet_ring(journal)
    volume = 2 * float((math.pi * (edge**2 - radius**2) * dz).sum())
    own_polar = 2 * float((math.pi / 2 * (edge**4 - radius**4) * dz).sum())
    return Moments(volume, 0.0, volume * y, own_polar + volume * y**2)


def product_of_inertia_kg_mm2(scene: Scene) -> complex:
    """Sum of mass times place along the shaft times place across it, about the plane of the cylinder.

    Real along the throw, imaginary toward +x; places count toward the second web. Rods have none. Where the
    halves are alike it is 0, and nothing is computed.
    """
    if not difference(scene):
        return 0j
    first, second = of_halves(scene, _half_product)
    return second - first


@dataclass(frozen=True)
class SplayedMass:
    """Unbalance of a throw with split pins and its moment about the middle of the pin, kg mm and kg mm2.

    Real along the middle of both half pins, imaginary ahead of it; with a straight pin that of the throw.

    Attributes:
        throw, throw_couple: of the throw alone, without its rods.
        rods, rods_couple: per kg on each of two half pins, at the places of their rods.
    """

    throw: complex
    throw_couple: complex
    rods: complex
    rods_couple: complex


def splayed_mass(scene: Scene) -> SplayedMass:
    """Return what the halves of a throw give, each turned with its part of the pin.

    U = U1 exp(-i s/2) + U2 exp(i s/2) with the splay s; the moments of both halves about the middle of the
    pin are opposite, so that C = C2 exp(i s/2) - C1 exp(-i s/2).
    """
    turns, products = _turns(scene), of_halves(scene, _half_product)
    radius, places = scene.throw.radius_mm, scene.rod_places_mm
    return SplayedMass(
        throw=splayed_throw_kg_mm(scene),
        throw_couple=complex(products[1] * turns[1] - products[0] * turns[0]),
        rods=complex(radius * (turns[0] + turns[1])),
        rods_couple=complex(radius * (places[0] * turns[0] + places[-1] * turns[1])),
    )


def splayed_throw_kg_mm(scene: Scene) -> complex:
    """Return the unbalance of `splayed_mass` alone; its moments take most of the time of all."""
    turns, unbalances = _turns(scene), of_halves(scene, _half_unbalance)
    return complex(unbalances[0] * turns[0] + unbalances[1] * turns[1])


def _turns(scene: Scene) -> tuple[complex, complex]:
    half = math.radians(scene.engine.pin_deg(1)) if scene.engine else 0.0
    return complex(np.exp(1j * half)), complex(np.exp(-1j * half))


@dataclass(frozen=True)
class TurningThrow:
    """Unbalance of a throw with its rods and its moment about the plane of the cylinder, as it turns.

    What counterweights balance of them has the share of the oscillating masses, as if on the pin.
    """

    unbalance_kg_mm: complex
    couple_kg_mm2: complex
    balanced_kg_mm: complex
    balanced_couple_kg_mm2: complex


def turning_throw(scene: Scene) -> TurningThrow:
    """Return what turns with a throw; of a split pin real along the middle of its halves."""
    engine, balance = scene.engine, throw_balance(scene)
    aside, couple = 1j * balance.lateral_unbalance_kg_mm, product_of_inertia_kg_mm2(scene)
    if engine is None or not engine.arranged.pin_splay_deg:
        with_rods, needed = balance.rotating_unbalance_kg_mm + aside, balance.counterweight_kg_mm + aside
        return TurningThrow(with_rods, couple, needed, couple)
    mass, kg = splayed_mass(scene), engine.rod_rotating_kg
    share = kg + engine.arranged.balanced_share * engine.reciprocating_kg
    return TurningThrow(
        mass.throw + kg * mass.rods,
        mass.throw_couple + kg * mass.rods_couple,
        mass.throw + share * mass.rods,
        mass.throw_couple + share * mass.rods_couple,
    )


def _half_unbalance(scene: Scene) -> complex:
    half = _half(scene)
    total = half.journal + half.crankpin + half.fillets + half.web
    return complex(total.first_y, total.first_x)


def _half_product(scene: Scene) -> complex:
    """Return what a half throw adds, its places counted from the mid-pin plane.

    Main journals are about the axis and add nothing but what is drilled out of them.
    """
    plane_mm, density = scene.pitch_mm / 2, density_kg_per_mm3(scene.material.density_kg_m3)
    web = (web_moments(scene, plane_mm) - drilled(scene, None, plane_mm)).times(density)
    web = web + bolted_mass(scene, plane_mm)
    return complex(web.first_y + density * _crankpin_mm5(scene), web.first_x)


def _crankpin_mm5(scene: Scene) -> float:
    """Volume times both distances of half of the crankpin with its fillet, drillings not taken out."""
    pin = scene.throw.crankpin
    half_mm, radius = pin.length_mm / 2, pin.radius_mm
    edge, height, from_face = _fillet_ring(pin)
    cylinder = math.pi * (radius**2 - pin.bore_radius_mm**2) * half_mm**2 / 2
    fillet = float((math.pi * (edge**2 - radius**2) * height * (half_mm - from_face)).sum())
    return scene.throw.radius_mm * (cylinder + fillet)
