"""Limits that no web of the envelope meets are refused before a web is tried, as `optimise` does."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from cranktopo.app.main import main
from cranktopo.base.errors import CranktopoError, ExitCode
from cranktopo.design.goal.scene_goal import with_goal
from cranktopo.design.loading import load_scene
from cranktopo.design.schema import Scene
from cranktopo.engine.balance.throw import throw_balance
from cranktopo.tasks.web_shape import run
from cranktopo.tasks.web_shape.reachable import check_reachable
from cranktopo.tasks.web_shape.run import shape_goal
from tests.cli.test_left_off_first import TWIN, stopped

CELL_MM = 4.5


def asked(*limits: str, scene: Scene | None = None) -> Scene:
    return with_goal(scene or load_scene("mikron-iiic-plain"), minimise="mass", limits=limits)


def check(scene: Scene) -> None:
    check_reachable(scene, shape_goal(scene), CELL_MM)


@pytest.mark.parametrize(
    ("limits", "told"),
    [
        (("torsion >= 400 %",), "torsion >= 400 %: the whole envelope reaches 1"),
        (("inertia >= 20000 kg mm2",), "inertia >= 20000 kg mm2: the whole envelope has "),
        (("bending >= 900 kN/mm",), "bending >= 900000 N/mm: the whole envelope reaches "),
    ],
)
def test_what_no_web_meets_is_refused(limits: tuple[str, ...], told: str) -> None:
    with pytest.raises(CranktopoError) as caught:
        check(asked(*limits))
    assert caught.value.code == ExitCode.CRITERION_NOT_MET
    assert told in str(caught.value)


def test_what_a_web_may_meet_is_not() -> None:
    check(asked("torsion >= 120 %", "inertia <= 110 %"))


def test_nothing_is_solved_for_limits_of_the_original(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("cranktopo.tasks.web_shape.reachable.build_domain", lambda *_: pytest.fail("cells"))
    check(asked())
    free = load_scene("mikron-iiic-plain")
    shape = free.shape.model_copy(
        update={"free": free.shape.free.model_copy(update={"web_thickness_mm": (15.0, 25.0)})}
    )
    check(asked("torsion >= 400 %", scene=free.model_copy(update={"shape": shape})))


def test_the_command_leaves_nothing(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(run, "optimise_shape", lambda *_: pytest.fail("a web was tried"))
    words = ["--minimise", "mass", "--limit", "torsion >= 400 %", "--out", str(tmp_path / "run")]
    assert main(["shape", "mikron-iiic-plain", *words]) == ExitCode.CRITERION_NOT_MET
    assert "torsion >= 400 %: the whole envelope reaches 14" in capsys.readouterr().err
    assert not (tmp_path / "run").exists()


def test_an_over_balanced_throw_is_refused_by_no_limit_that_nobody_wrote(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """Heavier counterweights than the engine asks for: the unbalance is below 0, and a run that ends leaves
    nothing in the way of the next one."""
    monkeypatch.setattr(run, "optimise_shape", stopped)
    design = tmp_path / "over.toml"
    text = (
        TWIN.read_text(encoding="utf-8")
        .partition("[shaft")[0]
        .replace("outer_radius_mm = 75.08", "outer_radius_mm = 76.5")
    )
    design.write_text(f"{text}\n[envelope]\nshape = 'cylinder'\nradius_mm = 78.0\n", encoding="utf-8")
    assert throw_balance(load_scene(str(design))).throw_unbalance_kg_mm < 0
    main(["shape", str(design), "--minimise", "mass", "--out", str(tmp_path / "run")])
    told = capsys.readouterr().err
    assert told.splitlines()[-1] == "error: stopped before the first solve."
    assert re.search(r"assumed: goal.limits.unbalance from -\d\S* kg mm to -\d", told)
    assert not (tmp_path / "run").exists()
