"""Hardness, residual stress and local strength below the surface of a hardened, nitrided or rolled fillet.

Sources: IACS UR M53 (Rev. 5, 2023), Appendix V, for the hardness over depth and what a depth of treatment
means; FKM guideline, Analytical Strength Assessment, chapter 5.5 (surface-treated components, numbers as
pyLife has them), for strength, support and residual stress by hardness. Each function names its equation.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from cranktopo.base.arrays import Array
from cranktopo.design.hardening import NITRIDED_HV, CaseHardening, Fillet, Process
from cranktopo.design.schema import Scene

TENSILE_PER_HV = 3.3
"""Tensile strength over Vickers hardness, MPa: FKM guideline, 5.5.50."""
_ZONE = 1.2
"""Depth to which stresses must be known, over that of the treatment: Appendix V, 3."""
_STEPS, _DEEPEST = 40, 2.0
"""Depths that are looked at, and the deepest over the depth of the treatment."""
_INDUCTION_MPA, BELOW_INDUCTION_MPA = -200.0, 300.0
"""Residual stress in the layer and in the transition zone where it is not known: Appendix V, 4."""
_CORE_SHARE = 0.3
"""Tension that balances the compression of the layer, of that compression: FKM guideline, 5.5.2."""
LOSS_PER_MPA = 0.2 / BELOW_INDUCTION_MPA
"""Strength that tension costs below a layer: 20 % for 300 MPa, Appendix V, 4 (1) (E)."""
_CYCLIC_YIELD = 0.6
"""Cyclic yield strength over tensile strength: FKM guideline, 5.5.1.2."""


@dataclass(frozen=True)
class ProcessLaw:
    """Strength of a layer by its hardness: FKM guideline, tables of chapter 5.5.

    Attributes:
        slope, offset_MPa: fully reversed strength over hardness below 500 HV.
        highest_MPa: strength from 500 HV on.
        mean_stress_sensitivity: of the layer.
    """

    slope: float
    offset_MPa: float
    highest_MPa: float
    mean_stress_sensitivity: float


LAWS: dict[Process, ProcessLaw] = {
    "nitrided": ProcessLaw(1.2, 90.0, 690.0, 0.45),
    "induction": ProcessLaw(1.42, 23.0, 733.0, 0.4),
    "rolled": ProcessLaw(0.45 * TENSILE_PER_HV, 0.0, np.inf, 0.18),
}


@dataclass(frozen=True)
class HardenedLayer:
    """A treated fillet in numbers that are all known.

    Attributes:
        transition_HV: hardness just below an induction-hardened layer, as far as 1.2 of its depth.
        residual: measured depths in mm and stresses in MPa; empty: by the process.
        scatter_MPa: added to the residual stress at every depth.
    """

    process: Process
    depth_mm: float
    surface_HV: float
    core_HV: float
    transition_HV: float
    residual: tuple[tuple[float, float], ...] = ()
    scatter_MPa: float = 0.0

    @property
    def depths_mm(self) -> Array:
        """Depths at which strength and stress are compared, 0 first, with those where a profile kinks."""
        even = np.linspace(0.0, _DEEPEST * self.depth_mm, _STEPS + 1)
        kinks = [self.depth_mm, _ZONE * self.depth_mm, *(depth for depth, _ in self.residual)]
        return np.unique(np.concatenate([even, kinks]))

    def hardness_HV(self, depth_mm: Array) -> Array:
        """Return the hardness at depths: Appendix V, 4 (two layers) and 5 (empirical formula).

        Of rolled fillets it falls linearly to that of the core, for which the rule has no formula.
        """
        if self.process != "induction":
            return self.core_HV + (self.surface_HV - self.core_HV) * self._case_share(depth_mm)
        share = depth_mm / self.depth_mm
        below = np.where(share < _ZONE, self.transition_HV, self.core_HV)
        return np.where(share < 1, self.surface_HV, below)

    def residual_MPa(self, depth_mm: Array) -> Array:
        """Return the residual stress at depths with its scatter, compression negative.

        Measured points are joined by straight lines; below the last one, tension goes on and compression does
        not. Without them induction hardening has those of Appendix V, 4, other processes those of the FKM
        guideline, 5.5.2, in the layer, and 0.3 of them as tension below.
        """
        if self.residual:
            depths, stress = np.array(self.residual).T
            stress = stress + self.scatter_MPa
            return np.interp(depth_mm, depths, stress, right=max(stress[-1], 0.0))
        share = depth_mm / self.depth_mm
        if self.process == "induction":
            return np.where(share < 1, _INDUCTION_MPA, BELOW_INDUCTION_MPA) + self.scatter_MPa
        hard = self._case_share(depth_mm)
        return layer_residual_MPa(self) * (hard - _CORE_SHARE * (1 - hard)) + self.scatter_MPa

    def relative_strength(self, depth_mm: Array, gradient_per_mm: Array) -> Array:
        """Return the local strength over that of the core without residual stress, at depths or points.

        Args:
            gradient_per_mm: related stress gradient there.
        """
        hardness = self.hardness_HV(depth_mm)
        strength = reversed_MPa(self.process, hardness)
        harder = strength / reversed_MPa(self.process, np.array(self.core_HV))
        support = support_factor(hardness, gradient_per_mm) / support_factor(
            np.array(self.core_HV), gradient_per_mm
        )
        return np.asarray(harder * support * self._residual_factor(depth_mm, strength, hardness))

    def _residual_factor(self, depth_mm: Array, strength: Array, hardness: Array) -> Array:
        """Return 1 - M s / S: FKM guideline, 5.5.1.2, with what the cyclic yield strength carries (range I).

        Tension costs at least what Appendix V, 4 (1) takes off.
        """
        sensitivity, stress = self.sensitivity(depth_mm), self.residual_MPa(depth_mm)
        yielding = _CYCLIC_YIELD * TENSILE_PER_HV * hardness
        kept = np.maximum(stress, np.minimum((strength - yielding) / (1 + sensitivity), 0.0))
        loss = np.where(stress > 0, np.maximum(sensitivity / strength, LOSS_PER_MPA), sensitivity / strength)
        return np.maximum(1 - loss * kept, 1e-6)

    def sensitivity(self, depth_mm: Array) -> Array:
        """Return the mean stress sensitivity at depths, from that of the layer to the core's."""
        core = 0.35e-3 * TENSILE_PER_HV * self.core_HV - 0.1  # FKM guideline, 4.4.2
        hard = self._case_share(depth_mm)
        return core + (LAWS[self.process].mean_stress_sensitivity - core) * hard

    def _case_share(self, depth_mm: Array) -> Array:
        """Return how much of the layer there is at depths, 1 to 0."""
        share = depth_mm / self.depth_mm
        if self.process == "nitrided":
            gain = self.surface_HV - self.core_HV
            return np.asarray((NITRIDED_HV / gain) ** share**2)
        return np.maximum(1 - share, 0.0) if self.process == "rolled" else np.where(share < 1, 1.0, 0.0)


def layer_of(scene: Scene, treatment: CaseHardening) -> HardenedLayer:
    """Return the layer of a scene that is checked."""
    core = treatment.core_HV(scene.material.ultimate_MPa)
    assert core is not None
    return HardenedLayer(
        treatment.process,
        treatment.case_depth_mm,
        treatment.surface_hardness_HV,
        core,
        treatment.transition_HV(core),
        treatment.residual_stress_MPa,
        treatment.residual_scatter_MPa,
    )


def layers(scene: Scene) -> dict[Fillet, HardenedLayer]:
    """Return the treated fillets of a scene."""
    return {fillet: layer_of(scene, one) for fillet, one in scene.fatigue.hardened.items()}


def reversed_MPa(process: Process, hardness_HV: Array) -> Array:
    """Return the fully reversed strength by hardness: FKM guideline, chapter 5.5."""
    law = LAWS[process]
    return np.minimum(law.slope * hardness_HV + law.offset_MPa, law.highest_MPa)


def support_factor(hardness_HV: Array, gradient_per_mm: Array) -> Array:
    """Return the support that a stress gradient gives at a hardness: FKM guideline, chapter 5.5."""
    return 1 + np.sqrt(1600.0 * gradient_per_mm) / hardness_HV


def layer_residual_MPa(layer: HardenedLayer) -> float:
    """Return the residual stress of a nitrided or rolled layer without scatter: FKM guideline, 5.5.2."""
    if layer.process == "nitrided":
        return max(-0.675 * (layer.surface_HV - layer.core_HV), -270.0)
    return min(0.0, max(350.0 - 0.7 * TENSILE_PER_HV * layer.core_HV, -700.0))
