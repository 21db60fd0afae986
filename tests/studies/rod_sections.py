"""Rods of Dolezal 2024 by elements at the sections of its safeties: `python -m tests.studies.rod_sections`.

    python -m tests.studies.rod_sections [DESIGN] ...
    python -m tests.studies.rod_sections meshes

A table of each rod in Markdown: largest and smallest signed von Mises stress over the cycle, the safety
against yield and that for fatigue by the source's rule, at every place and at five sections; where rigid pins
touch, by the cosine, and with a smaller radius at the neck. `meshes` prints the neck of the rod of aluminium
on elements of three sizes. Dimensions of the rods are not printed.
Their caps have more than 15: bolts hardly pull.
"""

from __future__ import annotations

import sys
from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from cranktopo.design.loading import load_scene
from cranktopo.design.material import Material
from cranktopo.design.named import with_values
from cranktopo.design.schema import Scene
from cranktopo.tasks.fatigue.criterion import LocalStress
from cranktopo.tasks.fatigue.lsa import LsaStrength, lsa
from cranktopo.tasks.rod.element_stage import rod_on_elements
from cranktopo.tasks.rod.element_stress import ElementStress

RODS = "mikron-iiic-rod", "mikron-iiic-rod-i", "mikron-iiic-rod-h"
NECK_RADIUS_MM = 12.0
SECTIONS = "crown of the eye", "middle of the shank", "middle of the cap", "sides of the big end"
HEAD = "| place | highest, MPa | lowest, MPa | yield | fatigue |\n|---|---:|---:|---:|---:|"
SIZES_MM = 3.0, 2.0, 1.5
PUSH_SPEED = 2100 / 2800
"""Speed of the largest push over that of the largest pull."""
_NEAR_MM = 1.0


def hardly_tightened(name: str) -> Scene:
    """Return a design whose bolts keep their holes and have no preload."""
    return with_values(load_scene(name), {"rod.bolt.preload_N": 1.0})


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


def goodman(material: Material, largest_MPa: float, smallest_MPa: float) -> float:
    """Return the fatigue safety of the source: amplitude over fatigue strength plus mean over tensile one."""
    fatigue, limit, ultimate = material.fatigue_bending_MPa, material.yield_MPa, material.ultimate_MPa
    assert fatigue is not None
    assert limit is not None
    assert ultimate is not None
    strength = LsaStrength(fatigue, fatigue, limit, ultimate, size_factor=1.0, survival_factor=1.0)
    amplitude, mean = abs(largest_MPa - smallest_MPa) / 2, (largest_MPa + smallest_MPa) / 2
    stress = LocalStress(np.array([amplitude]), np.array([mean]), np.zeros(1))
    return float(lsa(stress, strength).safety[0])


def printed_fatigue(material: Material, high_MPa: float, low_MPa: float) -> float:
    """Return that of a place: the larger extreme taken as tension, the other at the speed of the push."""
    largest, other = sorted((high_MPa, -low_MPa), reverse=True)
    return goodman(material, largest, -other * PUSH_SPEED**2)


def mesh_rows() -> Iterator[str]:
    """Yield the largest stress of the neck of the rod of aluminium on ever smaller elements."""
    for size in SIZES_MM:
        found = rod_on_elements(hardly_tightened(RODS[0]), "lsa", size, contact=True)
        assert found.strength.elements is not None
        neck = next(one for one in found.strength.elements.places if one.place == "eye to shank")
        nodes = found.strength.elements.nodes
        yield f"| {size:g} | {nodes:,} | {-neck.min_MPa:.1f} | {neck.error_percent:.2f} |"


def rows(scene: Scene, element_size_mm: float | None, *, contact: bool) -> Iterator[str]:
    """Yield a row of each place and of each section."""
    found = rod_on_elements(scene, "lsa", element_size_mm, contact)
    assert found.strength.elements is not None
    material = found.stress.fields.scene.material
    for place in found.strength.elements.places:
        fatigue = printed_fatigue(material, place.max_MPa, place.min_MPa)
        stresses = f"{place.max_MPa:.1f} | {place.min_MPa:.1f} | {place.yield_safety:.2f}"
        yield f"| {place.place} | {stresses} | {fatigue:.2f} |"
    limit = material.yield_MPa or np.nan
    for section in SECTIONS:
        here = at_section(found.stress, section)
        high, low = found.stress.high_MPa[:, here].max(), found.stress.low_MPa[:, here].min()
        yield (
            f"| {section} | {high:.1f} | {low:.1f} | {limit / largest_MPa(found.stress, section):.2f} "
            f"| {printed_fatigue(material, high, low):.2f} |"
        )


def main(names: tuple[str, ...]) -> None:
    """Print the tables of rods, or that of meshes."""
    if names == ("meshes",):
        print("| element, mm | nodes | neck, MPa | error, % |\n|---:|---:|---:|---:|", flush=True)
        print("\n".join(mesh_rows()))
        return
    for name in names:
        own = hardly_tightened(name)
        sharper = with_values(own, {"rod.shank_fillet_mm": NECK_RADIUS_MM})
        for title, scene, size, contact in (
            ("rigid pins touch", own, None, True),
            ("by the cosine, elements of 2.5 mm", own, 2.5, False),
            (f"rigid pins touch, radius {NECK_RADIUS_MM:g} mm, elements of 3 mm", sharper, 3.0, True),
        ):
            print(f"\n{name}, {title}\n\n{HEAD}")
            print("\n".join(rows(scene, size, contact=contact)), flush=True)


if __name__ == "__main__":
    main(tuple(sys.argv[1:]) or RODS)
