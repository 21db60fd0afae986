"""The main job end to end on a coarse grid: files, numbers, interruption, resumption."""

from __future__ import annotations

import contextlib
import csv
import json
import os
import signal
import subprocess
import sys
import time
from dataclasses import replace
from pathlib import Path
from typing import Any

import meshio
import numpy as np
import pytest
import trimesh

from cranktopo.app.main import main
from cranktopo.base.errors import CranktopoError, ExitCode
from cranktopo.design.schema import Scene
from cranktopo.numerics.grid import equilibrium
from cranktopo.runs.checkpoint import load_checkpoint
from cranktopo.tasks.density import loop
from cranktopo.tasks.density.state import State
from cranktopo.tasks.optimise.stage import optimise_design
from tests.plain_runs import plain_runs

COARSE = ["--resolution-mm", "4.5"]
SHORT = ["optimise", "--volume-fraction", "0.3", *COARSE, "--max-iterations", "6", "--no-bound"]


@pytest.fixture(scope="module")
def run(default_run: Path) -> Path:
    """A finished default run."""
    return default_run


@pytest.fixture(scope="module")
def metrics(run: Path) -> dict[str, Any]:
    data: dict[str, Any] = json.loads((run / "metrics.json").read_text())
    return data


def test_files(run: Path, metrics: dict[str, Any]) -> None:
    expected = {
        "manifest.json",
        "design.toml",
        "run.log",
        "history.csv",
        "metrics.json",
        "density.vtu",
        "web.stl",
        "result.png",
        "report.html",
        "checkpoint",
        "density",
        ".lock",
    }
    assert {path.name for path in run.iterdir()} == expected
    assert all((run / name).stat().st_size > 100 for name in metrics["files"].values())
    assert json.loads((run / "manifest.json").read_text())["status"] == "done"
    assert (run / "result.png").read_bytes().startswith(b"\x89PNG")


def test_metrics_follow_the_contract(metrics: dict[str, Any]) -> None:
    assert metrics["schema_version"] == 1
    assert metrics["design"] == "mikron-iiic"
    assert metrics["status"] == "converged"
    assert metrics["connected"] is True
    assert metrics["volume_fraction"]["reached"] == pytest.approx(0.3, abs=1e-3)
    assert set(metrics["load_cases"]) == {"bending", "torsion"}
    assert metrics["load_cases"]["bending"]["support"] == "pinned"
    assert metrics["load_cases"]["torsion"]["support"] == "free"
    assert metrics["grid"]["symmetry"] == ["x = 0", "mid-pin plane"]
    assert max(metrics["grid"]["cell_size_mm"].values()) == pytest.approx(metrics["grid"]["cell_mm"])
    throw = metrics["mass_kg"]["throw"]
    for name, unit in (("torsion", "stiffness_Nm_per_rad"), ("bending", "stiffness_N_per_mm")):
        key = "torsion_Nm_per_rad_kg" if name == "torsion" else "bending_N_per_mm_kg"
        ratio = metrics["load_cases"][name][unit] / throw
        assert metrics["stiffness_per_mass"][key] == pytest.approx(ratio)
    states = {effect["name"]: effect["state"] for effect in metrics["effects"]}
    assert states["bending"] == states["torsion"] == "on"
    assert all(effect["reason"] for effect in metrics["effects"])


def test_mass_and_stiffness_beat_the_original_web(metrics: dict[str, Any]) -> None:
    assert metrics["mass_kg"]["web"] == pytest.approx(0.458, abs=0.003)
    assert metrics["original_web"]["mass_kg"]["web"] == pytest.approx(0.456, abs=0.001)
    gain = metrics["original_web"]["gain_of_stiffness_per_mass_percent"]
    assert gain["bending"] > 3.0
    assert gain["torsion"] > 5.0


def test_the_result_beside_its_bound(metrics: dict[str, Any]) -> None:
    """Of each stiffness at the run's own mass, and above it along the whole curve."""
    bound, original = metrics["bound"], metrics["original_web"]
    mass = 100 * metrics["mass_kg"]["throw"] / original["mass_kg"]["throw"]
    assert [entry["quantity"] for entry in bound["statements"]] == ["torsion", "bending"]
    for entry in bound["statements"]:
        name = entry["quantity"]
        key = next(key for key in metrics["load_cases"][name] if key.startswith("stiffness"))
        own, before = (cases["load_cases"][name][key] for cases in (metrics, original))
        assert entry["at_mass_percent"] == pytest.approx(mass, abs=0.01)
        assert entry["reached_percent"] == pytest.approx(100 * own / before)
        assert 100 < entry["reached_percent"] < entry["percent_of_original"] < 130
        curve = bound["stiffest"][f"{name}_percent"]
        assert curve == sorted(curve)
        at_mass = np.interp(mass, bound["stiffest"]["mass_percent"], curve)
        assert at_mass == pytest.approx(entry["percent_of_original"], rel=1e-3)
        assert np.interp(100.0, bound["stiffest"]["mass_percent"], curve) > 100.0


def test_surface_is_a_solid_of_the_design_s_mass(run: Path, metrics: dict[str, Any]) -> None:
    mesh = trimesh.load_mesh(run / "web.stl")
    assert mesh.is_watertight
    assert mesh.is_winding_consistent
    assert len(mesh.split()) == 1 + metrics["surface"]["cavities"]
    kg = 2 * mesh.volume * 7850e-9
    assert kg == pytest.approx(metrics["mass_kg"]["throw"], rel=5e-3)
    np.testing.assert_allclose(mesh.bounds[:, 2], [0.0, 57.0], atol=1e-4)
    np.testing.assert_allclose(mesh.bounds[0, 0], -mesh.bounds[1, 0], atol=1e-4)
    radii = np.hypot(*mesh.vertices[mesh.vertices[:, 2] < 0.01][:, :2].T)
    assert np.all(np.isclose(radii, 21.0, atol=1e-3) | np.isclose(radii, 12.0, atol=1e-3))


def test_density_opens_and_holds_the_mass(run: Path, metrics: dict[str, Any]) -> None:
    grid = meshio.read(run / "density.vtu")
    cells = grid.cells_dict["hexahedron"]
    corners = grid.points[cells]
    volume = np.prod(corners.max(axis=1) - corners.min(axis=1), axis=1)
    kg = 4 * float(volume @ grid.cell_data_dict["density"]["hexahedron"]) * 7850e-9
    assert kg == pytest.approx(metrics["mass_kg"]["throw"], rel=1e-6)


def test_history_matches_the_metrics(run: Path, metrics: dict[str, Any]) -> None:
    with (run / "history.csv").open() as file:
        rows = list(csv.DictReader(file))
    assert len(rows) == metrics["iterations"]
    assert float(rows[-1]["greyness"]) == metrics["greyness"]
    objective = [float(row["objective"]) for row in rows]
    assert objective[-1] < 0.2 * objective[0]
    # The reported compliance is solved more tightly than the history's.
    last = float(rows[-1]["bending_compliance_N_mm"])
    assert last == pytest.approx(metrics["load_cases"]["bending"]["compliance_N_mm"], rel=1e-4)


def designs(run: Path) -> tuple[bytes, list[Any]]:
    """Design variables and history without the wall times."""
    saved = load_checkpoint(run / "checkpoint" / "state.npz")
    rows = [{k: v for k, v in row.items() if k != "seconds"} for row in saved.state["history"]]
    return saved.arrays["evaluated"].tobytes(), rows


@pytest.fixture(scope="module")
def short(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The default run up to its sixth design: what interrupted runs must end with, bit for bit."""
    out = tmp_path_factory.mktemp("runs") / "short"
    with plain_runs():
        assert main([*SHORT, "--out", str(out)]) == 5
    return out


@pytest.mark.slow
def test_stopped_run_continues_to_the_same_result(short: Path, tmp_path: Path) -> None:
    out = tmp_path / "stopped"
    arguments = ["--volume-fraction", "0.3", *COARSE, "--out", str(out), "--max-iterations", "4"]
    with plain_runs():
        assert main(["optimise", *arguments]) == 5
    stopped = json.loads((out / "metrics.json").read_text())
    assert stopped["status"] == "stopped"
    assert stopped["iterations"] == 4
    assert (out / "web.stl").is_file()
    with plain_runs():
        assert main(["optimise", "--resume", str(out), "--max-iterations", "6"]) == 5
    assert designs(out) == designs(short)
    assert (out / "web.stl").read_bytes() == (short / "web.stl").read_bytes()


def begun(out: Path, rows: int, *arguments: str) -> subprocess.Popen[str]:
    """A run in its own process that has done at least `rows` iterations."""
    command = [sys.executable, "-c", "from cranktopo.app.launch import main; main()", *arguments]
    process = subprocess.Popen(
        command,
        stderr=subprocess.PIPE,
        stdout=subprocess.PIPE,
        text=True,
        env={**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)},
    )
    checkpoint = out / "checkpoint" / "state.npz"
    deadline = time.monotonic() + 1200
    while time.monotonic() < deadline and process.poll() is None:
        if checkpoint.is_file() and len(load_checkpoint(checkpoint).state["history"]) >= rows:
            return process
        time.sleep(0.02)
    process.kill()
    pytest.fail(f"the run ended before it was interrupted: {process.communicate()}")


def test_killed_and_interrupted_run_resumes_bit_for_bit(
    short: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """Killed after two designs, resumed, interrupted by Ctrl-C after two more, resumed to its end.

    `python -m pytest -m slow tests/hard/test_kills.py` kills and interrupts processes at any moment.
    """
    out, step, steps = tmp_path / "run", loop.step, []
    process = begun(out, 2, *SHORT, "--out", str(out))
    process.kill()
    process.communicate(timeout=600)

    def interrupted(*arguments: Any) -> State:
        steps.append(len(steps))
        if len(steps) == 3:
            signal.raise_signal(signal.SIGINT)
        return step(*arguments)

    with monkeypatch.context() as patch:
        patch.setattr(loop, "step", interrupted)
        assert main(["optimise", "--resume", str(out)]) == 130
    assert f"cranktopo optimise --resume {out}" in capsys.readouterr().err
    assert json.loads((out / "manifest.json").read_text())["status"] == "interrupted"
    assert not (out / "metrics.json").exists()
    with plain_runs(), monkeypatch.context() as patch:
        patch.setattr("cranktopo.tasks.optimise.finalise._surface", lambda *_: "a surface takes longer")
        assert main(["optimise", "--resume", str(out)]) == 5
    assert designs(out) == designs(short)
    assert not list(out.rglob(".*.tmp*"))


def coarse(mikron: Scene) -> Scene:
    return mikron.with_optimise(volume_fraction=0.3, resolution_mm=4.5)


def test_ctrl_c_that_a_library_swallows_is_not_lost(mikron: Scene, tmp_path: Path) -> None:
    """The exception disappears, as in a callback of compiled code; the run ends with its iteration."""
    out, seen = tmp_path / "run", []

    def progress(problem: object, state: State) -> None:
        seen.append(state.last.iteration)
        if len(seen) == 2:
            with contextlib.suppress(KeyboardInterrupt):
                signal.raise_signal(signal.SIGINT)

    with pytest.raises(CranktopoError, match="interrupted") as error:
        optimise_design(coarse(mikron), out, progress=progress)
    assert error.value.code == ExitCode.INTERRUPTED
    assert seen == [1, 2]
    assert len(load_checkpoint(out / "checkpoint" / "state.npz").state["history"]) == 2
    assert json.loads((out / "manifest.json").read_text())["status"] == "interrupted"


def test_ctrl_c_before_the_first_iteration_is_recorded(
    mikron: Scene, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def interrupted(*_: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr("cranktopo.tasks.optimise.stage.build_problem", lambda *_: None)
    monkeypatch.setattr("cranktopo.tasks.optimise.stage.check_limits", lambda *_: None)
    monkeypatch.setattr("cranktopo.tasks.density.loop.init", interrupted)
    with pytest.raises(CranktopoError, match="interrupted"):
        optimise_design(coarse(mikron), tmp_path / "run")
    assert json.loads((tmp_path / "run" / "manifest.json").read_text())["status"] == "interrupted"


def test_damaged_checkpoint_says_so(run: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    out = tmp_path / "damaged"
    (out / "checkpoint").mkdir(parents=True)
    (out / "manifest.json").write_bytes((run / "manifest.json").read_bytes())
    content = bytearray((run / "checkpoint" / "state.npz").read_bytes())
    content[len(content) // 2] ^= 0xFF
    (out / "checkpoint" / "state.npz").write_bytes(content)
    assert main(["optimise", "--resume", str(out)]) == 3
    assert "corrupted" in capsys.readouterr().err


@pytest.mark.slow
def test_the_evaluation_takes_the_run(
    run: Path, metrics: dict[str, Any], capsys: pytest.CaptureFixture[str]
) -> None:
    """The surface of the optimised web on body-fitted tetrahedra; cells of 4.5 mm are some 10 % too stiff."""
    capsys.readouterr()
    assert main(["evaluate", str(run), "--element-size-mm", "12", "--json"]) == 0
    evaluated = json.loads(capsys.readouterr().out)["evaluations"][0]
    assert evaluated["mass_kg"]["throw"] == pytest.approx(metrics["mass_kg"]["throw"], rel=5e-3)
    for name, support, unit in (("torsion", "free", "Nm_per_rad"), ("bending", "pinned", "N_per_mm")):
        ratio = evaluated[name][f"{support}_{unit}"] / metrics["load_cases"][name][f"stiffness_{unit}"]
        assert 0.85 < ratio < 1.02, name


@pytest.mark.slow
def test_a_solver_fallback_is_announced(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    first, *rest = equilibrium.METHODS
    monkeypatch.setattr(equilibrium, "METHODS", (replace(first, cap=1), *rest))
    out = tmp_path / "run"
    arguments = ["--process", "forged", "--max-iterations", "1", "--out", str(out)]
    with plain_runs():
        assert main(["optimise", *COARSE, *arguments]) == 5
    line = "iteration 1: multigrid CG stopped at relative residual"
    assert line in capsys.readouterr().err
    assert line in (out / "run.log").read_text(encoding="utf-8")
    effects = json.loads((out / "metrics.json").read_text())["effects"]
    assert {effect["name"]: effect["state"] for effect in effects}["manufacturing_constraint"] == "on"


def test_a_design_without_a_surface_is_saved(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """The first free design is uniform: no iso-surface encloses its volume; all else but a bound is there."""
    out = tmp_path / "first"
    arguments = ["--process", "free", "--volume-fraction", "0.3", *COARSE, "--max-iterations", "1", "-v"]
    assert main(["optimise", *arguments, "--no-bound", "--out", str(out)]) == 5
    printed, said = capsys.readouterr()
    assert "iteration 1: bending" in said
    assert "no STL: surface: no iso-value encloses" in printed
    assert "web.stl" not in printed
    first = json.loads((out / "metrics.json").read_text())
    assert first["status"] == "stopped"
    assert "bound" not in first
    assert first["surface"]["refusal"].startswith("surface: no iso-value")
    share = first["volume_fraction"]["reached"] / 0.3
    assert first["mass_kg"]["web"] == pytest.approx(0.458 * share, abs=0.003)
    assert not {"stl", "picture"} & set(first["files"])
    assert all((out / name).is_file() for name in first["files"].values())
    assert not (out / "web.stl").exists()
    assert "the density has no surface" in (out / "report.html").read_text()
    assert json.loads((out / "manifest.json").read_text())["status"] == "done"
