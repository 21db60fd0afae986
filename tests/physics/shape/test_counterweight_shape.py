"""A free counterweight in the shape optimisation: masses by formula, gradients by differences."""

from __future__ import annotations

import math
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from cranktopo.base.errors import CranktopoError
from cranktopo.base.spans import holds
from cranktopo.bodies.cells.domain import build_domain
from cranktopo.bodies.cells.outside import without_counterweight
from cranktopo.design.free_dimensions import moved_ranges_text, with_dimensions
from cranktopo.design.goal.limit import Goal, Limit
from cranktopo.design.loading import scene_from_dict
from cranktopo.design.schema import Scene
from cranktopo.engine.balance.throw import throw_balance
from cranktopo.numerics.precision import double_precision
from cranktopo.tasks.bound import stage
from cranktopo.tasks.bound.lower_bound import bound_model
from cranktopo.tasks.bound.result import BoundStatement, NoBound
from cranktopo.tasks.refit.family import Layout, exact_web_of, free_dimensions, scene_at, with_free
from cranktopo.tasks.refit.fit import scene_with_web, usual_limits
from cranktopo.tasks.refit.model_fill import FILLET, FITS
from cranktopo.tasks.refit.parametric_web import ParametricWeb
from cranktopo.tasks.throw_fea.evaluation import evaluate_on_mesh
from cranktopo.tasks.throw_fea.targets import Target
from cranktopo.tasks.web_shape import run
from cranktopo.tasks.web_shape.mesh_model import MeshModel
from cranktopo.tasks.web_shape.rules import rules_at
from cranktopo.tasks.web_shape.start import scene_start
from cranktopo.throw.fitted_pocket import FittedBox
from cranktopo.throw.web import web_bodies, web_spans
from tests.unit.throw.counterweight_cases import PLAIN, roomy_scene, weighted

FREE = {"counterweight_radius_mm": [50.0, 80.0], "counterweight_angle_deg": [40.0, 90.0]}


@pytest.fixture(scope="module")
def free(mikron: Scene) -> Scene:
    data = weighted(roomy_scene(mikron), PLAIN).model_dump(mode="json", exclude_none=True)
    return scene_from_dict({**data, "shape": {"free": FREE}}, "free")


def ring(outer: float, inner: float, degrees: float, density: float) -> dict[str, tuple[float, float]]:
    """Derivatives of both counterweights' mass, unbalance, inertia by radius, per mm, and angle, per deg."""
    angle, kg, deg = math.radians(degrees), 2 * 19.0 * density * 1e-9, math.radians(1)
    sine, cosine = math.sin(angle), math.cos(angle)
    return {
        "mass": (kg * 2 * angle * outer, kg * (outer**2 - inner**2) * deg),
        "unbalance": (-kg * 2 * sine * outer**2, -kg * 2 / 3 * cosine * (outer**3 - inner**3) * deg),
        "inertia": (kg * 2 * angle * outer**3, kg / 2 * (outer**4 - inner**4) * deg),
    }


def test_mesh_moves_with_the_counterweight(free: Scene) -> None:
    """Masses by the ring sector's formula, torsion by differences of the very same mesh."""
    start = scene_start(free, usual_limits(free))
    layout, values = with_free(start.layout, start.values, free, free_dimensions(free))
    assert layout.names[-2:] == ("counterweight_radius", "counterweight_angle")
    model = MeshModel(free, layout, values, 14.0)
    assert model.moved.distances_mm(model.moved.mesh.points_mm, values).max() < 1e-9
    found = model.responses(values, ("torsion",))
    # The sampled outline is not round about the crank axis to the last digit: the inner radius is near 25.
    for name, expected in ring(62.0, 25.0, 60.0, free.material.density_kg_m3).items():
        assert found.gradients[name][-2] == pytest.approx(expected[0], rel=1e-5), name
        assert found.gradients[name][-1] == pytest.approx(expected[1], rel=2e-2), name
    step = 1e-2 * np.eye(len(values))[-1]
    above, below = (model.responses(values + s * step, ("torsion",)).values["torsion"] for s in (1, -1))
    assert found.gradients["torsion"][-1] == pytest.approx((above - below) / 2e-2, rel=1e-4)


def test_cells_follow_the_counterweight(free: Scene) -> None:
    """Signed distances of cells: where they count, of which sign, and their derivatives by differences."""
    limits = usual_limits(free)
    start = scene_start(free, limits)
    layout, values = with_free(start.layout, start.values, free, free_dimensions(free))
    axes = np.arange(1.1, 75.0, 4.0), np.arange(-73.3, 80.0, 4.0), np.arange(21.5, 39.0, 4.0)
    web = ParametricWeb(layout, free, limits, axes)
    inside, which = web.inside_mm(values)
    x, y = axes[0][:, None], axes[1][None, :]
    beyond = (np.hypot(x, y) > 27.0) & (y < 0)
    in_sector = (np.hypot(x, y) < 62.0) & (np.arctan2(x, -y) < math.radians(60.0))
    np.testing.assert_array_equal(inside[beyond] > 0, np.repeat(in_sector[beyond][:, None], len(axes[2]), 1))
    weight = np.random.default_rng(3).normal(size=inside.shape) * (np.abs(inside) < 6.0)
    slopes = web.vjp(values, which, weight)
    for k in (2, -2, -1):
        step = 1e-5 * np.eye(len(values))[k]
        change = [(weight * web.inside_mm(values + s * step)[0]).sum() for s in (1, -1)]
        assert slopes[k] == pytest.approx((change[0] - change[1]) / 2e-5, rel=1e-4), k
    assert rules_at(free, web, values).violated == ()
    values[-2] = 76.0
    assert rules_at(free, web, values).violated == ("room of the envelope",)


def test_the_proof_may_fill_every_counterweight_of_the_range(free: Scene) -> None:
    """All that the range allows in the envelope lies in cells that any web may fill, or that all have."""
    domain = build_domain(without_counterweight(free), 8.0)
    room, filled = domain.passive_fraction + domain.design_fraction, []
    for radius, angle in ((50.0, 40.0), (62.0, 60.0), (74.9, 40.0), (74.9, 90.0)):
        one = with_dimensions(free, {"counterweight_radius": radius, "counterweight_angle": angle})
        own = build_domain(one, 8.0, "web", domain.extent, domain.grid).passive_fraction
        assert (own <= room + 1e-9).all()
        filled.append(own.sum())
    assert filled[0] < filled[1] < filled[3]


LIGHT = Goal("minimise", "mass", (Limit("torsion", ">=", 90.0, percent=True),))


def test_a_free_counterweight_leaves_the_bound_to_the_proof(
    free: Scene, monkeypatch: pytest.MonkeyPatch
) -> None:
    def proof(*_: object) -> None:
        raise CranktopoError("a failed solve")

    monkeypatch.setattr(stage, "bound_model", proof)
    assert stage.bound_for_goal(free, LIGHT, 8.0, {}) == NoBound(none="a failed solve")


@pytest.mark.slow
def test_the_bound_beside_a_free_counterweight_is_that_of_the_design(free: Scene) -> None:
    with double_precision():
        found, own = (
            stage.bound_for_goal(scene, LIGHT, 8.0, {})
            for scene in (free, free.model_copy(update={"shape": type(free.shape)()}))
        )
    assert isinstance(found, BoundStatement)
    assert found == own


def of_balance(scene: Scene) -> tuple[Limit, ...]:
    """Limits that keep a throw's unbalance within 1 kg mm."""
    own = throw_balance(scene).throw_unbalance_kg_mm
    return Limit("unbalance", ">=", own - 1.0), Limit("unbalance", "<=", own + 1.0)


def test_shape_has_limits_of_the_unbalance_proven(free: Scene, monkeypatch: pytest.MonkeyPatch) -> None:
    """Those in kg mm, by which it keeps the balance, were left out without a word."""
    asked, goal = list[Goal](), replace(LIGHT, limits=(*LIGHT.limits, *of_balance(free)))

    def bound(scene: Scene, goal: Goal, *_: object) -> NoBound:
        asked.append(goal)
        return NoBound(none="not asked for")

    monkeypatch.setattr(run, "bound_for_goal", bound)
    run._bound(free, goal, 8.0, {}, SimpleNamespace(once=lambda _, made: made()))
    assert asked == [goal]


@pytest.mark.slow
def test_a_kept_balance_makes_the_bound_tighter(free: Scene) -> None:
    own, found = {"unbalance": throw_balance(free).throw_unbalance_kg_mm}, list[float]()
    for limits in ((), of_balance(free)):
        with double_precision():
            goal = replace(LIGHT, limits=(*LIGHT.limits, *limits))
            bound = stage.bound_for_goal(free, goal, 8.0, own)
        assert isinstance(bound, BoundStatement)
        assert bound.percent_of_original is not None
        found.append(bound.percent_of_original)
    assert found[1] > found[0] + 5.0


@pytest.mark.slow
def test_cells_misjudge_the_unbalance_of_every_web_alike(free: Scene) -> None:
    """They lack the same of journals and fillets, whatever the web: a limit moves by it."""
    errors = []
    for change in ({}, {"counterweight_radius": 50.0}):
        scene = with_dimensions(free, change)
        with double_precision():
            cells = bound_model(scene, 8.0).original.quantities["unbalance"]
        errors.append(cells - throw_balance(scene).throw_unbalance_kg_mm)
    assert abs(errors[0]) > 0.05
    assert errors[1] == pytest.approx(errors[0], abs=0.01)


def test_a_free_thickness_rules_the_bound_out_and_is_named(free: Scene) -> None:
    data = free.model_dump(mode="json", exclude_none=True)
    other = scene_from_dict({**data, "shape": {"free": {**FREE, "web_thickness_mm": [15.0, 20.0]}}}, "other")
    found = stage.bound_for_goal(other, LIGHT, 8.0, {})
    assert isinstance(found, NoBound)
    assert found.none.startswith("web_thickness: free, and the bound is about webs of one thickness")


def test_the_web_of_a_free_counterweight_keeps_it(free: Scene) -> None:
    start = scene_start(free, usual_limits(free))
    again = scene_with_web(free, exact_web_of(start.layout, start.values, free))
    assert again.web.counterweight == free.web.counterweight


FILLETED = {**PLAIN, "fillet_mm": 6.0}


@pytest.fixture(scope="module")
def filleted(free: Scene) -> Scene:
    data = weighted(free, FILLETED).model_dump(mode="json", exclude_none=True)
    return scene_from_dict({**data, "shape": {"free": FREE}}, "filleted")


@pytest.fixture(scope="module")
def filleted_web(filleted: Scene) -> tuple[Layout, np.ndarray]:
    start = scene_start(filleted, usual_limits(filleted))
    return with_free(start.layout, start.values, filleted, free_dimensions(filleted))


def test_cells_follow_the_fillet(filleted: Scene, filleted_web: tuple[Layout, np.ndarray]) -> None:
    """Cells are filled as the scene's bodies are; derivatives by outline and angle by differences."""
    layout, values = filleted_web
    axes = np.arange(0.3, 75.0, 3.0), np.arange(-73.3, 80.0, 3.0), np.array([25.0, 30.0])
    web = ParametricWeb(layout, filleted, usual_limits(filleted), axes)
    inside, which = web.inside_mm(values)
    assert (which == FILLET).sum() > 10
    exact = scene_with_web(filleted, exact_web_of(layout, values, filleted))
    sampled = exact.model_copy(update={"web": exact.web.model_copy(update={"bevel": (), "pocket": ()})})
    added = [body for body in web_bodies(sampled) if body.adds]
    spans = list(zip(*web_spans(added, axes[1], np.full_like(axes[1], 25.0)), strict=True))
    here = holds(spans, axes[0][:, None])
    clear = np.abs(inside[:, :, 0]) > 0.1  # the outline of the cells is made of chords
    np.testing.assert_array_equal((inside[:, :, 0] > 0)[clear], here[clear])
    weight = np.random.default_rng(4).normal(size=inside.shape) * (np.abs(inside) < 3.0) * (which == FILLET)
    slopes = web.vjp(values, which, weight)
    rule = rules_at(filleted, web, values)
    assert rule.violated == ()
    place = rule.names.index(FITS)
    for k in (0, 2, -2, -1):
        step = 1e-5 * np.eye(len(values))[k]
        above, below = (values + s * step for s in (1, -1))
        change = [(weight * web.inside_mm(v)[0]).sum() for v in (above, below)]
        assert slopes[k] == pytest.approx((change[0] - change[1]) / 2e-5, rel=1e-5, abs=1e-6), k
        excess = [web.constraints(v)[place] for v in (above, below)]
        assert rule.gradients[place, k] == pytest.approx(
            (excess[0] - excess[1]) / 2e-5, rel=1e-5, abs=1e-7
        ), k
    assert np.abs(slopes[[2, -1]]).min() > 0.1
    values = values.copy()
    values[-2] = 18.0
    assert FITS in rules_at(filleted, web, values).violated


@pytest.mark.slow
def test_mesh_follows_the_fillet(filleted: Scene, filleted_web: tuple[Layout, np.ndarray]) -> None:
    """Every node of fillet and flank stays on it; the mass's derivatives by exact moments.

    Slow: `python -m pytest -m slow tests/physics/shape/test_counterweight_shape.py`.
    """
    layout, values = filleted_web
    model = MeshModel(filleted, layout, values, 14.0)
    # The edge node of an element that was straightened to be sound may be off its arc by up to 1e-3 mm.
    assert model.moved.distances_mm(model.moved.mesh.points_mm, values).max() < 1e-3
    found = model.responses(values, ())

    def kg(values: np.ndarray) -> float:
        moved = scene_at(filleted, layout, values)
        return throw_balance(scene_with_web(moved, exact_web_of(layout, values, moved))).mass_kg

    for name in ("half_width_1", "counterweight_angle"):
        k = layout.names.index(name)
        step = 1e-4 * np.eye(len(values))[k]
        exact = (kg(values + step) - kg(values - step)) / 2e-4
        assert found.gradients["mass"][k] == pytest.approx(exact, rel=2e-2), name
    moved = values + 0.3 * np.eye(len(values))[-1] - 0.2 * np.eye(len(values))[2]
    mesh = model.moved.at(moved)
    assert model.moved.distances_mm(mesh.points_mm, moved).max() < 2e-3


@pytest.mark.slow
def test_a_fillet_stiffens(free: Scene, filleted: Scene) -> None:
    """Material added at the corner: no stiffness of the body-fitted throw falls.

    Slow: `python -m pytest -m slow tests/physics/shape/test_counterweight_shape.py`.
    """
    sharp, rounded = (
        evaluate_on_mesh(Target(scene.name, scene), 7.0).stiffness for scene in (free, filleted)
    )
    for before, after in ((sharp.torsion, rounded.torsion), (sharp.bending, rounded.bending)):
        for support, value in before.items():
            now = after[support]
            assert value is None or (now is not None and now > (1 - 2e-3) * value), support


REFUSED = {
    "none": ({}, r"counterweight_radius_mm.*no counterweight"),
    "bolted": ({**PLAIN, "density_kg_m3": 9000.0}, r"counterweight_radius_mm.*part of its own"),
    "outside its range": ({**PLAIN, "outer_radius_mm": 48.0}, r"must hold the design's own value.*48 mm"),
}


@pytest.mark.parametrize("name", REFUSED)
def test_refused(name: str, mikron: Scene) -> None:
    counterweight, message = REFUSED[name]
    bare = roomy_scene(mikron)
    scene = weighted(bare, counterweight) if counterweight else bare
    data = scene.model_dump(mode="json", exclude_none=True)
    with pytest.raises(CranktopoError, match=message):
        scene_from_dict({**data, "shape": {"free": FREE}}, "refused")


@pytest.mark.parametrize(
    ("key", "value", "message"),
    [
        ("counterweight_radius_mm", [24.0, 70.0], r"its least gives.*adds nothing"),
        ("counterweight_angle_deg", [2.0, 70.0], r"least must be at least 5 deg"),
        ("counterweight_angle_deg", [40.0, 100.0], r"both must be >= 0 and <= 90 deg"),
    ],
)
def test_ranges_are_refused(free: Scene, key: str, value: list[float], message: str) -> None:
    data = free.model_dump(mode="json", exclude_none=True)
    with pytest.raises(CranktopoError, match=message):
        scene_from_dict({**data, "shape": {"free": {**FREE, key: value}}}, "refused")


def test_ranges_begin_where_a_wider_web_leaves_the_counterweight_something(free: Scene) -> None:
    """A re-model 104 mm wide holds all of a counterweight of 50 mm; its scene is one that can be read."""
    web = free.web.model_dump(mode="json", exclude_none=True) | {"width_mm": 104.0}
    assert web["outline"] == "obround"
    found = scene_with_web(free, web)
    low, high = found.shape.free.counterweight_radius_mm
    assert low == pytest.approx(52.0, abs=0.02)
    assert high == 80.0
    assert found.shape.free.counterweight_angle_deg == (40.0, 90.0)
    text = moved_ranges_text(found, free)
    assert text.startswith(f"shape.free.counterweight_radius_mm begins at {low:g} instead of 50")
    assert scene_from_dict(found.model_dump(mode="json", exclude_none=True), "again") == found
    assert scene_with_web(free, web | {"width_mm": 90.0}).shape == free.shape
    assert not moved_ranges_text(free, free)


def test_pockets_keep_a_wall_to_the_edge_of_the_counterweight(free: Scene) -> None:
    """A pocket in its middle is fine, one across its flank or its rim is not."""
    limits = usual_limits(free)
    start = scene_start(free, limits)
    layout = Layout(start.layout.stations, (FittedBox("pin", True),))
    axes = np.arange(1.1, 75.0, 8.0), np.arange(-73.3, 80.0, 8.0), np.arange(21.5, 39.0, 8.0)
    web = ParametricWeb(layout, free, limits, axes)
    rule = "least wall between the box pocket of the pin face and the counterweight's edge, 3 mm"
    for (x, y), broken in (((12.0, -42.0), False), ((30.0, -22.0), True), ((12.0, -58.0), True)):
        values = np.concatenate([start.values, [x, y, 8.0, 8.0, 5.0]])
        assert (rule in rules_at(free, web, values).violated) == broken, (x, y)
