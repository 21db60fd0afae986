"""The hand of a crank: told where its mirror image is another crank, and what a file says of it.

A mirrored body is as good a body as the other: faces and triangles of both are alike but for signs of places.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from cranktopo.base.frames import shortest_turn_deg
from cranktopo.tasks.crank_import.found_crank import FoundCrank
from cranktopo.tasks.crank_import.half_body import HalfGroup

_Half = tuple[float, int, int]
"""Angle of the throw, number of the group, and its hand there: 0 for a half that is its own mirror image."""
_SAME_DEG = 0.1
_PLACED = re.compile(
    r"(#\d+)\s*=\s*CARTESIAN_TRANSFORMATION_OPERATOR_3D\s*\(\s*'[^']*'\s*,"
    r"\s*(#\d+)\s*,\s*(#\d+)\s*,\s*#\d+\s*,[^,]*,\s*(#\d+)\s*\)"
)
_DIRECTION = r"{}\s*=\s*DIRECTION\s*\(\s*'[^']*'\s*,\s*\(([^)]*)\)"


def hand_words(crank: FoundCrank, groups: Sequence[HalfGroup]) -> list[str]:
    """Tell of a crank that is not its own mirror image that its hand is that of the file."""
    halves = [_half(crank, groups, index) for index in range(len(crank.halves))]
    turned = [(-angle, group, -hand) for angle, group, hand in halves]
    swapped = [(angle, group, -hand) for angle, group, hand in reversed(halves)]
    if _same(halves, turned) or (not any(crank.ends) and _same(halves, swapped)):
        return []
    angles = [crank.angle_deg(pin) for pin in crank.pins]
    seen, mirrored = (
        ", ".join(f"{angle % 360:g}" for angle in own) for own in (angles, [-angle for angle in angles])
    )
    turned_about = f"throws at {mirrored} instead of {seen} deg"
    differ = turned_about if mirrored != seen else "webs or drillings mirrored"
    return [
        f"the hand of the crank is that of the file: its mirror image, with {differ}, is another crank, "
        "and no body tells that it was mirrored"
    ]


def _half(crank: FoundCrank, groups: Sequence[HalfGroup], index: int) -> _Half:
    half = crank.halves[index]
    number, group = next((n, one) for n, one in enumerate(groups) if any(own is half for own in one.halves))
    hand = 0 if group.own_image else -1 if any(own is half for own in group.mirrored) else 1
    return crank.angle_deg(half.pin), number, hand


def _same(one: Sequence[_Half], other: Sequence[_Half]) -> bool:
    """Tell whether two cranks are alike but for a turn about their axis."""
    turn = one[0][0] - other[0][0]
    return all(
        abs(shortest_turn_deg(a[0] - b[0] - turn)) < _SAME_DEG and a[1:] == b[1:]
        for a, b in zip(one, other, strict=True)
    )


def mirrored_by_file(path: Path) -> list[str]:
    """Tell the placements of a STEP file that mirror what they place: their directions are left-handed."""
    text = path.read_text(encoding="latin-1")
    return [
        f"{placed[1]} of the file places a body as its mirror image (CARTESIAN_TRANSFORMATION_OPERATOR_3D "
        "with left-handed axes)"
        for placed in _PLACED.finditer(text)
        if _is_left_handed(text, placed.groups()[1:])
    ]


def _is_left_handed(text: str, names: Sequence[str]) -> bool:
    found = [re.search(_DIRECTION.format(name), text) for name in names]
    axes = [[float(value) for value in one[1].split(",")] for one in found if one]
    return len(axes) == 3 and bool(np.linalg.det(np.array(axes)) < 0)
