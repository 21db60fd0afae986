"""Scene table of the fatigue assessment: what strength depends on besides the material."""

from __future__ import annotations

from pydantic import Field

from cranktopo.base.table import Length, SceneTable


class Fatigue(SceneTable):
    """Surface, size and rule factors of the fatigue methods.

    Defaults: size and survival factor and specimen of J. Voparil, Brno University of Technology, 2011; ground
    fillets; drop forging and trunk piston engine of IACS UR M53.
    """

    surface_treatment_factor: float = Field(default=1.0, ge=0.5, le=3.0)
    """Strength of rolled, nitrided or hardened fillets over untreated ones, by tests or a standard."""
    surface_treatment_source: str = Field(
        default="", max_length=500, examples=["rolled, component tests of the forge, report 12/2025"]
    )
    """The treatment and where its factor comes from; told beside every safety that holds it."""
    size_factor: float = Field(default=0.89, ge=0.01, le=1.0)
    """Strength of the part over that of the specimen for its size."""
    survival_factor: float = Field(default=0.75, ge=0.01, le=1.0)
    """Strength at the wanted probability of survival over the mean strength."""
    specimen_diameter_mm: Length = 7.5
    """Diameter of the specimens of the fatigue strengths."""
    roughness_um: float = Field(default=6.3, ge=0.01, le=1000)
    """Roughness Rz of the fillets."""
    process_factor: float = Field(default=1.05, ge=0.1, le=1.5)
    """Factor K of IACS UR M53 for the way of forging: 1.05 drop forged, 1.0 free forged, 0.93 cast."""
    additional_stress_MPa: float = Field(default=10.0, ge=0, le=1e4)
    """Additional bending stress of IACS UR M53: 10 for trunk piston engines."""

    @property
    def treatment(self) -> str:
        """The factor of the surface treatment with its source in words; empty where there is none."""
        factor = self.surface_treatment_factor
        if factor == 1.0:
            return ""
        source = self.surface_treatment_source or "NO SOURCE; name it in fatigue.surface_treatment_source"
        return f"strength of the fillets times {factor:g} for their surface treatment: {source}"
