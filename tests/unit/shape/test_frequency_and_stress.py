"""Natural frequency and stress as limits: what they need, who judges them, how a search takes them."""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from cranktopo.base.errors import CranktopoError, ExitCode
from cranktopo.base.notes import redirected
from cranktopo.base.progress import StageMemory
from cranktopo.design.goal.limit import Goal, Limit, goal_text
from cranktopo.design.goal.scene_goal import check_goal, check_known, goal_of, with_goal
from cranktopo.design.loading import load_scene, scene_from_dict
from cranktopo.design.schema import Scene
from cranktopo.engine.balance.throw import throw_balance
from cranktopo.engine.vibration.first_frequency import first_frequency
from cranktopo.tasks.bound.webs import convex_problem
from cranktopo.tasks.compare import stage as compare_stage
from cranktopo.tasks.throw_fea.evaluation import evaluate
from cranktopo.tasks.throw_fea.targets import Target
from cranktopo.tasks.vibration.stage import shaft_vibration
from cranktopo.tasks.web_shape import evaluated_web as module
from cranktopo.tasks.web_shape.evaluated_web import Judging, coarse_shares, evaluated_web
from cranktopo.tasks.web_shape.search_goal import goal_on_cells, search_goal_of
from cranktopo.tasks.web_shape.shaft_frequency import frequency_of, needed_for

LIMITS = ("natural_frequency >= 98 %", "stress <= 250 MPa")
COARSE_MM = 12.0


def plain() -> dict[str, Any]:
    return load_scene("mikron-iiic-plain").model_dump(mode="json", exclude_none=True, exclude={"published"})


def limited(*limits: str, **tables: Any) -> Scene:
    return with_goal(scene_from_dict(plain() | tables), minimise="mass", limits=limits or LIMITS)


def stated_goal(scene: Scene) -> Goal:
    goal = goal_of(scene)
    assert goal is not None
    return goal


ONE = {**plain()["engine"], "cylinders": 1, "firing_order": [1]}


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"engine": None}, "natural frequency of the shaft in torsion needs an [engine]: it has the throws"),
        ({"engine": None}, "faces needs an [engine]: unit loads give no stress level"),
        ({"shaft": {"throw_stiffness_Nm_per_rad": 1.5e5}}, "leave out that of [shaft], which is fixed"),
        (
            {"crank": {"main_journal": [{"number": 0, "length_mm": 30.0}]}},
            "a crank whose throws are all alike",
        ),
        ({"engine": ONE}, "needs more than one throw, or what turns with it in [shaft]"),
    ],
)
def test_limits_that_the_scene_cannot_tell_are_refused(change: dict[str, Any], words: str) -> None:
    found = scene_from_dict({key: value for key, value in (plain() | change).items() if value is not None})
    with pytest.raises(CranktopoError) as error:
        with_goal(found, minimise="mass", limits=LIMITS)
    assert words in str(error.value)


def test_one_throw_with_a_flywheel_swings() -> None:
    scene = limited(LIMITS[0], engine=ONE, shaft={"flywheel": {"inertia_kg_m2": 0.2}})
    check_goal(scene)


def test_a_sharp_fillet_has_no_stress() -> None:
    throw = plain()["throw"]
    throw["crankpin"] |= {"fillet_mm": 0.0}
    with pytest.raises(CranktopoError, match="needs fillets at both journals"):
        limited(throw=throw)


def test_the_density_optimisation_refuses_a_stress_and_names_shape() -> None:
    with pytest.raises(CranktopoError) as error:
        check_known(stated_goal(limited("stress <= 250 MPa")), "density")
    told = str(error.value)
    line = goal_text(stated_goal(limited("stress <= 250 MPa")), "density").splitlines()[1]
    assert line == "of `cranktopo shape` alone, `optimise` refuses it: stress <= 250 MPa"
    assert "goal.limits.stress" in told
    assert "<= 250 MPa" in told
    assert "no fillets" in told
    assert "`cranktopo shape`" in told


def test_the_density_optimisation_is_not_asked_for_a_web_that_only_a_frequency_holds() -> None:
    none = ("torsion none", "bending none", "fatigue_safety none")
    with pytest.raises(CranktopoError, match="leaves the first natural frequency of the shaft in torsion to"):
        check_known(stated_goal(limited(LIMITS[0], *none)), "density")
    check_known(stated_goal(limited(LIMITS[0])), "density")
    assert stated_goal(limited(LIMITS[0], *none)).load_cases == {"torsion"}


def test_neither_is_part_of_a_proof() -> None:
    original = {"mass": 1.5, "torsion": 1.4e5, "bending": 2.3e5, "inertia": 2000.0, "unbalance": 35.0}
    dropped = {limit.quantity: why for limit, why in convex_problem(stated_goal(limited()), original).dropped}
    assert dropped["stress"] == "stress is not part of the proof"
    assert dropped["natural_frequency"] == "what turns with the throws is not part of the proof"
    most = with_goal(load_scene("mikron-iiic-plain"), maximise="natural_frequency")
    with pytest.raises(CranktopoError, match="what turns with the throws is not part of the proof"):
        convex_problem(stated_goal(most), original)
    with pytest.raises(CranktopoError, match="can be limited but is no goal"):
        with_goal(load_scene("mikron-iiic-plain"), minimise="stress")


@pytest.mark.parametrize(
    ("limit", "percent"),
    [
        (Limit("stress", "<=", 80.0, percent=True), 125.0),
        (Limit("stress", "<=", 250.0), 120.0),
        (Limit("stress", ">=", 80.0, percent=True), None),
    ],
)
def test_stiffness_stands_for_the_stress_on_cells(limit: Limit, percent: float | None) -> None:
    """A stress follows the inverse of the stiffness; the original has 300 MPa."""
    goal = goal_on_cells(
        Goal("minimise", "mass", (limit,)), {"torsion": 1e5, "bending": 2e5}, lambda: {"stress": 300.0}
    )
    expected = {} if percent is None else {"bending": percent, "torsion": percent}
    assert {one.quantity: one.value for one in goal.limits} == pytest.approx(expected)


def test_a_search_follows_torsion_and_inertia_where_the_goal_asks() -> None:
    values = {"torsion": 1.5e5, "inertia": 2300.0}
    assert frequency_of(load_scene("mikron-iiic-plain"), values) is None
    assert frequency_of(limited(), {"torsion": 1.5e5}) is None
    scene = limited()
    assert frequency_of(scene, values) == first_frequency(scene, *values.values())
    assert needed_for(["mass"]) == {"mass"}
    assert needed_for(["natural_frequency"]) == {"natural_frequency", "torsion", "inertia"}


@pytest.mark.slow
def test_a_coarse_mesh_is_brought_to_the_shaft_on_its_bearings() -> None:
    """Its share times what its own stiffness gives is the frequency of the evaluation."""
    scene = limited(LIMITS[0])
    found = evaluate(Target(scene.name, scene), 14.0)
    inertia = throw_balance(scene).inertia_kg_mm2
    original = {"torsion": 1.4e5, "bending": 2.2e5, "inertia": inertia, "natural_frequency": 990.0}
    shares = coarse_shares(scene, 14.0, original)
    own = first_frequency(scene, found.torsion_Nm_per_rad, inertia).frequency_Hz
    assert shares["natural_frequency"] * own == pytest.approx(990.0, rel=1e-3)
    assert "natural_frequency" not in coarse_shares(limited("stress <= 250 MPa"), 14.0, original)


@pytest.mark.slow
def test_the_evaluation_tells_what_vibration_does() -> None:
    """On rigid bearings, where a throw between its neighbours is stiffer than one that stands alone."""
    propeller = {"propeller": {"inertia_kg_m2": 0.6, "damping_Nms_per_rad": 3.0}}
    scene = limited(LIMITS[0], "torsion none", shaft=propeller)
    web = evaluated_web(scene, (), COARSE_MM, "web", StageMemory())
    told = shaft_vibration(Target(scene.name, scene), element_size_mm=COARSE_MM).modes[0].frequency_Hz
    assert web.values["natural_frequency"] == pytest.approx(told, rel=1e-9)
    alone = first_frequency(scene, web.values["torsion"], web.values["inertia"]).frequency_Hz
    assert 0.9 * told < alone < 0.999 * told


def test_stress_is_found_with_the_safety_or_alone(monkeypatch: pytest.MonkeyPatch) -> None:
    nodes = np.array([[10.0, 50.0, 20.0], [30.0, 5.0, 400.0]])
    field = SimpleNamespace(
        critical=SimpleNamespace(safety=1.2, place="pin fillet"),
        amplitude_MPa=nodes,
        mean_MPa=-nodes / 2,
        model=SimpleNamespace(judged=np.array([True, True, False])),
    )
    target = Target("web", load_scene("mikron-iiic-plain"))
    asked: list[str] = []

    def told(found: Any, loads: str) -> Any:
        asked.append(loads)
        return found

    monkeypatch.setattr(module, "fatigue_field", lambda *given: told(field, given[-2]))
    monkeypatch.setattr(module, "largest_stress_MPa", lambda *given: told(123.0, given[-2]))
    monkeypatch.setattr(module, "safety_remarks", lambda _: [])
    stressed, cycle = module._stressed, Judging("cycle")
    least = {"fatigue_safety": 1.2, "fatigue_place": "pin fillet", "fatigue_loads": "cycle"}
    assert stressed(target, {"fatigue_safety", "stress"}, cycle) == {**least, "stress_MPa": 75.0}
    assert stressed(target, {"fatigue_safety"}, cycle) == least
    assert stressed(target, {"stress"}, cycle) == {"stress_MPa": 123.0}
    assert asked == ["cycle"] * 3


def test_a_stress_alone_needs_no_strength(monkeypatch: pytest.MonkeyPatch) -> None:
    scene = limited("stress <= 250 MPa", "fatigue_safety none")
    weak = scene.model_copy(
        update={"material": scene.material.model_copy(update={"fatigue_bending_MPa": None})}
    )
    module._check(Target("web", weak), {"stress"}, Judging())
    with pytest.raises(CranktopoError, match="fatigue_bending_MPa"):
        module._check(Target("web", weak), {"stress", "fatigue_safety"}, Judging())


def test_a_limit_moves_with_the_error_of_the_model() -> None:
    """Cells with 950 Hz of the original's 990: 98 % are 931 Hz there."""
    (limit,) = search_goal_of(
        Goal("minimise", "mass", (Limit("natural_frequency", ">=", 98.0, percent=True),)),
        {"mass": 1.5, "natural_frequency": 950.0},
        {"mass": 1.5, "natural_frequency": 990.0},
        (),
    ).limits
    assert limit.bound == pytest.approx(931.0)


def test_compare_judges_them_and_says_which_target_has_no_shaft(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    lines: list[str] = []
    scene, told = limited(LIMITS[0], LIMITS[1]), {"original": 400.0, "web": 391.0}
    result = evaluate(Target("web", scene), 14.0).result

    def frequency(target: Target) -> float:
        if target.name not in told:
            raise CranktopoError("no engine", code=ExitCode.INVALID_INPUT)
        return told[target.name]

    monkeypatch.setattr(compare_stage, "first_frequency_Hz", frequency)
    entry = SimpleNamespace(evaluation=SimpleNamespace(result=result), safety=1.5, stress_MPa=260.0)
    targets = [Target(name, scene, Path(name)) for name in ("original", "web", "bare")]
    with redirected(lines.append):
        found = compare_stage._evaluated_goals(targets, targets, [entry] * 3, 0)
    limits = {name: {one.quantity: one for one in goal.limits} for name, goal in found.items()}
    assert limits["web"]["natural_frequency"].reached_percent == pytest.approx(97.75)
    assert limits["web"]["natural_frequency"].holds is True, "within the half percent of every command"
    assert limits["web"]["stress"].holds is False
    assert limits["bare"]["natural_frequency"].holds is None
    assert lines == ["bare: no natural frequency: no engine"]
