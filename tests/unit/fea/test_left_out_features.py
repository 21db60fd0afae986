"""Features that the plan takes out of an evaluated body are told: masses of other commands have them."""

from __future__ import annotations

from pathlib import Path

import pytest

from cranktopo.design.loading import load_scene
from cranktopo.design.schema import Scene
from cranktopo.design.writing import new_run
from cranktopo.tasks.throw_fea.stage import print_assumed
from cranktopo.tasks.throw_fea.targets import resolve_target


def narrow_bored() -> Scene:
    """A throw whose bores are 1 % of its mass, below the threshold of 2 %."""
    scene = load_scene("mikron-iiic-plain")
    throw = scene.throw
    bored = {
        name: getattr(throw, name).model_copy(update={"bore_diameter_mm": 5.0})
        for name in ("main_journal", "crankpin")
    }
    return scene.model_copy(update={"throw": throw.model_copy(update=bored)})


def test_bores_that_the_plan_leaves_out_are_told(caplog: pytest.LogCaptureFixture) -> None:
    caplog.set_level("INFO")
    target = resolve_target(narrow_bored())
    assert target.scene.throw.crankpin.bore_diameter_mm == 0
    print_assumed([target], ())
    assert f"{target.name}: meshed without bores: solid journals would be" in caplog.text
    assert "% heavier, below the threshold of 2 %; effects.bores = 'on' keeps them" in caplog.text


def test_nothing_is_told_of_features_that_stay() -> None:
    assert resolve_target(narrow_bored().with_effect("bores", "on")).left_out == ""
    assert resolve_target("mikron-iiic").left_out == ""


def test_fillets_are_told_but_where_they_are_kept() -> None:
    sharp = load_scene("mikron-iiic").with_effect("fatigue", "off").with_effect("fillets", "off")
    assert "meshed without fillets: set off in the scene" in resolve_target(sharp).left_out
    assert resolve_target(sharp, fillets=True).left_out == ""


def test_the_surface_of_a_run_is_told_alike(tmp_path: Path) -> None:
    run = new_run(narrow_bored(), (), tmp_path / "run", None, ["cranktopo", "optimise"], {})
    (run.path / "web.stl").touch()
    assert resolve_target(run.path).left_out.startswith("meshed without bores: solid journals")
