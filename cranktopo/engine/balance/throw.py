"""Mass, unbalance and inertia of a throw in closed form, and what counterweight it still needs.

Journals, bores and fillets are exact, the web and oil drillings to 1e-9. A fillet that reaches beyond the
web's edge is counted whole.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from cranktopo.base.arrays import Array
from cranktopo.base.units import density_kg_per_mm3
from cranktopo.bodies.volume import bolted_mass, counterweight_mass, web_moments
from cranktopo.design.halves import of_halves
from cranktopo.design.schema import Scene
from cranktopo.throw.drilling.moments import drilled
from cranktopo.throw.geometry import Journal
from cranktopo.throw.moments import Moments


@dataclass(frozen=True)
class ThrowBalance:
    """Mass properties of the throw between its two mid-journal planes, and its balance with the rod.

    Attributes:
        mass_kg: mass of the throw, kg.
        web_kg, second_web_kg: mass of each web with its counterweight, kg.
        journal_kg: mass of the main journal (both halves), kg.
        crankpin_kg: mass of the crankpin between the web faces, kg.
        throw_unbalance_kg_mm: mass times y of the throw's centre of mass, kg mm.
        lateral_unbalance_kg_mm: mass times x of the throw's centre of mass, kg mm.
        rotating_unbalance_kg_mm: with the rotating mass of the rods on the pin, kg mm.
        inertia_kg_mm2: inertia of the throw about the crank axis, kg mm2.
        rod_inertia_kg_mm2: what the rotating mass of the rod adds to it, kg mm2.
        web_kg_mm: unbalance of each web with its counterweight, first and second, kg mm.
        own_counterweights_kg: mass that its counterweight adds to each web, kg.
        own_counterweights_kg_mm: unbalance that its counterweight takes away from each web, kg mm.
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
    web_kg_mm: tuple[float, float]
    own_counterweights_kg: tuple[float, float]
    own_counterweights_kg_mm: tuple[float, float]

    @property
    def own_counterweight_kg_mm(self) -> float:
        """Unbalance that the counterweights of both webs take away, kg mm."""
        return sum(self.own_counterweights_kg_mm)

    @property
    def counterweight_kg_mm(self) -> float:
        """Mass times radius that counterweights of both webs need beside their own, kg mm.

        They balance the rotating masses; negative where their own are too heavy.
        """
        return self.rotating_unbalance_kg_mm


def throw_balance(scene: Scene) -> ThrowBalance:
    """Mass properties of the scene's throw with its own web; the rod counts when the scene has an engine.

    U = m_pin r + m_web,1 e_web,1 + m_web,2 e_web,2 + m_rod,rot r, with the fillets among them.
    """
    radius, (first, second) = scene.throw.radius_mm, of_halves(scene, _half)
    journal, crankpin = first.journal + second.journal, first.crankpin + second.crankpin
    fillets = first.fillets + second.fillets
    total = journal + crankpin + fillets + first.web + second.web
    rod_kg = scene.engine.rod_rotating_kg * scene.engine.rods_per_pin if scene.engine else 0.0
    own = first.counterweight, second.counterweight
    return ThrowBalance(
        mass_kg=total.volume,
        web_kg=first.web.volume,
        second_web_kg=second.web.volume,
        journal_kg=journal.volume,
        crankpin_kg=crankpin.volume,
        throw_unbalance_kg_mm=total.first_y,
        lateral_unbalance_kg_mm=total.first_x,
        rotating_unbalance_kg_mm=total.first_y + rod_kg * radius,
        inertia_kg_mm2=total.polar,
        rod_inertia_kg_mm2=rod_kg * radius**2,
        web_kg_mm=(first.web.first_y, second.web.first_y),
        own_counterweights_kg=(own[0].volume, own[1].volume),
        own_counterweights_kg_mm=(0.0 - own[0].first_y, 0.0 - own[1].first_y),
    )


@dataclass(frozen=True)
class _Half:
    """Mass moments of the parts of a half throw, kg and mm; its counterweight is part of the web."""

    web: Moments
    journal: Moments
    crankpin: Moments
    fillets: Moments
    counterweight: Moments


def _half(scene: Scene) -> _Half:
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
        counterweight=counterweight_mass(scene),
    )


def _cylinder(journal: Journal, y: float) -> Moments:
    """Moments of the hollow cylinder of a journal, its axis at (0, y)."""
    outer, bore = journal.radius_mm, journal.bore_radius_mm
    area = math.pi * (outer**2 - bore**2)
    own_polar = math.pi / 2 * (outer**4 - bore**4)
    return Moments(area, 0.0, area * y, own_polar + area * y**2).times(journal.length_mm)


def fillet_ring(journal: Journal) -> tuple[Array, Array, Array]:
    """Sections of a fillet ring for its integrals, mm: outer radius, height, distance from the web's face."""
    fillet = journal.fillet
    nodes, weights = np.polynomial.legendre.leggauss(32)
    angle = np.pi / 4 * (nodes + 1)
    # Along the arc the ring reaches from the journal to `edge`, over the axial step dz = axial sin(a) da.
    edge = journal.radius_mm + fillet.radial_mm * (1 - np.sin(angle))
    dz = fillet.axial_mm * np.sin(angle) * weights * np.pi / 4
    return edge, dz, fillet.axial_mm * (1 - np.cos(angle))


def _fillets(journal: Journal, y: float) -> Moments:
    """Moments of the two fillet rings of a journal: a corner less a quarter ellipse, revolved."""
    radius, (edge, dz, _) = journal.radius_mm, fillet_ring(journal)
    volume = 2 * float((math.pi * (edge**2 - radius**2) * dz).sum())
    own_polar = 2 * float((math.pi / 2 * (edge**4 - radius**4) * dz).sum())
    return Moments(volume, 0.0, volume * y, own_polar + volume * y**2)
