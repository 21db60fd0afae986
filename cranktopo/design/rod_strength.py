"""Worth of the strengths of a material in a rod of this size: remarks on safeties, notes on a drawing."""

from __future__ import annotations

import math
from collections.abc import Collection

from cranktopo.design.material import LIBRARY_STRENGTHS
from cranktopo.design.rod import Rod
from cranktopo.design.schema import Scene
from cranktopo.design.strength import RulingSection, material_notes, material_remarks


def rod_strength_remarks(
    rod: Rod, scene: Scene, used: Collection[str] = LIBRARY_STRENGTHS
) -> tuple[str, ...]:
    """Return what the library's strengths do not hold for in a rod, as `strength_remarks` of a crank."""
    return material_remarks(rod.material or scene.material, rod_ruling_section(rod), used)


def rod_strength_notes(rod: Rod, scene: Scene) -> list[str]:
    """Return what the rod's drawing says of the material, as `strength_notes` of a crank."""
    return material_notes(rod.material or scene.material, rod_ruling_section(rod))


def rod_ruling_section(rod: Rod) -> RulingSection:
    """Return the thickness through which the rod is hardened: the diameter of the largest ball in it.

    Walls of eyes and shank have their thickness. Bores count as open, as those of a crank.
    """
    small = (rod.small_end_diameter_mm - rod.small_end_bore_mm) / 2
    big = (rod.big_end_diameter_mm - rod.big_end_bore_mm) / 2
    parts = {
        "bosses": max(_boss_mm(rod, rod.boss_above_mm), _boss_mm(rod, rod.boss_below_mm)),
        "shank": _shank_mm(rod),
        "small end": min(small, rod.small_end_width_mm),
        "big end": min(big, rod.big_end_width_mm),
    }
    part = max(parts, key=lambda name: parts[name])
    own = "rod.material" if rod.material else "material"
    return RulingSection(parts[part], "rod", own, part)


def _boss_mm(rod: Rod, height_mm: float) -> float:
    """Diameter of the largest ball in a boss: it lies between two faces, or in the corner beside the bore."""
    half, bore = rod.boss_width_mm / 2, rod.big_end_bore_mm / 2
    total = half + height_mm + bore
    corner = total - math.sqrt(total**2 - (half**2 + height_mm**2 - bore**2))
    return min(height_mm, rod.big_end_width_mm, 2 * corner)


def _shank_mm(rod: Rod) -> float:
    if rod.shank == "plain":
        return min(rod.shank_width_mm, max(rod.shank_small_mm, rod.shank_big_mm))
    return max(rod.flange_mm, rod.web_mm)
