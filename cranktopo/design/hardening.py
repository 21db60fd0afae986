"""Scene table of hardened, nitrided and rolled fillets, and the hardness of a tensile strength."""

from __future__ import annotations

from typing import Annotated, Literal

import numpy as np
from pydantic import Field

from cranktopo.base.table import Length, SceneTable

Process = Literal["nitrided", "induction", "rolled"]
Fillet = Literal["pin", "journal"]
Hardness = Annotated[float, Field(ge=80, le=1500, allow_inf_nan=False)]
"""Vickers, HV 0.5 to HV 5."""
_Depth = Annotated[float, Field(ge=0, le=1000, allow_inf_nan=False)]
_Residual = Annotated[float, Field(ge=-5000, le=5000, allow_inf_nan=False)]
NITRIDED_HV = 50.0
"""Hardness above the core that defines the nitriding depth (IACS UR M53, Appendix V, 5)."""
_DROP = 0.9
"""Hardness of the transition zone of induction hardening over that of the core (Appendix V, 4)."""
TENSILE_OF_HV = (
    (80.0, 255.0),
    (100.0, 320.0),
    (150.0, 480.0),
    (200.0, 640.0),
    (250.0, 800.0),
    (300.0, 965.0),
    (350.0, 1125.0),
    (400.0, 1290.0),
    (450.0, 1455.0),
    (500.0, 1630.0),
    (550.0, 1810.0),
    (600.0, 1995.0),
    (650.0, 2180.0),
)
"""Vickers hardness and tensile strength in MPa of unalloyed and low-alloy steel: ISO 18265, Table A.1."""


class CaseHardening(SceneTable):
    """The treatment of a fillet as the workshop specifies it: minimum depth, minimum hardness."""

    process: Process = Field(examples=["nitrided"])
    """Treatment of the fillet: gas nitriding, induction hardening, or cold rolling."""
    case_depth_mm: Length = Field(examples=[0.4])
    """Least depth: nitrided to 50 HV above the core, induction to 80 % of the surface's hardness (IACS UR
    M53, Appendix V), rolled as far as the residual stress is compressive."""
    surface_hardness_HV: Hardness = Field(examples=[700.0])
    """Least Vickers hardness at the surface."""
    core_hardness_HV: Hardness | None = Field(default=None, examples=[340.0])
    """Vickers hardness of the core; by default that of `material.ultimate_MPa` by ISO 18265, Table A.1."""
    transition_hardness_HV: Hardness | None = Field(default=None, examples=[340.0])
    """Hardness just below an induction-hardened layer; by default 0.9 of the core's (Appendix V, 4). Give the
    core's where the drop is avoided."""
    residual_stress_MPa: tuple[tuple[_Depth, _Residual], ...] = Field(
        default=(), max_length=50, examples=[[[0.0, -400.0], [0.4, 0.0]]]
    )
    """Measured residual stress by depth, [depth in mm, MPa], compression negative; by default that of the
    process."""
    residual_scatter_MPa: float = Field(default=0.0, ge=0, le=2000)
    """Scatter of the residual stress, measured or by the process: added at every depth, to the safe side. The
    safety at its other end is shown beside it."""
    source: str = Field(default="", max_length=500, examples=["hardness run of the forge, 12/2025"])
    """Origin of depth, hardness and residual stress."""

    def core_HV(self, ultimate_MPa: float | None) -> float | None:
        """Return the core's hardness, given or from the tensile strength; None where neither is known."""
        return self.core_hardness_HV or (None if ultimate_MPa is None else vickers(ultimate_MPa))

    def transition_HV(self, core_HV: float) -> float:
        """Return the hardness just below an induction-hardened layer; of other processes that of the core."""
        if self.process != "induction":
            return core_HV
        return self.transition_hardness_HV or _DROP * core_HV

    @property
    def demand(self) -> str:
        """Process, least depth and least hardness for a workshop drawing."""
        process = "induction-hardened" if self.process == "induction" else self.process
        return f"{process}, at least {self.case_depth_mm:g} mm deep and {self.surface_hardness_HV:g} HV"

    @property
    def words(self) -> str:
        """The treatment in words."""
        source = self.source or "NO SOURCE; name it in its key `source`"
        return f"{self.process}, {self.case_depth_mm:g} mm, {self.surface_hardness_HV:g} HV: {source}"


class Hardening(CaseHardening):
    """Hardened, nitrided or rolled fillets by hardness and residual stress over depth.

    Instead of `surface_treatment_factor`: strength and stress are compared at every depth.
    """

    fillets: Literal["both", "pin", "journal"] = "both"
    """Fillets that are treated."""


def vickers(ultimate_MPa: float) -> float | None:
    """Return the Vickers hardness of a steel by its tensile strength, ISO 18265, Table A.1; None outside."""
    hardness, tensile = np.array(TENSILE_OF_HV).T
    if not tensile[0] <= ultimate_MPa <= tensile[-1]:
        return None
    return float(np.interp(ultimate_MPa, tensile, hardness))
