"""Scene tables of the bearings that hold the throw; their checks."""

from __future__ import annotations

import tomllib
from functools import cache
from importlib.resources import files
from itertools import pairwise
from typing import TYPE_CHECKING, Any, Literal

from pydantic import Field, model_validator

from cranktopo.base.errors import CranktopoError, invalid
from cranktopo.base.table import (
    SHOWN,
    UNLESS_IN_LIBRARY,
    Reaction,
    SceneTable,
    SmallLength,
    Stiffness,
    filled_in,
)

if TYPE_CHECKING:
    from cranktopo.design.schema import Scene


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


def check_supports(scene: Scene) -> None:
    """Check that the bearing stiffness is given once, and given where a spring support needs it.

    Raises:
        CranktopoError: first inconsistency found.
    """
    supports = scene.supports
    given = [
        key
        for key in ("bearing_spring_N_per_mm", "bearing_clearance_mm", "roller_bearing")
        if getattr(supports, key) is not None
    ]
    if len(given) > 1:
        raise CranktopoError(
            f"supports: {' and '.join(given)} each give the bearing stiffness.", hint="Keep one of them."
        )
    if "spring" in (supports.torsion, supports.bending) and not given:
        raise invalid(
            "supports.bearing_spring_N_per_mm",
            None,
            "must be > 0 N/mm when a support is 'spring'",
            "Give it, or bearing_clearance_mm, or roller_bearing.",
        )
    if supports.bearing_clearance_mm is not None and scene.engine is None:
        raise invalid(
            "supports.bearing_clearance_mm",
            supports.bearing_clearance_mm,
            "needs an [engine]: the spring is half the largest pin force over 0.8 of the clearance",
        )
    _check_roller_table(scene)


def _check_roller_table(scene: Scene) -> None:
    bearing = scene.supports.roller_bearing
    if bearing is None:
        return
    key = "supports.roller_bearing"
    if bearing.kind == "thrust":
        raise invalid(f"{key}.name", bearing.name, "a thrust bearing has no radial stiffness")
    if len(bearing.reaction_N) != len(bearing.displacement_mm):
        raise invalid(
            f"{key}.reaction_N",
            list(bearing.reaction_N),
            f"must have one value per displacement ({len(bearing.displacement_mm)})",
        )
    for name in ("displacement_mm", "reaction_N"):
        values = getattr(bearing, name)
        if any(b <= a for a, b in pairwise(values)):
            raise invalid(f"{key}.{name}", list(values), "must increase")
