"""Mass, unbalance, inertia and couple of the whole crank in closed form, rods apart."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from cranktopo.base.units import density_kg_per_mm3
from cranktopo.bodies.crank_drillings import taken_at_journals, taken_beyond
from cranktopo.bodies.crank_ends import crank_end, main_journal_places_mm
from cranktopo.design.crank import Side
from cranktopo.design.crank_throws import throw_scenes
from cranktopo.design.halves import halves
from cranktopo.design.schema import Scene
from cranktopo.engine.balance.throw import splayed_mass, throw_balance
from cranktopo.throw.moments import Moments

_NOTHING = Moments(0.0, 0.0, 0.0, 0.0)
ROUNDING = 1e-12
"""Share of the sum of all magnitudes below which a sum of directed parts is rounding."""


def unless_rounding(value: complex, scale: float) -> complex:
    """Return a sum of directed parts; 0 where it is rounding of their magnitudes, in sum `scale`."""
    return value if abs(value) > ROUNDING * scale else 0j


@dataclass(frozen=True)
class EndMass:
    """Mass properties of one end of the crank; all 0 where it has none.

    Attributes:
        unbalance_kg_mm: real along throw 1, imaginary ahead of it in the sense of rotation.
        couple_kg_mm2: the same times its place, from the middle of the outer main journal toward the output.
    """

    mass_kg: float
    inertia_kg_mm2: float
    unbalance_kg_mm: complex
    couple_kg_mm2: complex


def end_mass(scene: Scene, side: Side) -> EndMass:
    """Return the mass properties of an end of the crank, the outer half of its main journal included."""
    density = density_kg_per_mm3(scene.material.density_kg_m3)
    pieces = crank_end(scene, side)
    moments = sum((piece.moments for piece in pieces), _NOTHING).times(density)
    first = complex(moments.first_y, moments.first_x)
    places = [place for piece in pieces for place in piece.z_mm] or [0.0]
    product = density * sum(piece.product for piece in pieces)
    most = math.sqrt(moments.volume * moments.polar)  # what all of it at its radius of gyration would have
    return EndMass(
        moments.volume,
        moments.polar,
        unless_rounding(first, most),
        unless_rounding(product - places[0] * first, most * np.ptp(places)),
    )


@dataclass(frozen=True)
class JournalMass:
    """Unbalance of what a crank has at a main journal beside its throws, and its moment about the journal.

    An end, less what drillings of throws take out beyond the middle of the journal. Both fixed in the shaft,
    real along throw 1; places along the crank count toward the output.
    """

    unbalance_kg_mm: complex
    couple_kg_mm2: complex


def journal_masses(scene: Scene) -> tuple[JournalMass, ...]:
    """Return what every main journal has beside the throws, from the free end."""
    density = density_kg_per_mm3(scene.material.density_kg_m3)
    found = [JournalMass(-density * one.first, -density * one.product) for one in taken_at_journals(scene)]
    for place, end in ((0, end_mass(scene, "free")), (-1, end_mass(scene, "output"))):
        taken = found[place]
        found[place] = JournalMass(
            end.unbalance_kg_mm + taken.unbalance_kg_mm, end.couple_kg_mm2 + taken.couple_kg_mm2
        )
    return tuple(found)


@dataclass(frozen=True)
class CrankMass:
    """Mass properties of the whole crank without rods, as drawn: throws, own main journals and ends.

    Attributes:
        unbalance_kg_mm, unbalance_deg: mass times radius of the centre of mass, and its direction from throw
            1 in the sense of rotation.
        couple_kg_mm2, couple_deg: sum of mass times place along the shaft times place across it, about the
            middle between the outer main journals, toward the output.
    """

    mass_kg: float
    free_end_kg: float
    output_end_kg: float
    inertia_kg_mm2: float
    unbalance_kg_mm: float
    unbalance_deg: float
    couple_kg_mm2: float
    couple_deg: float


def crank_mass(scene: Scene) -> CrankMass | None:
    """Return the mass properties of the whole crank; None without [crank] or an engine."""
    return None if scene.crank is None or scene.engine is None else drawn_crank_mass(scene)


def drawn_crank_mass(scene: Scene) -> CrankMass:
    """Return the mass properties of the crank as a drawing has it, by its throws alone without [crank].

    Raises:
        CranktopoError: the scene has no engine.
    """
    places, throws = np.array(main_journal_places_mm(scene)), throw_scenes(scene)
    middle = places[-1] / 2
    along = np.exp(1j * np.radians(scene.shaft_angles_deg))
    balances = [throw_balance(throw) for throw in throws]
    turned = [splayed_mass(throw) for throw in throws]
    first = along * [one.throw for one in turned]
    planes = places[:-1] + [halves(throw)[0].pitch_mm / 2 for throw in throws] - middle
    product = (first * planes).sum() + (along * [one.throw_couple for one in turned]).sum()
    free, output = end_mass(scene, "free"), end_mass(scene, "output")
    beside = list(zip(journal_masses(scene), places - middle, strict=True))
    product += sum(one.couple_kg_mm2 + z * one.unbalance_kg_mm for one, z in beside)
    taken, density = taken_beyond(scene), density_kg_per_mm3(scene.material.density_kg_m3)
    total = first.sum() + sum(one.unbalance_kg_mm for one, _ in beside)
    scale = np.abs(first).sum() + sum(abs(one.unbalance_kg_mm) for one, _ in beside)
    return CrankMass(
        mass_kg=sum(b.mass_kg for b in balances) + beyond_throws_kg(scene),
        free_end_kg=free.mass_kg,
        output_end_kg=output.mass_kg,
        inertia_kg_mm2=sum(b.inertia_kg_mm2 for b in balances)
        + free.inertia_kg_mm2
        + output.inertia_kg_mm2
        - density * taken.polar,
        **_polar("unbalance_kg_mm", "unbalance_deg", complex(total), scale),
        **_polar("couple_kg_mm2", "couple_deg", complex(product), scale * places[-1]),
    )


def beyond_throws_kg(scene: Scene) -> float:
    """Return the mass of a crank beside its throws: its ends, less what drillings take beyond their throw."""
    ends = end_mass(scene, "free").mass_kg + end_mass(scene, "output").mass_kg
    return ends - density_kg_per_mm3(scene.material.density_kg_m3) * taken_beyond(scene).volume


def _polar(size: str, direction: str, value: complex, scale: float) -> dict[str, float]:
    """Magnitude and direction by their names."""
    value = unless_rounding(value, scale)
    return {size: abs(value), direction: float(round(np.degrees(np.angle(value)) % 360.0, 9) % 360.0)}
