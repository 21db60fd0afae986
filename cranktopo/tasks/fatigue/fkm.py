"""Fatigue limit of a point by the FKM guideline for local stresses, through pyLife.

Source: Analytical Strength Assessment of Components (FKM guideline), chapter 4, not welded: support factor of
Stieler, roughness, mean stress at constant stress ratio. pyLife (Bosch Research, Apache-2) holds tables and
formulae.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from cranktopo.base.arrays import Array
from cranktopo.base.errors import packages_of
from cranktopo.design.schema import Scene
from cranktopo.tasks.fatigue.criterion import (
    LAYERS,
    TREATMENT,
    FatigueCriterion,
    LocalStress,
    PointSafety,
)

_HALVINGS = 60


@dataclass(frozen=True)
class FkmStrength:
    """Strength of material and component.

    Attributes:
        group: material group in pyLife's names: "Steel", "Forg_Steel", "CaseHard_Steel", "GJS", ...
        roughness_um: Rz of the surface.
        treatment_factor: K_V, credit for a treated surface.
    """

    ultimate_MPa: float
    group: str = "Steel"
    roughness_um: float = 6.3
    treatment_factor: float = 1.0


@dataclass(frozen=True)
class FkmResult:
    """Safety and what makes it; arrays of shape (n,).

    Attributes:
        safety: fatigue limit over amplitude; no safety factor of the guideline is applied.
        limit_MPa: amplitude that the point endures at its stress ratio.
        support_factor: n, from the stress gradient.
        design_factor: K_WK.
        mean_factor: K_AK.
    """

    safety: Array
    limit_MPa: Array
    reversed_MPa: float
    support_factor: Array
    design_factor: Array
    mean_factor: Array


def fkm(stress: LocalStress, strength: FkmStrength) -> FkmResult:
    """Safety of points by the FKM guideline."""
    pd, rules = load_rules()
    count = len(stress.amplitude_MPa)
    group, kind = pd.Series([strength.group] * count), pd.Series(["normal"] * count)
    constants, shares = rules.get_material_constants(group, kind)
    ultimate = np.full(count, float(strength.ultimate_MPa))
    roughness = np.full(count, float(strength.roughness_um))
    plain, one = np.full(count, "None", dtype=object), np.ones(count)
    reversed_MPa = rules.reversed_mat_strength_chap4(ultimate, constants, shares, kind)
    rough = rules.rough_factor(ultimate, roughness, constants, shares, kind, plain)
    support = rules.stieler_support(constants, shares, kind, stress.gradient_per_mm, ultimate)
    notch = rules.kf_constant(group)
    design = rules.design_factor(support, notch, rough, strength.treatment_factor * one, one, one)
    mean = _mean_factor(rules, stress, rules.sm_sensitivity_chap4(ultimate, constants, shares, kind))
    limit = reversed_MPa / design * mean
    return FkmResult(
        limit / np.maximum(stress.amplitude_MPa, 1e-9 * limit),
        limit,
        float(reversed_MPa[0]),
        np.asarray(support),
        np.asarray(design),
        np.asarray(mean),
    )


def load_rules() -> tuple[Any, Any]:
    """Return pandas and the guideline's rules of pyLife, which takes its frames.

    Raises:
        CranktopoError: one of them is missing.
    """
    with packages_of("fatigue"):
        import pandas
        from pylife.strength.fkm_linear.fkm_functions import FkmLinearFunctions
    return pandas, FkmLinearFunctions()


def _mean_factor(rules: Any, stress: LocalStress, sensitivity: Array) -> Array:
    """Mean-stress factor K_AK at the stress ratio of each point."""
    amplitude = np.maximum(stress.amplitude_MPa, 1e-9)
    highest, lowest = stress.mean_MPa + amplitude, stress.mean_MPa - amplitude
    ratio = lowest / np.where(np.abs(highest) < 1e-12, 1e-12, highest)
    factor: Array = rules.sm_factor(ratio, sensitivity, stress.mean_MPa / amplitude)
    return np.asarray(factor)


def _strength(scene: Scene) -> FkmStrength:
    """Return the strength of a scene whose material is checked."""
    material, settings = scene.material, scene.fatigue
    return FkmStrength(
        material.ultimate_MPa or 0.0,
        material.fkm_group,
        settings.roughness_um,
        settings.surface_treatment_factor,
    )


def _point_safety(scene: Scene, stress: LocalStress) -> PointSafety:
    found = fkm(stress, _strength(scene))
    factors = {"n": found.support_factor, "K_WK": found.design_factor, "K_AK": found.mean_factor}
    share = np.minimum(found.mean_factor, 1.0)
    return PointSafety(found.safety, found.reversed_MPa / found.design_factor, share, factors)


def _haigh_limit_MPa(scene: Scene, strength_MPa: float, gradient_per_mm: float, mean_MPa: Array) -> Array:
    amplitude = np.full(mean_MPa.shape, strength_MPa)
    for _ in range(_HALVINGS):  # the limit holds at a constant stress ratio: iterate to the point on the line
        stress = LocalStress(amplitude, mean_MPa, np.full(mean_MPa.shape, gradient_per_mm))
        amplitude = (amplitude + fkm(stress, _strength(scene)).limit_MPa) / 2
    return amplitude


FKM = FatigueCriterion(
    "fkm",
    ("ultimate_MPa",),
    _point_safety,
    _haigh_limit_MPa,
    takes=(*TREATMENT, *LAYERS, "roughness_um", "spectrum"),
    load_packages=load_rules,
    title="the FKM guideline",
    asks=1.2,
    includes="roughness, survival of 97.5 %, mean stress, no size; FKM asks for 1.2 to 1.5 for steel, by "
    "consequence of failure and inspection",  # the guideline's table of j_F
)
