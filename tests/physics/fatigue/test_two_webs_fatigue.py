"""Stresses of a throw with two different halves: unit fields of the whole throw, both webs' fillets."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial import cKDTree

from cranktopo.bodies.mesh.solid_mesh import mesh_throw
from cranktopo.design.schema import Scene
from cranktopo.numerics.tetrahedra.elasticity import mean_displacement
from cranktopo.numerics.tetrahedra.mesh import TetMesh
from cranktopo.tasks.throw_fatigue.fillets import place
from cranktopo.tasks.throw_fatigue.target_safety import fatigue_field
from cranktopo.tasks.throw_fea.condense import loaded_mm
from cranktopo.tasks.throw_fea.targets import Target
from cranktopo.tasks.throw_fea.unit_fields import FieldKind, unit_fields
from tests.physics.fatigue.test_fatigue_superposition import (
    RADIAL_N,
    REFLECTED,
    SPEED2,
    SPRING,
    TANGENTIAL_N,
    TORQUE_NMM,
    direct,
)
from tests.physics.fea.evaluation_cases import elastic
from tests.physics.fea.test_two_webs import POCKET, SECOND, SIZE_MM, WEB, scene_with

FACTORS: dict[FieldKind, float] = {
    "bending": RADIAL_N,
    "tangential": TANGENTIAL_N,
    "torsion": TORQUE_NMM,
    "centrifugal": SPEED2,
}


def sprung(**second: object) -> Scene:
    """Two webs and four lengths of journals on bearing springs."""
    lengths = {"second_main_journal_length_mm": 50.0, "second_crankpin_length_mm": 40.0}
    supports = {"torsion": "spring", "bending": "spring", "bearing_spring_N_per_mm": SPRING}
    return scene_with(lengths, second_web={**SECOND, **second}, supports=supports)


@pytest.mark.parametrize(
    "pocket",
    [
        pytest.param((), id="mirror in x", marks=pytest.mark.slow),
        pytest.param(({**POCKET, "x_mm": 9.0},), id="none"),
    ],
)
def test_unit_fields_add_up_to_one_direct_solve(pocket: tuple[dict[str, object], ...]) -> None:
    """All loads at once on the whole throw, its torque answered in equal parts; by one LU factorisation."""
    scene = sprung(pocket=list(pocket))
    mesh = mesh_throw(scene, SIZE_MM, graded=False).mesh
    assert mesh.mirrored == (not pocket)
    model = elastic(mesh, scene)
    fields = unit_fields(model, scene, mesh.mirrored, FACTORS.keys(), whole=True)
    found = sum(FACTORS[field.kind] * field.displacement_mm for field in fields)
    body = elastic(unfolded(mesh), scene) if mesh.mirrored else model
    pin = -RADIAL_N * mean_displacement(body, 1, *loaded_mm(scene, True))
    pin += TANGENTIAL_N * mean_displacement(body, 0, *loaded_mm(scene, True))
    same = cKDTree(body.nodes_mm.T).query(model.nodes_mm.T)[1]
    wanted = direct(body, scene, pin).reshape(-1, 3)[same].ravel()
    assert np.abs(found - wanted).max() < 1e-6 * np.abs(wanted).max()


def unfolded(half: TetMesh) -> TetMesh:
    """The body that a mesh of its half x >= 0 stands for."""
    blocks = np.concatenate([half.points_mm, half.points_mm * [[-1], [1], [1]]], axis=1)
    _, first, number = np.unique(np.round(blocks, 6), axis=1, return_index=True, return_inverse=True)
    near, far = np.split(number.ravel(), 2)
    return TetMesh(
        blocks[:, first], np.concatenate([near[half.cells], far[half.cells[REFLECTED]]], axis=1), False
    )


def test_fillets_are_named_by_their_web() -> None:
    """Points on the arcs of both pin fillets, 45 deg along, and one on the second web's outline."""
    scene = sprung()
    low = 42.0 / 2 + 2.5 * (1 - np.sin(np.pi / 4))
    off = 2.5 * (1 - np.cos(np.pi / 4))
    near, far = 20.0 + 19.0 + off, scene.pitch_mm - (25.0 + 25.0 + off)
    for z, web in ((near, "first"), (far, "second")):
        at = place(scene, np.array([low, 48.0, z]))
        assert (at.fillet, at.web) == ("pin", web)
        assert (at.around_deg, at.along_deg) == pytest.approx((90.0, 45.0), abs=1e-6)
        assert str(at).startswith(f"pin fillet of the {web} web, +90 deg around")
    assert place(scene, np.array([0.0, -30.0, far + 5.0])).fillet == ""


@pytest.mark.slow
def test_a_second_web_a_hair_thicker_has_the_safety_of_equal_webs() -> None:
    """Half a throw against the whole one on a mesh of its own, and the weaker web is the one that is told."""
    plain = fatigue_field(Target("plain", scene_with()), "lsa", fillet_fraction=0.5)
    hair = scene_with(second_web={**WEB, "thickness_mm": 19.001})
    found = fatigue_field(Target("hair", hair), "lsa", fillet_fraction=0.5)
    assert found.model.whole
    assert found.critical.safety == pytest.approx(plain.critical.safety, rel=0.02)
    assert list(found.web_safety.values()) == pytest.approx([plain.critical.safety] * 2, rel=0.02)
    weak = scene_with(second_web={**WEB, "thickness_mm": 15.0})
    worse = fatigue_field(Target("weak", weak), "lsa", fillet_fraction=0.5)
    assert worse.critical.web == "second"
    assert worse.web_safety["second"] == worse.critical.safety < worse.web_safety["first"]
