"""Room of the bolts of the cap: heads on the bosses of the cap, threads in those of the rod or in nuts."""

from __future__ import annotations

from collections.abc import Iterator

from cranktopo.design.bolt import Bolt
from cranktopo.design.rod import Rod
from cranktopo.design.rod_split import turns

_NUT_ON_BOSS = 1e-3
"""Share by which the grip of a through bolt may differ from the height of both bosses."""


def bolt_shortfalls(rod: Rod, length_mm: float) -> Iterator[tuple[str, float, str]]:
    """Yield keys of what bosses and bolts ask of each other: the share that is missing, and why."""
    if not rod.split_angle_deg:
        free = length_mm - rod.small_end_diameter_mm / 2
        yield (
            "boss_above_mm",
            rod.boss_above_mm / free - 1,
            f"must be at most {free:.4g} mm: beyond, the bosses reach the small end",
        )
    if rod.bolt is None:
        return
    if rod.bolt.held_in == "nut":
        yield from _of_nut(rod, rod.bolt)
    else:
        yield from _of_tapped_hole(rod, rod.bolt)


def thread_end_mm(rod: Rod, bolt: Bolt) -> float:
    """Return how far above the split the thread of a bolt is engaged."""
    return bolt.grip_mm + bolt.engaged_mm - rod.boss_below_mm


def _of_tapped_hole(rod: Rod, bolt: Bolt) -> Iterator[tuple[str, float, str]]:
    """The grip reaches through the cap's boss, and the engaged thread ends in the rod's."""
    engaged, above, below = bolt.engaged_mm, rod.boss_above_mm, rod.boss_below_mm
    why = f"must be at least {engaged:.4g} mm: the engaged thread of a bolt ends in the rod's boss"
    yield "boss_above_mm", engaged / above - 1, why
    most = below + above - engaged
    allowed = (
        f"must be {below:.4g} to {most:.4g} mm: the bolt clamps the cap's boss, and its {engaged:.4g} mm of "
        f"engaged thread end in the rod's boss, rod.boss_above_mm = {above:.4g}"
    )
    yield "bolt.grip_mm", below / bolt.grip_mm - 1, allowed
    yield "bolt.grip_mm", thread_end_mm(rod, bolt) / above - 1, allowed


def _of_nut(rod: Rod, bolt: Bolt) -> Iterator[tuple[str, float, str]]:
    """The grip is the height of both bosses, and the nut has its place beside the shank."""
    both = rod.boss_above_mm + rod.boss_below_mm
    why = f"must be {both:.5g} mm, the height of both bosses: head and nut lie on them"
    yield "bolt.grip_mm", abs(bolt.grip_mm / both - 1) - _NUT_ON_BOSS, why
    cosine, sine = turns(rod)
    inner = (rod.bolt_distance_mm - bolt.head_mm) / 2 * cosine - thread_end_mm(rod, bolt) * sine
    shank = max(rod.shank_big_mm, rod.shank_small_mm) / 2
    at = f"at this rod.split_angle_deg, {rod.split_angle_deg:g} deg" if rod.split_angle_deg else ""
    nut = f"the upper nut meets the shank {at}" if at else "the nuts meet the shank"
    yield "bolt_distance_mm", (shank - inner) / rod.bolt_distance_mm, f"{nut}: take a tapped hole"
