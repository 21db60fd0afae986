"""The room that pistons and crankcase leave in the section in which web and counterweight turn.

In each direction from the crank axis the web may reach to a largest radius: to the crankcase, and as far as
it meets no piston while it turns. Of the piston the lower edge of its skirt counts, as wide as it is above
the web; whatever lies beyond the first radius that meets it counts as in its way.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from cranktopo.base.arrays import Array
from cranktopo.base.errors import invalid
from cranktopo.design.schema import Scene
from cranktopo.throw.feature import Reach

PISTON, CRANKCASE = "piston skirt", "crankcase"
_CRANK_ANGLES = 1441
_ANGLES_RAD = np.linspace(0.0, np.pi, 721)
"""Directions from that of the crankpin."""


@dataclass(frozen=True)
class ClearanceLimit:
    """The largest radius of the web in each direction from the crankpin's, to half a turn on either side."""

    angle_rad: Array
    radius_mm: Array

    def outside_mm(self, x_mm: Array, y_mm: Array) -> Array:
        """Return how far points lie beyond the largest radius, mm; 0 or less within."""
        angle = np.arctan2(np.abs(x_mm), y_mm)
        return np.asarray(np.hypot(x_mm, y_mm) - np.interp(angle, self.angle_rad, self.radius_mm))

    def gradients(self, x_mm: Array, y_mm: Array) -> Array:
        """Derivatives of `outside_mm` by x and y at points with x >= 0, (n, 2)."""
        away = np.maximum(np.hypot(x_mm, y_mm), 1e-9)
        rise = np.gradient(self.radius_mm, self.angle_rad)
        turn = np.interp(np.arctan2(np.abs(x_mm), y_mm), self.angle_rad, rise) / away
        x, y = x_mm / away, y_mm / away
        return np.stack([x - turn * y, y + turn * x], axis=-1)

    def contour(self, far_mm: float) -> Array:
        """Corners (n, 2) of what is free, at most so far from the crank axis, counter-clockwise."""
        radius = np.minimum(self.radius_mm, far_mm)
        right = np.column_stack([radius * np.sin(self.angle_rad), radius * np.cos(self.angle_rad)])[::-1]
        left = right[1:-1][::-1] * (-1.0, 1.0)
        return np.concatenate([right, left])


def clearance_limit(scene: Scene) -> ClearanceLimit | None:
    """Return what `[envelope.clearance]` leaves with its least gap; None without one."""
    found = _limits(scene, with_gap=True)
    if not found:
        return None
    return ClearanceLimit(_ANGLES_RAD, np.min([limit.radius_mm for limit in found.values()], axis=0))


def clearances_mm(scene: Scene) -> dict[str, float]:
    """Least radial room of web and counterweight to the piston skirt and to the crankcase, mm."""
    x, y = np.concatenate([np.stack(points) for _, _, points in _edges(scene)], axis=1)
    return clearances_of_points_mm(scene, x, y)


def clearances_of_points_mm(scene: Scene, x_mm: Array, y_mm: Array) -> dict[str, float]:
    """Least radial room of points of a body that turns in the scene, mm, by what is in the way."""
    return {name: float(-limit.outside_mm(x_mm, y_mm).max()) for name, limit in turning_limits(scene).items()}


def turning_limits(scene: Scene) -> dict[str, ClearanceLimit]:
    """Return what piston skirt and crankcase leave, without a gap."""
    return _limits(scene, with_gap=False)


def clearance_text(scene: Scene) -> str:
    """Return the least room of web and counterweight in words, or what is in the way; empty where unknown."""
    clearance = scene.envelope.clearance if scene.envelope else None
    if clearance is None:
        return pin_in_the_way(scene)
    return f"{clearances_text(clearances_mm(scene))}; at least {clearance.least_gap_mm:g} mm stay"


def room_words(scene: Scene) -> str:
    """Return the room of web and counterweight in words; empty where nothing is known to be in the way."""
    clearance = scene.envelope.clearance if scene.envelope else None
    if clearance is None or not turning_limits(scene):
        return ""
    return clearances_text(clearances_mm(scene))


def pin_in_the_way(scene: Scene) -> str:
    """Tell of a counterweight that reaches the axis of the piston pin; empty where none does.

    The pin is nearest at bottom dead centre, the length of the rod less the throw radius from the crank axis.
    """
    webs = (scene.web, scene.second_web)
    radii = [web.counterweight.outer_radius_mm for web in webs if web and web.counterweight]
    if scene.engine is None or not radii:
        return ""
    nearest, radius = scene.engine.rod_length_mm - scene.throw.radius_mm, max(radii)
    if radius < nearest:
        return ""
    return (
        f"the counterweight reaches {radius:g} mm from the crank axis, past the axis of the piston pin at "
        f"{nearest:g} mm at bottom dead centre; [envelope.clearance] tells what the piston leaves"
    )


def clearances_text(clearances_mm: Mapping[str, float]) -> str:
    """Rooms by what is in the way in words."""
    rooms = ", ".join(f"{room:.2f} mm to the {name}" for name, room in clearances_mm.items())
    return rooms or "nothing is in the way"


def check_clearance(scene: Scene) -> None:
    """Check that web and counterweight of the scene keep the clearances."""
    clearance = scene.envelope.clearance if scene.envelope else None
    if clearance is None:
        return
    if clearance.piston_skirt_mm is not None:
        _check_piston(scene, clearance.piston_skirt_mm, clearance.least_gap_mm)
    for name, limit in _limits(scene, with_gap=True).items():
        for key, value, (x, y) in _edges(scene):
            outside = limit.outside_mm(x, y)
            worst = int(outside.argmax())
            if outside[worst] > 1e-6:
                at = f"x = {x[worst]:.4g}, y = {y[worst]:.4g} mm"
                radius = float(np.hypot(x[worst], y[worst]))
                raise invalid(
                    key,
                    value,
                    f"reaches {radius:.4g} mm from the crank axis at {at}, the {name} leaves "
                    f"{radius - outside[worst]:.4g} mm with the least gap of {clearance.least_gap_mm:g} mm "
                    "[envelope.clearance]",
                    "Make it smaller, or correct the clearance.",
                )


def _check_piston(scene: Scene, skirt_mm: float, gap_mm: float) -> None:
    if scene.engine is None:
        raise scene.invalid(
            "envelope.clearance.piston_skirt_mm",
            "needs the piston's diameter and the rod's length",
            "Add [engine] with bore_mm and rod_length_mm.",
        )
    room = scene.engine.rod_length_mm - scene.throw.radius_mm - scene.throw.main_journal.radius_mm
    if skirt_mm + gap_mm >= room:
        raise scene.invalid(
            "envelope.clearance.piston_skirt_mm",
            f"with least_gap_mm = {gap_mm:g} mm must be smaller than {room:.4g} mm, what lies between main "
            "journal and piston pin at bottom dead centre",
            "Give the distance from the piston pin to the skirt's lower edge.",
        )


@lru_cache(maxsize=8)
def _limits(scene: Scene, with_gap: bool) -> dict[str, ClearanceLimit]:
    clearance = scene.envelope.clearance if scene.envelope else None
    found: dict[str, ClearanceLimit] = {}
    if clearance is None:
        return found
    gap = clearance.least_gap_mm if with_gap else 0.0
    if clearance.piston_skirt_mm is not None and _half_width_mm(scene):
        assert scene.engine is not None
        lengths = scene.engine.rod_length_mm, scene.throw.radius_mm, clearance.piston_skirt_mm + gap
        found[PISTON] = ClearanceLimit(_ANGLES_RAD, _below_piston(*lengths, _half_width_mm(scene)))
    if clearance.crankcase_radius_mm is not None:
        radius = np.full(len(_ANGLES_RAD), clearance.crankcase_radius_mm - gap)
        found[CRANKCASE] = ClearanceLimit(_ANGLES_RAD, radius)
    return found


@lru_cache(maxsize=8)
def _below_piston(rod_mm: float, throw_mm: float, skirt_mm: float, half_mm: float) -> Array:
    """Largest radius in each direction that stays below an edge so far below the pin, (directions,).

    It does not depend on the web: while that is dragged it is found once.
    """
    crank = np.linspace(0.0, 2 * np.pi, _CRANK_ANGLES)
    pin = throw_mm * np.cos(crank) + np.sqrt(rod_mm**2 - (throw_mm * np.sin(crank)) ** 2)
    edge = pin - skirt_mm
    turned = _ANGLES_RAD[:, None] + crank
    along, across = np.cos(turned), np.abs(np.sin(turned))
    with np.errstate(divide="ignore"):
        radius = np.where(along > 1e-9, edge / np.maximum(along, 1e-9), np.inf)
    return np.asarray(np.where(radius * across <= half_mm, radius, np.inf).min(axis=1))


def _half_width_mm(scene: Scene) -> float:
    """Half of the width of a round piston above the web's pin face; 0 where the web lies beside it."""
    assert scene.engine is not None
    beside = scene.throw.crankpin.length_mm / 2 - max(scene.rod_places_mm)
    return math.sqrt(max((scene.engine.bore_mm / 2) ** 2 - beside**2, 0.0))


def _edges(scene: Scene) -> list[Reach]:
    """Key path, its value, and points at x >= 0 of the outline and of the counterweight."""
    low, high = scene.web.y_range_mm(scene.throw.radius_mm)
    y = (low + high) / 2 - (high - low) / 2 * np.cos(np.linspace(0, np.pi, 801))
    outline = scene.web.half_width_mm(scene.throw.radius_mm, y), y
    found: list[Reach] = [("web.outline", scene.web.outline, outline)]
    return found + [reach for key, feature in scene.web.features() for reach in feature.reach_mm(scene, key)]
