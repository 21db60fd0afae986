"""A fatigue method of stress histories: its needs, the severity of a history, and what bounds that."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

from cranktopo.base.arrays import Array
from cranktopo.base.errors import CranktopoError, invalid
from cranktopo.design.schema import Scene
from cranktopo.tasks.fatigue.criterion import SafetyMethod

VON_MISES_RATIO = 1 / math.sqrt(3)
"""Strength in torsion over that in bending of a material that gives neither: by the von Mises stress."""


@dataclass(frozen=True)
class HistoryBounds:
    """Bounds of the stresses of points over their load states; arrays of shape (n,).

    Attributes:
        shear_MPa: radius of the smallest circle around the shear stress on any plane, and largest shear
            stress after the centre of the smallest hypersphere around the deviators is taken off.
        normal_MPa: largest normal stress on any plane.
        hydrostatic_MPa: largest hydrostatic stress.
    """

    shear_MPa: Array
    normal_MPa: Array
    hydrostatic_MPa: Array


@dataclass(frozen=True)
class Severity:
    """Severity of the stress histories of points; arrays of shape (n,).

    Attributes:
        equivalent_MPa: amplitude of the fully reversed tension that is as severe.
        shear_share: fraction of it that the shear makes.
        factors: by their names in JSON.
    """

    equivalent_MPa: Array
    shear_share: Array
    factors: dict[str, Array]


@dataclass(frozen=True)
class PlaneDiagram:
    """Shear stress over normal or hydrostatic stress of one point through its load states.

    Attributes:
        abscissa: what is on the axis of `normal_MPa`.
        normal_MPa, shear_MPa: in each state, shape (states,).
        slope: MPa of shear that a MPa of normal stress costs.
        limit_MPa: shear that the point endures at no normal stress.
    """

    abscissa: str
    normal_MPa: Array
    shear_MPa: Array
    slope: float
    limit_MPa: float


@dataclass(frozen=True)
class PlaneCriterion(SafetyMethod):
    """A method that judges points by their stress tensors in all load states.

    Its severity is proportional to the stresses, so that the safety is the strength over it.

    Attributes:
        severity: of histories (n, states, 6) of points of a scene whose material is checked.
        at_most_MPa: equivalent stress that points within bounds do not exceed.
        diagram: of one history (states, 6) of a point with a fully reversed strength in tension, MPa.
        remainder: what makes the share of the equivalent stress that is not of the shear, in words.
    """

    severity: Callable[[Scene, Array], Severity]
    at_most_MPa: Callable[[Scene, HistoryBounds], Array]
    diagram: Callable[[Scene, Array, float], PlaneDiagram]
    remainder: str


def torsion_ratio(scene: Scene) -> float:
    """Return the strength in torsion over that in bending, of specimens with the same gradient."""
    material = scene.material
    if material.fatigue_torsion_MPa is None or material.fatigue_bending_MPa is None:
        return VON_MISES_RATIO
    return material.fatigue_torsion_MPa / material.fatigue_bending_MPa


def check_scene(scene: Scene) -> None:
    """Check that normal stress counts against a material, and not for it or alone; and its fillets.

    Raises:
        CranktopoError: the strength in torsion is below half of that in bending, or not below it; or fillets
            that are hardened over their depth, below which these criteria do not look.
    """
    if scene.fatigue.hardened:
        raise CranktopoError(
            f"{scene.name}: fatigue.hardening: criteria of critical planes look at the surface alone.",
            hint="Take --method lsa, fkm or m53, or give surface_treatment_factor with its source.",
        )
    if 0.5 <= torsion_ratio(scene) < 1.0:
        return
    bending = scene.material.fatigue_bending_MPa or 0.0
    raise invalid(
        f"{scene.name}: material.fatigue_torsion_MPa",
        scene.material.fatigue_torsion_MPa,
        f"must be at least half of fatigue_bending_MPa and below it, {bending / 2:g} to {bending:g} MPa, for "
        "criteria of shear and normal stress",
        "Take --method lsa or fkm for such a material.",
    )
