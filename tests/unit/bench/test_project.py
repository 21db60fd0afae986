"""A session is in its files: edits keep comments, steps can be undone, and a killed server loses nothing."""

from __future__ import annotations

from pathlib import Path

import pytest

from cranktopo.base.errors import CranktopoError
from cranktopo.design.loading import builtin_designs, design_text, parse_toml, scene_from_dict
from cranktopo.tasks.bench.edits import changed_data, changed_text
from cranktopo.tasks.bench.project import Project

TEXT = design_text("mikron-iiic")
POCKET = {"shape": "cylinder", "face": "through", "x_mm": 0.0, "y_mm": 24.0, "diameter_mm": 6.0}


def opened(folder: Path, text: str = TEXT) -> Project:
    return Project.opened(folder, text, "mine.toml", "opened", "cranktopo bench mine.toml")


def test_a_change_keeps_comments() -> None:
    new = changed_text(TEXT, {"web.width_mm": 52, "web.pocket[0]": POCKET, "web.bevel[1]": None}, "mine")
    kept = [line for line in TEXT.splitlines() if line.startswith("#")]
    assert [line for line in new.splitlines() if line.startswith("#")] == kept
    assert "width_mm = 52.0" in new
    data = parse_toml(new, "mine")
    assert data["web"]["pocket"] == [POCKET]
    assert [bevel["face"] for bevel in data["web"]["bevel"]] == ["journal"]
    scene_from_dict(data)


@pytest.mark.parametrize("name", builtin_designs())
def test_any_design_can_be_changed(name: str) -> None:
    data = parse_toml(design_text(name), name)
    changes = {
        "web.thickness_mm": 21.5,
        "supports.bending": "clamped",
        "web.pocket[0]": None,
        "fatigue": None,
    }
    new = parse_toml(changed_text(design_text(name), changes, name), name)
    assert new == changed_data(data, changes)
    assert new["web"]["thickness_mm"] == 21.5
    assert new["supports"]["bending"] == "clamped"


@pytest.mark.parametrize("key", ["web.pocket[3]", "web.width_mm.x", "web.bevel[0].face[1]", "1x", "web..y"])
def test_an_impossible_key_is_refused(key: str) -> None:
    with pytest.raises(CranktopoError):
        changed_text(TEXT, {key: 1.0}, "mine")


def test_steps_are_undone_and_redone_and_a_new_one_ends_what_was_undone(tmp_path: Path) -> None:
    project = opened(tmp_path)
    for width in (51, 52, 53):
        project.change({"web.width_mm": width}, f"width {width}")
    project.move(-1)
    project.move(-1)
    assert project.data()["web"]["width_mm"] == 51
    project.move(1)
    assert project.data()["web"]["width_mm"] == 52
    project.change({"web.thickness_mm": 20}, "thickness 20")
    project.move(1)
    assert [step.what for step in project.as_steps(0, 9)] == ["width 51", "width 52", "thickness 20"]


def test_a_session_goes_on_where_it_was_left(tmp_path: Path) -> None:
    project = opened(tmp_path)
    project.change({"web.width_mm": 52}, "width 52")
    project.keep("wide", {"mass": 1.5})
    again = opened(tmp_path)
    assert again.text == project.text
    assert [variant.name for variant in again.variants] == ["wide"]
    assert again.variant_text("v1") == project.text
    other = opened(tmp_path, TEXT.replace("19.0", "18.0"))
    assert other.place != again.place


def test_a_variant_comes_back_as_a_step(tmp_path: Path) -> None:
    project = opened(tmp_path)
    project.change({"web.width_mm": 52}, "width 52")
    variant = project.keep("  wide\n<b>web</b> ", {})
    assert variant.name == "wide <b>web</b>"
    project.move(-1)
    project.replace(project.variant_text(variant.id), "took wide", "")
    assert project.data()["web"]["width_mm"] == 52
    project.drop(variant.id)
    assert project.variants == ()
