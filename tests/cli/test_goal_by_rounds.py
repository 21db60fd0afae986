"""Limits that hold by the evaluation of the surface: moved in the cells until they do; resumed exactly.

`python -m pytest -m slow tests/cli/test_goal_by_rounds.py`, half a minute.
"""

from __future__ import annotations

import json
import shutil
from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import trimesh

from cranktopo.app.main import main
from cranktopo.base.errors import CranktopoError
from cranktopo.base.progress import StageMemory
from cranktopo.design.goal.constraint import Constraint
from cranktopo.design.goal.limit import Goal, Limit
from cranktopo.design.goal.outcome import GoalOutcome, goal_outcome
from cranktopo.design.schema import Scene
from cranktopo.tasks.bound.result import NoBound
from cranktopo.tasks.density.state import Record, State
from cranktopo.tasks.optimise import evaluated_goal
from cranktopo.tasks.optimise.evaluated_goal import enforce_limits_by_fea
from cranktopo.tasks.optimise.result import RunMetrics
from cranktopo.tasks.optimise.text import headline, run_summary
from cranktopo.tasks.throw_fea.evaluation import Evaluation
from cranktopo.tasks.throw_fea.throw_stiffness import Stiffness

pytestmark = pytest.mark.slow
OPTIONS = [
    *("--minimise", "mass", "--limit", "bending none", "--limit", "torsion >= 90 %"),
    *("--limit", "fatigue_safety none", "--resolution-mm", "8", "--process", "free"),
]
TORSION_NM_PER_RAD = 100e3


def evaluation(target: Any, torsion: float, mass: float = 1.5) -> Evaluation:
    fine = Stiffness({"free": torsion}, {"pinned": 70e3}, 1234, 4.0, 1.0, 2.0)
    return Evaluation(target.name, mass, 0.6, 5000, 50, fine, "free", "pinned", 0.3, 0.4, 3.0)


class Evaluator:
    """A stand-in: the stiffness of a surface goes with its volume, the first one misses its limit.

    Before it has evaluated that, it copies the run: what a kill would leave.
    """

    def __init__(self, first_percent: float, run: Path, copy: Path) -> None:
        self.first_percent, self.run, self.copy = first_percent, run, copy
        self.names, self.first_volume = list[str](), 0.0

    def __call__(self, target: Any, *_: Any, **__: Any) -> Evaluation:
        self.names.append(target.name)
        if target.file is None:
            assert target.scene.throw.crankpin.fillet_mm == 0
            return evaluation(target, TORSION_NM_PER_RAD)
        volume = float(trimesh.load_mesh(target.file).volume)
        if not self.first_volume:
            self.first_volume = volume
            shutil.copytree(self.run, self.copy)
        share = self.first_percent / 100 * (volume / self.first_volume) ** 2
        return evaluation(target, share * TORSION_NM_PER_RAD, volume * 1e-5)


Short = tuple[int, Path, dict[str, Any], Evaluator]


@pytest.fixture(scope="module", autouse=True)
def bounds() -> Iterator[list[dict[str, float]]]:
    """What the bound, which is no subject here, is asked to stand beside, percent of the original."""
    asked: list[dict[str, float]] = []

    def beside(_: Scene, reached: dict[str, float], *__: Any) -> NoBound:
        asked.append(reached)
        return NoBound(none="not proven")

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("cranktopo.tasks.optimise.finalise.bounds_for_result", beside)
        yield asked


@pytest.fixture(scope="module")
def short(tmp_path_factory: pytest.TempPathFactory) -> Short:
    """A run whose first design misses its limit by 2 % of it."""
    folder = tmp_path_factory.mktemp("rounds")
    out = folder / "run"
    evaluator = Evaluator(88.2, out, folder / "killed")
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(evaluated_goal, "evaluate", evaluator)
        code = main(["optimise", "opposed-piston", *OPTIONS, "--out", str(out)])
    return code, out, json.loads((out / "metrics.json").read_text(encoding="utf-8")), evaluator


def test_a_limit_missed_by_the_evaluation_is_moved_until_it_holds(
    short: Short,
) -> None:
    code, _, metrics, evaluator = short
    goal = metrics["goal"]
    (limit,), found = goal["limits"], goal["evaluation"]
    assert code == 0
    assert 2 <= len(evaluator.names) - 1 == len(found["rounds"]) + 1 <= 4
    first = found["rounds"][0]
    assert first["bounds"][0] == pytest.approx(limit["required"] / 0.98, rel=3e-3)
    assert limit["evaluation"]["required"] == pytest.approx(0.9 * TORSION_NM_PER_RAD)
    assert limit["evaluation"]["reached_percent"] == pytest.approx(90, rel=5e-3)
    assert limit["reached_percent"] > 90.5
    assert limit["holds"]
    assert "every limit holds by the evaluation after" in metrics["stop_reason"]
    assert metrics["seconds"]["evaluation"] == 3.0 * len(evaluator.names)


def test_the_bound_stands_beside_what_the_goal_reached(short: Short, bounds: list[dict[str, float]]) -> None:
    assert bounds[0]["mass"] == short[2]["goal"]["reached_percent"]


def test_page_and_summary_show_both(short: Short) -> None:
    _, run, metrics, _ = short
    assert "original web without fillets" in (run / "report.html").read_text(encoding="utf-8")
    text = run_summary(RunMetrics.of_json(metrics, "run"), run)
    assert f"by the evaluation {metrics['goal']['evaluation']['reached_percent']:.1f} %" in text
    assert "evaluated: the extracted surface" in text


@pytest.mark.slow
def test_a_run_killed_in_an_evaluation_ends_the_same(short: Short, tmp_path: Path) -> None:
    _, whole, metrics, evaluator = short
    out, calls = tmp_path / "run", len(evaluator.names)
    shutil.copytree(evaluator.copy, out)
    assert json.loads((out / "manifest.json").read_text(encoding="utf-8"))["status"] == "running"
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(evaluated_goal, "evaluate", evaluator)
        assert main(["optimise", "--resume", str(out)]) == 0
    assert evaluator.names[calls:] == evaluator.names[:calls]
    assert (out / "web.stl").read_bytes() == (whole / "web.stl").read_bytes()
    again = json.loads((out / "metrics.json").read_text(encoding="utf-8"))
    assert again["goal"] == metrics["goal"]
    assert (
        again["iterations"] == metrics["iterations"] > metrics["goal"]["evaluation"]["rounds"][0]["iteration"]
    )


def test_limits_that_could_not_be_judged_are_said_first(
    short: Short, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Also where only the original, which limits are in percent of, could not be evaluated."""
    run = tmp_path / "run"
    shutil.copytree(short[3].copy, run)

    def failing(target: Any, *_: Any, **__: Any) -> Evaluation:
        if target.file is None:
            raise CranktopoError("mesh of the original web: no valid mesh.")
        return evaluation(target, TORSION_NM_PER_RAD)

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(evaluated_goal, "evaluate", failing)
        assert main(["optimise", "--resume", str(run)]) == 6
    out, err = capsys.readouterr()
    first = out.splitlines()[0]
    assert first.startswith("not judged: torsion >= ")
    assert "the evaluation failed, mesh of the original web: no valid mesh;" in first
    assert "could not be evaluated" in err
    metrics = json.loads((run / "metrics.json").read_text(encoding="utf-8"))
    (limit,) = metrics["goal"]["limits"]
    assert (metrics["status"], limit["holds"]) == ("converged", None)
    assert headline(RunMetrics.of_json(metrics, "run")).startswith("Not judged: torsion >= ")


GOAL = Goal("minimise", "mass", (Limit("torsion", ">=", 90.0, percent=True),))


@dataclass(frozen=True)
class Invented:
    """Designs of which the evaluation always says the same."""

    percent: float
    work: StageMemory = field(default_factory=StageMemory)
    goal: Goal = GOAL

    def original(self) -> dict[str, float]:
        return {"mass": 1.6, "torsion": 100.0}

    def reached(self, _: State) -> dict[str, float]:
        if self.percent == 0:
            raise CranktopoError("mesh: no valid mesh.")
        return {"mass": 1.4, "torsion": self.percent}

    def outcome(self, state: State) -> GoalOutcome:
        return goal_outcome(self.goal, self.reached(state), self.original())

    def in_cells(self, state: State) -> tuple[tuple[Constraint, float], ...]:
        limit = Constraint("torsion", ">=", state.bounds[0] if state.bounds else 90.0)
        return ((limit, limit.bound),)


DONE = State(
    *(np.zeros(1),) * 3,
    beta=16.0,
    history=(Record(30, 16.0, 1.0, (1.0,), 0.3, 0.01, 0.0, 5, 1.0),),
    status="converged",
    reason="settled",
)


def ended(percent: float) -> State:
    def settled(state: State) -> State:
        return replace(state, status="converged", reason="settled")

    case: Any = Invented(percent)
    found, failure = enforce_limits_by_fea(case, DONE, lambda _: None, settled)
    assert not failure
    return found


def test_what_cannot_be_met_is_said() -> None:
    found = ended(89.0)
    assert [now.bounds[0] for now in found.rounds] == pytest.approx([90 * (90 / 89) ** n for n in (1, 2, 3)])
    assert found.reason == (
        "settled; not met by the evaluation after the limits in the cells were moved 3 times: "
        "torsion >= 90 N m/rad: reached 89 N m/rad"
    )


def test_a_reserve_in_a_limit_that_decides_is_used_up() -> None:
    found = ended(92.0)
    assert [now.bounds[0] < 90 for now in found.rounds] == [True] * 3
    assert "every limit holds by the evaluation after" in found.reason


def test_a_limit_that_holds_is_not_moved() -> None:
    found = ended(90.2)
    assert (found.rounds, found.reason) == ((), "settled; every limit holds by the evaluation")


def test_a_search_that_fails_later_says_that_its_limits_were_moved() -> None:
    def stopped(state: State) -> State:
        return replace(state, status="stopped", reason="iterations spent")

    case: Any = Invented(89.0)
    found, _ = enforce_limits_by_fea(case, DONE, lambda _: None, stopped)
    assert found.reason == "iterations spent (limits in the cells as the evaluation moved them)"


def test_a_design_that_cannot_be_evaluated_is_kept() -> None:
    case: Any = Invented(0.0)
    found, failure = enforce_limits_by_fea(case, DONE, lambda _: None, lambda state: state)
    assert (found.status, found.reason) == ("converged", "settled; its limits are not judged")
    assert failure == "mesh: no valid mesh."


def test_the_option_needs_a_goal(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["optimise", "--no-evaluation"]) == 2
    assert "--no-evaluation needs a goal" in capsys.readouterr().err
