"""The effect of torsional vibration: its estimate, what it changes in loads and verdict; off is free."""

from __future__ import annotations

import re
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from cranktopo.base.errors import CranktopoError
from cranktopo.base.notes import redirected
from cranktopo.design.loading import load_scene, scene_from_dict
from cranktopo.design.schema import Scene
from cranktopo.engine.histories import load_history
from cranktopo.engine.judged_histories import histories_of
from cranktopo.engine.plan import planning
from cranktopo.engine.plan.effect import PhysicsPlan
from cranktopo.engine.plan.planning import plan
from cranktopo.engine.states import extreme_states, load_cases
from cranktopo.engine.throw_compliance import web_lever_mm
from cranktopo.engine.vibration import vibrating_shaft
from cranktopo.tasks.shaft.stage import with_throw_stiffness
from cranktopo.tasks.throw_fatigue.m53 import (
    LEAST_FACTOR,
    concentration_factors,
    dimensions,
    fatigue_strength_MPa,
    nominal_stresses,
    pin_equivalent_MPa,
)
from cranktopo.tasks.throw_fea.targets import Target

FLYWHEEL = {"flywheel": {"inertia_kg_m2": 0.08}}
PROPELLER = {"propeller": {"inertia_kg_m2": 0.6}}
VISCOUS = {"kind": "viscous", "ring_inertia_kg_m2": 0.004, "hub_inertia_kg_m2": 0.0005}
RUBBER = {"kind": "rubber", "ring_inertia_kg_m2": 0.003, "hub_inertia_kg_m2": 0.0005}
DAMPERS: dict[str, dict[str, object]] = {
    "viscous": {**VISCOUS, "damping_Nms_per_rad": 5.0},
    "rubber": {**RUBBER, "stiffness_Nm_per_rad": 1.2e4, "loss_factor": 0.2},
}
SIX: dict[str, Any] = {"cylinders": 6, "firing_order": [1, 5, 3, 6, 2, 4]}
GAS = {"peak_pressure_MPa": 19.4, "peak_angle_deg": 8.0, "compression_ratio": 15.0}
OPPOSED: dict[str, Any] = {"gas": GAS, "cylinders": 3, "firing_order": [1, 2, 3]}


def switched_to(scene: Scene, state: str) -> Scene:
    effects = scene.effects.model_copy(update={"torsional_vibration": state})
    return scene.model_copy(update={"effects": effects})


def turning(shaft: dict[str, Any], name: str = "mikron-iiic-plain", **engine: Any) -> Scene:
    data = load_scene(name).model_dump(mode="json", exclude_none=True)
    given = {k: v for k, v in data["engine"].items() if not k.startswith(("max_", "min_"))}
    return scene_from_dict({**data, "shaft": shaft, "engine": {**given, **engine}})


def by_switching(scene: Scene) -> float:
    """Change of the largest torque range of the load states that `fatigue` judges, off to on, percent."""
    ranges = []
    for state in ("off", "on"):
        switched = switched_to(scene, state)
        histories = histories_of(switched, "extremes", plan(switched).enabled)
        ranges.append(max(float(np.ptp(one.torque_Nm)) for one in histories))
    return 100 * (ranges[1] / ranges[0] - 1)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("shaft", "name", "engine"),
    [
        (PROPELLER, "mikron-iiic-plain", {}),
        ({**FLYWHEEL, "damper": DAMPERS["rubber"]}, "mikron-iiic-plain", {}),
        (
            {
                "flywheel": {"inertia_kg_m2": 0.02},
                "propeller": {"inertia_kg_m2": 0.6, "stiffness_Nm_per_rad": 1e5},
            },
            "mikron-iiic-plain",
            {},
        ),
        (
            {**FLYWHEEL, "pulley": {"inertia_kg_m2": 0.003}, "cylinder_damping_Nms_per_rad": 0.3},
            "mikron-iiic-plain",
            SIX,
        ),
        (
            {"flywheel": {"inertia_kg_m2": 0.5}, "cylinder_damping_Nms_per_rad": 1.0},
            "opposed-piston",
            OPPOSED,
        ),
    ],
)
def test_the_estimate_is_what_switching_it_on_does(
    shaft: dict[str, Any], name: str, engine: dict[str, Any]
) -> None:
    scene = turning(shaft, name, **engine)
    percent = plan(scene)["torsional_vibration"].estimate_percent
    assert percent == pytest.approx(abs(by_switching(scene)), rel=1e-6)


def test_a_shaft_that_hardly_twists_is_judged_over_all_its_speeds_all_the_same() -> None:
    """It said -0.6 %, off, of a shaft whose torque range grew by 14 % as it was switched on."""
    stiff = {"throw_stiffness_Nm_per_rad": 1e9, "flywheel": {"inertia_kg_m2": 1.0}}
    scene = turning(stiff)
    effect = plan(scene)["torsional_vibration"]
    assert effect.state == "on"
    assert effect.estimate_percent == pytest.approx(by_switching(scene), rel=1e-6)
    assert effect.estimate_percent > 5
    twist, speeds = map(float, re.findall(r"([+-][\d.]+) % (?:by the twist|as torques)", effect.reason))
    assert abs(twist) < 0.1
    assert speeds == pytest.approx(effect.estimate_percent, abs=0.1)


def test_a_shaft_behind_a_soft_coupling_is_not_judged_by_its_lowest_mode() -> None:
    """The coupling swings at a few hertz, far below the crankshaft's own modes, which the torque meets."""
    coupling = {"inertia_kg_m2": 0.02, "stiffness_Nm_per_rad": 1e3, "loss_factor": 0.15}
    shaft = {**FLYWHEEL, "coupling": coupling, "driven": {"inertia_kg_m2": 1.0}, "speed_min_rpm": 1900.0}
    scene = turning(shaft, **SIX)
    effect = plan(scene)["torsional_vibration"]
    assert "first natural frequency 16.6 Hz" in effect.reason
    assert effect.state == "on"
    assert effect.estimate_percent == pytest.approx(by_switching(scene), rel=1e-6)


@pytest.fixture(scope="module")
def with_propeller() -> tuple[Scene, PhysicsPlan]:
    scene = turning(PROPELLER)
    return scene, plan(scene)


def test_plan_and_loads_solve_the_range_once_for_each_torque() -> None:
    """With the reciprocating inertia and without it: what else is on or off changes no torque."""
    scene = turning({**PROPELLER, "speed_min_rpm": 2080.0, "speed_max_rpm": 2120.0})
    vibrating_shaft._solved_range.cache_clear()
    enabled = plan(switched_to(scene, "on")).enabled
    load_cases(scene, enabled)
    load_cases(switched_to(scene, "on"), enabled - {"rotating_rod_mass"})
    assert vibrating_shaft._solved_range.cache_info().misses == 2


@pytest.mark.usefixtures("every_step")
def test_the_reason_names_frequency_speed_and_order(with_propeller: tuple[Scene, PhysicsPlan]) -> None:
    effect = plan(with_propeller[0])["torsional_vibration"]
    assert effect.state == "on"
    assert "first natural frequency" in effect.reason
    assert "worst at 2768 rpm, mostly of order 8" in effect.reason
    stiff_and_heavy = {
        "throw_stiffness_Nm_per_rad": 1e11,
        "flywheel": {"inertia_kg_m2": 1e6},
        "speed_min_rpm": 2099.0,  # the range is its own speed: else lower ones are judged with it
    }
    stiff = plan(turning(stiff_and_heavy, overspeed_rpm=2100.0))["torsional_vibration"]
    assert stiff.state == "off"
    assert "below the threshold of 2 %" in stiff.reason


@pytest.mark.parametrize("name", ["mikron-iiic-plain", "opposed-piston"])
def test_built_in_designs_are_without_it(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """And nothing of it is computed."""

    def never(*_: object) -> None:
        raise AssertionError

    for where in (
        "engine.analysis.worst_speed_rpm",
        "engine.analysis.vibrating_torque",
        "engine.plan.vibration_rule.worst_speed_rpm",
    ):
        monkeypatch.setattr(f"cranktopo.{where}", never)
    planning._plan.cache_clear()  # else a plan that an earlier test asked for would be taken
    decided = plan(load_scene(name))
    assert decided["torsional_vibration"].state == "off"
    assert decided["torsional_vibration"].reason == "the scene has no [shaft]"
    assert load_cases(load_scene(name), decided.enabled)


@pytest.mark.slow
def test_off_leaves_the_load_cases_as_they_were(with_propeller: tuple[Scene, PhysicsPlan]) -> None:
    (scene, decided), plain = with_propeller, load_scene("mikron-iiic-plain")
    off = switched_to(scene, "off")
    enabled = plan(off).enabled
    assert enabled == plan(plain).enabled
    assert load_cases(off, enabled) == load_cases(plain, enabled)
    history, before = (load_history(s, "cycle", enabled) for s in (off, plain))
    assert (history.torque_Nm == before.torque_Nm).all()
    on = load_cases(scene, decided.enabled)
    assert on[0] == load_cases(plain, enabled)[0]
    assert on[1].torque_Nm > 2 * load_cases(plain, enabled)[1].torque_Nm
    assert "of the vibrating shaft, throws in closed form, at " in on[1].source
    given = load_cases(turning({**PROPELLER, "throw_stiffness_Nm_per_rad": 1.5e5}), decided.enabled)
    assert "closed form" not in given[1].source


def test_a_stiff_heavy_shaft_has_the_quasi_static_history() -> None:
    scene = turning({"throw_stiffness_Nm_per_rad": 1e11, "flywheel": {"inertia_kg_m2": 1e6}})
    enabled = frozenset({"torsion", "bending", "tangential", "reciprocating_inertia", "rotating_rod_mass"})
    plain = load_history(scene, "cycle", enabled)
    vibrating = load_history(scene, "cycle", enabled | {"torsional_vibration"})
    half = len(plain.labels)
    assert len(vibrating.labels) == 2 * half
    assert vibrating.torque_Nm[:half] == pytest.approx(
        plain.torque_Nm, abs=1e-3 * np.abs(plain.torque_Nm).max()
    )
    assert vibrating.labels[0] == "throw 1, 0 deg, 2100 rpm"
    states = {s.name: s for s in extreme_states(scene, enabled | {"torsional_vibration"})}
    assert states["max_torque"].case.source.endswith(" rpm")


def acceptability(scene: Scene) -> float:
    """Of the crankpin fillet by IACS UR M53, factors in closed form."""
    history = load_history(scene, "extremes", plan(scene).enabled)
    force, torque = np.ptp(history.radial_N) / 2, np.ptp(history.torque_Nm) / 2
    size, settings, ultimate = dimensions(scene), scene.fatigue, scene.material.ultimate_MPa
    assert ultimate is not None
    nominal = nominal_stresses(size, force / 2 * web_lever_mm(scene), force / 2, torque * 1000)
    stress = pin_equivalent_MPa(concentration_factors(size), nominal, settings.additional_stress_MPa)
    return fatigue_strength_MPa(size.pin, size.pin_fillet, ultimate, settings.process_factor) / stress


@pytest.mark.slow
def test_a_resonance_turns_the_verdict_and_a_damper_turns_it_back() -> None:
    bare = turning(PROPELLER)
    assert acceptability(switched_to(bare, "off")) > LEAST_FACTOR
    assert acceptability(bare) < LEAST_FACTOR
    for damper in DAMPERS.values():
        assert acceptability(turning({**PROPELLER, "damper": damper})) > LEAST_FACTOR


@pytest.mark.slow
def test_fatigue_takes_the_stiffness_of_the_elements(monkeypatch: pytest.MonkeyPatch) -> None:
    """Asked for where the vibration is on and the design does not give it, and nowhere else."""
    asked: list[str] = []

    def evaluated(target: Target, bearings: str) -> Any:
        asked.append(bearings)
        stiffness = SimpleNamespace(throws_Nm_per_rad=(1.5e5, 1.7e5, 1.7e5, 1.5e5))
        return SimpleNamespace(stiffness=stiffness, stiffness_bearings="rigid", error_percent=0.31)

    monkeypatch.setattr("cranktopo.tasks.shaft.stage.evaluate_shaft", evaluated)
    scene = turning(PROPELLER)
    said: list[str] = []
    with redirected(said.append):
        found = with_throw_stiffness(Target("mine", scene))
    assert found.scene.shaft is not None
    assert found.scene.shaft.throw_stiffnesses_Nm_per_rad == (1.5e5, 1.7e5, 1.7e5, 1.5e5)
    assert found.throw_stiffness_source == "finite elements, rigid bearings, +-0.31 %"
    assert asked == ["rigid"]
    assert "160,000 N m/rad" in said[0]
    before, after = (load_history(s, "extremes", plan(s).enabled) for s in (scene, found.scene))
    assert np.ptp(after.torque_Nm) < 0.9 * np.ptp(before.torque_Nm)  # the resonance of order 8 has gone
    given = turning({**PROPELLER, "throw_stiffness_Nm_per_rad": 1.4e5})
    every = turning({**PROPELLER, "throw_stiffnesses_Nm_per_rad": [1.4e5] * 4})
    for same in (given, every, switched_to(scene, "off"), load_scene("mikron-iiic-plain")):
        target = Target("mine", same)
        assert with_throw_stiffness(target) is target
    assert len(asked) == 1


@pytest.mark.parametrize(
    ("shaft", "engine", "why"),
    [
        (None, {}, "the scene has no [shaft]"),
        ({"pulley": {"inertia_kg_m2": 0.01}}, {}, "nothing is joined to the takeoff"),
        ({**FLYWHEEL, "throw_loss_factor": 0.0}, {}, "nothing damps the shaft, so that a resonance has no"),
        (FLYWHEEL, {"max_torque_Nm": 700.0}, "engine.max_torque_Nm or min_torque_Nm is taken as it is"),
        (FLYWHEEL, {"gas": None}, "the scene tells no torque over the cycle"),
    ],
)
def test_it_cannot_be_on_without_data(shaft: Any, engine: dict[str, Any], why: str) -> None:
    data = load_scene("mikron-iiic-plain").model_dump(mode="json", exclude_none=True)
    merged = {k: v for k, v in {**data["engine"], **engine}.items() if v is not None}
    extra = {} if shaft is None else {"shaft": shaft}
    scene = scene_from_dict({**data, "engine": merged, **extra})
    assert why in plan(scene)["torsional_vibration"].reason
    with pytest.raises(CranktopoError, match=r"effects\.torsional_vibration = 'on'"):
        plan(switched_to(scene, "on"))
