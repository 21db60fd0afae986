"""The loop: its files and pages, interruption and continuation, limits, bad use."""

from __future__ import annotations

import contextlib
import csv
import io
import json
import re
from dataclasses import dataclass
from datetime import datetime
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from manifold3d import Manifold

from cranktopo.app.main import main
from cranktopo.base.companion import ALONE, Companion
from cranktopo.base.errors import CranktopoError, ExitCode
from cranktopo.bodies.volume import web_volume_mm3
from cranktopo.design.schema import Scene
from cranktopo.design.writing import toml_text
from cranktopo.engine.balance.throw import throw_balance
from cranktopo.engine.throw_compliance import throw_compliance
from cranktopo.numerics.surfaces.mesh import SurfaceMesh, mesh_of
from cranktopo.runs.directories import create_run
from cranktopo.runs.manifest import settings_hash
from cranktopo.tasks.iterate import one_step
from cranktopo.tasks.iterate.one_step import Solids, read_solids, write_solids
from cranktopo.tasks.iterate.result import LoopResult
from cranktopo.tasks.iterate.text import best_line
from cranktopo.throw.manufacturing_limits import ManufacturingLimits, ProcessLimits
from cranktopo.throw.outline import ObroundWeb
from tests.plain_runs import plain_loops

Capture = pytest.CaptureFixture[str]


@pytest.fixture
def quick(monkeypatch: pytest.MonkeyPatch) -> list[str]:
    return with_stand_ins(monkeypatch)


def with_stand_ins(monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """The loop's own course with stand-ins for its long stages; the list records what was called."""
    calls: list[str] = []

    def optimised(folder: Path, scene: Scene, beside: Companion) -> SurfaceMesh:
        calls.append(f"optimise {scene.optimise.volume_fraction:.4f} {scene.optimise.process}")
        kind = "" if scene.envelope is None else scene.envelope.shape
        calls.append(f"inside {kind}")
        return mesh_of(Manifold.cube((1, 1, 1)))

    def fit(surface: SurfaceMesh, scene: Scene, limits: Any, beside: Companion) -> Any:
        """An obround whose volume is what the optimiser would have left."""
        volume = web_volume_mm3(scene.model_copy(update={"web": _web_inside(scene)}))
        target = scene.optimise.volume_fraction * volume
        widths = np.linspace(44.5, 90, 400)
        volumes = [web_volume_mm3(scene.model_copy(update={"web": _obround(w)})) for w in widths[::20]]
        width = float(np.interp(target, volumes, widths[::20]))
        return SimpleNamespace(scene=scene.model_copy(update={"web": _obround(width)}))

    def evaluate(target: Any, size: float | None) -> Any:
        scene = target.scene
        own, balance = throw_compliance(scene), throw_balance(scene)
        return SimpleNamespace(
            throw_kg=balance.mass_kg,
            web_kg=web_volume_mm3(scene) * 7850e-9,
            torsion_Nm_per_rad=1e-3 / own.torsion_rad_per_Nmm,
            bending_N_per_mm=1 / own.bending_mm_per_N,
            torsion_error_percent=0.1,
            bending_error_percent=0.2,
        )

    monkeypatch.setattr(one_step, "coarse_facet_mm", lambda scene: 6.0)
    monkeypatch.setattr(one_step, "write_solids", solids_once)
    monkeypatch.setattr(one_step, "optimised_surface", optimised)
    monkeypatch.setattr(one_step, "fit_web", fit)
    monkeypatch.setattr(one_step, "Companion", lambda _: contextlib.nullcontext(ALONE))
    monkeypatch.setattr(one_step, "web_overlap", lambda *_: 0.95)
    monkeypatch.setattr(one_step, "evaluate", evaluate)
    return calls


SOLIDS: dict[str, dict[str, bytes]] = {}
"""Solids of a web as the bytes of their files, by the web."""


def solids_once(scene: Scene, folder: Path, started: datetime) -> Solids:
    """The solids of a step, written again where an earlier loop has built the same web."""
    web = scene.web.model_dump_json()
    if web in SOLIDS:
        for name, data in SOLIDS[web].items():
            (folder / name).write_bytes(data)
        return read_solids(folder)
    found = write_solids(scene, folder, started)
    SOLIDS[web] = {n: (folder / n).read_bytes() for n in ("web.step", "web.stl", one_step.WEB)}
    return found


def _obround(width: float) -> ObroundWeb:
    return ObroundWeb(outline="obround", width_mm=width, thickness_mm=19.0)


def _web_inside(scene: Scene) -> ObroundWeb:
    """The web that the scene's envelope holds in this play: 90 mm wide at first."""
    if scene.envelope is None or scene.envelope.shape != "stl":
        return _obround(90.0)
    step_file = json.loads((Path(scene.envelope.file).parent / "step.json").read_text())
    return ObroundWeb(**step_file["scene"]["web"])


ARGUMENTS = ["iterate", "--steps", "2", "--resolution-mm", "4.5", "--volume-fraction", "0.45", "--no-shape"]


@dataclass(frozen=True)
class Whole:
    """A loop in a single go: its directory, what it printed, what its stages were asked."""

    out: Path
    data: dict[str, Any]
    calls: list[str]


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> Whole:
    out = tmp_path_factory.mktemp("loops") / "whole"
    with pytest.MonkeyPatch.context() as monkeypatch:
        calls = with_stand_ins(monkeypatch)
        printed = io.StringIO()
        with contextlib.redirect_stdout(printed):
            assert main([*ARGUMENTS, "--out", str(out), "--json"]) == 0
    return Whole(out, json.loads(printed.getvalue()), calls)


def test_steps_files_and_table(whole: Whole) -> None:
    out, data = whole.out, whole.data
    assert whole.calls[1::2] == ["inside box", "inside stl"]
    assert all(call.endswith("forged") for call in whole.calls[::2])
    numbers = [row["number"] for row in data["steps"]]
    assert numbers == list(range(len(numbers)))
    masses = [row["throw_kg"] for row in data["steps"][1:]]
    assert masses == sorted(masses, reverse=True)
    for number in numbers[1:]:
        folder = out / f"step-{number:02d}"
        assert {"web.toml", "web.step", "web.stl", "step.json"} <= {p.name for p in folder.iterdir()}
        assert main(["plan", str(folder / "web.toml")]) == 0
    with (out / "steps.csv").open() as file:
        rows = list(csv.DictReader(file))
    assert [float(row["throw_kg"]) for row in rows[1:]] == masses
    assert float(rows[0]["torsion_per_mass_percent"]) == 100.0
    assert (out / "steps.png").read_bytes().startswith(b"\x89PNG")
    assert json.loads((out / "iterate.json").read_text())["steps"] == data["steps"]
    assert json.loads((out / "manifest.json").read_text())["status"] == "done"
    assert data["files"]["report"] == str(out / "report.html")
    page_holds(data, (out / "report.html").read_text(encoding="utf-8"))


def test_its_page_is_written_again_from_its_files(whole: Whole, tmp_path: Path, capsys: Capture) -> None:
    again = tmp_path / "again.html"
    assert main(["report", str(whole.out), "--out", str(again)]) == 0
    assert again.read_bytes() == (whole.out / "report.html").read_bytes()
    capsys.readouterr()
    assert main(["report", str(whole.out), "--stress"]) == ExitCode.USAGE
    assert "was made by `cranktopo iterate`, whose page shows no load cases" in capsys.readouterr().err


def page_holds(data: dict[str, Any], text: str) -> None:
    """Verdict, a row of values and a body for every step, the command."""
    names = ["original web", *(f"step {row['number']}" for row in data["steps"][1:])]
    assert re.findall(r"<option[^>]*>([^<]*)</option>", text) == names
    options = re.findall(r"<option([^>]*)>", text)
    shown = data["best_step"] or len(names) - 1
    assert [number for number, option in enumerate(options) if "selected" in option] == [shown]
    if data["best_step"] is None:
        assert best_line(LoopResult.of_json(data, "a loop"))[1:] in text
    else:
        assert f"Step {shown} is the best: " in text
    for row in data["steps"]:
        assert f'data-value="{row["throw_kg"]}"' in text
    number = data["best_step"] or len(names) - 1
    change = data["steps"][number]["percent_of_original"]["torsion_per_mass"] - 100
    assert f"{change:+.1f}\u00a0%" in text
    masses = (f"{data['steps'][n]['throw_kg']:.3f}\u00a0kg" for n in (number, 0))
    assert f": {' against the original web&#39;s '.join(masses)}" in text


@pytest.mark.slow
def test_interrupted_loop_goes_on_where_it_was(
    whole: Whole, quick: list[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: Capture
) -> None:
    out = tmp_path / "loop"
    finished = one_step.evaluate

    def interrupted(target: Any, size: float | None) -> Any:
        if target.name.endswith("step-2"):
            raise KeyboardInterrupt
        return finished(target, size)

    monkeypatch.setattr(one_step, "evaluate", interrupted)
    capsys.readouterr()
    assert main([*ARGUMENTS, "--out", str(out)]) == 130
    assert f"cranktopo iterate --resume {out}" in capsys.readouterr().err
    assert json.loads((out / "manifest.json").read_text())["status"] == "interrupted"
    assert not (out / "step-02" / "step.json").exists()
    monkeypatch.setattr(one_step, "evaluate", finished)
    before = (out / "step-01" / "step.json").read_bytes()
    assert "step 1 of 2 done" in (out / "report.html").read_text(encoding="utf-8")
    done = len(quick)
    assert main(["iterate", "--resume", str(out)]) == 0
    assert "\nstiffnesses +-0.1 % in torsion, +-0.2 % in bending at most\n" in capsys.readouterr().out
    assert (out / "step-01" / "step.json").read_bytes() == before
    assert quick[done:] == whole.calls[2:]  # step 2 and what follows, not step 1
    first, second = (json.loads((p / "iterate.json").read_text()) for p in (whole.out, out))
    for one, other in zip(first["steps"], second["steps"], strict=True):
        assert {**one, "seconds": 0} == {**other, "seconds": 0}


@pytest.mark.slow
def test_a_lost_step_keeps_the_earlier_ones_and_says_which_is_best(
    quick: list[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: Capture
) -> None:
    out, finished = tmp_path / "loop", one_step.evaluate

    def failing(target: Any, size: float | None) -> Any:
        if target.name.endswith("step-2"):
            raise CranktopoError("mesh: no tetrahedra were made.")
        return finished(target, size)

    monkeypatch.setattr(one_step, "evaluate", failing)
    assert main([*ARGUMENTS, "--out", str(out)]) == 5
    printed = capsys.readouterr().out
    assert "ended: step 2 was lost, the steps before it stand: mesh: no tetrahedra" in printed
    data = json.loads((out / "iterate.json").read_text())
    assert [one["number"] for one in data["steps"]] == [0, 1]
    assert data["lost_step"].startswith("step 2 was lost")
    assert best_line(LoopResult.of_json(data, "a loop")) in printed
    monkeypatch.setattr(one_step, "evaluate", finished)
    assert main(["iterate", "--resume", str(out)]) == 0
    assert json.loads((out / "iterate.json").read_text())["lost_step"] is None


def test_manufacturing_limits_hold_in_every_step(
    quick: list[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: Capture
) -> None:
    """As given at the start, when it is continued, and the usual ones for a loop that kept none."""
    out, seen = tmp_path / "loop", []

    def fit(surface: SurfaceMesh, scene: Scene, limits: ProcessLimits, beside: Companion) -> Any:
        assert limits.opens == "sides"  # of the loop's own process, a lateral die
        own = vars(limits)
        seen.append(ManufacturingLimits(**{name: own[name] for name in vars(ManufacturingLimits())}))
        raise KeyboardInterrupt

    monkeypatch.setattr(one_step, "fit_web", fit)
    given = ["--min-wall-mm", "4", "--min-radius-mm", "7", "--draft-deg", "6", "--cell-mm", "2"]
    assert main(["iterate", "--steps", "1", "--resolution-mm", "4.5", *given, "--out", str(out)]) == 130
    assert main(["iterate", "--resume", str(out)]) == 130
    manifest = json.loads((out / "manifest.json").read_text())
    del manifest["options"]["iterate"]["rules"]
    manifest["settings_sha256"] = settings_hash(manifest["scene"], manifest["options"])
    (out / "manifest.json").write_text(json.dumps(manifest))
    assert main(["iterate", "--resume", str(out)]) == 130
    asked = ManufacturingLimits(min_wall_mm=4.0, min_radius_mm=7.0, min_draft_deg=6.0, cell_mm=2.0)
    usual = ManufacturingLimits(min_draft_deg=5.0)  # that of the process, more than the usual 3 deg
    assert seen == [asked, asked, usual]


def test_the_loop_ends_when_the_web_is_thin(quick: list[str], tmp_path: Path, capsys: Capture) -> None:
    out = tmp_path / "loop"
    with plain_loops():
        assert main([*ARGUMENTS, "--least-transition-mm", "19.5", "--out", str(out), "--json"]) == 0
    data = json.loads(capsys.readouterr().out)
    assert "19.0 mm thick beside a journal, less than 19.5 mm" in data["stop_reason"]
    assert len(data["steps"]) == 2
    assert data["best_step"] is None


@pytest.mark.slow
def test_a_loop_is_shown_and_listed_as_one(
    quick: list[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: Capture
) -> None:
    monkeypatch.chdir(tmp_path)
    assert (
        main(["iterate", "--steps", "1", "--resolution-mm", "4.5", "--volume-fraction", "0.6", "--no-shape"])
        == 0
    )
    ended = capsys.readouterr().out
    (path,) = (tmp_path / "runs").iterdir()
    assert main(["runs", "show", path.name]) == 0
    assert capsys.readouterr().out.endswith(f"\n\n{ended}")
    assert main(["runs", "show", path.name, "--json"]) == 0
    data = json.loads((path / "iterate.json").read_text())
    assert json.loads(capsys.readouterr().out)["loop"] == data
    assert data["best_step"] is None
    assert main(["runs", "list"]) == 0
    assert "no better web" in capsys.readouterr().out
    (path / "iterate.json").write_text(json.dumps({**data, "best_step": 1}))
    best = data["steps"][1]
    assert main(["runs", "show", path.name]) == 0
    assert "\nbest: step 1, " in capsys.readouterr().out
    assert main(["runs", "list", "--json"]) == 0
    (entry,) = json.loads(capsys.readouterr().out)["runs"]
    assert entry["command"] == "iterate"
    assert entry["mass_of_throw_kg"] == best["throw_kg"]
    torsion, mass = (best[key] / data["steps"][0][key] for key in ("torsion_Nm_per_rad", "throw_kg"))
    gain = 100 * (torsion / mass - 1)
    assert entry["gain_of_stiffness_per_mass_percent"]["torsion"] == pytest.approx(gain)
    (path / "iterate.json").unlink()
    assert main(["runs", "show", path.name]) == 0
    assert f"continue with: cranktopo iterate --resume runs/{path.name}" in capsys.readouterr().out


READERS = [
    ["optimise", "--resume"],
    ["extract"],
    ["remodel"],
    ["evaluate"],
    ["compare", "mikron-iiic-plain", "--baseline"],
    ["fatigue"],
    ["accuracy"],
]


@pytest.mark.parametrize("command", READERS, ids=lambda command: command[0])
def test_a_loop_is_no_run_of_optimise(
    command: list[str], tmp_path: Path, mikron: Scene, capsys: Capture
) -> None:
    """One line that names what made it and what goes on with it; nothing in it is touched."""
    path = new_run(tmp_path / "loop", mikron, {"iterate": {"steps": 3, "least_transition_mm": 7.6}})
    before = {file: file.read_bytes() for file in path.iterdir()}
    assert main([*command, str(path)]) == 3
    error = capsys.readouterr().err.splitlines()[-1]
    assert f"run '{path}': was made by `cranktopo iterate`" in error
    assert f"cranktopo runs show {path}; or continue it: cranktopo iterate --resume {path}" in error
    assert {file: file.read_bytes() for file in path.iterdir()} == before


@pytest.mark.parametrize(("kind", "file"), [("iterate", "iterate.json"), ("shape", "shape.json")])
def test_a_run_without_an_end_has_no_page(
    kind: str, file: str, tmp_path: Path, mikron: Scene, capsys: Capture
) -> None:
    path = new_run(tmp_path / "run", mikron, {kind: {}})
    assert main(["report", str(path)]) == ExitCode.INVALID_INPUT
    error = capsys.readouterr().err
    assert f"not finished, {file} is missing. Continue it with: cranktopo {kind} --resume {path}" in error
    assert not (path / "report.html").exists()


def test_the_page_of_a_sweep_is_its_own(tmp_path: Path, mikron: Scene, capsys: Capture) -> None:
    path = new_run(tmp_path / "run", mikron, {"sweep": {}})
    assert main(["report", str(path)]) == ExitCode.INVALID_INPUT
    assert "was made by `cranktopo sweep`" in capsys.readouterr().err


def test_a_run_of_optimise_is_no_loop(tmp_path: Path, mikron: Scene, capsys: Capture) -> None:
    path = new_run(tmp_path / "run", mikron, {})
    assert main(["iterate", "--resume", str(path)]) == 3
    error = capsys.readouterr().err
    assert "was made by `cranktopo optimise`; this needs one of `cranktopo iterate`" in error
    assert f"cranktopo optimise --resume {path}" in error


def new_run(path: Path, scene: Scene, options: dict[str, Any]) -> Path:
    """A run that holds nothing but its inputs."""
    return create_run(
        design=scene.name,
        design_toml=toml_text(scene, "as given"),
        scene=scene.model_dump(mode="json"),
        options=options,
        command=["cranktopo"],
        out=path,
    ).path


def test_bad_use(tmp_path: Path, capsys: Capture) -> None:
    for given in (["--process", "cast"], ["--steps", "6"], ["--draft-deg", "3"], ["mikron-iiic-plain"]):
        assert main(["iterate", "--resume", str(tmp_path), *given]) == 2
        (error,) = capsys.readouterr().err.splitlines()
        assert "--resume takes the design and its options from the run" in error
        assert f"leave out {given[0] if given[0].startswith('--') else 'DESIGN'}" in error
    assert main(["iterate", "--steps", "0"]) == 2
    assert main(["iterate", "nonsense"]) == 3
    taken = tmp_path / "taken"
    taken.mkdir()
    (taken / "file").write_text("kept")
    assert main(["iterate", "--out", str(taken)]) == 3
    assert "never overwritten" in capsys.readouterr().err
