"""Is the web one sound body? Refusals of dimensions that would give a broken or a silently wrong one."""

from __future__ import annotations

import numpy as np

from cranktopo.errors import CranktopoError, invalid
from cranktopo.scene.bevel import bevel_arc, height_range_mm
from cranktopo.scene.features import Disc, Feature, Wedge, bores, pockets
from cranktopo.scene.geometry import CylinderPocket, Journal, Pocket, RectangleWeb
from cranktopo.scene.outline import half_width_mm, y_range_mm
from cranktopo.scene.schema import Scene

SHOULDER_MM = 0.1
"""Least width of flat web face left beyond a fillet; less gives needle-shaped faces."""
_ROUNDING_MM = 1e-9
"""The largest fillet that a message names must itself be accepted."""


def check_solid(scene: Scene) -> None:
    """Check that the throw's dimensions describe one sound body.

    Raises:
        CranktopoError: corner larger than the web, outline that misses a journal, fillet larger than the
            shoulder, bore through the rim, pocket outside the web, too deep, or cutting a bore.
    """
    if isinstance(scene.web, RectangleWeb):
        _check_corner(scene.web, scene.throw.radius_mm)
    _check_journal(scene, "throw.main_journal", scene.throw.main_journal, 0.0)
    _check_journal(scene, "throw.crankpin", scene.throw.crankpin, scene.throw.radius_mm)
    _check_bevels(scene)
    for index, pocket in enumerate(scene.web.pocket):
        _check_depth(scene, f"web.pocket[{index}]", pocket)
    for feature in pockets(scene):
        _check_pocket(scene, feature)


def shoulder_mm(scene: Scene, y_mm: float) -> float:
    """Least distance from the axis (0, y) to the edge of the web's outline, mm.

    The outline is sampled at 4001 points of a cosine grid.

    Args:
        scene: the throw.
        y_mm: place of the axis along the throw.
    """
    low, high = y_range_mm(scene.web, scene.throw.radius_mm)
    y = low + (high - low) * (1 - np.cos(np.linspace(0, np.pi, 4001))) / 2
    half = half_width_mm(scene.web, scene.throw.radius_mm, y)
    ends = min(y_mm - low, high - y_mm)
    return float(min(np.hypot(half, y - y_mm).min(), ends))


def _check_corner(web: RectangleWeb, throw_radius_mm: float) -> None:
    half_length = throw_radius_mm / 2 + web.overhang_mm
    if web.corner_radius_mm >= web.width_mm / 2:
        allowed = f"must be smaller than half of web.width_mm ({web.width_mm / 2:g} mm)"
        hint = "Use the obround outline for fully round ends."
    elif web.corner_radius_mm > half_length:
        allowed = f"must be at most half of the web's length ({half_length:g} mm)"
        hint = "Reduce it or increase web.overhang_mm."
    else:
        return
    raise invalid("web.corner_radius_mm", web.corner_radius_mm, allowed, hint)


def _check_journal(scene: Scene, key: str, journal: Journal, y: float) -> None:
    edge = shoulder_mm(scene, y)
    if edge <= 0:
        allowed = f"does not reach around the axis of {key} at y = {y:g} mm"
        raise invalid("web.outline", scene.web.outline, allowed, "Widen or lengthen it.")
    if journal.bore_radius_mm >= edge - SHOULDER_MM:
        raise invalid(
            f"{key}.bore_diameter_mm",
            journal.bore_diameter_mm,
            f"breaks through the web's rim; must be smaller than {2 * (edge - SHOULDER_MM):.4g} mm",
            "Reduce the bore or widen the web.",
        )
    if journal.fillet_mm and journal.radius_mm + journal.fillet_mm > edge - SHOULDER_MM + _ROUNDING_MM:
        room = edge - SHOULDER_MM - journal.radius_mm
        allowed = f"at most {room:.4g} mm fits" if room > 0 else "no fillet fits"
        raise invalid(
            f"{key}.fillet_mm",
            journal.fillet_mm,
            f"larger than the shoulder: the web's edge is {edge:.4g} mm from the axis, {allowed}",
            "Reduce the fillet or widen the web.",
        )


def _check_bevels(scene: Scene) -> None:
    """A bevel keeps clear of the journal that stands on its face."""
    throw = scene.throw
    for index, bevel in enumerate(scene.web.bevel):
        arc = bevel_arc(scene.web, throw.radius_mm, bevel)
        on_main = bevel.face == "journal"
        journal = throw.main_journal if on_main else throw.crankpin
        room = arc.start_mm - (0.0 if on_main else -throw.radius_mm) - SHOULDER_MM
        if journal.radius_mm + journal.fillet_mm > room + _ROUNDING_MM:
            name = "main_journal" if on_main else "crankpin"
            raise invalid(
                f"web.bevel[{index}].y_mm",
                bevel.y_mm,
                f"starts {room + SHOULDER_MM:.4g} mm from the axis of throw.{name}, which needs "
                f"{journal.radius_mm + journal.fillet_mm + SHOULDER_MM:.4g} mm for its radius and fillet",
                "Move the bevel outward.",
            )


def _check_depth(scene: Scene, key: str, pocket: Pocket) -> None:
    thickness = scene.web.thickness_mm
    if isinstance(pocket, CylinderPocket):
        if (pocket.depth_mm is None) != (pocket.face == "through"):
            if pocket.depth_mm is None:
                allowed, hint = f"is missing with face = {pocket.face!r}", "Give it, or face = 'through'."
            else:
                allowed, hint = "has no meaning with face = 'through'", "Remove it, or name another face."
            raise invalid(f"{key}.depth_mm", pocket.depth_mm, allowed, hint)
        depth: float | None = pocket.depth_mm
        name = "depth_mm"
    elif pocket.shape == "side":
        depth, name = (
            pocket.height_mm + 2 * (pocket.slope * pocket.depth_mm + abs(pocket.offset_mm)),
            "height_mm",
        )
    else:
        depth, name = pocket.depth_mm, "depth_mm"
    if depth is not None and depth >= thickness:
        allowed = f"must be smaller than web.thickness_mm = {thickness:g} mm"
        raise invalid(f"{key}.{name}", depth, allowed, "Reduce the pocket or thicken the web.")


def _check_pocket(scene: Scene, feature: Feature) -> None:
    if not _touches_web(scene, feature):
        raise CranktopoError(
            f"{feature.key}: lies outside the web's outline and removes nothing.", hint="Move or remove it."
        )
    if isinstance(feature, Wedge):
        _check_wedge(scene, feature)
    for bore in bores(scene):
        if _distance(feature, bore) < SHOULDER_MM:
            raise CranktopoError(
                f"{feature.key}: cuts the bore {bore.key} = {2 * bore.radius_mm:g} mm.",
                hint=f"Keep at least {SHOULDER_MM:g} mm of web between the pocket and the bore.",
            )


def _check_wedge(scene: Scene, wedge: Wedge) -> None:
    """Sloped walls stay inside the bevels, unless the slot runs through both ends; clear of other pockets."""
    web, radius, start = scene.web, scene.throw.radius_mm, scene.web_z_mm[0]
    y = np.linspace(*wedge.y_range_mm, 401)
    half = half_width_mm(web, radius, y)
    height = wedge.half_height_mm + wedge.slope * (half - wedge.floor_mm)
    low, high = height_range_mm(web, radius, y)
    middle = wedge.z_centre_mm - start
    cut = half > wedge.open_from_mm(y)
    ends = y_range_mm(web, radius)
    through = abs(wedge.y_mm - sum(ends) / 2) + (ends[1] - ends[0]) / 2 <= wedge.half_length_mm
    sunk = cut & ((middle + wedge.half_height_mm < low) | (middle - wedge.half_height_mm > high))
    if through and sunk.any():
        raise CranktopoError(
            f"{wedge.key}: a bevel takes off its whole floor.", hint="Heighten the floor or move it inward."
        )
    if not through and (cut & ((middle - height < low) | (middle + height > high))).any():
        raise CranktopoError(
            f"{wedge.key}: its sloped walls run into a bevel.", hint="Shorten the pocket or the bevel."
        )
    for other in pockets(scene):
        if other.key != wedge.key and other.z_mm[0] < wedge.z_mm[1] and other.z_mm[1] > wedge.z_mm[0]:
            (a0, a1), (b0, b1) = wedge.spans(y), other.spans(y)
            if (np.minimum(a1, b1) > np.maximum(a0, b0)).any():
                raise CranktopoError(f"{wedge.key}: meets {other.key}.", hint="Move them apart.")


def _distance(feature: Feature, bore: Disc) -> float:
    return feature.distance_mm(bore.y_mm) - bore.radius_mm


def _touches_web(scene: Scene, feature: Feature) -> bool:
    y = np.linspace(*feature.y_range_mm, 401)
    start, end = feature.spans(y)
    half = half_width_mm(scene.web, scene.throw.radius_mm, y)
    return bool(((np.minimum(end, half) - np.maximum(start, -half)) > 0).any())
