"""The bounds that settle most points are bounds, and what they leave out changes no least safety."""

from __future__ import annotations

import numpy as np
import pytest

from cranktopo.base.arrays import Array
from cranktopo.design.loading import load_scene
from cranktopo.numerics.enclosing_balls import enclosing_balls
from cranktopo.tasks.fatigue.criteria import PLANE_METHODS, safety_method
from cranktopo.tasks.fatigue.dang_van import mesoscopic
from cranktopo.tasks.fatigue.plane_criterion import PlaneCriterion
from cranktopo.tasks.fatigue.plane_field import corner_states, histories, history_bounds, least_safety
from cranktopo.tasks.fatigue.planes import half_sphere, on_planes

SCENE = load_scene("mikron-iiic-plain")
METHODS = list(PLANE_METHODS)
SEEDS = [0, *(pytest.param(seed, marks=pytest.mark.slow) for seed in (1, 2, 3))]


def method_named(name: str) -> PlaneCriterion:
    found = safety_method(name)
    assert isinstance(found, PlaneCriterion)
    return found


def random_fields(seed: int, points: int = 80, kind: str = "any") -> tuple[Array, Array]:
    """Unit stresses (3, n, 6) of points, and loads (60, 3) on a closed path with a mean."""
    rng = np.random.default_rng(seed)
    stress = rng.normal(size=(3, points, 6))
    if kind == "tension":
        stress[..., 1:] = 0.0
    if kind == "shear":
        stress[..., :3] = 0.0
    turn = np.linspace(0.0, 2 * np.pi, 60, endpoint=False)
    loads = np.stack([np.cos(turn), np.sin(2 * turn + 1.0), np.sin(turn)], axis=1) + rng.normal(size=3)
    return stress, loads


@pytest.mark.parametrize("kind", ["any", "tension", "shear"])
@pytest.mark.parametrize("seed", SEEDS)
def test_no_plane_exceeds_the_bounds(seed: int, kind: str) -> None:
    stress, loads = random_fields(seed, kind=kind)
    bounds, history = history_bounds(stress, loads), histories(stress, loads)
    normal, shear = on_planes(history, half_sphere(150))
    radius = enclosing_balls(shear.reshape(-1, *shear.shape[2:]))[1].reshape(normal.shape[:2])
    grains, hydrostatic = mesoscopic(history)
    slack = 1 + 1e-9
    assert (radius.max(axis=1) <= bounds.shear_MPa * slack).all()
    assert (grains.max(axis=1) <= bounds.shear_MPa * slack).all()
    assert (normal.max(axis=(1, 2)) <= bounds.normal_MPa * slack).all()
    assert hydrostatic.max(axis=1) == pytest.approx(bounds.hydrostatic_MPa)


def test_the_bounds_are_sharp_in_pure_shear_and_in_tension() -> None:
    loads = np.array([[1.0], [-1.0], [0.3]])
    shear = np.array([[[0.0, 0, 0, 5.0, 0, 0]]])
    tension = np.array([[[5.0, 0, 0, 0, 0, 0]]])
    assert history_bounds(shear, loads).shear_MPa == pytest.approx(5.0)
    assert history_bounds(tension, loads).normal_MPa == pytest.approx(5.0)


@pytest.mark.parametrize("name", METHODS)
@pytest.mark.parametrize("seed", SEEDS)
def test_at_most_is_at_least_the_severity(name: str, seed: int) -> None:
    stress, loads = random_fields(seed)
    chosen = method_named(name)
    most = chosen.at_most_MPa(SCENE, history_bounds(stress, loads))
    assert (chosen.severity(SCENE, histories(stress, loads)).equivalent_MPa <= most * (1 + 1e-9)).all()


@pytest.mark.parametrize(
    "name", [pytest.param(n, marks=[pytest.mark.slow] * (n == "findley")) for n in METHODS]
)
def test_the_least_safety_is_that_of_all_points(name: str) -> None:
    """Of every part and both images the least safety is found, and nowhere is more told than there is."""
    stress, loads = random_fields(7, points=400)
    chosen, rng = method_named(name), np.random.default_rng(0)
    cycles = [loads, loads * np.array([1.0, -1.0, 1.0])]
    strength = rng.uniform(5.0, 9.0, size=(2, 400))
    first = np.arange(400) < 150
    found = least_safety(stress, cycles, strength, [first, ~first], chosen, SCENE)
    full = np.stack([chosen.severity(SCENE, histories(stress, own)).equivalent_MPa for own in cycles])
    safety = strength / full
    for part in (first, ~first):
        assert found[:, part].min() == pytest.approx(safety[:, part].min(), rel=1e-9)
        assert found[:, part].argmin() == safety[:, part].argmin()
    assert (found <= safety * (1 + 1e-9)).all()
    assert (found < safety * (1 - 1e-3)).any()


def test_states_inside_the_hull_are_left_out() -> None:
    turn = np.linspace(0.0, 2 * np.pi, 90, endpoint=False)
    ring = np.stack([1e4 * np.cos(turn), 3e6 * np.sin(turn), np.full(90, 7e4)], axis=1)
    inside = 0.4 * (ring - ring.mean(axis=0)) + ring.mean(axis=0)
    assert (corner_states(np.concatenate([inside, ring])) == np.arange(90, 180)).all()
    line = np.outer(np.sin(turn), [2.0, -3.0, 0.0]) + 5.0
    assert sorted(line[corner_states(line), 0]) == pytest.approx([line[:, 0].min(), line[:, 0].max()])
    assert list(corner_states(np.full((9, 3), 2.0))) == [0]
    four = np.array([[1.0, 2, 0], [1, 5, 0], [4, 2, 0], [4, 5, 0]])
    assert list(corner_states(four)) == [0, 1, 2, 3]
    many = np.random.default_rng(0).normal(size=(30, 6))
    assert list(corner_states(many)) == list(range(30))


@pytest.mark.parametrize("name", METHODS)
def test_corner_states_are_as_severe_as_all(name: str) -> None:
    stress, curve = random_fields(4, points=6)
    chosen, middle = method_named(name), curve.mean(axis=0)
    loads = np.concatenate([middle + 0.5 * (curve - middle), curve])
    kept = loads[corner_states(loads)]
    assert len(kept) < len(loads)
    one, other = (chosen.severity(SCENE, histories(stress, some)).equivalent_MPa for some in (loads, kept))
    assert other == pytest.approx(one, rel=1e-9)
