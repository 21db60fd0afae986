"""The search over dimensions: exact gradients, prices in closed form, and a whole optimisation."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose

from cranktopo.base.errors import CranktopoError
from cranktopo.base.progress import StageMemory
from cranktopo.design.goal.constraint import Constraint
from cranktopo.design.goal.scene_goal import with_goal
from cranktopo.design.loading import load_scene, scene_from_dict
from cranktopo.design.schema import Scene
from cranktopo.numerics.grid import equilibrium
from cranktopo.numerics.optimisers.gradient_search import multipliers
from cranktopo.numerics.precision import double_precision
from cranktopo.tasks.refit.family import Layout, with_free
from cranktopo.tasks.refit.fit import usual_limits
from cranktopo.tasks.web_shape.search import SearchResult, multipliers_of, search_on_cells
from cranktopo.tasks.web_shape.search_goal import SearchGoal
from cranktopo.tasks.web_shape.start import outline_start
from cranktopo.tasks.web_shape.web_model import WebModel, web_model
from cranktopo.throw.bevel import FittedBevel
from cranktopo.throw.fitted_pocket import FittedBox
from cranktopo.throw.fitted_slot import FittedSlot
from tests.physics.shape.shape_cases import die_web, round_groove_web, round_side_web, rounded_web

QUANTITIES = ("mass", "inertia", "unbalance", "torsion", "bending", "torsion_per_mass", "bending_per_mass")
PARTS = (
    FittedBevel("journal"),
    FittedBevel("pin", hollow=True),
    FittedSlot(through=True),
    FittedBox("pin", True),
)


@pytest.fixture(scope="module")
def mikron() -> Scene:
    return load_scene("mikron-iiic-plain")


@pytest.fixture(scope="module")
def model(mikron: Scene) -> Iterator[WebModel]:
    with double_precision():
        limited = with_goal(mikron, minimise="mass", limits=("natural_frequency >= 90 %",))
        yield web_model(limited, usual_limits(mikron), 8.0)


def values_of(scene: Scene) -> np.ndarray:
    """A web with every kind of feature, none of them symmetric about the middle of the throw."""
    bevels, groove, boxes = (
        [47.0, 12.0, 1.5, 3.0, 9.0, -0.8],
        [6.0, 21.0, 1.0, 8.0],
        [13.0, 17.0, 9.0, 8.0, 5.0],
    )
    return np.array([*outline_start(scene, usual_limits(scene)), *bevels, *groove, *boxes])


@pytest.mark.parametrize(
    "case",
    [
        *(
            pytest.param(case, marks=pytest.mark.slow)
            for case in (None, rounded_web, round_side_web, round_groove_web)
        ),
        die_web,
    ],
    ids=["every feature", "drafted pockets", "round side pocket", "round groove", "drafted bevels"],
)
def test_gradients_of_every_quantity_are_those_of_differences(
    model: WebModel, mikron: Scene, case: Callable[[], tuple[Scene, Layout, np.ndarray]] | None
) -> None:
    layout, values = case()[1:] if case else (Layout(7, PARTS), values_of(mikron))
    values = values + np.random.default_rng(4).normal(0, 0.3, len(values))
    web = model.web(layout)
    quantities = (*QUANTITIES, "natural_frequency")
    found, step = model.responses(web, values, quantities), 1e-4
    for index, name in enumerate(web.layout.names):
        move = step * np.eye(len(values))[index]
        ahead, back = (model.responses(web, values + sign * move, ()).values for sign in (1, -1))
        for quantity in quantities:
            slope = (ahead[quantity] - back[quantity]) / (2 * step)
            scale = np.abs(found.gradients[quantity]).max()
            message = f"{quantity} by {name}"
            assert_allclose(
                found.gradients[quantity][index], slope, rtol=1e-4, atol=1e-4 * scale, err_msg=message
            )


def test_gradients_by_free_bores_are_those_of_differences(mikron: Scene) -> None:
    """Uneven bores, the pin's in a journal that is solid in the design."""
    data = mikron.model_dump(mode="json", exclude_none=True)
    data["throw"]["crankpin"]["bore_diameter_mm"] = 0.0
    data["shape"] = {"free": {"pin_bore_mm": [0.0, 30.0], "journal_bore_mm": [10.0, 30.0]}}
    scene = scene_from_dict(data)
    layout, values = with_free(Layout(7, PARTS), values_of(mikron), scene, ("pin_bore", "journal_bore"))
    assert list(layout.sizes(values)) == [pytest.approx(0.3 * 42), 24.0]
    values += np.random.default_rng(4).normal(0, 0.3, len(values))
    values[-2] = 19.0
    with double_precision():
        bored = web_model(scene, usual_limits(scene), 8.0)
        web = bored.web(layout)
        found, step = bored.responses(web, values, QUANTITIES), 1e-4
        for index in (8, len(values) - 2, len(values) - 1):
            move = step * np.eye(len(values))[index]
            ahead, back = (bored.responses(web, values + s * move, ()).values for s in (1, -1))
            for name in QUANTITIES:
                slope = (ahead[name] - back[name]) / (2 * step)
                told = f"{name} by {layout.names[index]}"
                scale = np.abs(found.gradients[name]).max()
                assert_allclose(
                    found.gradients[name][index], slope, rtol=1e-4, atol=1e-4 * scale, err_msg=told
                )
        solid = bored.responses(bored.web(Layout(7, PARTS)), values[:-2], ()).values["mass"]
    gone = np.pi / 4 * 19.0**2 * (19 + 18) * 2 * scene.material.density_kg_m3 * 1e-9
    assert solid - found.values["mass"] == pytest.approx(gone, rel=0.04)


@pytest.mark.slow
def test_mass_of_a_web_agrees_with_its_exact_solid(mikron: Scene) -> None:
    """The plain bar between the journals, whose volume is known in closed form, on cells of 3 mm."""
    from cranktopo.bodies.volume import web_volume_mm3

    with double_precision():
        fine = web_model(mikron, usual_limits(mikron), 3.0)
        web = fine.web(Layout(9))
        values = outline_start(mikron, usual_limits(mikron), 9)
        found = fine.responses(web, values, ()).values["mass"]
    from cranktopo.tasks.refit.family import web_of
    from cranktopo.tasks.refit.fit import scene_with_web

    exact = web_volume_mm3(scene_with_web(mikron, web_of(web.layout, values, mikron)))
    own = web_volume_mm3(mikron)
    change = 2 * (exact - own) * mikron.material.density_kg_m3 * 1e-9
    assert found - fine.original["mass"] == pytest.approx(change, abs=0.003)


def test_prices_of_a_problem_in_closed_form() -> None:
    """Least x + 2 y with x y >= 1: x = sqrt 2, y = 1 / sqrt 2; the limit costs sqrt 2."""
    x, y = np.sqrt(2), 1 / np.sqrt(2)
    none = np.zeros(0), np.zeros((0, 2))
    limit = np.array([1 - x * y]), np.array([[-y, -x]])
    found = multipliers(np.array([1.0, 2.0]), limit, none, (np.ones(2), np.ones(2)))
    assert found.limits == pytest.approx([np.sqrt(2)], rel=1e-12)
    assert found.remainder < 1e-12


def test_a_limit_that_is_not_active_has_no_price() -> None:
    rows = np.array([[-1.0, 0.0], [0.0, -1.0]])
    none = np.zeros(0), np.zeros((0, 2))
    found = multipliers(np.array([3.0, 0.0]), (np.array([0.0, -0.5]), rows), none, (np.ones(2), np.ones(2)))
    assert found.limits == pytest.approx([3.0, 0.0])


def test_a_search_makes_the_web_lighter_and_keeps_both_stiffnesses(model: WebModel, mikron: Scene) -> None:
    original = model.original
    limits = tuple(Constraint(name, ">=", original[name]) for name in ("torsion", "bending"))
    goal = SearchGoal("mass", 1.0, original["mass"], limits)
    layout = Layout(7, PARTS[:2])
    start = values_of(mikron)[: len(layout.names)]
    found, solved = search_on_cells(model, layout, start, goal, "a", StageMemory())
    assert found is not None
    assert solved <= 40
    assert found.objective < 0.96
    for limit in limits:
        assert found.responses.values[limit.quantity] >= 0.998 * limit.bound
    assert model.web(layout).constraints(found.values).max() < 6e-3


def test_a_web_that_cannot_be_solved_leaves_the_next_one_a_start(
    model: WebModel, mikron: Scene, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A solve takes the displacements that it starts from, also one that fails."""
    layout, webs = Layout(7, PARTS[:2]), model.webs()
    web, values = webs.web(layout), values_of(mikron)[: len(layout.names)]
    found = webs.responses(web, values, ("torsion",))
    with monkeypatch.context() as patched:
        patched.setattr(equilibrium, "METHODS", (replace(equilibrium.METHODS[0], cap=1),))
        with pytest.raises(CranktopoError, match="relative residual"):
            webs.responses(web, values + 0.5, ("torsion",))
    again = webs.responses(web, values, ("torsion",))
    assert again.values["torsion"] == pytest.approx(found.values["torsion"], rel=1e-4)


@pytest.mark.slow
def test_a_price_predicts_the_optimum_of_a_limit_moved_by_one_percent(model: WebModel, mikron: Scene) -> None:
    original, layout = model.original, Layout(7, PARTS[:2])

    def optimum(torsion: float, start: np.ndarray) -> tuple[SearchResult, SearchGoal]:
        shares = {"torsion": torsion, "bending": 1.0}
        limits = tuple(Constraint(name, ">=", share * original[name]) for name, share in shares.items())
        goal = SearchGoal("mass", 1.0, original["mass"], limits)
        found, _ = search_on_cells(model, layout, start, goal, "a", StageMemory(), 60)
        assert found is not None
        return found, goal

    found, _ = optimum(1.1, values_of(mikron)[: len(layout.names)])
    found, goal = optimum(1.1, found.values)
    paid = multipliers_of(mikron, model.web(layout), found.values, found.responses, goal)
    assert paid.remainder < 0.05
    tighter, _ = optimum(1.1 * 1.01, found.values)
    assert tighter.objective - found.objective == pytest.approx(0.01 * paid.limits[0], rel=0.2)


def test_a_search_that_is_kept_is_not_done_again(model: WebModel, mikron: Scene) -> None:
    goal = SearchGoal("mass", 1.0, model.original["mass"], (Constraint("bending", ">=", 1.0),))
    layout, start = Layout(7), outline_start(mikron, usual_limits(mikron))
    work = StageMemory()
    first, _ = search_on_cells(model, layout, start, goal, "a", work, 6)
    again, _ = search_on_cells(model, layout, start + 1.0, goal, "a", StageMemory(kept=dict(work.kept)), 6)
    assert first is not None
    assert again is not None
    assert first.values.tobytes() == again.values.tobytes()
    assert first.responses.values == again.responses.values


def test_limits_that_no_web_keeps_end_without_a_web(model: WebModel, mikron: Scene) -> None:
    impossible = (Constraint("torsion", ">=", 3 * model.original["torsion"]),)
    goal = SearchGoal("mass", 1.0, model.original["mass"], impossible)
    found, _ = search_on_cells(
        model, Layout(7), outline_start(mikron, usual_limits(mikron)), goal, "a", StageMemory(), 12
    )
    assert found is None


@pytest.mark.slow
def test_a_web_stays_inside_a_narrow_envelope(mikron: Scene) -> None:
    data = mikron.model_dump(mode="json", exclude_none=True)
    data["envelope"] |= {"half_width_mm": 27.0}
    narrow = scene_from_dict(data)
    with double_precision():
        small = web_model(narrow, usual_limits(narrow), 8.0)
        goal = SearchGoal("torsion", -1.0, small.original["torsion"], ())
        found, _ = search_on_cells(
            small, Layout(7), outline_start(narrow, usual_limits(narrow)), goal, "a", StageMemory(), 20
        )
    assert found is not None
    points, _ = small.web(found.layout).points(found.values)
    assert 26.5 < points[:, 0].max() <= 27.0
