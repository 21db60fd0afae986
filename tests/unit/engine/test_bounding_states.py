"""Few states of a cycle that bound it: no sum of the loads ranges noticeably farther over all of them."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from cranktopo.base.arrays import Array
from cranktopo.design.loading import load_scene, scene_from_dict
from cranktopo.design.named import with_values
from cranktopo.engine.bounding_states import SHORTFALL, bounding_states
from cranktopo.engine.forces import INERTIA_EFFECTS
from cranktopo.engine.histories import LoadHistory, cycle_histories, rated_histories
from cranktopo.engine.judged_histories import histories_by_speed
from cranktopo.engine.plan.planning import plan_for_stress, stress_left_off
from cranktopo.tasks.throw_fatigue.needs import alone_left_off, load_kinds
from tests.hostile.featured_engines import featured_engine
from tests.random_engines import random_engine

ENABLED = INERTIA_EFFECTS | {"bending", "torsion", "tangential"}
TWIN = "tests/data/v-twin.toml"


def loads_of(history: LoadHistory) -> Array:
    return np.stack([history.radial_N, history.tangential_N, history.torque_Nm], axis=1)


def lacking(loads: Array, kept: Array, seed: int = 0) -> float:
    """Return the largest part of its range that any of many random sums of the loads lacks."""
    sums = np.random.default_rng(seed).normal(size=(loads.shape[1], 4000))
    sums /= np.maximum(np.ptp(loads, axis=0), 1e-12)[:, None]
    whole = np.ptp(loads @ sums, axis=0)
    return float((1 - np.ptp(kept @ sums, axis=0) / whole).max())


@pytest.mark.parametrize("seeds", [range(3), pytest.param(range(3, 8), marks=pytest.mark.slow)])
@pytest.mark.parametrize("engine", [random_engine, featured_engine], ids=["in line", "V among them"])
def test_no_sum_of_loads_ranges_farther_over_the_cycle(
    engine: Callable[[int], dict[str, Any]], seeds: range
) -> None:
    for seed in seeds:
        scene = scene_from_dict({k: v for k, v in engine(seed).items() if k != "second_web"})
        for cycle in cycle_histories(scene, ENABLED):
            loads = loads_of(cycle)
            kept = bounding_states(loads)
            assert len(kept) < len(loads) / 8
            assert lacking(loads, loads[kept]) < SHORTFALL + 0.006


def test_flat_clouds_and_single_states_have_bounds_too() -> None:
    angle = np.linspace(0.0, 2 * np.pi, 720, endpoint=False)
    circle = np.stack([3 * np.cos(angle), 2 * np.sin(angle), 4 * np.sin(angle)], axis=1)
    assert lacking(circle, circle[bounding_states(circle)]) < SHORTFALL
    line = np.outer(np.linspace(-1.0, 2.0, 50), [1.0, 0.0, 3.0])
    assert {0, 49} <= set(bounding_states(line)) == {0, 49}
    assert bounding_states(np.ones((5, 3))).tolist() == [0]


def test_joined_extremes_have_the_tangential_force_beside_them() -> None:
    """The same four joined states as ever, then those of every throw's cycle, at each speed."""
    scene = load_scene(TWIN)
    enabled, kinds = load_kinds(scene, "extremes")
    assert "tangential" in kinds
    (joined,) = rated_histories(scene, "extremes", enabled)
    (found,) = histories_by_speed(scene, "extremes", enabled)
    assert found[0].labels == joined.labels
    cycles = cycle_histories(scene, enabled)
    assert len(found) == 1 + len(cycles)
    for own, cycle in zip(found[1:], cycles, strict=True):
        assert np.ptp(own.tangential_N) == pytest.approx(np.ptp(cycle.tangential_N), rel=0.02)
        assert set(own.labels) < set(cycle.labels)


def test_a_tangential_force_that_is_off_leaves_the_extremes_as_they_are() -> None:
    """As in every built-in design, which sets it off and says so."""
    scene = load_scene("mikron-iiic")
    enabled, kinds = load_kinds(scene, "extremes")
    assert kinds == ("bending", "torsion", "centrifugal")
    assert [len(of_speed) for of_speed in histories_by_speed(scene, "extremes", enabled)] == [1, 1]
    assert "tangential 25.2 % (set off in the scene)" in stress_left_off(scene)


def test_without_a_cycle_a_tangential_force_is_named_as_left_out() -> None:
    scene = with_values(load_scene("opposed-piston"), {"effects.tangential": "auto"})
    assert "tangential" in plan_for_stress(scene).enabled
    assert "tangential" not in load_kinds(scene, "extremes")[1]
    assert "tangential (its cycle needs [engine.gas])" in alone_left_off(scene)
    assert "tangential" not in alone_left_off(load_scene(TWIN))
