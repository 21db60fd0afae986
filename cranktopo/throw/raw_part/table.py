"""Scene table of the forging."""

from __future__ import annotations

import math
from typing import Annotated

from pydantic import Field

from cranktopo.base.table import LengthOrZero, SceneTable

LEAST_DRAFT_DEG, MOST_DRAFT_DEG = 0.5, 15.0


class Forging(SceneTable):
    """The raw part of a throw that dies forge which part in x = 0: `export --part raw` and its drawing.

    That of the crank, `--part raw_crankshaft` and the second page of `drawing`, has its ends too.
    The journals with their fillets and both faces of each web have the allowance; outline and counterweight
    stay as forged. Bores, drillings, plugs, holes and pockets that the die does not release are machined out
    of the full. The tables of stiffness and strength are those of the finished part.
    """

    allowance_mm: LengthOrZero = Field(examples=[2.0])
    """Machining allowance on journals, fillets and web faces."""
    draft_deg: Annotated[float, Field(ge=LEAST_DRAFT_DEG, le=MOST_DRAFT_DEG, allow_inf_nan=False)] = 5.0
    """Draft angle of all surfaces toward the parting plane; usual for steel are 3 to 7 deg."""
    flash_mm: LengthOrZero = Field(default=0.0, examples=[2.0])
    """Thickness of the flash in the parting plane: once trimmed, a land of this height stays along the flash
    line, from which the draft begins."""

    @property
    def draft_slope(self) -> float:
        """Way of a drafted wall outward per mm toward the parting plane."""
        return math.tan(math.radians(self.draft_deg))

    @property
    def land_mm(self) -> float:
        """Distance from the parting plane at which the draft begins."""
        return self.flash_mm / 2
