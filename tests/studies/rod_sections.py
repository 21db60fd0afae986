"""Rods of Dolezal 2024 by elements at the sections of its safeties: `python -m tests.studies.rod_sections`.

    python -m tests.studies.rod_sections [DESIGN] ...

A table of each rod in Markdown: largest and smallest signed von Mises stress over the cycle and the safety
against yield, at every place and at five sections; where rigid pins touch, by the cosine, and with a smaller
radius at the neck. Dimensions of the rods are not printed.
"""

from __future__ import annotations

import sys
from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from cranktopo.design.loading import load_scene
from cranktopo.design.named import with_values
from cranktopo.design.schema import Scene
from cranktopo.tasks.rod.element_stage import rod_on_elements
from cranktopo.tasks.rod.element_stress import ElementStress

RODS = "mikron-iiic-rod", "mikron-iiic-rod-i", "mikron-iiic-rod-h"
NECK_RADIUS_MM = 12.0
SECTIONS = "crown of the eye", "middle of the shank", "middle of the cap", "sides of the big end"
HEAD = "| place | highest, MPa | lowest, MPa | yield |\n|---|---:|---:|---:|"
_NEAR_MM = 1.0


def at_section(stress: ElementStress, section: str) -> NDArray[np.bool_]:
    """Return the nodes of the surface within a millimetre of a section."""
    x, y, _ = stress.surface.points_mm
    length, bore = stress.fields.length_mm, stress.fields.rod.big_end_bore_mm
    found = (
        (np.abs(x) < _NEAR_MM) & (y > length),
        np.abs(y - length / 2) < _NEAR_MM,
        (np.abs(x) < _NEAR_MM) & (y < -bore / 2 + _NEAR_MM),
        (np.abs(y) < _NEAR_MM) & (np.abs(x) > bore / 2 - _NEAR_MM),
    )
    return np.asarray(found[SECTIONS.index(section)])


def largest_MPa(stress: ElementStress, section: str) -> float:
    """Return the largest von Mises stress over the cycle at a section."""
    return float(stress.largest_MPa[:, at_section(stress, section)].max())


def rows(scene: Scene, element_size_mm: float | None, *, contact: bool) -> Iterator[str]:
    """Yield a row of each place and of each section."""
    found = rod_on_elements(scene, "lsa", element_size_mm, contact)
    assert found.strength.elements is not None
    for place in found.strength.elements.places:
        stresses = f"{place.max_MPa:.1f} | {place.min_MPa:.1f} | {place.yield_safety:.2f}"
        yield f"| {place.place} | {stresses} |"
    limit = found.stress.fields.scene.material.yield_MPa or np.nan
    for section in SECTIONS:
        here = at_section(found.stress, section)
        high, low = found.stress.high_MPa[:, here].max(), found.stress.low_MPa[:, here].min()
        yield f"| {section} | {high:.1f} | {low:.1f} | {limit / largest_MPa(found.stress, section):.2f} |"


def main(names: tuple[str, ...]) -> None:
    """Print the tables of rods."""
    for name in names:
        own = load_scene(name)
        sharper = with_values(own, {"rod.shank_fillet_mm": NECK_RADIUS_MM})
        for title, scene, size, contact in (
            ("rigid pins touch", own, None, True),
            ("by the cosine, elements of 2.5 mm", own, 2.5, False),
            (f"rigid pins touch, radius {NECK_RADIUS_MM:g} mm, elements of 3 mm", sharper, 3.0, True),
        ):
            print(
                f"\n{name}, {title}\n\n| place | highest, MPa | lowest, MPa | yield |\n|---|---:|---:|---:|"
            )
            print("\n".join(rows(scene, size, contact=contact)), flush=True)


if __name__ == "__main__":
    main(tuple(sys.argv[1:]) or RODS)
