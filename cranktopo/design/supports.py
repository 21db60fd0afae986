"""Scene tables of the bearings that hold the throw."""

from __future__ import annotations

import tomllib
from functools import cache
from importlib.resources import files
from typing import Any, Literal

from pydantic import Field, model_validator

from cranktopo.base.table import (
    SHOWN,
    UNLESS_IN_LIBRARY,
    Reaction,
    SceneTable,
    SmallLength,
    Stiffness,
    filled_in,
)


@cache
def bearing_library() -> dict[str, dict[str, Any]]:
    """Return the roller bearings shipped with the package, by name."""
    return tomllib.loads((files("cranktopo.design") / "bearings.toml").read_text(encoding="utf-8"))


class RollerBearing(SceneTable):
    """Roller bearing given by the load-displacement table of one roller; a known `name` fills it in."""

    name: str = Field(default="custom", examples=["HK4520"], json_schema_extra=SHOWN)
    """A name of the library fills in every key that is not given; any other name needs own values."""
    kind: Literal["radial", "thrust"] = "radial"
    """Direction in which the bearing carries; only radial ones support a journal."""
    rollers: int = Field(ge=3, le=1000, examples=[38], json_schema_extra=UNLESS_IN_LIBRARY)
    """Number of rollers."""
    displacement_mm: tuple[SmallLength, ...] = Field(
        min_length=3, examples=[(0.001, 0.004, 0.01)], json_schema_extra=UNLESS_IN_LIBRARY
    )
    """Displacements of one roller, increasing."""
    reaction_N: tuple[Reaction, ...] = Field(
        min_length=3, examples=[(33.0, 172.0, 501.0)], json_schema_extra=UNLESS_IN_LIBRARY
    )
    """Reaction of one roller at each displacement, increasing."""
    dynamic_rating_kN: float | None = Field(default=None, ge=1e-3, le=1e5, examples=[26.0])
    """Basic dynamic load rating (ISO 281), for the life in `cranktopo balance`; axial of a thrust bearing."""
    source: str = ""
    """Where the values come from."""

    @model_validator(mode="before")
    @classmethod
    def _from_library(cls, data: Any) -> Any:
        return filled_in(data, bearing_library(), frozenset({"rollers", "displacement_mm", "reaction_N"}))


class Supports(SceneTable):
    """How the rigid mid-journal sections are held, per load case, and how stiff the bearings are.

    The radial stiffness of one bearing is given directly, by the clearance of a plain bearing, or by the
    roller table of a roller bearing.
    """

    torsion: Literal["free", "held", "spring"] = "free"
    """Mid-journal sections in torsion: free to move laterally and tilt, held, or on bearing springs."""
    bending: Literal["pinned", "clamped", "spring"] = "pinned"
    """Mid-journal sections in bending: free to tilt, clamped against tilt, or on bearing springs."""
    bearing_spring_N_per_mm: Stiffness | None = Field(default=None, examples=[1.07e6])
    """Radial stiffness of one main bearing; this or one of the next two where a support is `spring`."""
    bearing_clearance_mm: SmallLength | None = Field(default=None, examples=[0.03])
    """Radial clearance of a plain bearing: the spring is half the largest gas force over 0.8 of it."""
    roller_bearing: RollerBearing | None = None
