"""Surface-treated fillets by the crankshaft rule: strength of surface and transition, stress at either.

Source: IACS UR M53 (Rev. 5, 2023), Appendix V, Guidance for calculation of surface treated fillets and oil
bore outlets, sections 3 (stress), 4 (induction hardening) and 5 (nitriding).
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from cranktopo.tasks.throw_fatigue.hardened_layer import LOSS_PER_MPA, HardenedLayer
from cranktopo.tasks.throw_fatigue.m53 import (
    ConcentrationFactors,
    Dimensions,
    FilletCheck,
    Nominal,
    RuleHardening,
)

_NITRIDED_MPA = 450.0
"""Strength of a nitrided surface of 600 HV or more, residual stress included: section 5 (1) (B)."""
_ARTIFICIAL = 1.2
"""Depth of the artificial transition point over the nitriding depth: section 5 (1) (E)."""


@dataclass(frozen=True)
class FilletStress:
    """Alternating stresses of a fillet, and what their fall depends on.

    Attributes:
        bending_MPa: nominal times its factors, shear of the journal fillet included.
        torsion_MPa: nominal times its factor.
        bending_factor, torsion_factor: at the surface.
        radius_mm, diameter_mm: R_H and D, or R_G and D_G.
        web_mm: sqrt(W^2 + S^2).
    """

    bending_MPa: float
    torsion_MPa: float
    bending_factor: float
    torsion_factor: float
    radius_mm: float
    diameter_mm: float
    web_mm: float

    def equivalent_MPa(self, added_MPa: float, depth_mm: float = 0.0) -> float:
        """Return the equivalent alternating stress at a depth; additional bending stress does not fall."""
        bending = self.bending_MPa * self._bending_share(depth_mm) + added_MPa
        return math.sqrt(bending**2 + 3 * (self.torsion_MPa * self._torsion_share(depth_mm)) ** 2)

    def _bending_share(self, t: float) -> float:
        return local_bending(self.bending_factor, self.radius_mm, self.web_mm, t) / self.bending_factor

    def _torsion_share(self, t: float) -> float:
        return local_torsion(self.torsion_factor, self.radius_mm, self.diameter_mm, t) / self.torsion_factor


def local_bending(factor: float, radius_mm: float, web_mm: float, t: float) -> float:
    """Return alpha_B-local at depth t: section 3 (1) (D); not below 0."""
    nominal = 1 - (2 * t / web_mm) ** (0.6 / math.sqrt(factor))
    return max((factor - 1) * math.exp(-2 * t / radius_mm) + nominal, 0.0)


def local_torsion(factor: float, radius_mm: float, diameter_mm: float, t: float) -> float:
    """Return alpha_T-local at depth t: section 3 (1) (D); not below 0."""
    nominal = 1 - (2 * t / diameter_mm) ** (1 / math.sqrt(factor))
    return max((factor - 1) * math.exp(-t / radius_mm) + nominal, 0.0)


def pin_stresses(size: Dimensions, factors: ConcentrationFactors, nominal: Nominal) -> FilletStress:
    """Return the stresses of the pin fillet."""
    return FilletStress(
        factors.alpha_bending * nominal.bending_MPa,
        factors.alpha_torsion * nominal.pin_torsion_MPa,
        factors.alpha_bending,
        factors.alpha_torsion,
        size.pin_fillet,
        size.pin,
        size.fillet_distance,
    )


def journal_stresses(size: Dimensions, factors: ConcentrationFactors, nominal: Nominal) -> FilletStress:
    """Return the stresses of the journal fillet; what shear adds falls as bending does."""
    return FilletStress(
        factors.beta_bending * nominal.bending_MPa + factors.beta_shear * nominal.shear_MPa,
        factors.beta_torsion * nominal.journal_torsion_MPa,
        factors.beta_bending,
        factors.beta_torsion,
        size.journal_fillet,
        size.journal,
        size.fillet_distance,
    )


def surface_strength_MPa(layer: HardenedLayer) -> float:
    """Return the strength of the treated surface at R = -1, residual stress included.

    Sections 4 (1) (B): 400 + 0.5 (HV - 400), and 5 (1) (B): 450 from 600 HV on.
    """
    return _NITRIDED_MPA if layer.process == "nitrided" else 400 + 0.5 * (layer.surface_HV - 400)


def transition_mm(layer: HardenedLayer) -> float:
    """Return the depth of the transition to the core: sections 4 and 5 (1) (E)."""
    return layer.depth_mm * (_ARTIFICIAL if layer.process == "nitrided" else 1.0)


def transition_strength_MPa(layer: HardenedLayer, core_MPa: float) -> float:
    """Return the strength of the transition from that of the untreated fillet (M53.6).

    Nitrided: that of the core, section 5 (1) (D). Induction: less by the local drop of hardness, section 4,
    and by 20 % for 300 MPa of residual tension, section 4 (1) (E); other tension counts in proportion.
    """
    if layer.process == "nitrided":
        return core_MPa
    tension = max(float(layer.residual_MPa(np.array(transition_mm(layer)))), 0.0)
    drop = layer.transition_HV / layer.core_HV
    return core_MPa * drop * max(1 - LOSS_PER_MPA * tension, 0.0)


def treated_check(
    plain: FilletCheck, layer: HardenedLayer, stress: FilletStress, added_MPa: float
) -> FilletCheck:
    """Return a treated fillet against the rule: the worse of surface and transition (section 3 (3)).

    Args:
        plain: the fillet without its treatment.
    """
    depth = transition_mm(layer)
    surface = plain.equivalent_MPa, surface_strength_MPa(layer)
    below = stress.equivalent_MPa(added_MPa, depth), transition_strength_MPa(layer, plain.strength_MPa)
    over, under = surface[1] / surface[0], below[1] / below[0]
    deciding, at = (surface, 0.0) if over <= under else (below, depth)
    return FilletCheck(*deciding, RuleHardening(layer.process, over, under, depth, at))
