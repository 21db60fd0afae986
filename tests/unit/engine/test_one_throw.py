"""Of a crank with different throws a command takes one: that asked for, or the worst loaded."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from cranktopo.app.main import main
from cranktopo.base.errors import CranktopoError
from cranktopo.design.crank_throws import throw_scenes
from cranktopo.design.loading import parse_scene, scene_from_dict
from cranktopo.design.schema import Scene
from cranktopo.engine.balance.crank import crank_mass
from cranktopo.engine.balance.throw import throw_balance
from cranktopo.engine.one_throw import nominal_stresses_MPa, one_throw
from cranktopo.tasks.throw_fea.targets import resolve_target
from tests.engine_arrangements import MIKRON

THIN, END = "thickness_mm = 16.0", "[[crank.end]]\nside = 'free'\n"


@pytest.fixture
def design(tmp_path: Path) -> Path:
    """The second throw has thinner webs."""
    other = MIKRON.replace("thickness_mm = 19.0", THIN)
    (tmp_path / "thin.toml").write_text(other, encoding="utf-8")
    crank = f"[crank]\nthrows = ['throw', 'thin.toml', 'throw', 'throw']\n{END}"
    (tmp_path / "crank.toml").write_text(MIKRON + crank, encoding="utf-8")
    return tmp_path / "crank.toml"


def read(design: Path) -> Scene:
    return parse_scene(design.read_text(encoding="utf-8"), folder=design.parent)


def test_the_worst_loaded_throw_is_taken(design: Path) -> None:
    scene = read(design)
    stresses = nominal_stresses_MPa(scene)
    assert int(np.argmax(stresses)) == 1
    taken = one_throw(scene)
    assert taken.web.thickness_mm == 16.0
    assert taken.crank is not None
    assert len(taken.crank.end) == 1
    assert resolve_target(str(design)).scene.web.thickness_mm == 16.0
    assert resolve_target(str(design), whole=True, crank=True).scene.web.thickness_mm == 19.0


def test_a_throw_by_its_number(design: Path) -> None:
    assert one_throw(read(design), 3).web.thickness_mm == 19.0
    with pytest.raises(CranktopoError, match="the crank has throws 1 to 4"):
        one_throw(read(design), 5)


def test_throws_that_are_alike_are_not_asked_for() -> None:
    scene = parse_scene(MIKRON)
    assert one_throw(scene) is scene
    with pytest.raises(CranktopoError, match="all throws of the crank are alike"):
        one_throw(scene, 1)


def test_the_only_throw_is_taken_without_a_word(capsys: pytest.CaptureFixture[str]) -> None:
    """Its main journals differ, as those of a crank from CAD do."""
    data = parse_scene(MIKRON).model_dump(mode="json", exclude_none=True, exclude={"published"})
    data["engine"] |= {"cylinders": 1, "firing_order": [1]}
    data["crank"] = {"throws": ["throw"], "main_journal": [{"number": 1, "length_mm": 46.0}]}
    scene = scene_from_dict(data, "single")
    assert one_throw(scene).name == scene.name
    assert one_throw(scene, 1).throw == one_throw(scene).throw
    assert "is taken" not in capsys.readouterr().err


def test_mass_of_different_throws(design: Path) -> None:
    scene = read(design)
    mass = crank_mass(scene)
    assert mass is not None
    throws = sum(throw_balance(throw).mass_kg for throw in throw_scenes(scene))
    assert mass.mass_kg == pytest.approx(throws + mass.free_end_kg, rel=1e-12)
    assert throws < 4 * throw_balance(scene).mass_kg
    assert mass.unbalance_kg_mm > 1.0


def test_loads_tell_which_throw_and_the_whole_crank(design: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["loads", str(design)]) == 0
    told = capsys.readouterr()
    assert "throw 2 of 4 is taken, the worst loaded" in told.err
    assert "whole crank: mass" in told.out
    assert main(["loads", str(design), "--throw", "1"]) == 0
    assert "is taken" not in capsys.readouterr().err
