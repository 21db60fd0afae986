"""The split of the big end in the front view of the rod: joint, bolts, and the angle of an oblique one."""

from __future__ import annotations

from math import cos, radians, sin
from typing import Any

import numpy as np

from cranktopo.base.arrays import Array
from cranktopo.design.rod import Rod
from cranktopo.design.rod_split import in_rod, turns
from cranktopo.report.drafting import INK, TEXT_SIZE, THIN, centre_line, edges, hatched


def turned(rod: Rod, points: list[tuple[float, float]]) -> Array:
    """Return points of the frame of the split in that of the rod, (n, 2)."""
    u, v = np.array(points).T
    return np.column_stack(in_rod(rod, u, v))


def big_end_corners(rod: Rod) -> Array:
    """Return the corners of bosses and heads, (n, 2)."""
    half = rod.boss_width_mm / 2
    ends = [(half, -rod.boss_below_mm), (half, rod.boss_above_mm)]
    if rod.bolt is not None:
        head = -rod.boss_below_mm - rod.bolt.nominal.diameter_mm
        ends.append(((rod.bolt_distance_mm + rod.bolt.head_mm) / 2, head))
    return turned(rod, [(side * u, v) for u, v in ends for side in (-1, 1)])


def boss_top_mm(rod: Rod, x: float) -> float:
    """Return where the bosses end along the rod, beside its axis."""
    cosine, sine = turns(rod)
    top = (rod.boss_above_mm - x * sine) / cosine
    return min(top, (rod.boss_width_mm / 2 + x * cosine) / sine) if rod.split_angle_deg else top


def draw_split(axes: Any, rod: Rod, mm: float) -> None:
    """Draw the split, holes and threads of the bolts as hidden lines, their heads below the cap."""
    edge = max(rod.boss_width_mm, rod.big_end_diameter_mm) / 2
    for side in (-1, 1):
        edges(axes, [turned(rod, [(side * rod.big_end_bore_mm / 2, 0.0), (side * edge, 0.0)])], 1.6)
        if rod.bolt is None:
            continue
        u, below, d = side * rod.bolt_distance_mm / 2, -rod.boss_below_mm, rod.bolt.nominal.diameter_mm
        clamped = below + rod.bolt.grip_mm
        engaged, half = clamped + rod.bolt.engaged_mm, rod.bolt.head_mm / 2
        seen = [(below - d, below)]
        if rod.bolt.held_in == "nut":
            seen.append((clamped, engaged))
        for start, end in seen:
            box = [(u - half, start), (u + half, start), (u + half, end), (u - half, end)]
            hatched(axes, [turned(rod, box)], "")
        for wall in (-1, 1):
            for reach, low, high in ((rod.bolt_hole_mm, below, clamped), (d, clamped, engaged)):
                at = u + wall * reach / 2
                axes.plot(*turned(rod, [(at, low), (at, high)]).T, color=THIN, lw=0.7, ls="--")
        top = max(clamped + rod.bolt.engaged_mm, rod.boss_above_mm)
        start, end = turned(rod, [(u, below - d - 2 * mm), (u, top + 2 * mm)])
        centre_line(axes, tuple(start), tuple(end))


def draw_angle(axes: Any, rod: Rod, reach_mm: float, mm: float) -> None:
    """Draw the angle of an oblique split, from the line square to the rod's axis, as far out as a reach."""
    angle = radians(rod.split_angle_deg)
    edge = max(rod.boss_width_mm, rod.big_end_diameter_mm) / 2
    line = turned(rod, [(edge, 0.0), (reach_mm + 2 * mm, 0.0)])
    axes.plot(*line.T, color=THIN, lw=0.5)
    around = -np.linspace(0.0, angle, 61)
    axes.plot(reach_mm * np.cos(around), reach_mm * np.sin(around), color=INK, lw=0.7)
    for end, toward in ((0.0, 1.0), (-angle, -1.0)):
        tip = np.array([cos(end), sin(end)]) * reach_mm
        back = end - toward * min(3 * mm / reach_mm, angle / 2)
        tail = np.array([cos(back), sin(back)]) * reach_mm
        axes.annotate(
            "",
            tip,
            tail,
            arrowprops={"arrowstyle": "-|>", "lw": 0.7, "color": INK, "shrinkA": 0, "shrinkB": 0},
        )
    axes.text(
        reach_mm * cos(angle / 2),
        -reach_mm * sin(angle / 2),
        f"{rod.split_angle_deg:g}°",
        fontsize=TEXT_SIZE + 0.5,
        ha="center",
        va="center",
        bbox={"fc": "white", "ec": "none", "pad": 0.8},
    )
