"""What a millimetre is worth, against new solids and new meshes; what holds a dimension, by name."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from cranktopo.bodies.volume import half_throw_volume_mm3
from cranktopo.design.goal.constraint import Constraint, LimitSense
from cranktopo.design.loading import load_scene
from cranktopo.design.schema import Scene
from cranktopo.numerics.optimisers.gradient_search import Multipliers
from cranktopo.tasks.refit.family import Layout, exact_web_of
from cranktopo.tasks.refit.fit import scene_with_web, usual_limits
from cranktopo.tasks.refit.parametric_web import ParametricWeb
from cranktopo.tasks.throw_fea.evaluation import evaluate_on_mesh
from cranktopo.tasks.throw_fea.targets import Target
from cranktopo.tasks.web_shape.mesh_model import MeshedWebs, MeshResponses
from cranktopo.tasks.web_shape.result import DimensionSensitivity
from cranktopo.tasks.web_shape.rules import ENVELOPE, rules_at
from cranktopo.tasks.web_shape.search import prices_of
from cranktopo.tasks.web_shape.search_goal import SearchGoal
from cranktopo.tasks.web_shape.sensitivities import (
    active_constraints,
    dimension_sensitivities,
    worst_case_percent,
)
from cranktopo.throw.bevel import FittedBevel
from cranktopo.throw.fitted_slot import FittedSlot
from tests.physics.shape.shape_cases import Array, full_web

SIZE_MM = 10.0


@pytest.fixture(scope="module")
def found() -> tuple[DimensionSensitivity, ...]:
    scene, layout, values = full_web()
    webs = MeshedWebs(scene, usual_limits(scene), SIZE_MM)
    web = webs.web(layout)
    responses = webs.responses(web, values)
    held = active_constraints(scene, web, values, rules_at(scene, web, values))
    return dimension_sensitivities(web, values, responses, responses.values, held)


def changed(name: str, step: float) -> Scene:
    """The scene with one dimension changed by a step, nothing rounded."""
    scene, layout, values = full_web()
    new = values + step * np.eye(len(values))[layout.names.index(name)]
    return scene_with_web(scene, exact_web_of(layout, new, scene))


@pytest.mark.parametrize("name", ["half_width_3", "groove.draft", "box-pin.size_x"])
def test_mass_is_that_of_the_exact_solid(found: tuple[DimensionSensitivity, ...], name: str) -> None:
    """Central differences of the solid by the CAD kernel; the mesh has chords, a percent is its own."""
    (row,) = [row for row in found if row.name == name]
    above, below, here = (half_throw_volume_mm3(changed(name, step)) for step in (0.05, -0.05, 0.0))
    assert row.per_unit_percent["mass"] == pytest.approx(
        100 * (above - below) / 0.1 / here, rel=0.02, abs=1e-4
    )


@pytest.mark.slow
@pytest.mark.parametrize("name", ["half_width_3", "groove.floor"])
def test_stiffness_is_that_of_new_meshes(found: tuple[DimensionSensitivity, ...], name: str) -> None:
    """Evaluations of webs 1.5 mm apart on each side, on new meshes that scatter by some 0.2 %."""
    (row,) = [row for row in found if row.name == name]
    above, below = (
        evaluate_on_mesh(Target(name, changed(name, step)), SIZE_MM).stiffness for step in (1.5, -1.5)
    )
    for quantity, support in (("torsion", "free"), ("bending", "pinned")):
        high, low = (getattr(side, quantity)[support] for side in (above, below))
        measured = 100 * (high - low) / 3.0 / ((high + low) / 2)
        assert row.per_unit_percent[quantity] == pytest.approx(measured, abs=0.12), quantity


def test_the_worst_case_is_the_sum_of_all(found: tuple[DimensionSensitivity, ...]) -> None:
    worst = worst_case_percent(found, 0.2)
    assert worst["mass"] == pytest.approx(0.2 * sum(abs(d.per_unit_percent["mass"]) for d in found))
    assert set(worst) == set(found[0].per_unit_percent)


def plain(changes: dict[str, float]) -> tuple[Scene, MeshedWebs, Layout, Array]:
    """A web with a bevel and a groove that no rule holds, with changes."""
    scene = load_scene("mikron-iiic-plain")
    layout = Layout(7, (FittedBevel("journal"), FittedSlot(through=True)))
    values = np.array([-27.0, 76.0, 17.0, 29.0, 31.0, 28.0, 18.0, 50.0, 9.0, 1.0, 5.0, 27.5, 0.3, 10.0])
    for name, value in changes.items():
        values[layout.names.index(name)] = value
    return scene, MeshedWebs(scene, usual_limits(scene), SIZE_MM), layout, values


def holders(
    scene: Scene, web: ParametricWeb, values: Array, goal: Any = None, paid: Multipliers | None = None
) -> dict[str, tuple[str, ...]]:
    """What holds each dimension, by its name."""
    told = active_constraints(scene, web, values, rules_at(scene, web, values), goal, paid)
    return dict(zip(web.layout.names, told, strict=True))


@pytest.mark.parametrize(
    ("changes", "name", "held"),
    [
        ({}, "groove.height", ()),
        ({"groove.draft": 3.0}, "groove.draft", ("least draft, 3 deg",)),
        ({"bevel-journal.depth": 16.0}, "bevel-journal.depth", ("greatest value of its range, 16 mm",)),
        ({"y_high": 81.95}, "y_high", (ENVELOPE,)),
    ],
)
def test_rules_and_bounds_hold_a_dimension(
    changes: dict[str, float], name: str, held: tuple[str, ...]
) -> None:
    scene, webs, layout, values = plain(changes)
    assert holders(scene, webs.web(layout), values)[name] == held


def test_a_wall_holds_every_dimension_that_it_depends_on() -> None:
    """The flange beside the groove, made exactly as thick as the rule asks; one more mm breaks it."""
    scene, webs, layout, values = plain({})
    web, rule = webs.web(layout), "least wall beside the groove, 3 mm"
    place = layout.names.index("groove.height")
    rules = rules_at(scene, web, values)
    at = rules.names.index(rule)
    values[place] -= rules.excess[at] / rules.gradients[at, place]
    told = holders(scene, web, values)
    assert all(told[f"groove.{name}"] == (rule,) for name in ("height", "floor", "offset"))
    assert told["y_low"] == ()
    values[place] += 1.0
    assert rules_at(scene, web, values).violated == (rule,)


def test_with_a_goal_only_what_is_against_it_holds() -> None:
    """Least mass: a deeper bevel and a thinner outline pay; a bound ahead holds, the one behind does not."""
    scene, webs, layout, values = plain({"bevel-journal.depth": 16.0, "groove.draft": 3.0})
    web, count = webs.web(layout), len(values)
    slopes = {"mass": np.full(count, 0.01), "torsion": np.full(count, 2.0)}
    slopes["mass"][[layout.names.index(n) for n in ("bevel-journal.depth", "groove.draft")]] = -0.01
    slopes["torsion"][layout.names.index("half_width_1")] = -1.0
    slopes["torsion"][layout.names.index("half_width_2")] = 1e-4  # noise of the elements
    found = MeshResponses({"mass": 1.7, "torsion": 100.0}, slopes)
    goal = SearchGoal("mass", 1.0, 1.6, (Constraint("torsion", ">=", 100.0),))
    wanted = goal, found, {"mass": 1.6, "torsion": 100.0}
    told = holders(scene, web, values, wanted)
    assert told["bevel-journal.depth"] == ("greatest value of its range, 16 mm",)
    assert told["groove.draft"] == ()  # more draft is less mass, and less torsion is no limit to it
    assert told["half_width_3"] == ("limit: torsion >= 100 % of the original",)
    assert told["half_width_1"] == ()
    assert told["half_width_2"] == (), "a limit that a dimension does not move holds it not"


def test_a_limit_within_the_reserve_of_a_finish_has_its_price_and_holds() -> None:
    """A web that weighs by its torsion alone pays for it where a millimetre meets the limit."""
    scene, webs, layout, values = plain({})
    web, count = webs.web(layout), len(values)
    slope = 2.0 / count
    slopes = {"mass": np.full(count, 0.016), "torsion": np.full(count, slope)}
    goal = SearchGoal("mass", 1.0, 1.6, (Constraint("torsion", ">=", 100.0),))
    for reached, price, held in ((100.7, 1 / slope, True), (103.0, 0.0, False)):
        found = MeshResponses({"mass": 1.6, "torsion": reached}, slopes)
        paid = prices_of(scene, web, values, found, goal)
        assert paid.limits == pytest.approx([price], abs=1e-9)
        assert paid.remainder == pytest.approx(0.0 if held else 1.0, abs=1e-9)
        told = holders(scene, web, values, (goal, found, {"mass": 1.6, "torsion": 100.0}))
        assert (told["half_width_3"] == ("limit: torsion >= 100 % of the original",)) == held


@pytest.mark.parametrize(("sense", "bound"), [(">=", -72.63), ("<=", -69.92)])
def test_a_limit_of_a_negative_unbalance_is_told_by_its_value(sense: LimitSense, bound: float) -> None:
    """In percent of the original's -71.27 the words would have the sense of the other limit."""
    scene, webs, layout, values = plain({})
    slope = 1.0 if sense == "<=" else -1.0
    slopes = {"mass": np.full(len(values), -0.01), "unbalance": np.full(len(values), slope)}
    goal = SearchGoal("mass", 1.0, 6.8, (Constraint("unbalance", sense, bound),))
    found = MeshResponses({"mass": 6.6, "unbalance": bound}, slopes)
    told = holders(scene, webs.web(layout), values, (goal, found, {"mass": 6.8, "unbalance": -71.27}))
    assert told["half_width_3"] == (f"limit: unbalance {sense} {bound:g} kg mm",)


@pytest.mark.parametrize(("gain", "held"), [(-0.01, ("least wall beside the groove, 3 mm",)), (0.01, ())])
def test_a_rule_holds_only_in_its_direction(gain: float, held: tuple[str, ...]) -> None:
    """A groove as high as its flange allows cannot grow where that pays, and may shrink where that does."""
    scene, webs, layout, values = plain({})
    web, place = webs.web(layout), layout.names.index("groove.height")
    rules = rules_at(scene, web, values)
    at = rules.names.index("least wall beside the groove, 3 mm")
    values[place] -= rules.excess[at] / rules.gradients[at, place]
    slopes = {"mass": np.full(len(values), gain)}
    wanted = SearchGoal("mass", 1.0, 1.6, ()), MeshResponses({"mass": 1.7}, slopes), {"mass": 1.6}
    assert holders(scene, web, values, wanted)["groove.height"] == held


def test_what_has_a_price_holds_for_the_sake_of_a_limit() -> None:
    """A longer web and a shallower bevel weigh more and pay for a thinner outline: both stop at their ends.

    The table of a counterweight at the envelope named the limit of the balance alone.
    """
    scene, webs, layout, values = plain({"y_high": 81.95, "bevel-journal.depth": 0.0})
    web, count = webs.web(layout), len(values)
    depth, length, width = (
        layout.names.index(name) for name in ("bevel-journal.depth", "y_high", "half_width_3")
    )
    values[depth] = web.bounds[0][depth]
    slopes = {"mass": np.zeros(count), "torsion": np.zeros(count)}
    slopes["mass"][[length, depth, width]] = 0.01, -0.01, 0.05
    slopes["torsion"][[length, depth, width]] = 1.0, -1.0, 1.0
    found = MeshResponses({"mass": 1.6, "torsion": 100.0}, slopes)
    goal = SearchGoal("mass", 1.0, 1.6, (Constraint("torsion", ">=", 100.0),))
    paid = prices_of(scene, web, values, found, goal)
    rules = rules_at(scene, web, values)
    priced = {name for name, price in zip(rules.names, paid.rules, strict=True) if price > 0}
    assert ENVELOPE in priced
    assert paid.bounds[depth] > 0
    told = holders(scene, web, values, (goal, found, {"mass": 1.6, "torsion": 100.0}), paid)
    assert priced <= {name for names in told.values() for name in names}
    assert ENVELOPE in told["y_high"]
    assert told["bevel-journal.depth"][0].startswith("least value of its range")
    assert told["half_width_3"] == ("limit: torsion >= 100 % of the original",)
