"""Recessed fillets in the search for a shape: the mesh follows them, gradients are exact, walls are rules."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import pytest

from cranktopo.base.errors import CranktopoError
from cranktopo.design.loading import load_scene, scene_from_dict
from cranktopo.design.schema import Scene
from cranktopo.tasks.refit.family import Layout, free_dimensions, scene_at, with_free
from cranktopo.tasks.refit.parametric_web import ParametricWeb
from cranktopo.tasks.throw_fatigue.fillets import fillet_nodes
from cranktopo.tasks.web_shape.mesh_model import MeshModel
from cranktopo.throw.bevel import FittedBevel
from cranktopo.throw.fitted_pocket import FittedCylinder
from cranktopo.throw.fitted_slot import FittedSlot
from cranktopo.throw.manufacturing_limits import ManufacturingLimits
from tests.physics.shape.shape_cases import (
    COARSE_FILLET,
    COARSE_MM,
    Array,
    check_followed,
    check_gradients,
    check_same_change,
)

RECESSES_MM = {"main_journal": 0.8, "crankpin": 1.2}
_FREE: dict[str, list[float]] = {
    "pin_fillet_mm": [2.0, 5.0],
    "journal_fillet_mm": [2.0, 5.0],
    "web_thickness_mm": [17.0, 24.0],
}


def undercut(free: dict[str, list[float]]) -> Scene:
    """The plain throw with uneven recesses and free dimensions."""
    data: dict[str, Any] = load_scene("mikron-iiic-plain").model_dump(mode="json", exclude_none=True)
    for journal, recess in RECESSES_MM.items():
        data["throw"][journal] |= {"fillet_mm": 3.5, "recess_mm": recess}
    data["web"]["width_mm"] = 62.0
    data["shape"] = {"free": free}
    return scene_from_dict(data)


@dataclass(frozen=True)
class Case:
    scene: Scene
    layout: Layout
    values: Array
    model: MeshModel


def made(free: dict[str, list[float]]) -> Case:
    scene = undercut(free)
    outline, bevel = [-29.0, 78.0, 19.0, 31.0, 33.0, 31.0, 20.0], [53.0, 9.0, 1.0]
    layout, values = Layout(7, (FittedBevel("journal", hollow=True),)), np.array([*outline, *bevel])
    layout, values = with_free(layout, values, scene, free_dimensions(scene))
    return Case(scene, layout, values, MeshModel(scene, layout, values, COARSE_MM, COARSE_FILLET))


@pytest.fixture(scope="module")
def case() -> Case:
    return made(_FREE)


def test_nodes_follow_recesses_to_second_order(case: Case) -> None:
    check_followed(case.model.moved, case.values, dict(enumerate(case.layout.names)))


@pytest.mark.parametrize(("number", "side"), [(0, -1.0), (1, 1.0)], ids=["journal", "pin"])
def test_the_groove_keeps_its_depth_and_its_mouth(case: Case, number: int, side: float) -> None:
    """Nodes of both its edges stay on them where radius and thickness change."""
    changed = case.values.copy()
    changed[-len(case.layout.dimensions) :] += [0.4, -0.5, 0.6]
    mesh, scene = case.model.moved.at(changed), scene_at(case.scene, case.layout, changed)
    assert case.model.moved.distances_mm(mesh.points_mm, changed).max() < 1e-8
    journal, y = scene.throw.journals[number]
    face, fillet = scene.web_z_mm[number], journal.fillet
    on = fillet_nodes(case.model.scene, ("journal", "pin")[number], case.model.moved.mesh.points_mm)
    x, along, z = mesh.points_mm[:, on]
    across = np.hypot(x, along - y) - journal.radius_mm - fillet.radial_mm
    height = side * (z - face) - fillet.reach_mm
    assert np.hypot(across, height) == pytest.approx(fillet.radial_mm, abs=1e-6)
    assert across.max() == pytest.approx(fillet.half_mouth_mm, abs=1e-6)
    assert height[across.argmax()] == pytest.approx(-fillet.reach_mm, abs=1e-6)
    assert (side * (z - face)).min() == pytest.approx(-fillet.recess_mm, abs=0.02)


def test_gradients_by_all_dimensions_at_once_are_those_of_differences(case: Case) -> None:
    check_gradients(case.model, case.values, 2e-4, 2, 1e-5)


@pytest.mark.slow
def test_a_web_between_given_recesses_has_exact_gradients() -> None:
    """Nothing of the throw is free: the grooves stand still, and are followed all the same."""
    case = made({})
    check_gradients(case.model, case.values, 1e-3, 3, 1e-4)


@pytest.mark.slow
def test_a_mesh_there_and_a_mesh_here_tell_the_same_change(case: Case) -> None:
    changed = case.values.copy()
    changed[-len(case.layout.dimensions) :] += [0.2, -0.2, 0.4]
    check_same_change(case.scene, case.layout, (case.values, changed), COARSE_MM / 2, 0.005, 1e-2)


def rule_mm(layout: Layout, values: list[float], recess_mm: float, word: str) -> float:
    """The largest value of the rules whose name has a word, of a web between recesses of one depth."""
    scene = undercut({})
    update = {"recess_mm": recess_mm or None}
    journals = {name: getattr(scene.throw, name).model_copy(update=update) for name in RECESSES_MM}
    scene = scene.model_copy(update={"throw": scene.throw.model_copy(update=journals)})
    web = ParametricWeb(layout, scene, ManufacturingLimits(), (np.zeros(0),) * 3)
    at = np.array([-29.0, 78.0, 19.0, 31.0, 33.0, 31.0, 20.0, *values])
    pairs = zip(web.rule_names(at), web.constraints(at), strict=True)
    return max(float(value) for name, value in pairs if word in name)


def test_a_groove_leaves_its_flange_beside_a_recess() -> None:
    groove = Layout(7, (FittedSlot(through=True),)), [6.5, 27.5, 0.0, 10.0]
    deeper = rule_mm(*groove, 1.0, "beside the") - rule_mm(*groove, 0.0, "beside the")
    assert deeper == pytest.approx(1.0, abs=1e-9)


def test_a_bevel_leaves_its_wall_over_a_recess_to_its_outer_rim() -> None:
    """A wall of 19 - 3 - 1 mm is left at the mouth, not 19 - 3 mm at the edge of the journal."""
    bevel = Layout(7, (FittedBevel("journal", hollow=True),)), [53.0, 16.0, 0.0]
    assert rule_mm(*bevel, 1.0, "under the edge") > rule_mm(*bevel, 0.0, "under the edge") + 1.0


def test_a_pocket_keeps_clear_of_a_recess_or_leaves_a_wall_below_it() -> None:
    """Behind the main journal's groove a pocket of the pin's face is 1 mm too deep, or none too near."""
    layout, under, deep = Layout(7, (FittedCylinder("pin"),)), 19.0 - 3.0 - 1.0, 1.0
    assert rule_mm(layout, [-24.0, 8.0, under + deep], 1.0, "recess") == pytest.approx(deep, abs=0.05)
    assert rule_mm(layout, [-24.0, 8.0, under - deep], 1.0, "recess") == pytest.approx(-deep, abs=0.05)
    assert rule_mm(layout, [-200.0, 8.0, under + deep], 1.0, "recess") < -100.0


@pytest.mark.parametrize(
    ("free", "message"),
    [
        ({"pin_fillet_mm": [1.26, 5.0]}, r"must be larger than throw.crankpin.recess_mm = 1.3 mm"),
        ({"journal_fillet_axial_mm": [2.0, 5.0]}, r"recess_mm = 0.8 mm: an ellipse has no recess"),
    ],
)
def test_free_fillets_that_leave_no_recess_are_refused(
    free: dict[str, list[float]], message: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(RECESSES_MM, "crankpin", 1.3)
    with pytest.raises(CranktopoError, match=message):
        undercut(free)
