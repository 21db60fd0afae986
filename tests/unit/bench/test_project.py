"""A session is in its files: edits keep comments, steps can be undone, and a killed server loses nothing."""

from __future__ import annotations

import shlex
from pathlib import Path

import pytest

from cranktopo.app.main import main
from cranktopo.base.errors import CranktopoError
from cranktopo.design.edits import changed_data, changed_text, difference_words
from cranktopo.design.loading import (
    builtin_designs,
    design_text,
    load_scene,
    scene_from_dict,
    value_at,
)
from cranktopo.design.toml_text import parse_toml
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
    for command in ("first", "second"):
        project.record_file("mine.step", command)
    project.close()
    again = opened(tmp_path)
    assert [(file.name, file.command) for file in again.files] == [("mine.step", "second")]
    assert again.text == project.text
    assert [variant.name for variant in again.variants] == ["wide"]
    assert again.variant_text("v1") == project.text
    other = opened(tmp_path, TEXT.replace("19.0", "18.0"))
    assert other.place != again.place


def test_a_session_is_of_one_bench_alone(tmp_path: Path) -> None:
    """Two benches on one session wrote steps over each other: those of the first were lost."""
    project = opened(tmp_path)
    with pytest.raises(CranktopoError, match=r"session '.*bench/mine': in use by process \d+\.") as refused:
        opened(tmp_path)
    assert len(str(refused.value).splitlines()) == 1
    assert "that bench" in (refused.value.hint or "")
    project.change({"web.width_mm": 52}, "width 52")
    other = opened(tmp_path, TEXT.replace("19.0", "18.0"))
    assert other.place.name == "mine-2", "another design has a session of its own"
    project.close()
    assert opened(tmp_path).data()["web"]["width_mm"] == 52


def test_the_session_at_hand_is_opened_again_and_another_leaves_it(tmp_path: Path) -> None:
    project = opened(tmp_path)
    assert Project.opened(tmp_path, TEXT, "mine.toml", "opened", "", project) is project


def test_a_variant_comes_back_as_a_step(tmp_path: Path) -> None:
    project = opened(tmp_path)
    project.change({"web.width_mm": 52}, "width 52")
    variant = project.keep("  wide\n<b>web</b> ", {})
    assert variant.name == "wide <b>web</b>"
    project.move(-1)
    project.replace(project.variant_text(variant.id), "took wide")
    assert project.data()["web"]["width_mm"] == 52
    project.drop(variant.id)
    assert project.variants == ()


def test_two_variants_of_one_name_and_one_change_are_told_apart(tmp_path: Path) -> None:
    """A thickness that was typed with and without the pitch kept: the same step, two designs."""
    project = opened(tmp_path)
    kept = []
    for main_mm in (44.0, 40.0):
        project.change(
            {"web.thickness_mm": 21.0, "throw.main_journal.length_mm": main_mm}, "thickness: 21 mm"
        )
        kept.append(project.keep("thickness: 21 mm", {}, what="thickness: 21 mm"))
        project.move(-1)
    assert [one.name for one in kept] == ["thickness: 21 mm", "thickness: 21 mm (2)"]
    assert kept[1].what.startswith(
        "thickness: 21 mm; beside thickness: 21 mm: throw.main_journal.length_mm: 44 to 40"
    )
    again = project.keep("", {}, project.variant_text("v2"), kept[1].what)
    assert (again.name, again.what.endswith("as thickness: 21 mm (2)")) == ("variant 3", True)
    project.drop("v3")
    assert project.keep("variant 3", {}).name == "variant 3"


def test_a_difference_is_told_key_by_key() -> None:
    data = parse_toml(TEXT, "mine")
    changes = {"web.width_mm": 52.0, "web.pocket[0]": POCKET, "fatigue": None}
    told = difference_words(data, changed_data(data, changes))
    assert "web.width_mm: 50 to 52" in told
    assert "web.pocket[0].diameter_mm: none to 6" in told
    assert difference_words(data, data) == ""


def test_the_commands_of_a_session_make_the_design_as_it_stands(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Everything that was entered is in the file, the trace that it names is found."""
    monkeypatch.chdir(tmp_path)
    begun = "cranktopo designs new mine.toml --bore-mm=80"
    project = Project.opened(tmp_path, TEXT, "mine.toml", "begun", begun)
    assert project.commands() == [begun]
    project.change({"web.width_mm": 52.0}, "width")
    trace = tmp_path / "trace.csv"
    trace.write_text("crank_angle_deg,pressure_bar\n", encoding="utf-8")
    gas = {"engine.gas.indicator_csv": "trace.csv", "engine.gas.peak_pressure_MPa": None}
    project.change({**gas, "engine.gas.peak_angle_deg": None}, "trace")
    first, copied = project.commands()
    assert first == begun
    assert not any(step.command.startswith("#") for step in project.as_steps(-1, 9))
    assert main(shlex.split(copied)[1:]) == 0
    (file,) = (Path(word) for word in shlex.split(copied) if word.endswith("0002.toml") and "/" not in word)
    scene = load_scene(str(file))
    assert value_at(scene.model_dump(mode="json"), "web.width_mm") == 52.0
    assert scene.engine is not None
    assert scene.engine.gas is not None
    assert Path(str(scene.engine.gas.indicator_csv)).resolve() == trace.resolve()
