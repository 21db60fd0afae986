"""Webs with counterweights that several tests share."""

from __future__ import annotations

from typing import Any

from cranktopo.design.loading import scene_from_dict
from cranktopo.design.schema import Scene
from cranktopo.tasks.refit.fit import scene_with_web

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


OUTLINES: dict[str, dict[str, Any]] = {
    "obround": {"outline": "obround", "width_mm": 50.0},
    "rectangle": {"outline": "rectangle", "width_mm": 58.0, "overhang_mm": 30.0, "corner_radius_mm": 3.0},
    "ellipse": {"outline": "ellipse", "semi_axis_throw_mm": 56.0, "semi_axis_lateral_mm": 36.0},
    "tapered": {"outline": "tapered", "main_radius_mm": 36.0, "pin_radius_mm": 27.0},
    "widening": {"outline": "tapered", "main_radius_mm": 27.0, "pin_radius_mm": 36.0},
    "profile": {
        "outline": "profile",
        "stations_mm": (-26.0, -15.0, 5.0, 24.0, 45.0, 64.0, 72.0),
        "half_widths_mm": (0.0, 21.0, 31.0, 34.0, 30.0, 21.0, 0.0),
    },
}
"""One outline of every kind, and one that widens toward the crankpin."""
