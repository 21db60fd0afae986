"""Is the web one sound body? Refusals of dimensions that would give a broken or a silently wrong one."""

from __future__ import annotations

import numpy as np

from cranktopo.base.errors import invalid
from cranktopo.design.schema import Scene
from cranktopo.throw.drilling.checks import check_apart
from cranktopo.throw.drilling.table import drill_bores
from cranktopo.throw.feature import ROUNDING_MM, least_shoulder_mm
from cranktopo.throw.geometry import Journal


def check_solid(scene: Scene) -> None:
    """Check that the throw's dimensions describe one sound body.

    Raises:
        CranktopoError: corner larger than the web, outline that misses a journal, fillet larger than the
            shoulder, bore through the rim, pocket outside the web, too deep, or cutting a bore, drilling that
            breaks out.
    """
    web = scene.web
    features = list(web.features())
    web.check_outline(scene.throw.radius_mm)
    for key, feature in features:
        feature.check_alone(scene, key)
    _check_journal(scene, "throw.main_journal", scene.throw.main_journal, 0.0)
    _check_journal(scene, "throw.crankpin", scene.throw.crankpin, scene.throw.radius_mm)
    for key, feature in features:
        feature.check_in_web(scene, key)
    for key, drilling in scene.throw.features():
        drilling.check_in_web(scene, key)
    check_apart(scene, drill_bores(scene))


def _shoulder_mm(scene: Scene, y_mm: float) -> float:
    """Least distance from the axis (0, y) to the edge of the web's outline, mm.

    The outline is sampled at 4001 points of a cosine grid.
    """
    low, high = scene.web.y_range_mm(scene.throw.radius_mm)
    y = low + (high - low) * (1 - np.cos(np.linspace(0, np.pi, 4001))) / 2
    half = scene.web.half_width_mm(scene.throw.radius_mm, y)
    ends = min(y_mm - low, high - y_mm)
    return float(min(np.hypot(half, y - y_mm).min(), ends))


def _check_journal(scene: Scene, key: str, journal: Journal, y: float) -> None:
    edge = _shoulder_mm(scene, y)
    least = least_shoulder_mm(scene.throw)
    if edge <= 0:
        allowed = f"does not reach around the axis of {key} at y = {y:g} mm"
        raise invalid("web.outline", scene.web.outline, allowed, "Widen or lengthen it.")
    if journal.bore_radius_mm >= edge - least:
        raise invalid(
            f"{key}.bore_diameter_mm",
            journal.bore_diameter_mm,
            f"breaks through the web's rim; must be smaller than {2 * (edge - least):.4g} mm",
            "Reduce the bore or widen the web.",
        )
    if journal.fillet_mm and journal.radius_mm + journal.fillet_mm > edge - least + ROUNDING_MM:
        room = edge - least - journal.radius_mm
        allowed = f"at most {room:.4g} mm fits" if room > 0 else "no fillet fits"
        raise invalid(
            f"{key}.fillet_mm",
            journal.fillet_mm,
            f"larger than the shoulder: the web's edge is {edge:.4g} mm from the axis, of which "
            f"{least:.3g} mm stay, {allowed}",
            "Reduce the fillet or widen the web.",
        )
