"""Outlines of the rod for its drawing: seen along the pins, cut along it, and the section of its shank.

Polygons are (n, 2), mm, counter-clockwise outside and clockwise inside. Along the rod is y, from the big end.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np

from cranktopo.base.arrays import Array
from cranktopo.design.rod import Rod
from cranktopo.design.rod_body import shank_edge_mm
from cranktopo.design.rod_split import turns

if TYPE_CHECKING:
    from manifold3d import CrossSection

_POINTS, _ROUND = 400, 180
"""Points of a side of the shank, and of a circle."""


def front_outline(rod: Rod, length_mm: float) -> list[Array]:
    """Return what is seen along the pins, x to the right, both bores cut out."""
    y = np.linspace(0.0, length_mm, _POINTS)
    half = shank_edge_mm(rod, length_mm, y)
    shank = _polygon(np.column_stack([np.r_[half, -half[::-1]], np.r_[y, y[::-1]]]))
    boss = _rectangle(rod.boss_width_mm / 2, -rod.boss_below_mm, rod.boss_above_mm)
    boss = boss.rotate(-rod.split_angle_deg) if rod.split_angle_deg else boss
    eyes = _disc(rod.small_end_diameter_mm, length_mm) + _disc(rod.big_end_diameter_mm, 0.0)
    bores = _disc(rod.small_end_bore_mm, length_mm) + _disc(rod.big_end_bore_mm, 0.0)
    return _polygons(shank + boss + eyes - bores)


def lengthwise_cut(rod: Rod, length_mm: float) -> list[Array]:
    """Return the section x = 0, z to the right, with its split."""
    small, big = rod.small_end_diameter_mm / 2, rod.big_end_diameter_mm / 2
    web = rod.web_mm if rod.shank == "I" else rod.shank_width_mm
    ends = _rectangle(rod.small_end_width_mm / 2, length_mm - small, length_mm + small)
    below, above = _boss_range(rod)
    ends += _rectangle(rod.big_end_width_mm / 2, -max(big, below), max(big, above))
    whole = ends + _rectangle(web / 2, 0.0, length_mm)
    for at, bore in ((length_mm, rod.small_end_bore_mm), (0.0, rod.big_end_bore_mm)):
        whole -= _rectangle(length_mm, at - bore / 2, at + bore / 2)
    if rod.oil_hole_mm:
        whole -= _rectangle(rod.oil_hole_mm / 2, 0.0, length_mm)
    return _polygons(whole - _upper_hole(rod) if rod.split_angle_deg and rod.bolt_hole_mm else whole)


def _boss_range(rod: Rod) -> tuple[float, float]:
    """Return the reach of the bosses in the section, below and above the axis of the big end."""
    cosine, sine = turns(rod)
    side = rod.boss_width_mm / 2 / sine if sine else math.inf
    return min(rod.boss_below_mm / cosine, side), min(rod.boss_above_mm / cosine, side)


def _upper_hole(rod: Rod) -> CrossSection:
    """The ellipse in which an oblique bolt's hole meets the section, as far as the hole is long."""
    cosine, sine = turns(rod)
    ellipse = _disc(rod.bolt_hole_mm, 0.0).scale((1.0, 1 / sine))
    ellipse = ellipse.translate((0.0, rod.bolt_distance_mm / 2 / sine))
    return ellipse ^ _rectangle(rod.bolt_hole_mm, 0.0, rod.boss_above_mm / cosine)


def bush_cut(rod: Rod, length_mm: float) -> list[Array]:
    """Return the bush in the same section; nothing without one."""
    if not rod.bush_thickness_mm:
        return []
    outer, inner = rod.small_end_bore_mm / 2, rod.pin_diameter_mm / 2
    whole = _rectangle(rod.small_end_width_mm / 2, length_mm - outer, length_mm + outer)
    return _polygons(whole - _rectangle(length_mm, length_mm - inner, length_mm + inner))


def shank_cut(rod: Rod, length_mm: float, y_mm: float) -> list[Array]:
    """Return the section of the shank at a place, x to the right, z upward."""
    half = float(shank_edge_mm(rod, length_mm, np.array([y_mm]))[0])
    wide = rod.shank_width_mm / 2
    whole = _rectangle(half, -wide, wide)
    pocket: Any = None
    if rod.shank == "I":
        taper = (rod.shank_small_mm - rod.shank_big_mm) / length_mm
        inner = (rod.shank_big_mm + taper * y_mm) / 2 - rod.flange_mm
        pocket = _rectangle(inner, -wide, wide) - _rectangle(inner, -rod.web_mm / 2, rod.web_mm / 2)
    elif rod.shank == "H":
        deep = wide - rod.flange_mm
        pocket = _rectangle(half, -deep, deep) - _rectangle(rod.web_mm / 2, -deep, deep)
    if pocket is not None:
        whole -= pocket
    return _polygons(whole - _disc(rod.oil_hole_mm, 0.0) if rod.oil_hole_mm else whole)


def _disc(diameter_mm: float, y_mm: float) -> CrossSection:
    from manifold3d import CrossSection

    return CrossSection.circle(diameter_mm / 2, _ROUND).translate((0.0, y_mm))


def _rectangle(half_mm: float, low_mm: float, high_mm: float) -> CrossSection:
    x, (low, high) = half_mm, (low_mm, high_mm)
    return _polygon(np.array([(-x, low), (x, low), (x, high), (-x, high)]))


def _polygon(points: Array) -> CrossSection:
    from manifold3d import CrossSection, FillRule

    return CrossSection([points], FillRule.NonZero)


def _polygons(section: CrossSection) -> list[Array]:
    return [np.asarray(polygon) for polygon in section.to_polygons()]
