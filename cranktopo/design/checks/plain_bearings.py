"""Consistency of the plain bearings with their journals."""

from __future__ import annotations

from cranktopo.design.schema import Scene
from cranktopo.throw.journal import Journal

_LARGEST_CLEARANCE = 0.01
"""Clearance over the diameter."""


def check_plain_bearings(scene: Scene) -> None:
    """Check widths, groove and clearances."""
    bearings, throw = scene.bearings, scene.throw
    if bearings is None:
        return
    _check(scene, throw.main_journal, "width_mm", "clearance_mm")
    _check(scene, throw.crankpin, "big_end_width_mm", "big_end_clearance_mm")
    width = bearings.width_mm or throw.main_journal.length_mm
    if bearings.groove_mm >= width:
        raise scene.invalid(
            "bearings.groove_mm", f"must be smaller than the {width:g} mm of the bearing", "Take 0 for none."
        )


def _check(scene: Scene, journal: Journal, width: str, clearance: str) -> None:
    given = getattr(scene.bearings, width)
    if given is not None and given > journal.length_mm:
        raise scene.invalid(f"bearings.{width}", f"must be at most the journal's {journal.length_mm:g} mm")
    most = _LARGEST_CLEARANCE * journal.outer_diameter_mm
    if (getattr(scene.bearings, clearance) or 0.0) > most:
        raise scene.invalid(
            f"bearings.{clearance}",
            f"must be at most {most:.4g} mm, 1 % of the journal's diameter",
            "Usual is 0.05 to 0.15 %.",
        )
