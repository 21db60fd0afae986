"""The section that rules the strength of a rod's material, and what is told and drawn by it."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from cranktopo.app.main import main
from cranktopo.design.loading import load_scene
from cranktopo.design.material import Material
from cranktopo.design.named import with_values
from cranktopo.design.rod import Rod
from cranktopo.design.rod_strength import rod_ruling_section, rod_strength_notes, rod_strength_remarks
from cranktopo.design.schema import Scene
from cranktopo.design.writing import save_scene

SCENE = load_scene("mikron-iiic-rod-i")


def rod_of(scene: Scene, **changes: Any) -> Rod:
    assert scene.rod is not None
    return scene.rod.model_copy(update=changes)


@pytest.mark.parametrize(
    ("boss_width_mm", "above_mm", "below_mm", "width_mm"),
    [(82.0, 20.0, 20.0, 28.0), (82.0, 12.0, 22.0, 28.0), (82.0, 26.0, 8.0, 28.0), (90.0, 40.0, 8.0, 23.0)],
)
def test_the_section_of_bosses_is_the_largest_ball_in_them(
    boss_width_mm: float, above_mm: float, below_mm: float, width_mm: float
) -> None:
    """By search over all places of its centre; the bore is 49 mm."""
    sizes = {"boss_width_mm": boss_width_mm, "boss_above_mm": above_mm, "boss_below_mm": below_mm}
    found = rod_ruling_section(rod_of(SCENE, **sizes, big_end_bore_mm=49.0, big_end_width_mm=width_mm))
    largest = 0.0
    for height in (above_mm, below_mm):
        u, v = np.meshgrid(np.linspace(0, boss_width_mm / 2, 801), np.linspace(0, height, 801))
        faces = [boss_width_mm / 2 - u, v, height - v, np.hypot(u, v) - 24.5, 0 * u + width_mm / 2]
        largest = max(largest, 2 * float(np.min(faces, axis=0).max()))
    assert found.thickness_mm == pytest.approx(largest, abs=0.1)
    assert (found.part, found.place) == ("rod", "bosses")


def test_without_bosses_the_thickest_wall_rules() -> None:
    flat = {"boss_above_mm": 1.0, "boss_below_mm": 1.0}
    plain = rod_ruling_section(rod_of(SCENE, **flat, shank="plain", shank_width_mm=14.0))
    assert (plain.thickness_mm, plain.place) == (14.0, "shank")
    ring = rod_ruling_section(rod_of(SCENE, **flat, big_end_bore_mm=46.0, big_end_diameter_mm=80.0))
    assert (ring.thickness_mm, ring.place) == (17.0, "big end")


def test_strengths_of_thin_sections_are_told_and_not_demanded() -> None:
    """42CrMo4 has 1,100 MPa to 16 mm, 1,000 and 750 MPa to 40 mm by the standard."""
    sizes = {"boss_width_mm": 82.0, "boss_above_mm": 20.0, "big_end_bore_mm": 49.0, "big_end_width_mm": 28.0}
    steel = Material.model_validate({"name": "42CrMo4"})
    thick = rod_of(SCENE, **sizes, material=steel)
    (remark,) = rod_strength_remarks(thick, SCENE)
    assert "sections to 16 mm in the library; this rod has 18.3 mm in its bosses" in remark
    assert "1000 and a yield strength of 750 MPa. Give rod.material.ultimate_MPa" in remark
    notes = rod_strength_notes(thick, SCENE)
    assert notes[0] == "42CrMo4: strength to be agreed with the forge for 18.3 mm;"
    assert "at least" not in " ".join(notes)
    thin = rod_of(SCENE, **sizes | {"boss_above_mm": 15.0, "boss_below_mm": 15.0}, material=steel)
    assert rod_strength_remarks(thin, SCENE) == ()
    assert rod_strength_notes(thin, SCENE) == ["42CrMo4: Rm at least 1100 MPa, Re at least 900 MPa."]
    by_crank = SCENE.model_copy(update={"material": steel})
    (remark,) = rod_strength_remarks(rod_of(SCENE, **sizes, material=None), by_crank)
    assert "Give material.ultimate_MPa" in remark


def test_the_command_tells_it(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    """In a note and in its JSON; own strengths of the forging need no remark."""
    sizes = {"rod.boss_above_mm": 24.0, "rod.boss_width_mm": 82.0}
    own = {"name": "42CrMo4", "ultimate_MPa": 1000.0, "yield_MPa": 750.0}
    own |= {"fatigue_tension_MPa": 430.0, "fatigue_bending_MPa": 460.0}
    for name, material, told in (("library", {"name": "42CrMo4"}, 1), ("own", own, 0)):
        path = tmp_path / f"{name}.toml"
        save_scene(with_values(SCENE, sizes | {"rod.material": material}), path)
        assert main(["rod", str(path), "--json"]) == 0
        out, err = capsys.readouterr()
        assert len(json.loads(out).get("strength_remarks", ())) == told
        assert ("rod: material: ultimate_MPa = 1100 of 42CrMo4" in err) == bool(told)
