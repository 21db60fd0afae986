"""Scene table of the shape optimisation: dimensions of the throw that it may change, each within a range."""

from __future__ import annotations

from typing import Annotated, Any

from pydantic import BeforeValidator, Field, WithJsonSchema

from cranktopo.base.table import LARGEST_MM, Length, SceneTable
from cranktopo.design.goal.limit import refused


def _ascending(value: Any, most: float = LARGEST_MM, unit: str = "mm", example: str = "[2.5, 5.0]") -> Any:
    numbers = isinstance(value, list | tuple) and len(value) == 2
    if not numbers or any(isinstance(v, bool) or not isinstance(v, int | float) for v in value):
        raise refused(f"must be the least and the greatest value in {unit}", f"Write {example}, for example.")
    low, high = value
    if not 0 <= low <= most or not 0 <= high <= most:  # before they are floats: an integer may be too large
        raise refused(f"both must be >= 0 and <= {most:g} {unit}", "Correct that value, or its unit.")
    if low >= high:
        raise refused("the least must be smaller than the greatest", "Exchange them, or leave the key out.")
    return float(low), float(high)


def _groups(value: Any) -> Any:
    groups = value if isinstance(value, list | tuple) else None
    if groups is None or not all(isinstance(group, list | tuple) and len(group) > 1 for group in groups):
        raise refused("must be lists of two web numbers or more", "Write [[1, 8], [2, 7]], for example.")
    numbers = [web for group in groups for web in group]
    if any(
        isinstance(web, bool) or not isinstance(web, int) or not 1 <= web <= _MOST_WEBS for web in numbers
    ):
        raise refused(f"must hold whole numbers from 1 to {_MOST_WEBS}", "Webs count from the free end.")
    if len(set(numbers)) < len(numbers):
        raise refused("has a web in two places", "Keep each web once.")
    return tuple(tuple(group) for group in groups)


_MOST_WEBS = 96
WebGroups = Annotated[
    tuple[tuple[int, ...], ...],
    BeforeValidator(_groups),
    WithJsonSchema({"type": "array", "kind": "lists of web numbers", "minimum": 1, "maximum": _MOST_WEBS}),
]
Range = Annotated[
    tuple[float, float],
    BeforeValidator(_ascending),
    WithJsonSchema({"type": "array", "kind": "least and greatest", "minimum": 0, "maximum": LARGEST_MM}),
]
_AngleRange = Annotated[
    tuple[float, float],
    BeforeValidator(lambda value: _ascending(value, 90.0, "deg", "[40.0, 75.0]")),
    WithJsonSchema({"type": "array", "kind": "least and greatest", "minimum": 0, "maximum": 90}),
]


class FreeDimensions(SceneTable):
    """Dimensions of the throw that the shape optimisation may change beside those of the web.

    Each is free where its range is given; the design's own value lies in it. Bearings stay: diameters, throw
    and pitch do not change.
    """

    pin_fillet_mm: Range | None = Field(default=None, examples=[[2.0, 5.0]])
    """Range of the fillet radius at the crankpin; 0.03 to 0.13 of the pin's diameter (IACS UR M53)."""
    journal_fillet_mm: Range | None = Field(default=None, examples=[[2.0, 5.0]])
    """Range of the fillet radius at the main journal; 0.03 to 0.13 of the pin's diameter."""
    pin_fillet_axial_mm: Range | None = Field(default=None, examples=[[2.0, 5.0]])
    """Makes the fillet at the crankpin an ellipse: range of its semi-axis along the crank; 0.03 to 0.13 of
    the pin's diameter. The other semi-axis is the radius of the fillet."""
    journal_fillet_axial_mm: Range | None = Field(default=None, examples=[[2.0, 5.0]])
    """The same at the main journal."""
    pin_bore_mm: Range | None = Field(default=None, examples=[[0.0, 30.0]])
    """Range of the crankpin's bore diameter."""
    journal_bore_mm: Range | None = Field(default=None, examples=[[0.0, 30.0]])
    """Range of the main journal's bore diameter."""
    web_thickness_mm: Range | None = Field(default=None, examples=[[17.0, 22.0]])
    """Range of the web's thickness; the pitch stays, so the main journal gets shorter by twice what the web
    gets thicker."""
    counterweight_radius_mm: Range | None = Field(default=None, examples=[[50.0, 70.0]])
    """Range of the counterweight's outer radius."""
    counterweight_angle_deg: _AngleRange | None = Field(default=None, examples=[[40.0, 75.0]])
    """Range of the counterweight's half-angle; 5 to 90."""


class ShapeTable(SceneTable):
    """Settings of the shape optimisation."""

    tolerance_mm: Length = 0.5
    """Tolerance of every dimension of the web, mm, of angles in degrees; the table of sensitivities has the
    worst case within it."""
    same_webs: WebGroups = Field(default=(), examples=[[[1, 8], [2, 4, 5, 7]]])
    """Webs that `shape --each-web` makes equal, such as those of one die: lists of their numbers from the
    free end, 1 first. The others are equal by mirror pairs and by what they carry."""
    free: FreeDimensions = FreeDimensions()
