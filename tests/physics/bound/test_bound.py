"""The bound: nothing beats it, it is tight, and a bad proof is only looser."""

from __future__ import annotations

from collections.abc import Iterator

import jax.numpy as jnp
import numpy as np
import pytest
from numpy.typing import NDArray

from cranktopo.bodies.cells.domain import build_domain
from cranktopo.design.goal.constraint import Constraint
from cranktopo.design.goal.scene_goal import goal_of, with_goal
from cranktopo.design.loading import builtin_designs, load_scene, scene_from_dict
from cranktopo.design.schema import Scene
from cranktopo.numerics.precision import double_precision
from cranktopo.tasks.bound.certificate import (
    LinearUnderestimator,
    best_certificate,
    energies,
    underestimator_of,
)
from cranktopo.tasks.bound.lower_bound import Bound, BoundModel, bound_model, next_densities, prove
from cranktopo.tasks.bound.stage import stiffest, stiffness_percent
from cranktopo.tasks.bound.webs import STIFFNESSES
from cranktopo.tasks.density.material import CONTRAST
from cranktopo.tasks.density.response import solve
from tests.physics.bound.bound_cases import (
    loaded_bar,
    own_body,
    pressed,
    quantities_of,
    quantities_of_body,
    random_blobs,
    random_webs,
    simp_density,
)
from tests.physics.density.throw_cases import forged
from tests.studies.bound_proof import THROWS, Judged, cells_of, judged_webs, proven, stay_above, throw_of

Array = NDArray[np.float64]
CELL_MM = 4.5


def found(scene: Scene, model: BoundModel, limits: tuple[str, ...] = (), **goal: str) -> Bound:
    goal_found = goal_of(with_goal(scene, limits=limits, **goal))
    assert goal_found is not None
    return prove(model, goal_found)


@pytest.fixture(scope="module")
def model(mikron: Scene) -> Iterator[BoundModel]:
    with double_precision():
        yield bound_model(mikron, CELL_MM)


@pytest.fixture(scope="module")
def lightest(mikron: Scene, model: BoundModel) -> Bound:
    return found(mikron, model, minimise="mass")


@pytest.fixture(scope="module")
def planes(model: BoundModel, lightest: Bound) -> tuple[LinearUnderestimator, LinearUnderestimator]:
    """What good displacements prove, and those of a uniform density."""
    bad = model.solved(np.full(model.webs.design.shape, 0.5), None, 1e-3)
    return model.underestimator(lightest.displacements), model.underestimator(bad)


@pytest.fixture(scope="module")
def made(mikron: Scene, model: BoundModel) -> list[Array]:
    """Quantities of webs of every kind, over the original's."""
    webs = [quantities_of(model, random_blobs(model, seed), 1.0 + seed % 3) for seed in range(2)]
    webs += [quantities_of(model, fill) for fill in random_webs(model, 2, 3)]
    webs += [
        quantities_of(model, simp_density(mikron, model, p, volume_fraction=v), p) for v, p in ((0.3, 3.0),)
    ]
    return [*webs, quantities_of_body(model, own_body(model))]


def test_no_web_beats_the_inequality(
    planes: tuple[LinearUnderestimator, LinearUnderestimator], made: list[Array]
) -> None:
    """With no weights, and no tolerance: rounding is in the bound."""
    draw = np.random.default_rng(0)
    for plane in planes:
        for _ in range(30):
            weights = draw.exponential(size=5) * [1, 1, 1, 1, draw.choice([-1, 0, 1])]
            least = plane.minimum(weights)[0]
            assert all(least <= weights @ web for web in made)


def test_no_web_is_lighter_than_the_lightest(lightest: Bound, made: list[Array], model: BoundModel) -> None:
    as_stiff = [web for web in made if max(web[:2]) <= 1.0]
    assert as_stiff
    original = model.original.quantities["mass"]
    assert lightest.value is not None
    assert all(lightest.value <= original * web[2] for web in as_stiff)
    assert 0.97 * lightest.reached < lightest.value <= lightest.reached * (1 + 1e-3) < original


def test_a_bad_proof_is_a_proof(
    planes: tuple[LinearUnderestimator, LinearUnderestimator], lightest: Bound
) -> None:
    goal, constraints = np.array([0.0, 0.0, 1.0, 0.0, 0.0]), lightest.problem.constraints
    good, bad = (
        best_certificate(plane, goal, constraints, np.ones(len(constraints))).value for plane in planes
    )
    assert 0 < bad < 0.98 * good


@pytest.mark.slow
def test_stiffness_at_a_mass_and_per_mass(mikron: Scene, model: BoundModel, made: list[Array]) -> None:
    torsion = found(mikron, model, ("bending none", "mass <= 100 %"), maximise="torsion")
    per_mass = found(mikron, model, maximise="torsion_per_mass")
    own = model.original.quantities
    case = model.model.case_names.index("torsion")
    assert torsion.value is not None
    assert per_mass.value is not None
    for web in made:
        if web[2] <= 1.0:
            assert own["torsion"] / web[case] <= torsion.value
            if web[1 - case] <= 1.0:
                assert own["torsion_per_mass"] / (web[case] * web[2]) <= per_mass.value
    assert own["torsion"] < torsion.reached < torsion.value < 1.03 * torsion.reached
    assert own["torsion_per_mass"] < per_mass.reached < per_mass.value < 1.04 * per_mass.reached


@pytest.mark.slow
def test_no_web_is_above_the_curve_over_the_mass(mikron: Scene, model: BoundModel, made: list[Array]) -> None:
    """From the displacements of one bound, at every other mass."""
    for name in STIFFNESSES:
        bound, case = prove(model, stiffest(name, 95.0)), model.model.case_names.index(name)
        percent = [100 * web[2] for web in made]
        for web, most in zip(made, stiffness_percent(model, bound, percent), strict=True):
            assert most is not None
            assert 100 / web[case] <= most
        assert stiffness_percent(model, bound, [1.0, 95.0]) == [None, pytest.approx(bound.percent, rel=1e-3)]


def test_what_no_web_reaches_is_refuted(mikron: Scene, model: BoundModel) -> None:
    assert found(mikron, model, ("torsion >= 400 %",), minimise="mass").value is None


@pytest.mark.slow
def test_a_die_leaves_less(mikron: Scene, lightest: Bound) -> None:
    scene = forged(mikron)
    with double_precision():
        model = bound_model(scene, CELL_MM)
        die = found(scene, model, minimise="mass")
        plane = model.underestimator(die.displacements)
        webs = [quantities_of(model, pressed(scene, model, seed), 2.0) for seed in range(4)]
        assert model.webs.die is not None
        assert die.value is not None
        assert lightest.value is not None
        assert die.value > lightest.value
        for weights in np.random.default_rng(1).exponential(size=(20, 5)):
            assert all(plane.minimum(weights)[0] <= weights @ web for web in webs)


def test_a_pocket_in_the_counterweight_is_among_the_webs(monkeypatch: pytest.MonkeyPatch) -> None:
    """A density keeps the sector solid, a search over dimensions does not; one bound judges both."""
    monkeypatch.setattr("cranktopo.tasks.bound.lower_bound.assess_original", lambda *_: None)
    pocket = {"shape": "box", "face": "pin", "y_mm": -48.0, "x_mm": 14.0, "depth_mm": 8.0}
    scene = load_scene("car-diesel")
    data = scene.model_dump(mode="json", exclude_none=True, by_alias=True)
    data["web"]["pocket"] = [{**pocket, "size_x_mm": 20.0, "size_y_mm": 12.0}]
    pocketed = scene_from_dict(data)
    with double_precision():
        model = bound_model(scene, CELL_MM)
    domain = model.domain
    own = own_body(model)
    web = build_domain(pocketed, CELL_MM, "web", domain.extent, domain.grid).passive_fraction
    room = model.webs.fixed.copy()
    room[:, :, model.webs.layers] += model.webs.design
    assert own.sum() - web.sum() > 5.0
    for fill in (own, web):
        assert (fill >= model.webs.fixed - 1e-9).all()
        assert (fill <= room + 1e-9).all()


def test_the_best_bar_is_known() -> None:
    """Layers under different forces: the bound comes from below and within 1 % of the closed form."""
    with double_precision():
        model, webs, least = loaded_bar()
        density = np.full(webs.design.shape, 0.5)
        constraints = [Constraint("mass", "<=", webs.design.sum() / 4)]
        weights, goal = np.ones(1), np.array([1.0, 0.0])
        for _ in range(12):
            moduli = jnp.asarray(CONTRAST + (1 - CONTRAST) * density)
            u = solve(model, moduli, tolerance=1e-8).displacements
            plane = underestimator_of(webs, ("end",), energies(model, webs, u), {"mass": 1.0}, {"end": 1.0})
            proof = best_certificate(plane, goal, constraints, weights)
            assert proof.value <= least
            density, weights = next_densities(plane, 1, density, goal, constraints, weights)
        assert proof.value > 0.99 * least


@pytest.mark.slow
@pytest.mark.parametrize("name", THROWS)
def test_two_hundred_webs_stay_below_the_bound(name: str) -> None:
    """`python -m pytest -m slow tests/physics/bound/test_bound.py -k two_hundred`"""
    with double_precision():
        scene = throw_of(name)
        model = cells_of(scene)
        webs = list(judged_webs(scene, model))
        assert len(webs) >= 200
        assert stay_above(model, np.full(model.webs.design.shape, 0.5), webs)
        for goal in proven(scene, model, webs):
            assert goal.holds
            assert len(goal.told) > 1
            assert stay_above(model, goal.bound.density, webs)


@pytest.mark.slow
@pytest.mark.parametrize("name", [name for name in builtin_designs() if load_scene(name).envelope])
def test_no_built_in_web_beats_its_bound(name: str) -> None:
    with double_precision():
        scene = throw_of(name)
        model = cells_of(scene)
        own = Judged("original", quantities_of_body(model, own_body(model)))
        for goal in proven(scene, model, [own]):
            assert goal.holds
            assert goal.told
            assert stay_above(model, goal.bound.density, [own])
