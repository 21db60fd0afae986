"""The commands `doctor` and `runs` as a user runs them."""

from __future__ import annotations

import importlib
import json
import sys
from pathlib import Path
from typing import Any

import pytest

from cranktopo.app.main import main
from cranktopo.runs.destination import locked
from cranktopo.runs.directories import RunStore, create_run
from cranktopo.tasks.doctor import stage as checks
from tests.run_metrics import run_metrics


def doctor(capsys: pytest.CaptureFixture[str], code: int) -> dict[str, dict[str, Any]]:
    assert main(["doctor", "--json"]) == code
    data = json.loads(capsys.readouterr().out)
    assert data["ready"] is (code == 0)
    return {check["name"]: check for check in data["checks"]}


def test_a_sound_machine(capsys: pytest.CaptureFixture[str]) -> None:
    found = doctor(capsys, 0)
    assert {"Python", "packages", "gmsh", "JAX", "cores", "memory", "CalculiX", "Chromium"} <= set(found)
    assert "CPU" in found["JAX"]["value"] or "GPU" in found["JAX"]["value"]
    assert main(["doctor"]) == 0
    assert capsys.readouterr().out.rstrip().endswith("ready")


def test_a_missing_library_of_gmsh(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    original = importlib.import_module

    def without_glu(name: str, *arguments: Any) -> Any:
        if name == "gmsh":
            raise OSError("libGLU.so.1: cannot open shared object file")
        return original(name, *arguments)

    monkeypatch.setattr(checks.importlib, "import_module", without_glu)
    assert main(["doctor"]) == 7
    text = capsys.readouterr().out
    assert "libGLU.so.1" in text
    assert "apt-get install -y libglu1-mesa" in text
    assert "needed and missing: gmsh" in text


def test_a_command_that_needs_gmsh_ends_with_the_same_code(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, "gmsh", None)  # importing it then fails
    assert main(["export", "mikron-iiic-plain", str(tmp_path / "a.step")]) == 7
    (line,) = capsys.readouterr().err.splitlines()
    assert line.startswith("error: gmsh cannot be loaded: ")
    assert line.endswith("'cranktopo doctor' says which line installs it.")
    assert not list(tmp_path.iterdir())


def test_missing_packages_and_tools(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(checks.shutil, "which", lambda name: None)
    found = doctor(capsys, 0)
    assert found["CalculiX"]["state"] == found["Chromium"]["state"] == "absent"
    assert found["CalculiX"]["remedy"] == "apt-get install -y calculix-ccx"
    version = checks.metadata.version

    def without_nlopt(name: str) -> str:
        if name == "nlopt":
            raise checks.metadata.PackageNotFoundError(name)
        return version(name)

    monkeypatch.setattr(checks.metadata, "version", without_nlopt)
    assert doctor(capsys, 7)["package nlopt"]["remedy"] == "pip install nlopt"


def test_python_and_memory_limits(monkeypatch: pytest.MonkeyPatch) -> None:
    assert checks.python((3, 10, 12)).state == "missing"
    assert checks.python((3, 11, 0)).state == "ok"
    monkeypatch.setattr("cranktopo.bodies.memory.available_memory_MiB", lambda: 100.0)
    assert checks.memory().state == "absent"
    monkeypatch.setattr("cranktopo.bodies.memory.available_memory_MiB", lambda: 1e6)
    assert checks.memory().state == "ok"


@pytest.fixture
def runs(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> dict[str, RunStore]:
    """One run of each kind under runs/, the finished one with metrics."""
    monkeypatch.chdir(tmp_path)
    made = {}
    for state in ("done", "failed", "interrupted"):
        made[state] = create_run(
            design=state,
            design_toml="",
            scene={"name": state},
            options={},
            command=["cranktopo", "optimise"],
        )
        made[state].set_status(state)
    metrics = run_metrics(mass_kg={"throw": 1.25, "web": 0.4})
    gain = {"gain_of_stiffness_per_mass_percent": {"torsion": 12.34, "bending": -1.0}}
    original = metrics.original_web.model_copy(update=gain)
    made["done"].write_metrics(metrics.model_copy(update={"original_web": original}).as_json())
    return made


def test_list(runs: dict[str, RunStore], capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["runs", "list"]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert all(sum(line.startswith(run.name) for line in lines) == 2 for run in runs.values())
    words = [word for line in lines if line.startswith(runs["done"].name) for word in line.split()[1:]]
    assert words == ["optimise", "done", "converged", "1.250", "+12.3", "%", "-1.0", "%"]
    assert main(["runs", "list", "--json"]) == 0
    entries = json.loads(capsys.readouterr().out)["runs"]
    assert {entry["status"] for entry in entries} == {"done", "failed", "interrupted"}


def test_show(runs: dict[str, RunStore], capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["runs", "show", runs["interrupted"].name]) == 0
    assert f"--resume {runs['interrupted'].path}" in capsys.readouterr().out
    assert main(["runs", "show", runs["done"].name, "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["metrics"]["mass_kg"]["throw"] == 1.25
    assert main(["runs", "show", "nothing-like-it"]) == 3
    assert main(["report", runs["failed"].name]) == 3
    assert "not finished" in capsys.readouterr().err


def test_clean_deletes_what_was_asked_for(
    runs: dict[str, RunStore], capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["runs", "clean"]) == 0
    assert "would delete" in capsys.readouterr().out
    assert all(run.path.is_dir() for run in runs.values())
    assert main(["runs", "clean", "--yes"]) == 0
    assert [name for name, run in runs.items() if run.path.is_dir()] == ["done", "interrupted"]
    capsys.readouterr()
    with locked(runs["interrupted"].path):
        assert main(["runs", "clean", "--status", "interrupted", "--yes"]) == 3
    assert "in use" in capsys.readouterr().err
    assert runs["interrupted"].path.is_dir()


def test_no_runs(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    monkeypatch.chdir(tmp_path)
    assert main(["runs", "list"]) == 0
    assert "no runs under 'runs'" in capsys.readouterr().out
    assert list(tmp_path.iterdir()) == []
