"""The effects plan of a goal: the load cases that goal and limits are read off, and no others."""

import pytest

from cranktopo.base.errors import CranktopoError
from cranktopo.design.goal.scene_goal import goal_of, with_goal
from cranktopo.design.loading import scene_from_dict
from cranktopo.design.schema import Weights
from cranktopo.engine.balance.throw import throw_balance
from cranktopo.engine.plan.planning import plan
from tests.unit.engine.plan_cases import MIKRON, with_effects, with_part


def goal_plan(scene=MIKRON, **options):
    goal_scene = with_goal(scene, **options)
    return plan(goal_scene, goal=goal_of(goal_scene))


@pytest.mark.parametrize(
    ("options", "cases"),
    [
        ({"minimise": "mass"}, {"bending", "torsion"}),
        ({"maximise": "torsion"}, {"bending", "torsion"}),
        ({"maximise": "torsion_per_mass", "limits": ["bending none"]}, {"torsion"}),
        ({"minimise": "mass", "limits": ["torsion none", "bending >= 90 %"]}, {"bending"}),
        (
            {"minimise": "inertia", "limits": ["torsion none", "bending none", "twist <= 0.3 deg"]},
            {"torsion"},
        ),
        (
            {"maximise": "torsion", "limits": ["bending none", "pin_displacement <= 0.2 mm"]},
            {"bending", "torsion"},
        ),
        # The fatigue safety, by default at least that of the original, rests on both.
        ({"minimise": "mass", "limits": ["torsion none", "bending none"]}, {"bending", "torsion"}),
        ({"maximise": "fatigue_safety", "limits": ["torsion none", "bending none"]}, {"bending", "torsion"}),
    ],
)
def test_a_goal_takes_the_load_cases_that_it_is_read_off_and_no_others(options, cases):
    heavy = MIKRON.optimise.weights.model_copy(update={"centrifugal": 0.5})
    scene = with_part(with_part(MIKRON, "optimise", weights=heavy), "engine", overspeed_rpm=4200.0)
    assert {"tangential", "centrifugal"} <= plan(scene).enabled
    decided = goal_plan(scene, **options)
    loads = {"bending", "torsion", "tangential", "centrifugal"}
    assert decided.enabled & loads == cases
    for name in loads - cases:
        assert decided[name].reason.startswith("neither goal nor limits need it")
    for name in cases:
        assert decided[name].reason.startswith("the goal needs it: ")


def test_nothing_is_proven_where_the_safety_alone_keeps_a_web():
    safety_alone = ["torsion none", "bending none"]
    told = goal_plan(minimise="mass", limits=safety_alone)["bound"]
    assert (told.state, told.reason) == (
        "off",
        "stress is not part of the proof, and no limit asks for a stiffness",
    )
    assert goal_plan(minimise="mass", limits=safety_alone[:1])["bound"].state == "on"


def balanced():
    """The Mikron with webs whose counterweights are heavier than the crankpin."""
    web = {"outline": "profile", "thickness_mm": 19.0}
    web |= {"stations_mm": [-100, -50, 0, 40, 75], "half_widths_mm": [80, 70, 50, 35, 25]}
    scene = scene_from_dict({**MIKRON.model_dump(mode="json"), "web": web})
    assert throw_balance(scene).throw_unbalance_kg_mm < 0
    return scene


def test_the_reason_names_the_limit():
    decided = goal_plan(minimise="mass", limits=["bending none", "pin_displacement <= 0.2 mm"])
    assert "the goal needs it: pin_displacement <= 0.2 mm; radial force" in decided["bending"].reason
    assert decided["fatigue"].reason.startswith("the goal needs it: fatigue_safety >= 100 %")


def test_a_goal_needs_no_weights_and_works_with_unit_loads():
    weights = Weights(bending=0, torsion=0, tangential=0)
    scene = with_part(MIKRON, "optimise", weights=weights).model_copy(update={"engine": None})
    assert {"bending", "torsion"} <= goal_plan(scene, minimise="mass").enabled


@pytest.mark.parametrize(
    ("scene", "options", "message"),
    [
        (
            with_effects(MIKRON, torsion="off"),
            {"minimise": "mass"},
            "effects.torsion = 'off': the goal needs it: torsion >= 100 %. Set it to 'auto' or 'on'.",
        ),
        (
            MIKRON,
            {"minimise": "mass", "limits": ["torsion none", "bending none", "fatigue_safety none"]},
            "no limit asks for a stiffness, and no web at all would be best",
        ),
        (
            balanced(),
            {"minimise": "mass", "limits": ["unbalance <= 90 %"]},
            "goal.limits.unbalance = '<= 90 %': percent of the original's unbalance, which is -",
        ),
    ],
)
def test_a_plan_that_cannot_serve_its_goal_is_refused(scene, options, message):
    with pytest.raises(CranktopoError) as caught:
        goal_plan(scene, **options)
    assert message in str(caught.value)


def test_an_unbalance_below_zero_may_stay_as_it_is():
    """More than balanced: 100 % of it has a meaning whatever its sign, other shares have none."""
    assert goal_plan(balanced(), minimise="mass", limits=["unbalance <= 100 %"]).enabled


def test_a_load_that_only_the_fatigue_safety_counts_says_so():
    heavy = MIKRON.optimise.weights.model_copy(update={"centrifugal": 0.5})
    scene = with_part(with_part(MIKRON, "optimise", weights=heavy), "engine", overspeed_rpm=9000.0)
    told = goal_plan(scene, minimise="mass", limits=["fatigue_safety >= 100 %"])["centrifugal"]
    assert told.state == "off"
    assert "the fatigue safety counts it" in told.reason
    plain = goal_plan(scene, minimise="mass", limits=["fatigue_safety none"])["centrifugal"]
    assert "fatigue" not in plain.reason


def test_large_changes_have_no_exponent():
    fast = with_part(MIKRON, "engine", speed_rpm=9000.0, overspeed_rpm=9000.0)
    assert not [effect for effect in plan(fast).effects if "e+" in f"{effect.reason} {effect.changes}"]
