"""The front view of a web as strokes, and the dimensions that are dragged on it."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any

import numpy as np

from cranktopo.design.clearance import turning_limits
from cranktopo.design.loading import scene_from_dict
from cranktopo.design.schema import Scene
from cranktopo.tasks.drawing.views import outline_points
from cranktopo.throw.envelope import BoxEnvelope, CylinderEnvelope, OutlineEnvelope
from cranktopo.throw.primitives import Circle

_POINTS = 90
_SMALL = 4
"""Of so many points of an outline a small picture has one."""
_FAR = 3.0


def front_view(scene: Scene) -> dict[str, Any]:
    """Return the view along the crank axis, mm: paths, circles, and handles of dimensions.

    A handle moves along its direction; its dimension changes by `per_mm` of that way.
    """
    y, half = outline_points(scene)
    pick = np.linspace(0, len(y) - 1, _POINTS).round().astype(int)
    outline = np.column_stack([np.r_[half[pick], -half[pick][::-1]], np.r_[y[pick], y[pick][::-1]]])
    features = [feature.drawing(scene) for _, feature in scene.web.features()]
    circles = [
        {"at": [0.0, place], "radius": j.radius_mm, "kind": "journal"} for j, place in scene.throw.journals
    ]
    circles += [
        {"at": [0.0, place], "radius": j.bore_radius_mm, "kind": "bore"}
        for j, place in scene.throw.journals
        if j.bore_radius_mm
    ]
    paths = [{"points": _rounded(outline), "kind": "web", "closed": True}]
    paths += [{"points": _rounded(f.added), "kind": "web", "closed": True} for f in features if f.added]
    for stroke in (stroke for feature in features for stroke in feature.front):
        if isinstance(stroke, Circle):
            circles.append({"at": list(stroke.centre), "radius": stroke.radius, "kind": "feature"})
        else:
            paths.append({"points": _rounded(stroke.points), "kind": "feature", "closed": False})
    return {
        "paths": paths,
        "circles": circles,
        "room": [*_envelope(scene), *_turning(scene)],
        "handles": list(_handles(scene)),
    }


def web_outlines(data: dict[str, Any]) -> list[list[list[float]]]:
    """Return the closed outlines of the web of a design, mm, for a small picture."""
    paths = front_view(scene_from_dict(data, "design", whole=True))["paths"]
    return [path["points"][::_SMALL] for path in paths if path["kind"] == "web"]


def _rounded(points: Any) -> list[list[float]]:
    return np.round(np.asarray(points, dtype=float), 3).tolist()


def _envelope(scene: Scene) -> Iterator[dict[str, Any]]:
    match scene.envelope:
        case BoxEnvelope(half_width_mm=x, y_min_mm=low, y_max_mm=high):
            yield {"points": [[-x, low], [x, low], [x, high], [-x, high]], "kind": "envelope", "closed": True}
        case CylinderEnvelope(radius_mm=radius):
            turn = np.linspace(0, 2 * np.pi, 73)
            points = _rounded(radius * np.column_stack([np.cos(turn), np.sin(turn)]))
            yield {"points": points, "kind": "envelope", "closed": True}
        case OutlineEnvelope(points_mm=points):
            yield {"points": _rounded(points), "kind": "envelope", "closed": True}


def _turning(scene: Scene) -> Iterator[dict[str, Any]]:
    """Yield what piston and crankcase leave, where it is near."""
    far = _FAR * (scene.throw.radius_mm + scene.throw.crankpin.radius_mm)
    for name, limit in turning_limits(scene).items():
        points = limit.contour(far)[::8]
        yield {"points": _rounded(points), "kind": name.replace(" ", "-"), "closed": True}


def _handles(scene: Scene) -> Iterator[dict[str, Any]]:
    throw, web = scene.throw, scene.web
    main, pin, radius = throw.main_journal, throw.crankpin, throw.radius_mm
    yield handle("throw.radius_mm", radius, (0.0, radius), (0.0, 1.0))
    yield handle(
        "throw.crankpin.outer_diameter_mm",
        pin.outer_diameter_mm,
        (0.0, radius + pin.radius_mm),
        (0.0, 1.0),
        2,
    )
    yield handle(
        "throw.main_journal.outer_diameter_mm", main.outer_diameter_mm, (-main.radius_mm, 0.0), (-1.0, 0.0), 2
    )
    if (width := getattr(web, "width_mm", None)) is not None:
        yield handle("web.width_mm", width, (width / 2, radius / 2), (1.0, 0.0), 2)
    for name, place in (("main_radius_mm", 0.0), ("pin_radius_mm", radius)):
        if (round_mm := getattr(web, name, None)) is not None:
            yield handle(f"web.{name}", round_mm, (round_mm, place), (1.0, 0.0))
    for number, pocket in enumerate(web.pocket):
        x, y = getattr(pocket, "x_mm", 0.0), pocket.y_mm
        yield handle(f"web.pocket[{number}].y_mm", y, (x, y), (0.0, 1.0))
        if (bore := getattr(pocket, "diameter_mm", None)) is not None:
            yield handle(f"web.pocket[{number}].diameter_mm", bore, (x + bore / 2, y), (1.0, 0.0), 2)
    for number, bevel in enumerate(web.bevel):
        yield handle(f"web.bevel[{number}].y_mm", bevel.y_mm, (0.0, bevel.y_mm), (0.0, 1.0))
    if (weight := web.counterweight) is not None:
        outer, turn = weight.outer_radius_mm, math.radians(weight.half_angle_deg)
        yield handle("web.counterweight.outer_radius_mm", outer, (0.0, -outer), (0.0, -1.0))
        corner = (outer * math.sin(turn), -outer * math.cos(turn))
        way = (math.cos(turn), math.sin(turn))
        yield handle(
            "web.counterweight.half_angle_deg", weight.half_angle_deg, corner, way, math.degrees(1 / outer)
        )


def handle(
    key: str, value: float, at: tuple[float, float], way: tuple[float, float], per_mm: float = 1.0
) -> dict[str, Any]:
    """Return a place of a view at which a dimension is dragged along a way."""
    return {"key": key, "value": value, "at": [*at], "way": [*way], "per_mm": per_mm}
