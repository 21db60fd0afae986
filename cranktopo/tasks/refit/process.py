"""Demands of a scene's process on pockets, as limits of a fit or a search."""

from __future__ import annotations

from dataclasses import replace

from cranktopo.design.free_dimensions import free_range_mm
from cranktopo.design.schema import Scene
from cranktopo.tasks.density.manufacturing import tool_radius_mm
from cranktopo.throw.manufacturing_limits import ManufacturingLimits, ProcessLimits

_FLOOR_SHARE = 0.5
"""Most radius of a floor's edge over the depth that a pocket may have, or over half of a groove's height."""


def fit_limits(scene: Scene, limits: ManufacturingLimits) -> ProcessLimits:
    """Return the limits of a fit with the demands of the scene's process; a free one has none."""
    if scene.optimise.process == "free":
        return ProcessLimits(**vars(limits))
    return process_limits(scene, limits)


def process_limits(scene: Scene, limits: ManufacturingLimits) -> ProcessLimits:
    """Return limits with what the scene's process asks of pockets: way, draft, corners, and depth; of bevels.

    A die with a flat parting plane in mid-web cuts no deeper than that. The edges of floors have the radius
    of the mill or the die, but no more than half of the depth that a pocket from a face may have, and each of
    a groove's no more than a quarter of the height between its flanges.
    """
    settings, own = scene.optimise, vars(limits)
    if settings.process == "free":
        return ProcessLimits(**{**own, "pocket_radius_mm": limits.min_radius_mm})
    if settings.process == "milled":
        radius = max(limits.min_radius_mm, tool_radius_mm(scene))
        return _with_side_floors(
            scene, _with_floors(scene, ProcessLimits(**{**own, "pocket_radius_mm": radius}))
        )
    draft, lateral = max(limits.min_draft_deg, settings.draft_deg), settings.parting == "lateral"
    scene_limits = {
        "min_draft_deg": draft,
        "opens": "sides" if lateral else "faces",
        "pocket_draft_deg": 0.0 if lateral else draft,
        "pocket_radius_mm": limits.min_radius_mm,
        "bevel_draft_deg": draft if lateral else 0.0,
        "depth_share": 1.0 if lateral or settings.process == "cast" else 0.5,
    }
    adjusted = ProcessLimits(**{**own, **scene_limits})
    return _with_side_floors(scene, adjusted) if lateral else _with_floors(scene, adjusted)


def _with_floors(scene: Scene, limits: ProcessLimits) -> ProcessLimits:
    most = _FLOOR_SHARE * limits.deepest_mm(_thinnest_mm(scene))
    return replace(limits, floor_radius_mm=min(limits.pocket_radius_mm, most))


def _with_side_floors(scene: Scene, limits: ProcessLimits) -> ProcessLimits:
    radius, tallest = limits.pocket_radius_mm, _thinnest_mm(scene) - 2 * limits.min_wall_mm
    groove = min(radius, max(_FLOOR_SHARE * tallest / 2, 0.0))
    return replace(limits, side_floor_radius_mm=radius, groove_radius_mm=groove)


def _thinnest_mm(scene: Scene) -> float:
    thinnest, _ = free_range_mm(scene, "web_thickness") or (scene.web.thickness_mm, 0.0)
    return thinnest
