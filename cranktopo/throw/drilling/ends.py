"""Scene tables of the two ends of an oil drilling."""

from __future__ import annotations

from typing import Literal

from pydantic import Field

from cranktopo.base.table import LengthOrZero, SceneTable

Surface = Literal["main_journal", "crankpin", "main_journal_bore", "crankpin_bore"]
_BORE = "_bore"


class DrillingEnd(SceneTable):
    """One end of a drilling: a point on a journal, or on the wall of its axial bore."""

    on: Surface = Field(examples=["main_journal"])
    """The surface: of a journal, or of its axial bore, where the drilling ends in that."""
    angle_deg: float = Field(ge=-360, le=360, examples=[180.0])
    """Angle about that journal's axis: 0 points from the crank axis to the crankpin, 90 to +x, 180 back."""
    place_mm: LengthOrZero = Field(examples=[5.0])
    """Distance from the middle of that journal toward the web."""

    @property
    def in_bore(self) -> bool:
        """True if it lies on the wall of an axial bore."""
        return self.on.endswith(_BORE)

    @property
    def journal_key(self) -> str:
        """Key of its journal in the throw."""
        return self.on.removesuffix(_BORE)


class DrillingSecondEnd(DrillingEnd):
    """The other end of a drilling, given in the same way."""

    on: Surface = Field(examples=["crankpin"])
    """The surface, as of the first end."""
    angle_deg: float = Field(ge=-360, le=360, examples=[0.0])
    """Angle about that journal's axis, as of the first end."""
