"""Webs that the faces of a half throw speak for, and profiles through its silhouette in their place."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

import numpy as np

from cranktopo.base.arrays import Array
from cranktopo.tasks.crank_import.counterweight import counterweights
from cranktopo.tasks.crank_import.fits import centred_ellipse, near_ellipse
from cranktopo.tasks.crank_import.half_body import HalfBody
from cranktopo.tasks.crank_import.silhouette import half_width_mm, outer_edge
from cranktopo.tasks.importing.faces import DIGITS, FLAT, Faces, PlaneFace

if TYPE_CHECKING:
    from manifold3d import CrossSection

_STATIONS = 17
_SAMPLED = 6
"""Decimals of a dimension that is taken from triangles."""
_SIDES = 4
"""Plane sides that are tried, the largest first: floors of grooves are among them."""
_ARM = 1.2
"""Half-width of a web without plane sides beside its counterweight, over the main journal's radius."""


def web_candidates(
    body: HalfBody, radius_mm: float, silhouette: CrossSection
) -> Iterator[tuple[str, dict[str, Any]]]:
    """Yield webs in words and as tables of a scene, the plainest first, profiles last."""
    edge = outer_edge(silhouette)
    thickness = {"thickness_mm": round(body.half.thickness_mm, DIGITS)}
    weights: list[dict[str, Any]] = [{}, *({"counterweight": one} for one in counterweights(body))]
    for outline in _outlines(body.faces, radius_mm, edge):
        for weight in weights:
            yield _words(outline["outline"], weight), {**thickness, **outline, **weight}
    arm = _arm_mm(body)
    for weight in weights:
        profile = _profile(edge, arm if weight else None)
        yield _words("profile through stations", weight), {**thickness, **profile, **weight}


def _words(outline: str, weight: dict[str, Any]) -> str:
    return f"{outline} with a counterweight" if weight else outline


def _outlines(faces: Faces, radius: float, edge: Array) -> Iterator[dict[str, Any]]:
    """Yield outlines whose sides are planes, hulls of two circles and rectangles, and the ellipse."""
    sides = (tuple(round(_from_axis_mm(side, y), DIGITS) for y in (0.0, radius)) for side in faces.sides)
    for main, pin in list(dict.fromkeys(sides))[:_SIDES]:
        if min(main, pin) <= 0:
            continue
        if abs(main - pin) < FLAT * radius:
            yield {"outline": "obround", "width_mm": 2 * main}
            yield from _rectangles(faces, radius, main, edge)
        else:
            yield {"outline": "tapered", "main_radius_mm": main, "pin_radius_mm": pin}
    for points in faces.patches_mm:
        exact = centred_ellipse(points[:, :2] - np.array([0.0, radius / 2]))
        if exact is not None:
            lateral, along = (round(semi, DIGITS) for semi in exact)
            yield {"outline": "ellipse", "semi_axis_throw_mm": along, "semi_axis_lateral_mm": lateral}
    lateral, along = (round(semi, _SAMPLED) for semi in near_ellipse(edge - np.array([0.0, radius / 2])))
    yield {"outline": "ellipse", "semi_axis_throw_mm": along, "semi_axis_lateral_mm": lateral}


def _from_axis_mm(side: PlaneFace, y_mm: float) -> float:
    """Return the distance of a plane from the line along z at a place along the throw."""
    return float(side.normal @ (side.point_mm - np.array([0.0, y_mm, 0.0])))


def _rectangles(faces: Faces, radius: float, half: float, edge: Array) -> Iterator[dict[str, Any]]:
    tops = {
        round(float(plane.point_mm[1]) - radius, DIGITS)
        for plane in faces.planes
        if plane.upright and plane.normal[1] > 1 - FLAT
    }
    tops.add(round(float(edge[:, 1].max()) - radius, _SAMPLED))
    corners = {
        round(face.radius_mm, DIGITS)
        for face in faces.cylinders
        if face.outward
        and face.upright
        and abs(abs(face.point_mm[0]) - (half - face.radius_mm)) < 1e-4 * half
    }
    for top in sorted((top for top in tops if top > 0), reverse=True)[:2]:
        table = {"outline": "rectangle", "width_mm": 2 * half, "overhang_mm": top}
        yield from ({**table, "corner_radius_mm": corner} for corner in sorted(corners))
        yield table


def _arm_mm(body: HalfBody) -> float:
    """Return the half-width of the web beside its counterweight, from the largest plane side."""
    if not body.faces.sides:
        return _ARM * body.half.main.radius_mm
    return float(body.faces.sides[0].point_mm[0])


def _profile(edge: Array, arm_mm: float | None) -> dict[str, Any]:
    """Return the profile through a silhouette; `arm_mm`: below the crank axis it is round, so wide."""
    low, high = float(edge[:, 1].min()), float(edge[:, 1].max())
    if arm_mm is not None:
        low = -arm_mm
    stations = low + (high - low) * (1 - np.cos(np.linspace(0, np.pi, _STATIONS))) / 2
    stations = np.round(stations, 4)
    widths = np.array([half_width_mm(edge, float(y)) for y in stations])
    if arm_mm is not None:
        round_end = np.sqrt(np.maximum(arm_mm**2 - np.minimum(stations, 0.0) ** 2, 0.0))
        widths = np.where(stations < 0, round_end, np.minimum(widths, arm_mm))
    least = max(1e-3, 0.02 * float(widths.max()))
    ends = [half_width_mm(edge, float(y)) for y in (low + 1e-3 * (high - low), high - 1e-3 * (high - low))]
    straight = [end > 0.35 * widths.max() for end in ends]
    widths[0] = 0.0 if arm_mm is not None or not straight[0] else ends[0]
    widths[-1] = ends[1] if straight[1] else 0.0
    widths[1:-1] = np.maximum(widths[1:-1], least)
    return {
        "outline": "profile",
        "stations_mm": stations.tolist(),
        "half_widths_mm": np.round(widths, 4).tolist(),
    }
