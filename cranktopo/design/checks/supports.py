"""Consistency of the bearings of a scene."""

from __future__ import annotations

from itertools import pairwise

from cranktopo.base.errors import CranktopoError, invalid
from cranktopo.design.schema import Scene


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
