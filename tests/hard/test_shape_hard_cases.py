"""Hard starts and goals of the shape optimisation: each ends in a web that can be made, or in one message."""

from __future__ import annotations

import re
from collections.abc import Collection, Iterator
from dataclasses import dataclass, replace

import numpy as np
import pytest
from numpy.typing import NDArray

from cranktopo.base.errors import CranktopoError, ExitCode
from cranktopo.base.progress import StageMemory
from cranktopo.design.goal.limit import Goal, Limit
from cranktopo.design.loading import load_scene, scene_from_dict
from cranktopo.design.schema import Scene
from cranktopo.numerics.optimisers.dimension_search import SearchBudget
from cranktopo.numerics.precision import double_precision
from cranktopo.tasks.refit.family import Layout, free_dimensions, with_free
from cranktopo.tasks.refit.fit import usual_limits
from cranktopo.tasks.refit.parametric_web import ParametricWeb
from cranktopo.tasks.web_shape.feature_selection import FeatureSelection
from cranktopo.tasks.web_shape.mesh_model import MeshedWebs, MeshResponses
from cranktopo.tasks.web_shape.rules import ENVELOPE, rules_at
from cranktopo.tasks.web_shape.search import best_values, search_on_cells, shaped_scene
from cranktopo.tasks.web_shape.search_goal import SearchGoal, search_goal_of
from cranktopo.tasks.web_shape.start import outline_start
from cranktopo.tasks.web_shape.web_model import WebModel, web_model
from cranktopo.throw.bevel import FittedBevel
from cranktopo.throw.fitted_pocket import FittedBox, FittedCylinder
from cranktopo.throw.fitted_slot import FittedSlot
from cranktopo.throw.manufacturing_limits import ManufacturingLimits

Array = NDArray[np.float64]
CELL_MM = 8.0
OUTLINE = [-24.5, 73.0, 17.0, 28.0, 29.0, 27.0, 17.0]
JOURNAL, PIN = FittedBevel("journal", hollow=True), FittedBevel("pin", hollow=True)
GROOVE, BOX, CYLINDERS = FittedSlot(through=True), FittedBox("pin"), FittedCylinder("journal", pair=True)
LIGHT = Goal("minimise", "mass", tuple(Limit(name, ">=", 90.0, True) for name in ("torsion", "bending")))
STARTS: dict[str, tuple[Layout, list[float], str]] = {
    "outline across the fillets": (Layout(7), [-15.0, 63.0, 9.0, 16.0, 15.0, 14.0, 8.0], "shoulder"),
    "outline outside of the envelope": (Layout(7), [-60.0, 110.0, 30.0, 70.0, 55.0, 60.0, 20.0], ENVELOPE),
    "outline that folds back": (Layout(7), [-24.5, 73.0, 17.0, 45.0, 17.0, 45.0, 17.0], "least radius"),
    "groove with walls thinner than the least": (
        Layout(7, (GROOVE,)),
        [*OUTLINE, 17.5, 22.0, 0.5, 6.0],
        "beside the groove",
    ),
    "bevel beyond its bounds": (Layout(7, (JOURNAL,)), [*OUTLINE, 90.0, 25.0, 14.0], "bevel"),
    "bevel on the journal": (Layout(7, (JOURNAL, PIN)), [*OUTLINE, 5.0, 9.0, 0.5, 40.0, 9.0, 0.0], "journal"),
    "pocket against bevel": (
        Layout(7, (JOURNAL, PIN, BOX)),
        [*OUTLINE, 47.0, 14.0, 0.0, 2.0, 14.0, 0.0, 19.0, 14.0, 16.0, 14.0],
        "box pocket",
    ),
    "groove against pocket": (
        Layout(7, (GROOVE, BOX)),
        [*OUTLINE, 9.0, 12.0, 0.0, 7.0, 19.0, 20.0, 12.0, 14.0],
        "box",
    ),
    "groove against bore": (Layout(7, (GROOVE,)), [*OUTLINE, 6.0, 9.0, 3.0, 7.0], "groove"),
    "pockets through each other": (
        Layout(7, (BOX, CYLINDERS)),
        [*OUTLINE, 22.0, 20.0, 18.0, 14.0, 6.0, 22.0, 20.0, 14.0],
        "pocket",
    ),
}


@pytest.fixture(scope="module")
def mikron() -> Scene:
    return load_scene("mikron-iiic-plain")


@pytest.fixture(scope="module")
def model(mikron: Scene) -> Iterator[WebModel]:
    with double_precision():
        yield web_model(mikron, usual_limits(mikron), CELL_MM)


def stated(goal: Goal, model: WebModel) -> SearchGoal:
    return search_goal_of(goal, model.original, model.original, model.model.cases)


def growth(model: WebModel, goal: Goal) -> FeatureSelection:
    """On cells that err in nothing, so that they stand for the elements as well."""
    both = stated(goal, model)
    return FeatureSelection(model, model.webs(), (both, both), model.original, StageMemory())


QUICK = "outline across the fillets", "groove against bore"


@pytest.mark.parametrize(
    "name", [pytest.param(name, marks=() if name in QUICK else pytest.mark.slow) for name in STARTS]
)
def test_a_start_that_breaks_the_rules_ends_in_a_web_that_can_be_made(
    name: str, model: WebModel, mikron: Scene
) -> None:
    layout, start, rule = STARTS[name]
    web, values = model.web(layout), np.array(start)
    before = rules_at(mikron, web, values)
    outside = (values < web.bounds[0]) | (values > web.bounds[1])
    assert any(rule in broken for broken in before.violated) or outside.any()
    found, _ = search_on_cells(
        model, layout, values, stated(LIGHT, model), name, StageMemory(), 12, nearest=True
    )
    assert found is not None
    assert rules_at(mikron, web, found.values).violated == ()
    assert shaped_scene(mikron, layout, found.values).web.thickness_mm == mikron.web.thickness_mm


GOALS: dict[str, tuple[Goal, tuple[str, ...]]] = {
    "torsion of half as much again": (
        Goal("minimise", "mass", (Limit("torsion", ">=", 150.0, True), Limit("bending", ">=", 100.0, True))),
        ("torsion >= 150 %", "bending >= 100 %"),
    ),
    "half the mass, twice the stiffness": (
        Goal("maximise", "torsion", (Limit("mass", "<=", 50.0, True), Limit("bending", ">=", 200.0, True))),
        ("mass <= 50 %", "bending >= 200 %"),
    ),
}


@pytest.mark.slow
@pytest.mark.parametrize("name", GOALS)
def test_limits_that_no_web_meets_name_what_the_nearest_reaches(
    name: str, model: WebModel, mikron: Scene, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Each feature is tried by a few webs: which of them is the nearest is not the subject."""
    monkeypatch.setattr("cranktopo.tasks.web_shape.feature_selection.EVALUATIONS", 4)
    goal, asked = GOALS[name]
    growing = growth(model, goal)
    start = outline_start(mikron, usual_limits(mikron))
    with pytest.raises(CranktopoError) as error:
        growing.select(growing.first(Layout(7), start))
    assert error.value.code == ExitCode.CRITERION_NOT_MET
    assert error.value.hint
    for limit in asked:
        reached = re.search(rf"{limit}: ([\d.]+) % reached", str(error.value))
        assert reached, error.value
        required = float(limit.split()[2])
        assert 0.3 * required < float(reached[1]) < 3 * required


@pytest.mark.slow
def test_an_envelope_that_holds_no_web_names_the_rule(mikron: Scene) -> None:
    """Narrower than the shoulders beside the fillets."""
    data = mikron.model_dump(mode="json", exclude_none=True)
    narrow = scene_from_dict({**data, "envelope": data["envelope"] | {"half_width_mm": 25.2}})
    with double_precision():
        cells = web_model(narrow, usual_limits(narrow), 12.0)
    limits = ManufacturingLimits(min_wall_mm=14.0)
    growing = growth(replace(cells, limits=limits), LIGHT)
    with pytest.raises(CranktopoError, match=f"'{ENVELOPE}' is broken by [0-9.]+ mm") as error:
        growing.first(Layout(7), outline_start(narrow, limits))
    assert error.value.code == ExitCode.CRITERION_NOT_MET


@dataclass
class Plane:
    """Mass of a web as a plane in its parameters: wide outlines are heavy, large fillets light."""

    scene: Scene

    def web(self, layout: Layout) -> ParametricWeb:
        return MeshedWebs(self.scene, ManufacturingLimits(), 14.0).web(layout)

    def responses(self, web: ParametricWeb, values: Array, quantities: Collection[str]) -> MeshResponses:
        slope = np.array([-30.0 if "fillet" in name else 1.0 for name in web.layout.names])
        slope[0] = -1.0
        return MeshResponses({"mass": float(slope @ values) + 500.0}, {"mass": slope})


def test_fillets_grow_no_further_than_their_shoulders_let_them(mikron: Scene) -> None:
    """The shortest outline and the largest fillets are wanted at once, in the largest ranges there are."""
    data = mikron.model_dump(mode="json", exclude_none=True)
    free = {"pin_fillet_mm": [1.5, 5.4], "journal_fillet_mm": [1.5, 5.4], "web_thickness_mm": [17.0, 24.0]}
    scene = scene_from_dict({**data, "shape": {"free": free}})
    bevels, starts = (JOURNAL, PIN), [47.0, 9.0, 0.5, 2.0, 9.0, 0.0]
    values = np.array([*OUTLINE, *starts])
    layout, start = with_free(Layout(7, bevels), values, scene, free_dimensions(scene))
    webs, goal = Plane(scene), SearchGoal("mass", 1.0, 500.0, ())
    found, _ = best_values(lambda: webs, layout, start, goal, "a", StageMemory(), SearchBudget(60, 8.0))
    assert found is not None
    assert rules_at(scene, webs.web(layout), found).violated == ()
    shaped = shaped_scene(scene, layout, found)
    pin, main = shaped.throw.crankpin, shaped.throw.main_journal
    assert pin.fillet_mm == pytest.approx(5.4)
    assert main.fillet_mm == pytest.approx(5.4)
    shoulder = found[1] - shaped.throw.radius_mm - pin.radius_mm - pin.fillet_mm
    assert 0.0 < shoulder < 2.0
    assert main.length_mm == pytest.approx(40.0 + 2 * (19.0 - shaped.web.thickness_mm))
