"""Values printed elsewhere for a design and its variants; shown beside computed ones as ratios only."""

from __future__ import annotations

from pydantic import Field

from cranktopo.base.table import SceneTable


class PublishedSafety(SceneTable):
    """A printed fatigue safety."""

    method: str = Field(examples=["lsa"])
    """Method of `cranktopo fatigue` that it is shown beside."""
    printed_method: str = Field(default="", examples=["FEMFAT"])
    """The method that printed it, where it is another one; shown with the value."""
    safety: float = Field(ge=1e-6, le=1e6, examples=[1.038])
    """Printed safety."""

    @property
    def printed_as(self) -> str:
        """The other method in brackets, if any."""
        return f"({self.printed_method})" if self.printed_method else ""


class PublishedValues(SceneTable):
    """Printed values of one variant."""

    mass_kg: float = Field(ge=1e-6, le=1e6, examples=[1.6])
    """Printed mass."""
    torsional_stiffness_kNm_per_rad: float = Field(ge=1e-9, le=1e9, examples=[140.0])
    """Printed torsional stiffness."""
    bending_stiffness_kN_per_mm: float | None = Field(default=None, ge=1e-9, le=1e9, examples=[230.0])
    """Printed bending stiffness."""
    fatigue: tuple[PublishedSafety, ...] = Field(default=(), max_length=8)


class PublishedVariant(PublishedValues):
    """A variant of the same source whose geometry no design has; a row of its own in `cranktopo compare`."""

    name: str = Field(examples=["topology-optimised"])
    """Name of the row."""


class Published(PublishedValues):
    """Values printed for this design elsewhere, to be shown beside the computed ones as ratios only."""

    source: str = Field(examples=["author, title, year"])
    """Author, title and year of the print."""
    variant: tuple[PublishedVariant, ...] = Field(default=(), max_length=32)
