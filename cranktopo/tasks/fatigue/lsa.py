"""Fatigue safety by local stress analysis, in the form printed in crankshaft theses.

Source: J. Voparil, Shape optimisation of aircraft engine crankshaft, Brno University of Technology, 2011,
after G. Hueck, L. Thrainer, W. Schuetz (VDEh report ABF 11) and E. Siebel, M. Stieler (VDI-Z 97, 1955). The
notch ratio beta/alpha is taken as printed: it exceeds 1 and multiplies the amplitude, against the support
effect that it was made for.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from cranktopo.base.arrays import Array
from cranktopo.design.schema import Scene
from cranktopo.tasks.fatigue.criterion import (
    LAYERS,
    TREATMENT,
    FatigueCriterion,
    LocalStress,
    PointSafety,
)

NEEDS = ("fatigue_tension_MPa", "fatigue_bending_MPa", "yield_MPa")
"""Keys of the material that the fully reversed strength of a point follows from."""
FACTORS = (*TREATMENT, "size_factor", "survival_factor", "specimen_diameter_mm")
"""Keys of `[fatigue]` that it follows from."""


@dataclass(frozen=True)
class LsaStrength:
    """Strength of material and component.

    Attributes:
        fatigue_tension_MPa, fatigue_bending_MPa: fully reversed strengths of the specimen.
        specimen_diameter_mm: of the bending specimen.
        treatment_factor: credit for a treated surface (1.3 for hardened fillets), or one for each point.
    """

    fatigue_tension_MPa: float
    fatigue_bending_MPa: float
    yield_MPa: float
    ultimate_MPa: float
    specimen_diameter_mm: float = 7.5
    size_factor: float = 0.89
    survival_factor: float = 0.75
    treatment_factor: float | Array = 1.0


@dataclass(frozen=True)
class LsaResult:
    """Safety and what makes it, each of shape (n,).

    Attributes:
        safety: 1 / (amplitude term + mean term).
        amplitude_term, mean_term: shares of the strength that amplitude and mean stress use up.
        support_factor: fG, from the stress gradient.
        notch_ratio: beta/alpha.
    """

    safety: Array
    amplitude_term: Array
    mean_term: Array
    support_factor: Array
    notch_ratio: Array
    strength_MPa: Array


def lsa(stress: LocalStress, strength: LsaStrength) -> LsaResult:
    """Safety by local stress analysis; a compressive mean stress adds no safety."""
    point, support, notch = point_strength_MPa(stress.gradient_per_mm, strength)
    amplitude = stress.amplitude_MPa / point
    mean = np.maximum(stress.mean_MPa, 0.0) / strength.ultimate_MPa
    return LsaResult(1 / np.maximum(amplitude + mean, 1e-12), amplitude, mean, support, notch, point)


def point_strength_MPa(gradient_per_mm: Array, strength: LsaStrength) -> tuple[Array, Array, Array]:
    """Return the fully reversed strength of points, their support factor and their notch ratio, (n,) each."""
    s, gradient = strength, gradient_per_mm
    ratio = s.fatigue_bending_MPa / s.fatigue_tension_MPa
    support = 1 + (ratio - 1) / (2 / s.specimen_diameter_mm) * gradient
    notch = 1 + np.sqrt(gradient) * 10 ** -(0.35 + s.yield_MPa / 810)
    reduced = s.fatigue_tension_MPa * s.size_factor * s.survival_factor * s.treatment_factor
    return reduced * support / notch, support, notch


def lsa_strength(scene: Scene) -> LsaStrength:
    """Return the strength for local stress analysis of a scene whose material is checked."""
    material, settings = scene.material, scene.fatigue
    return LsaStrength(
        material.fatigue_tension_MPa or 0.0,
        material.fatigue_bending_MPa or 0.0,
        material.yield_MPa or 0.0,
        material.ultimate_MPa or 0.0,
        settings.specimen_diameter_mm,
        settings.size_factor,
        settings.survival_factor,
        settings.surface_treatment_factor,
    )


def _point_safety(scene: Scene, stress: LocalStress) -> PointSafety:
    found = lsa(stress, lsa_strength(scene))
    factors = {"fG": found.support_factor, "beta_over_alpha": found.notch_ratio}
    return PointSafety(found.safety, found.strength_MPa, found.amplitude_term * found.safety, factors)


def _haigh_limit_MPa(scene: Scene, strength_MPa: float, gradient_per_mm: float, mean_MPa: Array) -> Array:
    ultimate = scene.material.ultimate_MPa or np.nan
    return np.asarray(strength_MPa * (1 - np.maximum(mean_MPa, 0.0) / ultimate))


LSA = FatigueCriterion(
    "lsa",
    (*NEEDS, "ultimate_MPa"),
    _point_safety,
    _haigh_limit_MPa,
    takes=(*FACTORS, *LAYERS, "spectrum", "scatter"),
    title="local stress analysis",
    includes="size and survival by factors, tensile mean stress, no roughness; names no least safety",
    line_of="Goodman",
)
