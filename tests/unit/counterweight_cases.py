"""Webs with counterweights that several tests share."""

from __future__ import annotations

from typing import Any

from cranktopo.remodel.fit import scene_with_web
from cranktopo.scene import Scene, scene_from_dict

PLAIN = {"outer_radius_mm": 62.0, "half_angle_deg": 60.0}
THIN = {"outer_radius_mm": 55.0, "half_angle_deg": 75.0, "thickness_mm": 12.0, "face": "pin"}
DISC = {"outer_radius_mm": 70.0, "half_angle_deg": 90.0}


def roomy_scene(scene: Scene) -> Scene:
    """The Mikron with a design space that holds counterweights."""
    data = scene.model_dump(mode="json", exclude_none=True)
    data["envelope"] |= {"half_width_mm": 75.0, "y_min_mm": -75.0}
    return scene_from_dict(data, "roomy")


def weighted(scene: Scene, counterweight: dict[str, Any], **features: Any) -> Scene:
    """The scene with a counterweight."""
    web = scene.web.model_dump(mode="json", exclude_none=True)
    return scene_with_web(scene, {**web, **features, "counterweight": counterweight})
