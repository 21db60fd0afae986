"""What a scene leaves out is said, and nothing else."""

from __future__ import annotations

from dataclasses import asdict

import pytest

from cranktopo.design.assumed import (
    ENVELOPE,
    FATIGUE,
    LOADS,
    SUPPORTS,
    THROW,
    assumed_text,
    assumptions,
    filter_by_table,
)
from cranktopo.design.loading import load_scene, parse_scene, scene_from_dict
from cranktopo.design.schema import Scene
from cranktopo.design.writing import toml_text


def scene_with(**tables: object) -> Scene:
    journal = {"outer_diameter_mm": 40.0, "bore_diameter_mm": 0.0, "length_mm": 30.0}
    return scene_from_dict(
        {
            "name": "t",
            "throw": {"radius_mm": 40.0, "main_journal": journal, "crankpin": {**journal, "fillet_mm": 2.0}},
            "web": {"outline": "obround", "width_mm": 50.0, "thickness_mm": 15.0},
            "material": {"name": "42CrMo4"},
            **tables,
        }
    )


ENGINE = {"bore_mm": 80.0, "rod_length_mm": 150.0, "speed_rpm": 3000.0, "strokes": 4, "cylinders": 1}
GAS = {"peak_pressure_MPa": 6.0, "peak_angle_deg": 10.0}


def keys(scene: Scene, *tables: str) -> list[str]:
    return [item.key for item in assumptions(scene, tables)]


def test_only_what_is_left_out_is_named() -> None:
    assert keys(scene_with(), THROW) == ["throw.main_journal.fillet_mm"]
    assert keys(scene_with(), SUPPORTS) == ["supports.torsion", "supports.bending"]
    assert keys(scene_with(supports={"torsion": "held", "bending": "pinned"}), SUPPORTS) == []


def test_missing_masses_and_compression_ratio_are_named() -> None:
    found = keys(scene_with(engine={**ENGINE, "gas": GAS, "masses": {"piston_group_kg": 0.5}}), LOADS)
    assert {"engine.masses.rod_reciprocating_kg", "engine.gas.compression_ratio"} <= set(found)
    assert "engine.masses.piston_group_kg" not in found
    assert "engine.gas.peak_pressure_MPa" not in found


def test_a_whole_rod_leaves_nothing_of_its_parts_to_assume() -> None:
    masses = {"piston_group_kg": 0.5, "rod_kg": 0.6, "rod_centre_from_big_end_mm": 50.0}
    found = keys(scene_with(engine={**ENGINE, "gas": GAS, "masses": masses}), LOADS)
    assert not any("rod" in key for key in found)


def test_a_part_of_a_table_by_its_path() -> None:
    found = assumptions(scene_with(engine={**ENGINE, "gas": GAS}), (THROW, LOADS))
    named = [item.key for item in filter_by_table(found, ("engine.masses",))]
    assert named == [
        f"engine.masses.{key}_kg" for key in ("piston_group", "rod_reciprocating", "rod_rotating")
    ]
    assert [item.key for item in filter_by_table(found, (THROW,))] == ["throw.main_journal.fillet_mm"]


def test_a_measured_diagram_needs_no_combustion_model() -> None:
    found = keys(scene_with(engine={**ENGINE, "gas": {"indicator_csv": "diagram.csv"}}), LOADS)
    assert {"engine.gas.ambient_pressure_MPa", "engine.gas.firing_deg"} <= set(found)
    assert "engine.gas.firing_deg" not in keys(scene_with(engine={**ENGINE, "gas": GAS}), LOADS)
    assert not any("wiebe" in key or "compression" in key for key in found)


def test_without_an_engine_or_an_envelope_nothing_of_them_is_assumed() -> None:
    assert keys(scene_with(), LOADS, ENVELOPE) == []


def test_the_line_says_what_the_number_means() -> None:
    text = assumed_text(assumptions(scene_with(), (THROW,)))
    assert text == "assumed: throw.main_journal.fillet_mm = 0 (sharp)"
    assert assumed_text(()) == ""


def test_json_has_key_value_and_meaning() -> None:
    entries = [asdict(item) for item in assumptions(scene_with(), (THROW, FATIGUE))]
    assert entries[0] == {"key": "throw.main_journal.fillet_mm", "value": 0.0, "meaning": "sharp"}
    assert all(isinstance(entry["value"], (int, float, str)) for entry in entries)


@pytest.mark.parametrize("name", ["mikron-iiic-plain"])
def test_a_stored_scene_has_every_key(name: str, mikron: Scene) -> None:
    """Why the question is asked before a run is stored."""
    assert keys(mikron, LOADS)
    assert keys(scene_from_dict(mikron.model_dump(mode="json", exclude_none=True)), LOADS) == []


def test_a_written_design_assumes_what_its_origin_assumed() -> None:
    """The dossier of a web from `shape` listed two assumptions in place of seventeen: defaults were given."""
    scene = load_scene("mikron-iiic")
    web = scene.model_copy(update={"web": scene.web.model_copy(update={"thickness_mm": 20.0})})
    tables = (THROW, LOADS, SUPPORTS, FATIGUE)
    again = parse_scene(toml_text(web, "a web"))
    assert again.web.thickness_mm == 20.0
    assert len(assumptions(again, tables)) > 3
    assert assumptions(again, tables) == assumptions(scene, tables)
    assert assumptions(parse_scene(toml_text(web, "a run", with_defaults=True)), (THROW, SUPPORTS)) == ()
