"""`cranktopo shaft --dynamic`: the shaft that vibrates, beside all that is told without it."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any
from unittest.mock import patch

import pytest

from cranktopo.app.main import main
from cranktopo.base.line_width import in_width
from cranktopo.design.loading import load_scene, scene_from_dict
from cranktopo.tasks.dynamics.result import ShaftDynamics
from cranktopo.tasks.shaft_safety.dynamics_text import dynamics_text
from cranktopo.tasks.shaft_safety.stage import assess_shaft

pytestmark = pytest.mark.usefixtures("throws_made_once")

WORDS = ["shaft", "mikron-iiic-plain", "--element-size-mm", "24", "--quiet"]
SIZE_MM = 24.0


def driven() -> dict[str, Any]:
    """An engine with its propeller; the varying inertia is below its threshold, where the plan is quick."""
    data = load_scene("mikron-iiic-plain").model_dump(mode="json", exclude_none=True)
    data["shaft"] = {"propeller": {"inertia_kg_m2": 0.6}}
    data["effects"]["threshold"] = 0.5
    return data


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
    """Of two speeds; ratio, place and speed on the terminal, 80 columns."""
    found = said([*WORDS, "--dynamic", "--speeds", "900:2800:2"], capsys)["dynamics"]
    text = "\n\n".join(dynamics_text(ShaftDynamics.model_validate(found)))
    assert max(map(len, in_width(text).splitlines())) <= 80
    assert "its output turns evenly" in " ".join(text.split())
    speeds = [at["speed_rpm"] for at in found["speeds"]]
    added = found["added_speed_rpm"]
    assert speeds == sorted([900.0, 2800.0, added])
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
    data = driven()
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
    """Free bearings, and bearings with play, before anything is meshed."""
    assert main([*WORDS, "--dynamic", "--bearings", "free"]) == 2
    assert "--dynamic: the forces on all bearings need [engine.gas]" in capsys.readouterr().err
    assert main(["shaft", "car-diesel", "--dynamic", "--bearings", "clearance", "--quiet"]) == 2
    told = capsys.readouterr().err
    assert "clearance has no answer for a shaft with mass: without oil, journals bounce in their play" in told
    assert "Choose --bearings rigid, spring or film." in told


def test_a_shaft_on_springs_in_words() -> None:
    """Journals that give way, and parts whose mass is not given."""
    data = driven()
    data["supports"]["bearing_spring_N_per_mm"] = 4e5
    found = assess_shaft(scene_from_dict(data), "spring", SIZE_MM, dynamic=True).dynamics
    assert found is not None
    text = "\n\n".join(dynamics_text(found))
    words = " ".join(text.split())
    assert "its output swings with what it drives. Without a mass_kg in torsion alone: propeller." in words
    assert max(map(len, in_width(text).splitlines())) <= 80


@pytest.mark.slow
def test_a_shaft_in_its_oil_films() -> None:
    """Films beside those without mass, what is permitted of them, their work, and the words."""
    data = load_scene("mikron-iiic-plain").model_dump(mode="json", exclude_none=True)
    data["bearings"] = {"clearance_mm": 0.05, "viscosity_mPas": 9.0, "permitted_film_um": 4.0}
    with patch(
        "cranktopo.tasks.film.stage.with_conserving", side_effect=lambda _, films, *rest: tuple(films)
    ):
        found = assess_shaft(scene_from_dict(data), "film", SIZE_MM, dynamic=True)
    assert found.dynamics is not None
    (at,), (still,) = found.dynamics.speeds, found.on_bearings
    for one, before in zip(at.main_bearings, still.main_bearings, strict=True):
        assert one.film_um is not None
        assert one.film_um == pytest.approx(25.0 - at.sections[one.bearing - 1].offset_um, abs=0.1)
        assert one.quasi_static_film_um == before.film_um != one.film_um
        assert one.film_um == pytest.approx(before.film_um, rel=0.3)
    assert at.film_work_J is not None
    assert at.work_in_J == pytest.approx(at.damping_work_J + at.film_work_J, rel=1e-5)
    thin = [one.bearing for one in at.main_bearings if one.film_um is not None and one.film_um < 4.0]
    assert thin
    assert found.dynamics.films_hold is False
    text = "\n\n".join(dynamics_text(found.dynamics))
    words = " ".join(text.split())
    assert (
        "Its journals move in oil films, where a disturbance of its cycle dies away. Of its films, below"
        in words
    )
    assert all(f"main {number}" in words for number in thin)
    assert max(map(len, in_width(text).splitlines())) <= 80
