"""What a command does, one call of the Python interface does as well."""

from __future__ import annotations

import inspect
import json
import re
from datetime import datetime
from pathlib import Path
from typing import Any

import pytest

import cranktopo
from cranktopo.app.main import COMMANDS
from cranktopo.design.schema import Scene
from cranktopo.tasks.accuracy import stage as accuracy
from cranktopo.tasks.iterate import one_step
from cranktopo.tasks.optimise.result import OptimisedRun
from cranktopo.tasks.refit import stage as remodelling
from cranktopo.tasks.throw_fatigue import stage as fatigue
from cranktopo.tasks.throw_fea import stage as evaluating
from cranktopo.tasks.throw_fea.evaluation import Evaluation
from cranktopo.tasks.throw_fea.throw_stiffness import Stiffness
from tests.plain_runs import plain_runs

BEHIND = {
    "optimise": ["optimise_design", "resume_optimisation", "with_cells_for", "with_goal"],
    "plan": ["load_scene", "plan", "wanted"],
    "loads": ["loads_at_speeds", "write_load_curves", "plot_load_curves"],
    "evaluate": [
        "resolve_targets",
        "evaluate_target",
        "evaluate_targets",
        "evaluate_sensitivities",
        "MeshRequest",
    ],
    "compare": ["compare_targets", "report_comparison"],
    "accuracy": ["study_accuracy"],
    "report": ["report_run"],
    "fatigue": ["assess_fatigue"],
    "shaft": ["assess_shaft"],
    "balance": ["engine_balance", "balance_result", "report_balance"],
    "vibration": ["shaft_vibration"],
    "modes": ["shaft_modes"],
    "bolts": ["check_bolts"],
    "rod": ["check_rod_strength", "check_rod_elements", "lighten_rod", "lighten_rod_by_elements", "draw_rod"],
    "balancer": ["check_balancer", "redesign_balancer", "draw_balancer"],
    "film": ["oil_films"],
    "extract": ["extract_surface"],
    "remodel": ["remodel_run"],
    "shape": [
        "web_target",
        "shape_design",
        "resume_shape",
        "shape_settings",
        "shape_each_web",
        "resume_each_web",
    ],
    "bound": ["bound_of"],
    "sweep": ["sweep"],
    "iterate": ["loop_scene", "loop_settings", "start_loop", "continue_loop"],
    "export": ["export_solid"],
    "runs": ["summarise_runs", "clean_runs"],
    "doctor": ["check_machine"],
    "import": ["import_crank"],
    "drawing": ["draw_crank"],
}
"""The functions behind each command; `designs` and `completion` only list and copy, `bench` is a page."""


def test_every_command_has_its_functions() -> None:
    assert set(COMMANDS) - set(BEHIND) == {"bench", "designs", "completion"}
    assert {name for names in BEHIND.values() for name in names} <= set(cranktopo.__all__)


@pytest.fixture(scope="module")
def run(mikron: Scene, tmp_path_factory: pytest.TempPathFactory) -> OptimisedRun:
    out = tmp_path_factory.mktemp("runs") / "api"
    scene = mikron.with_optimise(volume_fraction=0.3, resolution_mm=4.5, max_iterations=3)
    with plain_runs():
        return cranktopo.optimise_design(scene, out)


def test_a_run_from_its_start_to_its_files(run: OptimisedRun, tmp_path: Path) -> None:
    assert run.metrics.as_json() == json.loads((run.folder / "metrics.json").read_text())
    assert run.metrics.status == "stopped"
    with plain_runs():
        again = cranktopo.resume_optimisation(str(run.folder), max_iterations=4)
    assert again.metrics.iterations == 4
    assert cranktopo.report_run(str(run.folder), tmp_path / "run.md").is_file()
    found, path = cranktopo.extract_surface(str(run.folder), 3, tmp_path / "three.3mf", "3mf")
    assert (found.iteration, path.read_bytes()[:2], path.stat().st_size > 1000) == (3, b"PK", True)
    (entry,) = cranktopo.summarise_runs(run.folder.parent)
    assert (entry.status, entry.result) == ("done", "stopped")
    assert cranktopo.clean_runs(("failed",), True, run.folder.parent) == []


def invented(target: Any, *_: object) -> Evaluation:
    fine = Stiffness({"free": 100e3}, {"pinned": 70e3}, 1234, 4.0, 1.0, 2.0)
    return Evaluation(target.name, 2.0, 0.6, 5000, 50, fine, "free", "pinned", 0.3, 0.4, 3.0)


def test_targets_are_evaluated_compared_and_reported(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(evaluating, "evaluate", invented)
    assert cranktopo.evaluate_target("mikron-iiic-plain").torsion_Nm_per_rad == 100e3
    names = ["opposed-piston", "opposed-piston-casting"]
    targets = cranktopo.resolve_targets(names)
    assert [e.target for e in cranktopo.evaluate_targets(targets).evaluations] == names
    found = cranktopo.compare_targets(names[1:], names[0], cranktopo.MeshRequest(element_size_mm=8.0))
    assert [entry.name for entry in found.comparison.entries] == names
    cranktopo.report_comparison(found, tmp_path / "page.md", ["by", "hand"])
    assert "by hand" in (tmp_path / "page.md").read_text(encoding="utf-8")
    with pytest.raises(cranktopo.CranktopoError, match="excludes"):
        cranktopo.MeshRequest(element_size_mm=8.0, accuracy_percent=1.0)


def test_loads_are_tabulated_and_drawn(mikron: Scene, tmp_path: Path) -> None:
    slow, fast = cranktopo.loads_at_speeds(mikron, [1000.0, 2000.0])
    assert (slow.speed_rpm, fast.speed_rpm) == (1000.0, 2000.0)
    cranktopo.write_load_curves(mikron, tmp_path / "curves.csv", [1000.0])
    cranktopo.plot_load_curves(mikron, tmp_path / "curves.png", 1000.0)
    assert {path.name for path in tmp_path.iterdir()} == {"curves.csv", "curves.png"}


def test_machine_is_checked() -> None:
    assert all(check.state in ("ok", "missing", "short", "absent") for check in cranktopo.check_machine())


def test_every_path_may_be_text(mikron: Scene, tmp_path: Path) -> None:
    """In a notebook nobody imports Path: every function that takes one takes its text as well."""
    functions = {name: getattr(cranktopo, name) for name in cranktopo.__all__}
    paths = {
        (name, parameter.name): str(parameter.annotation)
        for name, function in functions.items()
        if inspect.isfunction(function)
        for parameter in inspect.signature(function).parameters.values()
        if re.search(r"\bPath\b", str(parameter.annotation))
    }
    assert len(paths) > 25
    assert [place for place, told in paths.items() if not re.search(r"\bstr\b", told)] == []
    cranktopo.export_solid(mikron, "web", str(tmp_path / "web.stl"), 4.0)
    cranktopo.write_load_curves(mikron, str(tmp_path / "curves.csv"), [1000.0])
    cranktopo.report_balance(cranktopo.engine_balance(mikron), str(tmp_path / "balance.md"))
    assert len(list(tmp_path.iterdir())) >= 3
    assert cranktopo.summarise_runs(str(tmp_path)) == []


def test_solids_and_shafts(mikron: Scene, tmp_path: Path) -> None:
    assert cranktopo.export_solid(mikron, "web", tmp_path / "web.stl", 4.0) > 0
    assert cranktopo.evaluate_shaft(cranktopo.resolve_target("mikron-iiic-plain"), "rigid", 20.0).mass_kg > 0


def a_path(tmp_path: Path) -> Path:
    path = tmp_path / "mikron-iiic-plain.toml"
    cranktopo.save_scene("mikron-iiic-plain", path)
    return path


@pytest.mark.parametrize(
    "call",
    [
        cranktopo.plan,
        cranktopo.load_cases,
        cranktopo.wanted,
        cranktopo.loop_scene,
        cranktopo.loop_settings,
        cranktopo.shape_settings,
        lambda design: cranktopo.loads_at_speeds(design)[0].extremes,
        lambda design: cranktopo.engine_balance(design).counterweights,
        lambda design: cranktopo.prepare(design).cases,
        lambda design: cranktopo.web_target(design).design,
        lambda design: cranktopo.resolve_target(design).scene,
        lambda design: cranktopo.with_values(design, {"web.width_mm": 60.0}),
        lambda design: cranktopo.with_goal(design, minimise="mass"),
    ],
)
def test_a_scene_a_path_and_a_name_are_the_same(call: Any, tmp_path: Path) -> None:
    name, scene = "mikron-iiic-plain", cranktopo.load_scene("mikron-iiic-plain")
    assert call(name) == call(scene) == call(a_path(tmp_path)) == call(str(a_path(tmp_path)))


def test_scenes_are_targets(scheduler: str, monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """Variants that have no file, told apart where they have one name."""
    monkeypatch.setattr(evaluating, "evaluate", invented)
    scene = cranktopo.load_scene("mikron-iiic-plain")
    wider = cranktopo.with_values(scene, {"web.width_mm": 60.0})
    assert cranktopo.evaluate_target(wider).target == cranktopo.evaluate_target(a_path(tmp_path)).target
    found = cranktopo.evaluate_targets([scene, wider, "mikron-iiic"])
    names = ["mikron-iiic-plain", "mikron-iiic-plain-2", "mikron-iiic"]
    assert [one.target for one in found.evaluations] == names
    compared = cranktopo.compare_targets([wider], scene)
    assert [entry.name for entry in compared.comparison.entries] == names[:2]
    assert compared.comparison.base.name == names[0]
    place: dict[str, Any] = {"scheduler": scheduler, "out": tmp_path / "s"}
    _, row = cranktopo.sweep(scene, {"web.width_mm": [58.0]}, function=width, **place)["width"]
    assert row == 58.0


def width(scene: Scene) -> dict[str, float]:
    return {"width": scene.web.largest_half_width_mm * 2}


class AskedError(Exception):
    """The long part was reached with these arguments."""


def stop(*arguments: object, **_: object) -> Any:
    raise AskedError(arguments)


def test_fatigue_takes_names_and_knows_its_defaults(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(fatigue, "fatigue_fields", stop)
    with pytest.raises(AskedError) as asked:
        cranktopo.assess_fatigue(["mikron-iiic-plain"])
    target, *settings = asked.value.args[0][:4]
    assert (target.name, *settings) == ("mikron-iiic-plain", ["lsa"], "extremes", fatigue.RULE_FRACTION)


def test_accuracy_takes_a_name(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(accuracy, "run_studies", stop)
    with pytest.raises(AskedError) as asked:
        cranktopo.study_accuracy("mikron-iiic-plain", out=tmp_path / "study")
    assert asked.value.args[0][1] == accuracy.BUDGET_S


def test_remodel_takes_a_run(run: OptimisedRun, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(remodelling, "fit_web", stop)
    with pytest.raises(AskedError) as asked:
        cranktopo.remodel_run(str(run.folder))
    limits, usual = asked.value.args[0][2], cranktopo.ManufacturingLimits()
    assert {key: getattr(limits, key) for key in vars(usual)} == vars(usual)


def test_loop_is_forged_and_ends_at_forty_percent_by_itself(mikron: Scene) -> None:
    assert cranktopo.loop_scene(mikron).optimise.process == "forged"
    cast = mikron.with_optimise(process="cast")
    assert cranktopo.loop_scene(cast) is cast
    assert cranktopo.loop_settings(mikron).least_transition_mm == pytest.approx(0.4 * 19.0)


def test_loop_starts_and_continues(mikron: Scene, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    seen = []

    def interrupted(scene: Scene, folder: Path, started: datetime) -> None:
        seen.append((scene.name, folder.name))
        raise KeyboardInterrupt

    monkeypatch.setattr(one_step, "write_solids", interrupted)
    with pytest.raises(cranktopo.CranktopoError, match="finished steps are kept"):
        cranktopo.start_loop(mikron, cranktopo.loop_settings(mikron, 3), tmp_path / "loop")
    with pytest.raises(cranktopo.CranktopoError, match="finished steps are kept"):
        cranktopo.continue_loop(str(tmp_path / "loop"))
    assert seen == [("mikron-iiic-plain", "original")] * 2
