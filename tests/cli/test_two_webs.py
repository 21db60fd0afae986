"""Commands on a throw with two different webs, as a user runs them."""

from __future__ import annotations

import json
import re
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from cranktopo.app.main import main
from cranktopo.base.errors import CranktopoError
from cranktopo.design.halves import halves
from cranktopo.design.loading import designs_folder, load_scene, scene_from_dict
from cranktopo.engine.balance.throw import throw_balance
from cranktopo.tasks.accuracy.study import planned_studies, run_studies
from cranktopo.tasks.compare import stage as compare
from cranktopo.tasks.sweep.fineness import Fineness
from cranktopo.tasks.sweep.plan import sweep_plan
from cranktopo.tasks.sweep.stages import run_stage
from cranktopo.tasks.sweep.variation import read_option
from cranktopo.tasks.throw_fatigue import rule_check
from cranktopo.tasks.throw_fatigue.m53 import concentration_factors, dimensions
from cranktopo.tasks.throw_fatigue.mesh_quality import Quality
from cranktopo.tasks.throw_fea.studies import EVALUATION, FILLET_STRESS
from cranktopo.tasks.throw_fea.targets import Target, resolve_targets
from cranktopo.throw.drilling import moments as drilling_moments
from tests.packed_scenes import unpacked

MIKRON = (designs_folder() / "mikron-iiic-plain.toml").read_text(encoding="utf-8")
SECOND = """
[second_web]
thickness_mm = 25.0
outline = "tapered"
main_radius_mm = 30.0
pin_radius_mm = 26.0
"""
QUALITY = Quality(0.4, 0.24, 1000, 1.0, 4.0, 1.0, 2.0)
COARSE = ("--element-size-mm", "24", "--quiet")


@pytest.fixture
def two(tmp_path: Path) -> str:
    path = tmp_path / "two.toml"
    path.write_text(
        MIKRON.replace('name = "mikron-iiic-plain"', 'name = "two"', 1) + SECOND, encoding="utf-8"
    )
    return str(path)


def printed(capsys: pytest.CaptureFixture[str], *command: str) -> str:
    assert main(list(command)) == 0
    return capsys.readouterr().out


def test_the_table_has_the_mass_of_both_webs(two: str, capsys: pytest.CaptureFixture[str]) -> None:
    """Those of `loads`, in closed form; a throw with equal webs beside it has a dash."""
    balance = json.loads(printed(capsys, "loads", two, "--json"))["balance"]
    lines = printed(capsys, "evaluate", two, "mikron-iiic-plain", *COARSE).splitlines()
    head = next(number for number, line in enumerate(lines) if line.startswith("target"))
    assert re.split(r"  +", lines[head])[:4] == ["target", "throw", "web", "web"]
    assert lines[head - 1].split()[0] == "second", "its head goes on below"
    masses = [f"{balance[f'{which}web_mass_kg']:.3f}" for which in ("", "second_")]
    assert re.split(r"  +", lines[head + 3])[2:4] == masses
    assert re.split(r"  +", lines[head + 4])[3] == "-"


def test_the_rule_judges_each_web(
    two: str, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """In a throw that has it twice, here by a stand-in for its elements; a comparison takes the worse one."""

    def solved(target: Target, *_: object, **__: object) -> SimpleNamespace:
        return SimpleNamespace(
            scene=target.scene, throw_kg=throw_balance(target.scene).mass_kg, quality=QUALITY
        )

    monkeypatch.setattr(rule_check, "solve_stresses", solved)
    monkeypatch.setattr(
        rule_check, "element_factors", lambda model: concentration_factors(dimensions(model.scene))
    )
    data = json.loads(printed(capsys, "fatigue", two, "--method", "m53", "--json", "--quiet"))
    first, second = data["fatigue"]
    balance = json.loads(printed(capsys, "loads", two, "--json"))["balance"]
    assert [first["target"], second["target"]] == ["two, first web", "two, second web"]
    assert first["throw_kg"] == second["throw_kg"] == pytest.approx(balance["throw_mass_kg"], rel=1e-12)
    # Half throws of 57 and 63 mm: the nearer bearing takes more; levers from it to the middle of each web.
    radial, moments = (
        first["alternating"]["radial_N"],
        [c["alternating"]["moment_Nm"] for c in data["fatigue"]],
    )
    levers_mm = 63 / 120 * (20.0 + 19.0 / 2), 57 / 120 * (20.0 + 25.0 / 2)
    assert moments == pytest.approx([radial * lever / 1e3 for lever in levers_mm])
    lines = printed(
        capsys, "compare", two, "--baseline", "mikron-iiic-plain", *COARSE, "--fatigue", "m53"
    ).splitlines()
    rows = [re.split(r"  +", line) for line in lines if line.startswith("two ")]
    worse = min(first["safety"], second["safety"])
    assert rows[1][-1].rstrip("*") == f"{worse:.3f}", "the last column of the values"


@pytest.mark.slow
def test_the_page_of_a_comparison_shows_both_webs(two: str) -> None:
    """Each half throw in its own frame, a drilling of one half alone in it."""
    target = resolve_targets([two], whole=True)[0]
    data = target.scene.model_dump(mode="json", by_alias=True, exclude_none=True)
    data["throw"]["drilling"] = [{"diameter_mm": 5.0, "web": "second"}]
    drilled = replace(target, scene=scene_from_dict(data, whole=True))
    volumes = []
    for throw in (target, drilled):
        shown = [(half, mesh) for half, mesh, _ in compare.half_throws(throw)]
        assert [half.name for half, _ in shown] == ["two, first web", "two, second web"]
        assert [half.scene.web.thickness_mm for half, _ in shown] == [19.0, 25.0]
        assert [half.scene.pitch_mm for half, _ in shown] == [114.0, 126.0]
        volumes.append([mesh.volume_mm3 for _, mesh in shown])
    lost = np.subtract(*volumes)
    assert lost.sum() == pytest.approx(drilling_moments.drilled(halves(drilled.scene)[1]).volume, rel=0.1)
    assert 0 < lost[0] < 0.2 * lost[1]  # what reaches across the middle of the crankpin


def test_accuracy_tells_what_it_leaves_out(two: str) -> None:
    """Without time no level is solved."""
    target = resolve_targets([two], whole=True)[0]
    assert list(planned_studies(target)) == [EVALUATION, FILLET_STRESS]
    (said,) = run_studies(target, 0.0).failures
    assert said == "optimiser: models half of a throw, and second_web makes its halves differ"


def test_balance_of_two_webs(two: str, capsys: pytest.CaptureFixture[str]) -> None:
    """The heavier web needs more; the couples balance each other, the pistons are 3 mm off the middle."""
    data = json.loads(printed(capsys, "balance", two, "--json", "--quiet"))
    first, second = data["counterweights"][:2]
    assert second["web_kg_mm"] > 1.2 * first["web_kg_mm"]
    assert second["unbalance_kg_mm"] > 1.1 * first["unbalance_kg_mm"]
    for entry in data["orders"]:
        assert entry["moment_Nm"] == pytest.approx(3e-3 * entry["force_N"], rel=1e-9)
    page = printed(capsys, "balance", two, "--quiet")
    assert re.search(r"^web +throw +web +has +for its throw", page, re.MULTILINE)


@pytest.mark.slow
def test_vibration_takes_the_closed_form_of_both_halves(two: str, capsys: pytest.CaptureFixture[str]) -> None:
    """With a stiffness given no elements are needed; the softer half is not that at the flywheel; 20 s."""
    path = Path(two)
    given = "\n[shaft]\nthrow_stiffness_Nm_per_rad = 1.5e5\n[shaft.flywheel]\ninertia_kg_m2 = 0.5\n"
    path.write_text(path.read_text(encoding="utf-8") + given, encoding="utf-8")
    data = json.loads(printed(capsys, "vibration", two, "--json", "--quiet"))
    assert data["stiffness_source"] == "shaft.throw_stiffness_Nm_per_rad"
    *inner, last = (section["stiffness_Nm_per_rad"] for section in data["sections"])
    assert inner == pytest.approx([1.5e5] * 3, rel=1e-12)
    assert last > 1.01 * 3e5


@pytest.mark.parametrize("command", ["optimise", "bound", "iterate"])
def test_optimisers_ask_which_web(command: str, two: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main([command, two]) == 3
    err = capsys.readouterr().err
    assert "second_web: the halves of the throw differ, and one web is optimised at a time. " in err
    assert "--web first or --web second" in err


def test_pair_writes_a_design(two: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = tmp_path / "pair.toml"
    assert main(["designs", "pair", two, str(file)]) == 2
    assert "give --first, --second or both" in capsys.readouterr().err
    out = printed(capsys, "designs", "pair", two, str(file), "--second", "mikron-iiic-plain")
    assert out == f"{file}: cranktopo evaluate {file}\n"
    assert "whole_throw" not in printed(capsys, "plan", str(file))


def test_a_point_of_a_sweep_shows_both_halves(two: str, tmp_path: Path) -> None:
    """Each the partner of the other; what optimises one web is refused before the first point."""
    scene = load_scene(two, whole=True)
    found = run_stage("evaluate", scene, tmp_path, Fineness(24.0, None))
    assert found["second_web_mass_kg"] == pytest.approx(throw_balance(scene).second_web_kg)
    header, _ = unpacked(found["view"])
    assert [body["partner"] for body in header["bodies"]] == [1, -1]
    assert [body["half_pitch_mm"] for body in header["bodies"]] == [57.0, 63.0]
    ends = [body["low_mm"][2] + body["size_mm"][2] for body in header["bodies"]]
    assert ends == pytest.approx([57.0, 63.0], abs=1e-4)
    with pytest.raises(CranktopoError, match="second_web: the halves of the throw differ"):
        sweep_plan([two], [read_option("web.thickness_mm=17,19")], stage="shape")
