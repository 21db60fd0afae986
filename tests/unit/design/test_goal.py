"""What is wanted: goal and limits as they are read, completed and refused."""

from __future__ import annotations

import math
from dataclasses import replace

import pytest

from cranktopo.base.errors import CranktopoError, ExitCode
from cranktopo.design.assumed import GOAL, assumptions
from cranktopo.design.goal.limit import Limit, goal_text
from cranktopo.design.goal.quantities import QUANTITIES
from cranktopo.design.goal.scene_goal import check_known, goal_of, with_goal
from cranktopo.design.loading import designs_folder, load_scene, parse_scene, scene_from_dict
from cranktopo.design.schema import Scene
from cranktopo.engine.states import extreme_states

MIKRON = (designs_folder() / "mikron-iiic-plain.toml").read_text(encoding="utf-8")


def scene_with(goal: str, text: str = MIKRON) -> Scene:
    return parse_scene(text + "\n" + goal, "my.toml")


def limits(goal: str) -> list[str]:
    found = goal_of(scene_with(goal))
    assert found is not None
    return [str(limit) + (" assumed" if limit.assumed else "") for limit in found.limits]


def error_of(goal: str, text: str = MIKRON) -> str:
    with pytest.raises(CranktopoError) as caught:
        scene_with(goal, text)
    return str(caught.value)


def with_limit(text: str, goal: str = 'minimise = "mass"') -> str:
    return f"[goal]\n{goal}\n[goal.limits]\n{text}"


def test_a_scene_without_a_goal_wants_nothing_more() -> None:
    assert goal_of(scene_with("")) is None


@pytest.mark.parametrize(
    ("goal", "expected"),
    [
        ('minimise = "mass"', ["torsion >= 100 %", "bending >= 100 %", "fatigue_safety >= 100 %"]),
        ('maximise = "torsion"', ["mass <= 100 %", "bending >= 100 %", "fatigue_safety >= 100 %"]),
        ('maximise = "bending_per_mass"', ["mass <= 100 %", "torsion >= 100 %", "fatigue_safety >= 100 %"]),
        ('maximise = "fatigue_safety"', ["mass <= 100 %", "torsion >= 100 %", "bending >= 100 %"]),
    ],
)
def test_by_default_nothing_gets_worse(goal: str, expected: list[str]) -> None:
    assert limits(f"[goal]\n{goal}") == [f"{limit} assumed" for limit in expected]


def test_a_counterweight_is_not_made_smaller_for_a_lighter_web() -> None:
    light, balanced, free = (
        with_goal(load_scene("car-diesel"), limits=limits, **asked)
        for asked, limits in (
            ({"minimise": "mass", "maximise": None}, ()),
            ({"minimise": "unbalance", "maximise": None}, ()),
            ({"minimise": "mass", "maximise": None}, ("unbalance none",)),
        )
    )
    found = [
        [str(limit) for limit in goal.limits if limit.quantity == "unbalance"]
        for goal in map(goal_of, (light, balanced, free))
        if goal is not None
    ]
    assert found == [["unbalance <= 100 %"], ["unbalance >= 0 kg mm"], []]


def test_a_given_limit_replaces_the_default_one_of_its_quantity() -> None:
    found = limits(with_limit('torsion = ">= 120 %"\nbending = "none"\nunbalance = "<= 0.04 kg m"'))
    assert found == ["unbalance <= 40 kg mm", "torsion >= 120 %", "fatigue_safety >= 100 % assumed"]


def test_a_balance_factor_is_percent_of_the_oscillating_mass() -> None:
    """Not of the original; the counterweight then follows it and not the original's unbalance."""
    found = limits(with_limit('balance_factor = [">= -20 %", "<= 52.5 %"]'))
    assert found[:2] == ["balance_factor >= -20 %", "balance_factor <= 52.5 %"]
    goal = goal_of(scene_with(with_limit('balance_factor = ">= 50 %"')))
    assert goal is not None
    limit = goal.limits[0]
    assert (limit.percent, limit.required(-140.0)) == (False, 50.0)
    weighted = with_goal(load_scene("car-diesel"), minimise="mass", limits=["balance_factor >= 40 %"])
    most = with_goal(load_scene("car-diesel"), maximise="balance_factor")
    for goal in map(goal_of, (weighted, most)):
        assert goal is not None
        assert "unbalance" not in {limit.quantity for limit in goal.limits}
    with pytest.raises(CranktopoError, match=r"the unit is missing; valid: %\.") as caught:
        with_goal(load_scene("car-diesel"), minimise="mass", limits=["balance_factor >= 40"])
    assert caught.value.hint == "For it write '>= 40 %'."


def test_a_balance_factor_needs_an_oscillating_mass() -> None:
    with pytest.raises(CranktopoError, match=r"needs \[engine.masses\]: without them nothing oscillates"):
        with_goal(load_scene("opposed-piston"), minimise="mass", limits=["balance_factor >= 50 %"])


def test_a_range_is_two_limits() -> None:
    found = limits(with_limit('mass = [">= 90 %", "<= 1.5 kg"]', 'maximise = "torsion"'))
    assert found[:2] == ["mass >= 90 %", "mass <= 1.5 kg"]


@pytest.mark.parametrize(
    ("quantity", "text", "value"),
    [
        ("mass", "<= 1500 g", 1.5),
        ("inertia", "<= 2.5e-3 kg·m²", 2500.0),
        ("torsion", ">= 150 kNm/rad", 150e3),
        ("torsion", ">= 1 N m/deg", 180 / math.pi),
        ("bending", ">= 200 N/µm", 200e3),
        ("torsion_per_mass", ">= 90 kN*m/rad/kg", 90e3),
        ("bending_per_mass", ">=120kN/mm/kg", 120e3),
        ("pin_displacement", "≤ 150 um", 0.15),
        ("twist", "<= 5 mrad", math.degrees(5e-3)),
        ("twist", "<= 0.3°", 0.3),
        ("torsion_per_mass", ">= 9e4 N m/(rad kg)", 9e4),
        ("fatigue_safety", ">= 1.5", 1.5),
        ("unbalance", ">= -3 kg mm", -3.0),
    ],
)
def test_units_become_the_internal_one(quantity: str, text: str, value: float) -> None:
    found = goal_of(
        scene_with(
            with_limit(
                f'{quantity} = "{text}"',
                'maximise = "torsion"' if quantity == "mass" else 'minimise = "mass"',
            )
        )
    )
    assert found is not None
    (limit,) = (limit for limit in found.limits if not limit.assumed)
    assert limit.value == pytest.approx(value)
    assert limit == Limit(QUANTITIES[limit.quantity].name, limit.sense, limit.value)


def test_a_goal_survives_being_stored() -> None:
    scene = scene_with(with_limit('torsion = [">= 100 %", "<= 120 %"]'))
    assert scene_from_dict(scene.model_dump(mode="json")) == scene


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ('mas = "<= 3 kg"', "unknown key goal.limits.mas. Did you mean 'mass'?"),
        ('torsion = "> 3 %"', "goal.limits.torsion = '> 3 %': '>' is no sign of a limit. Write '>= 3 %'."),
        ('torsion = "= 3 %"', "For a fixed value give two limits, '>= 3 %' and '<= 3 %'."),
        ('torsion = "100 %"', "must begin with <= or >=. Write '>= 100 %'."),
        ('torsion = ">= much"', "a number must follow the sign"),
        ('torsion = ">= nan %"', "the number must be finite"),
        ('torsion = ">= -inf N m/rad"', "the number must be finite"),
        ('torsion = ">= 1e999 N m/rad"', "the number must be finite"),
        ('torsion = ">= 1,5 %"', "'1,5' is not a number. Write a decimal point and no separators."),
        ('torsion = ">= 100"', "the unit is missing; valid: N m/rad, kN m/rad, MN m/rad, N m/deg, %."),
        ('torsion = ">= 100 kN/rad"', "unknown unit 'kN/rad'; valid: N m/rad, kN m/rad,"),
        ('unbalance = "<= 40 kg mm2"', "valid: kg mm, kg m, g mm, g m, %. Did you mean 'kg mm'?"),
        ('fatigue_safety = ">= 2 mm"', "unknown unit 'mm'; valid: none, or %."),
        ('torsion = ">= -5 %"', "the percentage must be > 0 and <= 10000"),
        ('inertia = "<= 0 kg mm2"', "the number must be > 0"),
        ("torsion = 100", "goal.limits.torsion = 100: must be text with a sign, a number"),
        ("torsion = [100]", "must be text with a sign, a number and a unit"),
        ("torsion = []", "no limit is given"),
        ('torsion = ""', "must begin with <= or >="),
        ('torsion = "<= 100 %"', "is wanted high: a limit on its own is >=. Write '>= 100 %'"),
        ('bending = [">= 50 kN/mm", "<= 40 kN/mm"]', "contradictory: nothing is >= 50000 and <= 40000 N/mm."),
        ('bending = [">= 50 %", ">= 60 %"]', "two limits from below. Keep the tighter one"),
    ],
)
def test_a_limit_that_cannot_be_read_says_what_to_write(text: str, message: str) -> None:
    assert message in error_of(with_limit(text))


@pytest.mark.parametrize(
    ("goal", "message"),
    [
        ('maximise = "mass"', "goal.maximise = 'mass': mass is wanted low. Minimise it."),
        ('minimise = "torsion"', "goal.minimise = 'torsion': torsional stiffness is wanted high."),
        ('minimise = "weight"', "goal.minimise = 'weight': unknown quantity. Did you mean 'mass'?"),
        ('maximise = "torsoin"', "Did you mean 'torsion'?"),
        ('minimise = "twist"', "can be limited but is no goal. Maximise 'torsion'"),
        (
            "minimise = 3",
            "goal.minimise = 3: must be the name of a quantity. Valid: mass, inertia, unbalance.",
        ),
        ('minimise = "mass"\nmaximise = "torsion"', "minimise and maximise are both given"),
        ("", "neither minimise nor maximise is given"),
        ('minimize = "mass"', "unknown key goal.minimize. Did you mean 'minimise'?"),
    ],
)
def test_a_goal_that_makes_no_sense_is_refused(goal: str, message: str) -> None:
    assert message in error_of(f"[goal]\n{goal}")


NO_ENGINE = MIKRON[: MIKRON.index("[engine]")] + MIKRON[MIKRON.index("[envelope]") :]


@pytest.mark.parametrize(
    ("goal", "message"),
    [
        (with_limit('mass = "<= 90 %"'), "goal.limits.mass = '<= 90 %': the goal itself makes it as low as"),
        (
            with_limit('torsion = "none"\nbending = "none"\nfatigue_safety = "none"'),
            "Limit torsion or bending.",
        ),
    ],
)
def test_limits_leave_the_goal_its_sense(goal: str, message: str) -> None:
    assert message in error_of(goal)


def test_a_safety_that_is_switched_off_cannot_be_limited() -> None:
    text = MIKRON.replace("[effects]", '[effects]\nfatigue = "off"')
    assert "effects.fatigue is 'off'" in error_of(with_limit('fatigue_safety = ">= 1.5"'), text)
    assert "fatigue" not in str(goal_of(scene_with('[goal]\nminimise = "mass"', text)))


def test_what_depends_on_the_load_needs_an_engine() -> None:
    text = 'fatigue_safety = ">= 1.5"\ntwist = "<= 1 deg"\npin_displacement = "<= 90 %"'
    message = error_of(with_limit(text), NO_ENGINE)
    assert "3 errors" in message
    assert "goal.limits.fatigue_safety = '>= 1.5': fatigue safety needs an [engine]" in message
    assert "without one the load is a unit load. Give what it needs, or limit torsion instead." in message
    assert "or limit bending instead." in message


def test_the_safety_goes_without_saying_only_where_there_is_one() -> None:
    found = goal_of(scene_with('[goal]\nminimise = "mass"', NO_ENGINE))
    assert found is not None
    assert [limit.quantity for limit in found.limits] == ["torsion", "bending"]


def test_whether_a_load_is_given_is_told_as_the_load_states_tell_it() -> None:
    """Independent of the check: the states say themselves that they are unit loads."""
    for given in ({}, {"max_gas_force_N": 3e4}, {"max_torque_Nm": 500.0}):
        mikron = load_scene("mikron-iiic-plain")
        assert mikron.engine is not None
        engine = mikron.engine.model_copy(update={"gas": None, **given})
        scene = mikron.model_copy(update={"engine": engine})
        unit = {state.case.kind for state in extreme_states(scene, frozenset()) if state.unit}
        for name, kind in (("pin_displacement", "bending"), ("twist", "torsion")):
            limits = [f"{name} <= 90 %"]
            refused = False
            try:
                with_goal(scene, minimise="mass", limits=limits)
            except CranktopoError:
                refused = True
            assert refused == (kind in unit)


def test_the_balance_is_where_the_least_unbalance_ends() -> None:
    assert limits('[goal]\nminimise = "unbalance"')[-1] == "unbalance >= 0 kg mm assumed"


def test_options_replace_goal_and_limits() -> None:
    scene = scene_with(with_limit('torsion = ">= 120 %"'))
    more = goal_of(with_goal(scene, limits=["bending >= 90 %", "bending <= 95 %", "fatigue_safety none"]))
    other = goal_of(with_goal(scene, maximise="bending"))
    assert more is not None
    assert other is not None
    assert [str(limit) for limit in more.limits] == ["torsion >= 120 %", "bending >= 90 %", "bending <= 95 %"]
    assert [str(limit) for limit in other.limits][:2] == ["mass <= 100 %", "torsion >= 100 %"]
    assert with_goal(scene) is scene


@pytest.mark.parametrize(
    ("limit", "message"),
    [
        ("torsoin >= 100 %", "limit 'torsoin >= 100 %': unknown quantity 'torsoin'. Did you mean 'torsion'?"),
        (">= 100 %", "must begin with the name of a quantity. Valid: balance_factor, bearing_pressure,"),
        ("torsion", "goal.limits.torsion = '': must begin with <= or >="),
        (
            "torsion >= 3 \udcff\n",
            "goal.limits.torsion = '>= 3 \\udcff': must hold no control character, here U+DCFF",
        ),
    ],
)
def test_a_limit_as_an_option_is_refused_as_wrong_use(limit: str, message: str) -> None:
    with pytest.raises(CranktopoError) as caught:
        with_goal(load_scene("mikron-iiic-plain"), minimise="mass", limits=[limit])
    assert message in str(caught.value)
    assert caught.value.code == ExitCode.USAGE


def test_what_is_assumed_and_what_is_left_is_said() -> None:
    scene = scene_with(with_limit('torsion = ">= 120 %"'))
    assert [str(item) for item in assumptions(scene, (GOAL,))] == [
        'goal.limits.bending = ">= 100 %" (of the original web)',
        'goal.limits.fatigue_safety = ">= 100 %" (of the original web)',
    ]
    goal = goal_of(scene)
    assert goal is not None
    assert goal_text(goal, "density").splitlines() == [
        "goal: least mass; torsion >= 120 %, bending >= 100 % (% of the original web)",
        "not known to the density optimisation, left to the evaluation: fatigue_safety >= 100 % (% of the "
        "original web)",
    ]
    assert "evaluation" not in goal_text(goal, "shape")


def test_an_optimiser_refuses_a_goal_that_it_does_not_know() -> None:
    goal = goal_of(scene_with('[goal]\nmaximise = "fatigue_safety"'))
    assert goal is not None
    check_known(goal, "shape")
    with pytest.raises(CranktopoError, match="cannot tell the fatigue safety of a design"):
        check_known(goal, "density")


def test_a_density_does_not_rest_on_the_safety_alone() -> None:
    goal = goal_of(with_goal(scene_with(""), minimise="mass", limits=["torsion none", "bending none"]))
    assert goal is not None
    check_known(goal, "shape")
    with pytest.raises(CranktopoError, match="no limit asks for a stiffness"):
        check_known(goal, "density")
    check_known(replace(goal, limits=(*goal.limits, Limit("torsion", ">=", 80.0, True))), "density")


def test_all_mistakes_are_listed() -> None:
    message = error_of(with_limit('torsion = ">= 100"\nbending = 3\nmas = "<= 3 kg"', 'minimise = "torsion"'))
    assert "my.toml: 4 errors." in message
