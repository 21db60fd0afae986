"""Scene tables of the bearings that hold the throw."""

from __future__ import annotations

import tomllib
from functools import cache
from importlib.resources import files
from typing import Any, Literal

from pydantic import Field, model_validator

from cranktopo.errors import invalid, suggest
from cranktopo.scene.base import NonNegative, Positive, SceneTable


@cache
def bearing_library() -> dict[str, dict[str, Any]]:
    """The roller bearings shipped with the package, by name."""
    return tomllib.loads((files("cranktopo.scene") / "bearings.toml").read_text(encoding="utf-8"))


class RollerBearing(SceneTable):
    """Roller bearing given by the load-displacement table of one roller; a known `name` fills it in."""

    name: str = "custom"
    kind: Literal["radial", "thrust"] = "radial"
    rollers: int = Field(ge=3, le=1000)
    displacement_mm: tuple[Positive, ...] = Field(min_length=3)
    reaction_N: tuple[NonNegative, ...] = Field(min_length=3)
    source: str = ""

    @model_validator(mode="before")
    @classmethod
    def _from_library(cls, data: Any) -> Any:
        if not isinstance(data, dict) or "name" not in data:
            return data
        entry = bearing_library().get(data["name"])
        if entry is None and not {"rollers", "displacement_mm", "reaction_N"} <= data.keys():
            raise invalid(
                "supports.roller_bearing.name",
                data["name"],
                "not in the library, and rollers, displacement_mm, reaction_N are not all given",
                suggest(str(data["name"]), list(bearing_library())),
            )
        return {**(entry or {}), **data}


class Supports(SceneTable):
    """How the rigid mid-journal sections are held, per load case, and how stiff the bearings are.

    The radial stiffness of one bearing is given directly, by the clearance of a plain bearing, or by the
    roller table of a roller bearing.
    """

    torsion: Literal["free", "held", "spring"] = "free"
    bending: Literal["pinned", "clamped", "spring"] = "pinned"
    bearing_spring_N_per_mm: Positive | None = None
    bearing_clearance_mm: Positive | None = None
    roller_bearing: RollerBearing | None = None
