"""Free dimensions of the throw on a moved mesh: its faces are followed, and gradients are exact."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pytest

from cranktopo.design.schema import Scene
from cranktopo.tasks.refit.family import Layout, rounded_dimensions, scene_at
from cranktopo.tasks.refit.parametric_web import ParametricWeb
from cranktopo.tasks.web_shape.mesh_model import MeshModel
from cranktopo.throw.manufacturing_limits import ManufacturingLimits
from tests.physics.shape.shape_cases import (
    COARSE_FILLET,
    COARSE_MM,
    Array,
    check_followed,
    check_gradients,
    check_same_change,
    free_throw,
)

_CHANGE = [0.4, 0.3, -0.3, -1.0, 0.2, 0.5]
"""Of every dimension, mm: elements as coarse as these fold soon on a bore that grows."""


@dataclass(frozen=True)
class Case:
    scene: Scene
    layout: Layout
    values: Array
    model: MeshModel

    @property
    def sizes(self) -> range:
        """Places of the dimensions of the throw among the values."""
        return range(len(self.values) - len(self.layout.dimensions), len(self.values))


@pytest.fixture(scope="module")
def case() -> Case:
    scene, layout, values = free_throw()
    return Case(scene, layout, values, MeshModel(scene, layout, values, COARSE_MM, COARSE_FILLET))


def test_nodes_follow_the_faces_of_the_throw_to_second_order(case: Case) -> None:
    check_followed(case.model.moved, case.values, {i: case.layout.names[i] for i in case.sizes})


def test_both_ends_of_the_throw_stay_and_fillets_keep_their_arcs(case: Case) -> None:
    """The pitch stays; nodes on the arc's rims stay there, so that none crosses onto journal or web."""
    moved = case.model.moved
    changed = case.values.copy()
    changed[case.sizes] += _CHANGE
    mesh, scene = moved.at(changed), scene_at(case.scene, case.layout, changed)
    assert moved.distances_mm(mesh.points_mm, changed).max() < 1e-8
    assert moved.quality(mesh) > 0.5
    for plane in (0.0, scene.pitch_mm / 2):
        there = np.abs(moved.mesh.points_mm[2] - plane) < 1e-9
        assert there.sum() > 20
        assert np.abs(mesh.points_mm[2, there] - plane).max() < 1e-9
    for number, side in ((0, -1.0), (1, 1.0)):
        old, new = case.model.scene, scene
        rims = [s.web_z_mm[number] + side * s.throw.journals[number][0].fillet.axial_mm for s in (old, new)]
        journal, y = old.throw.journals[number]
        start = moved.mesh.points_mm
        rim = np.abs(np.hypot(start[0], start[1] - y) - journal.radius_mm) < 1e-6
        rim &= np.abs(start[2] - rims[0]) < 1e-6
        assert rim.sum() > 5
        assert np.abs(mesh.points_mm[2, rim] - rims[1]).max() < 1e-9
        around = np.arctan2(start[0], start[1] - y)
        assert np.allclose(np.arctan2(mesh.points_mm[0], mesh.points_mm[1] - y)[rim], around[rim])


def test_gradients_by_all_dimensions_at_once_are_those_of_differences(case: Case) -> None:
    """By steps so small that no point of integration of the pin's load crosses the web's face."""
    check_gradients(case.model, case.values, 2e-4, 2, 1e-5)


@pytest.mark.slow
def test_gradients_by_each_dimension_are_those_of_differences(case: Case) -> None:
    """Each alone: `pytest -m slow tests/physics/refit/test_free_dimensions_mesh.py`."""
    found, step = case.model.responses(case.values), 1e-3
    for i in case.sizes:
        change = step * np.eye(len(case.values))[i]
        above, below = (case.model.responses(case.values + s * change) for s in (1, -1))
        for name, value in found.values.items():
            measured = (above.values[name] - below.values[name]) / (2 * step)
            exact = pytest.approx(measured, rel=1e-4, abs=1e-8 * abs(value))
            assert found.gradients[name][i] == exact, f"{name} by {case.layout.names[i]}"


@pytest.mark.slow
def test_a_mesh_there_and_a_mesh_here_tell_the_same_change(case: Case) -> None:
    changed = case.values.copy()
    changed[case.sizes] += _CHANGE
    check_same_change(case.scene, case.layout, (case.values, changed), COARSE_MM, 0.02, 5e-3)


def test_slopes_of_the_rules_are_those_of_differences(case: Case) -> None:
    web = ParametricWeb(case.layout, case.scene, ManufacturingLimits(), (np.zeros(0),) * 3)
    values, step = case.values + 0.01, 1e-4
    slopes = web.gradients(values)
    for i in range(len(values)):
        change = step * np.eye(len(values))[i]
        measured = (web.constraints(values + change) - web.constraints(values - change)) / (2 * step)
        assert slopes[:, i] == pytest.approx(measured, abs=2e-5), case.layout.names[i]


def test_walls_of_bores_and_clear_fillets_are_rules(case: Case) -> None:
    """A bore that leaves less than the wall, that meets the other one or the other fillet; flat ellipses."""
    web = ParametricWeb(case.layout, case.scene, ManufacturingLimits(), (np.zeros(0),) * 3)
    kept = web.constraints(case.values)
    names = list(case.layout.names)
    for name, value in (
        ("journal_bore", 37.0),
        ("pin_bore", 51.0),
        ("journal_fillet", 17.0),
        ("pin_fillet", 1.0),
        ("pin_fillet_axial", 1.0),
    ):
        broken = case.values.copy()
        broken[names.index(name)] = value
        assert (web.constraints(broken) > np.maximum(kept, 0) + 0.4).any(), name


def test_bounds_and_rounding_stay_in_the_ranges(case: Case) -> None:
    web = ParametricWeb(case.layout, case.scene, ManufacturingLimits(), (np.zeros(0),) * 3)
    low, high = (bound[case.sizes] for bound in web.bounds)
    assert low == pytest.approx([2.0, 2.0, 2.5, 0.05 * 42, 10.0, 17.0])
    assert high == pytest.approx([5.0, 5.0, 5.4, 26.0, 30.0, 24.0])
    depth = list(case.layout.names).index("bevel-journal.depth")
    assert web.bounds[1][depth] == pytest.approx(24 - 3)
    outside = case.values.copy()
    outside[case.sizes] = [1.9999, 5.0001, 3.337, 20.126, 24.0, 19.004]
    assert rounded_dimensions(case.scene, case.layout, outside)[case.sizes] == pytest.approx(
        [2.0, 5.0, 3.34, 20.13, 24.0, 19.0]
    )
