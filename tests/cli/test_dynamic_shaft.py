"""`cranktopo shaft --dynamic`: the shaft that vibrates, beside all that is told without it."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

from cranktopo.app.main import main
from cranktopo.base.line_width import in_width
from cranktopo.design.loading import load_scene, scene_from_dict
from cranktopo.tasks.dynamics.result import ShaftDynamics
from cranktopo.tasks.shaft_safety.dynamics_text import dynamics_text
from cranktopo.tasks.shaft_safety.stage import assess_shaft

WORDS = ["shaft", "mikron-iiic-plain", "--element-size-mm", "24", "--quiet"]
SIZE_MM = 24.0


def said(words: list[str], capsys: pytest.CaptureFixture[str]) -> dict[str, Any]:
    assert main([*words, "--json"]) == 0
    return dict(json.loads(capsys.readouterr().out))


def test_all_else_stays_as_it_is(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    """At one speed: the dynamic answer stands beside it, in the JSON and in the file of the curves."""
    plain = said([*WORDS, "--csv", str(tmp_path / "plain.csv")], capsys)
    found = said([*WORDS, "--dynamic", "--csv", str(tmp_path / "both.csv")], capsys)
    dynamics = found.pop("dynamics")
    assert found == plain
    (at,), (still,) = dynamics["speeds"], plain["on_bearings"]
    for web, before in zip(at["webs"], still["webs"], strict=True):
        assert web["quasi_static_Nm"]["bending"] == pytest.approx(before["range_Nm"], rel=1e-12)
        assert web["ratio"] == pytest.approx(
            web["range_Nm"]["equivalent"] / web["quasi_static_Nm"]["equivalent"]
        )
        assert web["range_Nm"]["bending"] == pytest.approx(before["range_Nm"], rel=0.02)
    assert max(web["ratio"] for web in at["webs"]) > 1.2
    assert at["work_in_J"] == pytest.approx(at["damping_work_J"], rel=1e-6)
    assert [one["quasi_static_N"] for one in at["main_bearings"]] == [
        one["largest_N"] for one in still["main_bearings"]
    ]
    assert dynamics["resonances"] == []
    assert dynamics["turns_freely"] is False
    head, *rows = (tmp_path / "both.csv").read_text(encoding="utf-8").splitlines()
    before, *plain_rows = (tmp_path / "plain.csv").read_text(encoding="utf-8").splitlines()
    curves = before.split(",")[4:]
    assert head == ",".join([before, *(f"dynamic_{name}" for name in curves)])
    assert [row.rsplit(",", len(curves))[0] for row in rows] == plain_rows


def test_the_worst_resonance_is_among_the_speeds(capsys: pytest.CaptureFixture[str]) -> None:
    """Of several speeds; ratio, place and speed on the terminal, 80 columns."""
    found = said([*WORDS, "--dynamic", "--speeds", "900:2800:3"], capsys)["dynamics"]
    text = "\n\n".join(dynamics_text(ShaftDynamics.model_validate(found)))
    assert max(map(len, in_width(text).splitlines())) <= 80
    assert "its output turns evenly" in " ".join(text.split())
    speeds = [at["speed_rpm"] for at in found["speeds"]]
    added = found["added_speed_rpm"]
    assert speeds == sorted([900.0, 1850.0, 2800.0, added])
    at = found["speeds"][speeds.index(added)]
    worst = max(found["resonances"], key=lambda one: one["ratio"])
    assert worst["speed_rpm"] == added
    assert worst["kind"] == "torsion"
    assert worst["frequency_Hz"] == pytest.approx(worst["order"] * added / 60)
    web = at["webs"][worst["web"] - 1]
    assert web["ratio"] == pytest.approx(worst["ratio"], rel=1e-9)
    assert web["ratio"] > 2.0
    assert f"{added:,.0f} rpm, the worst of them, is added to the speeds." in " ".join(text.split())


def test_torsion_is_not_counted_twice() -> None:
    """A shaft whose torsion the plan has on: the vibration is the same, and the torque beside it is other."""
    data = load_scene("mikron-iiic-plain").model_dump(mode="json", exclude_none=True)
    data["shaft"] = {"propeller": {"inertia_kg_m2": 0.6}}
    found = []
    for switch in ("on", "off"):
        data["effects"]["torsional_vibration"] = switch
        found.append(assess_shaft(scene_from_dict(data), element_size_mm=SIZE_MM, dynamic=True).dynamics)
    with_disks, without = found
    assert with_disks is not None
    assert without is not None
    (one,), (other,) = with_disks.speeds, without.speeds
    for with_torque, alone in zip(one.webs, other.webs, strict=True):
        ranges = alone.range_Nm.model_dump()
        assert with_torque.range_Nm.model_dump() == pytest.approx(ranges, rel=1e-9, abs=1e-6)
    moved, disks, still = (
        max(torques)
        for torques in (
            [web.range_Nm.torque for web in one.webs],
            [web.quasi_static_Nm.torque for web in one.webs],
            [web.quasi_static_Nm.torque for web in other.webs],
        )
    )
    assert disks > 1.1 * still
    assert moved == pytest.approx(disks, rel=0.15), "order 12 is near the first mode, of disks 0.6 % faster"
    assert with_disks.turns_freely
    assert with_disks.torsion_only == ("propeller",)


def test_what_cannot_vibrate_is_refused(capsys: pytest.CaptureFixture[str]) -> None:
    """Free bearings, films, and a material without loss, before anything is meshed."""
    assert main([*WORDS, "--dynamic", "--bearings", "free"]) == 2
    assert "--dynamic: the forces on all bearings need [engine.gas]" in capsys.readouterr().err
    assert main(["shaft", "car-diesel", "--dynamic", "--bearings", "film", "--quiet"]) == 2
    assert "--dynamic: needs linear bearings" in capsys.readouterr().err


def test_a_shaft_on_springs_in_words() -> None:
    """Journals that give way, and parts whose mass is not given."""
    data = load_scene("mikron-iiic-plain").model_dump(mode="json", exclude_none=True)
    data["shaft"] = {"propeller": {"inertia_kg_m2": 0.6}}
    data["supports"]["bearing_spring_N_per_mm"] = 4e5
    found = assess_shaft(scene_from_dict(data), "spring", SIZE_MM, dynamic=True).dynamics
    assert found is not None
    text = "\n\n".join(dynamics_text(found))
    words = " ".join(text.split())
    assert "its output swings with what it drives. Without a mass_kg in torsion alone: propeller." in words
    assert max(map(len, in_width(text).splitlines())) <= 80
