"""`cranktopo vibration`: what it prints and writes, what it warns of, what it refuses."""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from cranktopo.app.main import main
from cranktopo.design.loading import designs_folder, load_scene
from cranktopo.engine.balance.throw import throw_balance
from cranktopo.engine.vibration.disk_error import FEW_THROWS_ERROR
from cranktopo.engine.vibration.shaft_chain import estimated_chain, shaft_chain
from cranktopo.engine.vibration.steady import vibration
from cranktopo.engine.vibration.study import study_vibration
from cranktopo.engine.vibration.torque_harmonics import torque_harmonics
from cranktopo.tasks.shaft.result import ShaftEvaluation
from cranktopo.tasks.shaft.stage import evaluate_shaft
from cranktopo.tasks.vibration.text import DISKS, vibration_text
from tests.page_text import typed_page

MIKRON = (designs_folder() / "mikron-iiic-plain.toml").read_text(encoding="utf-8")
GIVEN = "throw_stiffness_Nm_per_rad = 1.4e5\nspeed_min_rpm = 2000.0\n"
MEAN_INERTIA = MIKRON.replace("[effects]\n", "[effects]\nthreshold = 0.5\n")
"""A threshold that leaves the varying inertia out: solving with it takes most of the time of a response."""


def design(folder: Path, table: str, text: str = MIKRON) -> str:
    path = folder / "mine.toml"
    path.write_text(text.replace("[engine]\n", f"[shaft]\n{table}\n[engine]\n"), encoding="utf-8")
    return str(path)


def printed(arguments: list[str], capsys: pytest.CaptureFixture[str]) -> dict[str, Any]:
    assert main(["vibration", *arguments, "--json", "--quiet"]) == 0
    data: dict[str, Any] = json.loads(capsys.readouterr().out)
    return data


def test_json_page_and_table(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    table = GIVEN + "permitted_shear_MPa = 60.0\nflywheel = {inertia_kg_m2 = 0.1}"
    path, page, csv = design(tmp_path, table), tmp_path / "page.html", tmp_path / "orders.csv"
    data = printed([path, "--report", str(page), "--csv", str(csv), "--run-up", "1s"], capsys)
    assert [disk["name"] for disk in data["disks"]] == [*(f"throw {n}" for n in range(1, 5)), "flywheel"]
    sections, speeds = len(data["sections"]), data["speeds"]
    assert {len(speed[key]) for speed in speeds for key in ("torque_amplitude_Nm", "twist_deg")} == {sections}
    worst = data["worst"]
    (at,) = (speed for speed in speeds if speed["rpm"] == worst["speed_rpm"])
    assert max(at["torque_amplitude_Nm"]) == worst["torque_amplitude_Nm"]
    assert max(max(speed["torque_amplitude_Nm"]) for speed in speeds) == worst["torque_amplitude_Nm"]
    above = [speed["rpm"] for speed in speeds if max(speed["shear_MPa"]) > 60.0]
    barred = data["barred_ranges"]
    assert above == [s["rpm"] for s in speeds if any(low <= s["rpm"] <= high for low, high in barred)]
    assert all(any(low < rpm < high for rpm in above) for low, high in barred)
    runs_there = any(low <= 2100.0 <= high for low, high in barred)
    assert (
        any("engine's speed of 2100 rpm lies in the barred range" in w for w in data["warnings"])
        == runs_there
    )
    assert data["damping"] == {
        "cylinder_damping_Nms_per_rad": 0.0,
        "throw_damping_Nms_per_rad": 0.0,
        "throw_loss_factor": 0.02,
    }
    assert "shaft.throw_loss_factor" in [entry["key"] for entry in data["assumed"]]
    passage = data["run_up"]
    assert passage["seconds"] == 1.0
    # The run-up has the mean inertia: it stays below the steady peak with that.
    of_mean = worst["torque_amplitude_Nm"] / (1 + data["varying_inertia"]["torque_change_percent"] / 100)
    assert 0.5 < passage["worst"]["torque_amplitude_Nm"] / of_mean < 1.0
    text = typed_page(page)
    assert "In a run-up of 1 s, with mean inertia, it swings most at" in text
    assert text.count("<svg") >= 3
    assert "http" not in text.replace("http://www.w3.org", "")
    rows = np.loadtxt(csv, delimiter=",", skiprows=1)
    orders = len(data["worst"]["by_order"])
    assert orders >= 24
    assert rows.shape == (orders * len(speeds), 2 + sections)
    by_order = {entry["order"]: entry["torque_Nm"] for entry in worst["by_order"]}
    mine = rows[np.isclose(rows[:, 0], worst["speed_rpm"], rtol=1e-7) & (rows[:, 1] == worst["order"])]
    column = [section["name"] for section in data["sections"]].index(worst["section"])
    assert mine[0, 2 + column] == pytest.approx(by_order[worst["order"]], rel=1e-6)


@pytest.mark.slow
def test_varying_inertia_above_the_threshold_alone(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Left out, the response is that of the mean inertia, whose largest torque the change is told of."""
    table, page = GIVEN + "flywheel = {inertia_kg_m2 = 0.1}", tmp_path / "page.html"
    found = printed([design(tmp_path, table), "--report", str(page)], capsys)
    part = found["varying_inertia"]
    assert part["included"]
    assert 15.0 < part["estimate_percent"] < found["varying_inertia_percent"]
    assert "above the threshold of 2 %: included, it changes" in typed_page(page)
    # The plan would drop bores and fillets below so high a threshold, and the throw would be heavier.
    high = MIKRON.replace("[effects]\n", "[effects]\nthreshold = 0.5\nfillets = 'on'\nbores = 'on'\n")
    path = design(tmp_path, table, high)
    left_out = printed([path], capsys)
    assert left_out["varying_inertia"] == {**part, "included": False, "torque_change_percent": None}
    ratio = found["worst"]["torque_amplitude_Nm"] / left_out["worst"]["torque_amplitude_Nm"]
    assert 100 * (ratio - 1) == pytest.approx(part["torque_change_percent"], rel=1e-9)
    assert abs(part["torque_change_percent"]) > 5.0
    assert main(["vibration", path, "--quiet"]) == 0
    assert "below the threshold of 50 %: they count with their mean" in capsys.readouterr().out


@pytest.mark.slow
def test_a_damper_lowers_the_peak(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    bare = printed([design(tmp_path, GIVEN + "flywheel = {inertia_kg_m2 = 0.1}")], capsys)
    ring = "kind = 'viscous', ring_inertia_kg_m2 = 0.004, hub_inertia_kg_m2 = 0.0005"
    damper = f"damper = {{{ring}, damping_Nms_per_rad = 5.0}}"
    table = GIVEN + "flywheel = {inertia_kg_m2 = 0.1}\n" + damper
    damped = printed([design(tmp_path, table)], capsys)
    assert damped["worst"]["torque_amplitude_Nm"] < 0.7 * bare["worst"]["torque_amplitude_Nm"]
    assert damped["damping"]["damper"] == {"kind": "viscous", "damping_Nms_per_rad": 5.0}


def test_propeller_without_flywheel_is_a_warning(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = design(tmp_path, GIVEN + "propeller = {inertia_kg_m2 = 0.6}", MEAN_INERTIA)
    assert main(["vibration", path]) == 0
    found = capsys.readouterr()
    assert "warning: mikron-iiic-plain: shaft.flywheel is missing: the propeller alone" in found.err
    assert "throw 4 - propeller" in found.out
    assert "At the engine's 2100 rpm it swings most between throw" in found.out
    assert "Barred" not in found.out


@pytest.mark.slow
def test_elements_of_a_design_without_a_shaft(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """The bare crankshaft on a coarse mesh: stiffness and inertia are those of `shaft`."""
    found: list[ShaftEvaluation] = []

    def kept(*arguments: Any) -> ShaftEvaluation:
        found.append(evaluate_shaft(*arguments))
        return found[0]

    monkeypatch.setattr("cranktopo.tasks.vibration.stage.evaluate_shaft", kept)
    page = tmp_path / "page.html"
    words = ["mikron-iiic-plain", "--element-size-mm", "30", "--report", str(page)]
    data = printed(words, capsys)
    text = typed_page(page)
    assert f"mode 1, {data['modes'][0]['frequency_Hz']:.0f} Hz" in text, (
        "above all orders, but in the diagram"
    )
    assert text.index("[shaft] is missing") < text.index("First natural frequency")
    assert text.count("[shaft] is missing") == 1
    assert data["stiffness_source"].startswith("finite elements, rigid bearings")
    assert data["warnings"] == [
        "[shaft] is missing: the crankshaft swings with both ends free, without its flywheel."
    ]
    one, two = found[0].stiffness.throws_Nm_per_rad[:2]
    assert data["sections"][0]["stiffness_Nm_per_rad"] == pytest.approx(2 / (1 / one + 1 / two))
    assert not data["varying_inertia"]["included"]
    total = sum(disk["inertia_kg_m2"] for disk in data["disks"])
    assert total == pytest.approx(sum(disk.I for disk in found[0].opentorsion.disks), rel=1e-12)


@pytest.mark.parametrize("time", ["1ms", "20h", "fast"])
def test_impossible_run_ups(time: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = design(tmp_path, GIVEN + "flywheel = {inertia_kg_m2 = 0.1}", MEAN_INERTIA)
    assert main(["vibration", path, "--run-up", time, "--quiet"]) == 2
    assert len(capsys.readouterr().err.splitlines()) == 1


@pytest.mark.parametrize(
    ("name", "said"),
    [
        ("opposed-piston", "engine.gas: is missing, so nothing is known of the torque over the cycle."),
        ("bare", "[engine] is missing"),
        ("lone", "shaft: one throw with nothing joined to it cannot twist."),
    ],
)
def test_refused(name: str, said: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = name
    if name == "bare":
        head, tail = MIKRON.split("[engine]", 1)
        path = str(tmp_path / "bare.toml")
        text = head + "[" + tail[tail.index("[envelope]") + 1 :]
        Path(path).write_text(text, encoding="utf-8")
    elif name == "lone":
        text = MIKRON.replace("cylinders = 4", "cylinders = 1").replace("firing_order = [1, 3, 4, 2]", "")
        path = design(tmp_path, GIVEN, text)
    page = tmp_path / "page.html"
    coarse = [] if name == "lone" else ["--element-size-mm", "30"]
    assert main(["vibration", path, "--report", str(page), "--quiet", *coarse]) == 3
    found = capsys.readouterr()
    assert said in found.err
    assert len(found.err.splitlines()) == 1
    assert not page.exists()


def test_damping_and_speeds_of_a_marine_shaft(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """The ring of a viscous damper moves with its mode, and the mode of a soft coupling is met, too."""
    table = (
        "throw_stiffness_Nm_per_rad = 1.4e5\nspeed_min_rpm = 400.0\nspeed_max_rpm = 2800.0\n"
        "damper = {kind = 'viscous', ring_inertia_kg_m2 = 0.01, hub_inertia_kg_m2 = 0.002, "
        "damping_Nms_per_rad = 8.0}\nflywheel = {inertia_kg_m2 = 0.1}\n"
        "coupling = {inertia_kg_m2 = 0.01, stiffness_Nm_per_rad = 500.0, loss_factor = 0.15}\n"
        "driven = {inertia_kg_m2 = 0.2}"
    )
    data = printed([design(tmp_path, table, MEAN_INERTIA)], capsys)
    crank = data["modes"][1]
    assert data["disks"][0]["name"] == "damper ring"
    assert abs(crank["shape"][0]) > 0.05
    assert 0.02 < crank["damping_ratio"] < 0.5
    assert main(["vibration", design(tmp_path, table, MEAN_INERTIA), "--quiet"]) == 0
    out = capsys.readouterr().out
    assert "Also met, where the cylinders cancel one another to below 5%: mode 1 at" in out
    assert "(order 1)" in out


@pytest.mark.slow
def test_the_range_is_solved_once(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """What the varying inertia changes is told beside the mean inertia's peaks, without all speeds again."""
    scene = load_scene(design(tmp_path, GIVEN + "propeller = {inertia_kg_m2 = 0.6}"))
    solved: list[int] = []

    def counted(shaft: Any, harmonics: Any, speeds_rpm: Any, *more: Any) -> Any:
        solved.append(len(speeds_rpm))
        return vibration(shaft, harmonics, speeds_rpm, *more)

    monkeypatch.setattr("cranktopo.engine.vibration.vibrating_shaft.vibration", counted)
    study = study_vibration(scene, estimated_chain(scene), throw_balance(scene).inertia_kg_mm2, "given")
    assert study.varying.included
    assert [count >= 200 for count in solved] == [True, False]
    harmonics = torque_harmonics(scene)
    assert harmonics is not None
    every = vibration(study.shaft, harmonics, study.response.speeds_rpm, len(study.response.orders))
    assert vibration_text(study).endswith(DISKS)
    assert study.mean_response.worst_Nm == pytest.approx(every.worst_Nm, rel=1e-4)


@pytest.mark.slow
def test_a_short_shaft_is_told_that_its_disks_swing_too_fast(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """On terminal and page; a longer one is told both directions of the error alone."""
    path, page = tmp_path / "vee.toml", tmp_path / "page.html"
    vee = (Path(__file__).parents[1] / "data/v-twin.toml").read_text(encoding="utf-8")
    vee = vee.replace("[shaft.flywheel]", "[shaft]\nthrow_stiffness_Nm_per_rad = 3e5\n[shaft.flywheel]")
    path.write_text(vee, encoding="utf-8")
    assert main(["vibration", str(path), "--report", str(page), "--quiet"]) == 0
    told = "This shaft has 1 throw: `cranktopo modes` gives frequencies"
    flat = " ".join(capsys.readouterr().out.split())
    shown = re.sub("</?code>", "`", page.read_text(encoding="utf-8").replace("\xa0", " "))
    for text in (flat, shown):
        assert told in text
        assert f"{FEW_THROWS_ERROR} for one to three throws" in " ".join(text.split())
        assert "10 to 14 % too low" in text
    assert f"of disks, {FEW_THROWS_ERROR}" in shown
    assert main(["vibration", design(tmp_path, GIVEN + "flywheel = {inertia_kg_m2 = 0.1}"), "--quiet"]) == 0
    assert "`cranktopo modes` gives" not in capsys.readouterr().out


@pytest.mark.parametrize(
    "throws", [(136e3, 138e3, 138e3, 136e3), pytest.param((136e3,) * 4, marks=pytest.mark.slow)]
)
def test_the_stiffness_that_it_asks_to_write_is_that_of_the_run(
    throws: tuple[float, ...], tmp_path: Path
) -> None:
    """It asked for the mean of the sections between the throws, which no throw has where they differ."""
    table = "propeller = {inertia_kg_m2 = 0.6}\n"
    scene = load_scene(design(tmp_path, table))
    inertia = throw_balance(scene).inertia_kg_mm2
    text = vibration_text(study_vibration(scene, shaft_chain(scene, inertia, throws), inertia, "elements"))
    (asked,) = re.findall(r"that of this run write shaft\.(\w+ = [^.\n]+)\.", text)
    written = load_scene(design(tmp_path, f"{table}{asked}\n"))
    assert estimated_chain(written).throws_Nm_per_rad == throws


@pytest.mark.parametrize(
    "words", [["--bearings", "spring"], ["--bearings", "rigid"], ["--element-size-mm", "9"]]
)
def test_what_a_given_stiffness_leaves_out_is_refused(
    words: list[str], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["vibration", design(tmp_path, GIVEN), *words]) == 2
    found = capsys.readouterr()
    assert found.out == ""
    assert found.err.startswith(f"error: {words[0]}: shaft.throw_stiffness_Nm_per_rad gives the stiffness")


def test_an_endless_run_up_is_refused_before_anything_is_solved(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr("cranktopo.tasks.vibration.stage.evaluate_shaft", lambda *_: pytest.fail("solved"))
    assert main(["vibration", design(tmp_path, "speed_min_rpm = 2000.0"), "--run-up", "20h"]) == 2
    assert "--run-up 72000 s: must be >=" in capsys.readouterr().err


@pytest.mark.slow
def test_a_cylinder_that_does_not_fire(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """By option or key alike; `worst` has the same numbers for it, one line a cylinder, beside all firing."""
    table = GIVEN + "flywheel = {inertia_kg_m2 = 0.1}\ndriven = {inertia_kg_m2 = 0.5}\n"
    table += "coupling = {inertia_kg_m2 = 0.01, stiffness_Nm_per_rad = 900.0, loss_factor = 0.1}\n"
    path = design(tmp_path, table, MEAN_INERTIA)
    healthy, third = printed([path], capsys), printed([path, "--misfire", "3"], capsys)
    every, page = printed([path, "--misfire", "worst"], capsys), tmp_path / "page.html"
    assert "misfire" not in healthy
    assert third["misfire"] == [3]
    assert [one["cylinder"] for one in every["misfires"]] == [1, 2, 3, 4]
    same = every["misfires"][2]
    assert {key: same[key] for key in ("speed_rpm", "torque_amplitude_Nm", "section", "order")} == {
        key: third["worst"][key] for key in ("speed_rpm", "torque_amplitude_Nm", "section", "order")
    }
    assert every["worst"] == healthy["worst"]
    outside = [i for i, section in enumerate(third["sections"]) if not section["in_crankshaft"]]
    assert [one["section"] for one in same["joined"]] == [third["sections"][i]["name"] for i in outside]
    for place, one in zip(outside, same["joined"], strict=True):
        swings = {speed["rpm"]: speed["torque_amplitude_Nm"][place] for speed in third["speeds"]}
        assert one["torque_amplitude_Nm"] == max(swings.values()) == swings[one["speed_rpm"]]
    for place, one in zip(outside, same["joined_at_engine_speed"], strict=True):
        (own,) = (speed for speed in third["speeds"] if speed["rpm"] == one["speed_rpm"] == 2100.0)
        assert one["torque_amplitude_Nm"] == own["torque_amplitude_Nm"][place]
    assert third["worst"]["mean_torque_Nm"] < healthy["worst"]["mean_torque_Nm"]
    keyed = MEAN_INERTIA.replace("[1, 3, 4, 2]", "[1, 3, 4, 2]\nmisfire = [3]")
    by_key = printed([design(tmp_path, table, keyed)], capsys)
    assert {**by_key, "assumed": None} == {**third, "assumed": None}
    found = [str(tmp_path / "mine.toml"), "--misfire", "worst", "--report", str(page), "--quiet"]
    assert main(["vibration", *found]) == 0
    out = capsys.readouterr().out
    assert "One cylinder that does not fire:" in out
    assert "Outside the crankshaft, where the worst cylinder does not fire:" in out
    assert "The pressure is that of 2100 rpm at every speed" in out
    assert "does not fire: compression" not in out  # the key gives way to the option
    _check_own_speed(out, healthy, every, outside[-1])
    worst = max(every["misfires"], key=lambda one: one["torque_amplitude_Nm"])
    assert f"Misfire of cylinder {worst['cylinder']} is the worst" in out
    text = page.read_text(encoding="utf-8")
    assert "One cylinder that does not fire" in text
    assert "Outside the crankshaft, where the worst cylinder does not fire" in text


def _check_own_speed(out: str, healthy: dict[str, Any], every: dict[str, Any], coupling: int) -> None:
    """The coupling's torque at 2100 rpm stands in words: where all fire, and without the worst cylinder."""
    own = next(speed for speed in healthy["speeds"] if speed["rpm"] == 2100.0)["torque_amplitude_Nm"]
    name = healthy["sections"][coupling]["name"]
    last = ((one["cylinder"], one["joined_at_engine_speed"][-1]) for one in every["misfires"])
    silent = {cylinder: swing["torque_amplitude_Nm"] for cylinder, swing in last}
    worst = max(silent, key=lambda cylinder: silent[cylinder])
    assert f"Outside the crankshaft: {name} +-" in out
    told = re.search(
        rf"With a misfire at the engine's 2100 rpm: {re.escape(name)} \+-([\d.,]+) N m without "
        r"cylinder (\d), \+-([\d.,]+) N m where all fire\.",
        out,
    )
    assert told
    assert float(told[1].replace(",", "")) == pytest.approx(silent[worst], abs=0.6)
    assert silent[int(told[2])] == pytest.approx(silent[worst], rel=1e-9)
    assert float(told[3].replace(",", "")) == pytest.approx(own[coupling], abs=0.6)


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["--misfire", "9"], "--misfire = [9]: must be numbers of cylinders, 1 to 4."),
        (["--misfire", "2", "--misfire", "2"], "names a cylinder twice. Name each once."),
        (["--misfire", "worst", "--misfire", "2"], "--misfire worst: looks at every cylinder alone."),
        (["--misfire", "all"], "must be the number of a cylinder, 1 at the free end, or worst."),
        (["--misfire", "0"], "must be the number of a cylinder"),
    ],
)
def test_cylinders_that_are_none(
    words: list[str], said: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["vibration", design(tmp_path, GIVEN), *words, "--quiet"]) == 2
    found = capsys.readouterr()
    assert said in found.err
    assert len(found.err.splitlines()) == 1
