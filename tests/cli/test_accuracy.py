"""`cranktopo accuracy`, and `--accuracy` and `--budget` of evaluate and optimise."""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import Any

import pytest

from cranktopo.app.main import main
from cranktopo.design.loading import designs_folder, load_scene
from cranktopo.runs.directories import create_run
from cranktopo.tasks.throw_fea.levels import MESHES

CASTING = (designs_folder() / "opposed-piston-casting.toml").read_text(encoding="utf-8")
"""No envelope, so there is nothing to optimise."""


@pytest.fixture(scope="module")
def design(tmp_path_factory: pytest.TempPathFactory) -> str:
    """Without fatigue there is no stress to be found."""
    path = tmp_path_factory.mktemp("design") / "casting.toml"
    path.write_text(CASTING + '\n[effects]\nfatigue = "off"\n', encoding="utf-8")
    return str(path)


@pytest.fixture
def cache(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    return tmp_path / "cache" / "cranktopo" / "studies"


def test_a_budget_buys_levels_a_table_a_plot_and_a_stored_study(
    design: str,
    cache: Path,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Two levels, and a budget that is enough for them even on a slow or busy machine."""
    monkeypatch.setattr("cranktopo.tasks.throw_fea.levels.MESHES", MESHES[:2])
    out = tmp_path / "out"
    assert main(["accuracy", design, "--budget", "10min", "--out", str(out), "--json"]) == 0
    captured = capsys.readouterr()
    result: dict[str, Any] = json.loads(captured.out)
    assert result["schema_version"] == 1
    assert result["design"] == "opposed-piston-casting"
    assert {level["ladder"] for level in result["rungs"]} == {"judge"}
    first, second = result["rungs"]
    assert first["settings"]["graded"] is False
    assert all(level["seconds"] > 0 and level["peak_memory_MiB"] > 50 for level in result["rungs"])
    limit = result["limits"]["judge"]["torsion_Nm_per_rad"]
    assert limit["uncertainty_percent"] > 0
    assert first["torsion_Nm_per_rad"] > second["torsion_Nm_per_rad"] > limit["value"]
    assert Path(result["files"]["picture"]).read_bytes().startswith(b"\x89PNG")
    stored = json.loads((out / "accuracy.json").read_text())
    assert stored["rungs"] == result["rungs"]
    assert "# What accuracy costs in time: opposed-piston-casting" in (out / "accuracy.md").read_text()
    assert "opposed-piston-casting" in json.loads((cache / "accuracy.json").read_text())["designs"]
    assert re.search(r"\d of 600 s: body-fitted evaluation, uniform [\d.]+ mm", captured.err)


def test_every_evaluation_prints_its_estimate_beside_the_value(
    design: str, cache: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["evaluate", design, "--budget", "2s"]) == 0
    captured = capsys.readouterr()
    line = captured.out.strip().splitlines()[-1]
    number = r"([\d.]+)"
    found = re.fullmatch(
        rf"opposed-piston-casting: torsion {number} kN m/rad, \+-{number} %; "
        rf"bending {number} kN/mm, \+-{number} %; {number} s",
        line,
    )
    assert found, line
    torsion, torsion_error = float(found.group(1)), float(found.group(2))
    assert torsion == pytest.approx(463.9, rel=torsion_error / 100 + 0.01)


@pytest.mark.parametrize(
    ("arguments", "code", "words"),
    [
        (["evaluate", "--budget", "soon"], 2, "not a time such as 30s"),
        (["evaluate", "--budget", "0s"], 2, "above 0 s"),
        (["accuracy", "--budget", "nan"], 2, "above 0 s"),
        (["evaluate", "--element-size-mm", "3", "--budget", "9s"], 2, "excludes"),
        (["optimise", "--accuracy", "5%", "--resolution-mm", "3"], 2, "excludes"),
        (["optimise", "--resume", "x", "--budget", "5s"], 2, "--resume takes the design"),
        (["optimise", "--accuracy", "120%"], 2, "below 100%"),
        (["optimise", "--budget", "0.1s"], 2, "coarsest cells"),
        (["optimise", "--accuracy", "0.001%"], 2, "finest cells that fit"),
        (["accuracy", "no-such-design"], 3, "no such file or built-in design"),
    ],
    ids=lambda value: " ".join(value) if isinstance(value, list) else None,
)
def test_mistakes_are_one_clear_line(
    arguments: list[str], code: int, words: str, cache: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(arguments) == code
    captured = capsys.readouterr()
    assert captured.out == ""
    assert words in captured.err
    assert len(captured.err.strip().splitlines()) == 1


def test_a_broken_cache_is_no_obstacle(cache: Path, capsys: pytest.CaptureFixture[str]) -> None:
    cache.mkdir(parents=True)
    (cache / "accuracy.json").write_text("{", encoding="utf-8")
    assert main(["optimise", "--budget", "0.1s"]) == 2
    assert "not measured here: run cranktopo accuracy" in capsys.readouterr().err


def test_the_folder_is_checked_before_the_budget_is_spent(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    def solved(*_: object) -> None:
        raise AssertionError("solved before the destination was checked")

    monkeypatch.setattr("cranktopo.tasks.accuracy.study.run_studies", solved)
    (tmp_path / "mine").write_text("mine", encoding="utf-8")
    assert main(["accuracy", "--out", str(tmp_path / "mine" / "folder")]) == 3
    assert "is a file. Choose another --out." in capsys.readouterr().err


def test_files_of_a_surface_go_into_the_runs_and_those_of_a_run_into_itself(
    tmp_path: Path, cache: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Nothing is dropped beside an STL of the user's."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr("cranktopo.tasks.accuracy.study.planned_studies", lambda _: {})
    run, scene = tmp_path / "one", load_scene("opposed-piston-casting").model_dump(mode="json")
    command = ["cranktopo", "optimise"]
    create_run(design="casting", design_toml=CASTING, scene=scene, options={}, command=command, out=run)
    for path in (tmp_path / "part.stl", run / "web.stl"):
        path.write_bytes(b"")
    assert main(["accuracy", "part.stl", "--design", "mikron-iiic-plain"]) == 0
    assert main(["accuracy", "one"]) == 0
    assert sorted(path.name for path in tmp_path.iterdir()) == ["cache", "one", "part.stl", "runs"]
    assert (tmp_path / "runs" / "accuracy-part" / "accuracy.json").is_file()
    assert (run / "accuracy.json").is_file()


@pytest.mark.slow
def test_an_accuracy_chooses_the_cells_of_a_run(
    cache: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    arguments = ["optimise", "--accuracy", "15%", "--max-iterations", "4", "--out", str(tmp_path / "run")]
    assert main([*arguments, "--json"]) == 5
    captured = capsys.readouterr()
    metrics = json.loads(captured.out)
    for case in metrics["load_cases"].values():
        assert 0 < case["error_estimate_percent"] <= 15.0
    said = re.search(r"cells of ([\d.]+) mm: stiffness \+-([\d.]+) %", captured.err)
    assert said
    assert metrics["grid"]["cell_mm"] == pytest.approx(float(said.group(1)), rel=0.05)
    assert float(said.group(2)) <= 15.0


@pytest.mark.slow
def test_all_studies_of_a_design(cache: Path, tmp_path: Path) -> None:
    """At least one level each of evaluation, fillet stress and optimiser."""
    out = tmp_path / "out"
    assert main(["accuracy", "--budget", "90s", "--out", str(out), "-q"]) == 0
    result = json.loads((out / "accuracy.json").read_text())
    assert {level["ladder"] for level in result["rungs"]} == {"judge", "fillet stress", "optimiser"}
    shape = next(level for level in result["rungs"] if level["ladder"] == "optimiser")
    assert abs(shape["model_errors_percent"]["torsion_Nm_per_rad"]) < 5.0
    assert 0 < shape["model_errors_percent"]["bending_N_per_mm"] < 14.0
