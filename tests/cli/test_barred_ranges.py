"""`vibration --misfire worst`: speeds barred with all cylinders firing, and with one that does not."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import pytest

from cranktopo.app.main import main
from cranktopo.design.loading import designs_folder
from cranktopo.design.schema import Scene
from cranktopo.engine.vibration.barred import MisfireRange, misfire_ranges
from cranktopo.engine.vibration.steady import CriticalSpeed
from cranktopo.engine.vibration.study import VibrationStudy, misfire_warnings
from cranktopo.tasks.vibration.page import vibration_page
from cranktopo.tasks.vibration.stage import shaft_vibration
from cranktopo.tasks.vibration.text import vibration_text
from tests.cli.test_vibration import design

SIX = (designs_folder() / "industrial-gas.toml").read_text(encoding="utf-8")
MEAN_INERTIA = SIX.replace("[effects]\n", "[effects]\nthreshold = 0.5\n")
"""A threshold that leaves the varying inertia out: solving with it takes most of the time of a response."""
GIVEN = "throw_stiffness_Nm_per_rad = 5.5e6\nspeed_min_rpm = 1140.0\nspeed_max_rpm = 1180.0\n"
WHEEL = "flywheel = {inertia_kg_m2 = 6.0}\ndriven = {inertia_kg_m2 = 20.0}\n"
WHEEL += "coupling = {inertia_kg_m2 = 0.2, stiffness_Nm_per_rad = 2.6e4, loss_factor = 0.15}\n"


Stresses = tuple[float, dict[int, float]]


@pytest.fixture(scope="module")
def stresses_MPa(tmp_path_factory: pytest.TempPathFactory) -> Stresses:
    """Largest shear stress with all cylinders firing, and of each cylinder's own misfire."""
    study = shaft_vibration(
        design(tmp_path_factory.mktemp("six"), GIVEN + WHEEL, MEAN_INERTIA), misfire="worst"
    )
    firing = study.shaft.shear_MPa(study.response.worst_Nm)
    silent = {
        one.cylinder: study.shaft.shear_MPa(one.crankshaft.torque_amplitude_Nm) for one in study.misfires
    }
    assert max(silent.values()) > 1.01 * firing
    return firing, silent


def permitted(folder: Path, stress_MPa: float) -> str:
    return design(folder, f"{GIVEN}permitted_shear_MPa = {stress_MPa}\n{WHEEL}", MEAN_INERTIA)


@pytest.mark.slow
def test_a_stress_above_the_permitted_with_a_misfire_alone_bars_speeds(
    tmp_path: Path, stresses_MPa: Stresses, capsys: pytest.CaptureFixture[str]
) -> None:
    """Text, card and JSON name the ranges and the cylinders; those of one cylinder are that misfire's own."""
    firing, silent = stresses_MPa
    limit = (firing + max(silent.values())) / 2
    path = permitted(tmp_path, limit)
    study = shaft_vibration(path, misfire="worst")
    assert study.barred_rpm == ()
    text = vibration_text(study)
    assert f"Barred, above {limit:g} MPa: with all cylinders firing none; with one misfiring " in text
    assert "No range of speed is barred" not in text
    (card,) = (fact for fact in vibration_page(study, "").facts if fact.label == "Barred")
    assert card.status == "bad"
    assert card.value.startswith("none; with one misfiring ")
    for one in study.misfires:
        assert bool(one.barred_rpm) == (silent[one.cylinder] > limit)
        assert one.barred_rpm == shaft_vibration(path, misfire=[one.cylinder]).barred_rpm
    capsys.readouterr()
    assert main(["vibration", path, "--misfire", "worst", "--json", "--quiet"]) == 0
    data = json.loads(capsys.readouterr().out)
    assert data["barred_ranges"] == []
    barred = [[list(pair) for pair in one.barred_rpm or ()] for one in study.misfires]
    assert [one["barred_ranges"] for one in data["misfires"]] == barred


def test_no_speed_is_barred_where_no_misfire_reaches_the_permitted_stress(
    tmp_path: Path, stresses_MPa: Stresses
) -> None:
    _, silent = stresses_MPa
    study = shaft_vibration(permitted(tmp_path, 1.01 * max(silent.values())), misfire="worst")
    assert "MPa, with one cylinder misfiring too." in vibration_text(study)
    (card,) = (fact for fact in vibration_page(study, "").facts if fact.label == "Barred")
    assert (card.value, card.status) == ("none", "good")


def test_an_engine_that_runs_where_a_misfire_bars_is_warned_of(
    tmp_path: Path, stresses_MPa: Stresses
) -> None:
    """Not again where the speed is barred with all cylinders firing."""
    firing, silent = stresses_MPa
    study = shaft_vibration(permitted(tmp_path, (firing + max(silent.values())) / 2), misfire="worst")
    low, high = study.misfire_barred[0].low_rpm, study.misfire_barred[0].high_rpm
    there = replace(study, scene=at_speed(study, (low + high) / 2))
    (line,) = misfire_warnings(there)
    assert line.startswith("shaft: with one cylinder misfiring, the engine's speed of ")
    assert misfire_warnings(replace(there, barred_rpm=((low, high),))) == ()
    assert misfire_warnings(replace(study, scene=at_speed(study, high + 1.0))) == ()


def at_speed(study: VibrationStudy, rpm: float) -> Scene:
    """The scene of a study with an engine of another speed and no overspeed."""
    scene = study.scene
    assert scene.engine is not None
    engine = scene.engine.model_copy(update={"speed_rpm": rpm, "overspeed_rpm": None})
    return scene.model_copy(update={"engine": engine})


def test_ranges_that_overlap_are_one_of_all_their_cylinders() -> None:
    single = [(1200.0, 1210.0, 2), (1157.0, 1166.0, 4), (1159.0, 1170.0, 5), (1160.0, 1161.0, 4)]
    found = misfire_ranges(MisfireRange(low, high, (cylinder,)) for low, high, cylinder in single)
    assert found == (MisfireRange(1157.0, 1170.0, (4, 5)), MisfireRange(1200.0, 1210.0, (2,)))


def test_the_card_names_every_resonance_where_one_cylinder_misfires(tmp_path: Path) -> None:
    """It told the first alone, 319 rpm of order 1.5, and left out 478 rpm of order 1."""
    study = shaft_vibration(design(tmp_path, GIVEN + WHEEL, MEAN_INERTIA))
    weak = tuple(CriticalSpeed(rpm, order, 1, 0.0, False) for rpm, order in ((478.0, 1.0), (319.0, 1.5)))
    (card,) = (
        fact
        for fact in vibration_page(replace(study, critical=weak), "").facts
        if fact.label == "First natural frequency"
    )
    assert "but at 319 rpm by order 1.5 and 478 rpm by order 1 where one misfires" in card.note
