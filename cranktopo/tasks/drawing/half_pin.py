"""The other half of a split crankpin beside a half throw: its place, its angle, and what a sheet says of it.

A half throw is seen from its crankpin, its own half pin up. Of either half the other half pin is then to the
right where the splay is positive: the crank turns from up to the right, and looks the other way at the
second half.
"""

from __future__ import annotations

from math import cos, radians, sin
from typing import Any

import numpy as np

from cranktopo.design.assumed import pin_overlap_mm
from cranktopo.design.crank_throws import half_turns_deg, is_split
from cranktopo.design.schema import Scene
from cranktopo.report.drafting import INK, TEXT_SIZE, THIN, centre_line, circle, number_mm

ANGLE_MM = 12.0
"""Paper above a split pin for the angle of its halves."""
_ARC_MM, _BEYOND_MM, _TEXT_MM = 4.0, 1.5, 3.2
"""Paper from the pin to the arc of the angle, and from that to the ends of its lines and to its text."""
_HEAD = 6
"""Points of an arc that an arrowhead takes its direction from."""


def splay_deg(scene: Scene) -> float:
    """Return the angle of the second half pin ahead of the first one, deg; 0 of a straight pin."""
    near, far = half_turns_deg(scene)
    return far - near


def other_axis_mm(scene: Scene) -> tuple[float, float]:
    """Return the place of the other half pin's axis in the front view of a half throw."""
    turn, radius = radians(splay_deg(scene)), scene.throw.radius_mm
    return radius * sin(turn), radius * cos(turn)


def front_reach_mm(scene: Scene) -> float:
    """Return how far a split pin reaches to either side in the front view; 0 of a straight pin."""
    return abs(other_axis_mm(scene)[0]) + scene.throw.crankpin.radius_mm if is_split(scene) else 0.0


def draw_other_half_pin(axes: Any, scene: Scene, mm: float) -> None:
    """Draw the other half pin, cut away before the view, and the angle to it; `mm` is one of paper."""
    pin, radius, (x, y) = scene.throw.crankpin.radius_mm, scene.throw.radius_mm, other_axis_mm(scene)
    circle(axes, pin, y, "-.", 0.8, x=x)
    way = np.array([x, y]) / radius
    arc_mm = radius + pin + _ARC_MM * mm
    end = arc_mm + _BEYOND_MM * mm
    centre_line(axes, (0.0, 0.0), tuple(end * way))
    across = 1.15 * pin * np.array([way[1], -way[0]])
    centre_line(axes, (x - across[0], y - across[1]), (x + across[0], y + across[1]))
    centre_line(axes, (0.0, radius + pin), (0.0, end))
    turns = np.radians(np.linspace(0.0, splay_deg(scene), 60))
    arc = arc_mm * np.column_stack([np.sin(turns), np.cos(turns)])
    axes.plot(*arc.T, color=THIN, lw=0.6)
    for tip, tail in ((0, _HEAD), (-1, -1 - _HEAD)):
        arrow = {"arrowstyle": "-|>", "lw": 0.6, "color": INK, "shrinkA": 0, "shrinkB": 0}
        axes.annotate("", arc[tip], arc[tail], arrowprops=arrow)
    text = f"{abs(splay_deg(scene)):g}° ±{scene.drawing.throw_angle_tolerance_deg:g}°"
    aside = abs(sin(radians(splay_deg(scene)) / 2)) * number_mm(text) / 2
    middle = arc[len(arc) // 2] * (1 + (_TEXT_MM + aside) * mm / arc_mm)
    axes.text(*middle, text, fontsize=TEXT_SIZE + 0.5, ha="center", va="center")


def split_lines(scene: Scene) -> list[str]:
    """Return the line of the table on a split pin; none of a straight one."""
    if not is_split(scene):
        return []
    half_mm = scene.throw.crankpin.length_mm / 2
    return [f"{'':13}half pin {half_mm:g} long, overlap {pin_overlap_mm(scene):.2f}"]


def split_notes(scene: Scene, *, alone: bool) -> list[str]:
    """Return the notes of a sheet on a split pin; `alone`: it stands for both halves of the throw."""
    if not is_split(scene):
        return []
    sense = "ahead of" if splay_deg(scene) > 0 else "behind"
    return [
        f"Split crankpin, dash-dotted the other half: half pin b, toward the output, is "
        f"{abs(splay_deg(scene)):g}° {sense} half pin a in the sense of rotation. No web is between them.",
        *["The other half is this one, half a turn about the line midway between both half pins."] * alone,
    ]
