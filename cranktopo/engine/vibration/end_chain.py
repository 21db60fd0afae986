"""Ends of the crank in torsion: their spring to the tip, and their inertia between throw and tip."""

from __future__ import annotations

from dataclasses import dataclass

from cranktopo.base.units import MM2_PER_M2, MPA_PER_GPA, NMM_PER_NM, density_kg_per_mm3, number_text
from cranktopo.bodies.crank_ends import crank_end
from cranktopo.design.crank import Side
from cranktopo.design.schema import Scene

_AT_TIP: dict[Side, tuple[str, ...]] = {
    "free": ("pulley", "damper"),
    "output": ("flywheel", "driven", "propeller"),
}
"""Parts that turn with the tip of an end where they have no stiffness of their own."""
_SOFT = 0.3
"""Share of an end's twist from which one of its steps is named."""


@dataclass(frozen=True)
class EndChain:
    """An end of the crank as a spring with a part of its inertia at either side.

    Attributes:
        stiffness_Nm_per_rad: from the middle of the outer main journal to the outer face of the last step.
        inner_kg_m2, tip_kg_m2: its inertia, split where a static twist would have it by the lever rule.
        tip_by_before: derivative of the tip's part by the twist per torque before the end, kg m2 N m/rad.
    """

    stiffness_Nm_per_rad: float
    inner_kg_m2: float
    tip_kg_m2: float
    tip_by_before: float


def end_chain(scene: Scene, side: Side, before_rad_per_Nm: float) -> EndChain | None:
    """Return an end of the crank in torsion; None where the crank has none.

    Args:
        before_rad_per_Nm: twist per torque between the disk that takes the inner part and the middle of the
            outer main journal.
    """
    pieces = crank_end(scene, side)
    if not pieces:
        return None
    material = scene.material
    shear_MPa = material.E_GPa * MPA_PER_GPA / (2 * (1 + material.poisson))
    soft = [piece.twist_per_mm3 / shear_MPa * NMM_PER_NM for piece in pieces]
    whole = before_rad_per_Nm + sum(soft)
    density = density_kg_per_mm3(material.density_kg_m3)
    total = tip = 0.0
    at = before_rad_per_Nm
    for piece, own in zip(pieces, soft, strict=True):
        inertia = density * piece.moments.polar / MM2_PER_M2
        total, tip = total + inertia, tip + inertia * (at + own / 2) / whole
        at += own
    return EndChain(1 / sum(soft), total - tip, tip, (total - tip) / whole)


def tip_remarks(scene: Scene) -> list[str]:
    """Return which rotors sit at the tips of the crank's ends, and what twists most on the way to them."""
    found = []
    for side, rotors in _AT_TIP.items():
        end, chain = scene.crank.end_on(side) if scene.crank else None, end_chain(scene, side, 0.0)
        rotor = next((name for name in rotors if scene.shaft and getattr(scene.shaft, name)), None)
        if end is None or not end.step or chain is None or rotor is None or scene.shaft is None:
            continue
        own = rotor != "damper"  # whose stiffness is that of its ring
        if own and getattr(scene.shaft, rotor).stiffness_Nm_per_rad:
            continue  # it is that of the end
        journal, *twists = (piece.twist_per_mm3 for piece in crank_end(scene, side))
        softest = max(range(len(twists)), key=twists.__getitem__)
        share = twists[softest] / (journal + sum(twists))
        named = f", {100 * share:.0f} % of the twist in its {end.step[softest].kind}" if share > _SOFT else ""
        found.append(
            f"the {rotor} sits at the tip of the crank's {side} end: "
            f"{number_text(chain.stiffness_Nm_per_rad)} N m/rad from the outer journal{named}."
            + (f" shaft.{rotor}.stiffness_Nm_per_rad takes the place of that spring." if own else "")
        )
    return found
