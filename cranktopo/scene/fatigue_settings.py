"""Scene table of the fatigue assessment: what strength depends on besides the material."""

from __future__ import annotations

from pydantic import Field

from cranktopo.scene.base import NonNegative, Positive, SceneTable


class Fatigue(SceneTable):
    """Surface, size and rule factors of the fatigue methods.

    Defaults: size and survival factor and specimen of J. Voparil, Brno University of Technology, 2011; ground
    fillets; drop forging and trunk piston engine of IACS UR M53.
    """

    surface_treatment_factor: float = Field(default=1.0, ge=0.5, le=3.0)
    size_factor: float = Field(default=0.89, gt=0, le=1.0)
    survival_factor: float = Field(default=0.75, gt=0, le=1.0)
    specimen_diameter_mm: Positive = 7.5
    roughness_um: Positive = 6.3
    process_factor: float = Field(default=1.05, gt=0, le=1.5)
    additional_stress_MPa: NonNegative = 10.0
