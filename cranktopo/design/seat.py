"""The seat of a counterweight that is bolted on: how thick a layer of its web stays beneath it."""

from __future__ import annotations

from cranktopo.design.schema import Scene

_WALL_SHARE = 1 / 8
"""Least thickness of a seat over that of the web: 3 mm at 24 mm, the least wall of a usual re-model."""


def seat_mm(scene: Scene) -> float | None:
    """Return the thickness, mm, of the layer that holds a bolted counterweight; None without one.

    It takes the engaged threads of the bolts that hold the counterweight, and is never thinner than a wall.
    """
    weight = scene.web.counterweight
    if weight is None or not weight.bolted:
        return None
    held = [joint.engaged_mm for joint in scene.bolted_joint if joint.holds == "web.counterweight"]
    return max([_WALL_SHARE * scene.web.thickness_mm, *held])
