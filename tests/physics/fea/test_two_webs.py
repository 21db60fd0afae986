"""A throw with two different halves: mass, solid and stiffness, against other ways to the same numbers."""

from __future__ import annotations

import math
import shutil
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.spatial import cKDTree

from cranktopo.base.errors import CranktopoError
from cranktopo.bodies.mesh.solid_mesh import mesh_throw
from cranktopo.bodies.solid.checked import solid_properties
from cranktopo.bodies.solid.files import surface_of
from cranktopo.bodies.solid.throw import add_full_throw
from cranktopo.design.halves import difference, halves
from cranktopo.design.loading import load_scene, scene_from_dict
from cranktopo.design.schema import Scene
from cranktopo.engine.balance.throw import throw_balance
from cranktopo.engine.plan.planning import plan
from cranktopo.numerics.gmsh_session import cad_session
from cranktopo.numerics.tetrahedra.elasticity import mean_displacement
from cranktopo.numerics.tetrahedra.mesh import TetMesh
from cranktopo.numerics.tetrahedra.superelement import Superelement
from cranktopo.tasks.throw_fea.condense import (
    bending_stiffness_N_per_mm,
    condense,
    torsional_stiffness_Nm_per_rad,
)
from tests.physics.fea.calculix import displacements, handles
from tests.physics.fea.evaluation_cases import elastic
from tests.physics.fea.test_evaluation_full_throw import FLIPPED

WEB = {"thickness_mm": 19.0, "outline": "obround", "width_mm": 50.0}
SECOND = {"thickness_mm": 25.0, "outline": "tapered", "main_radius_mm": 30.0, "pin_radius_mm": 26.0}
POCKET = {"shape": "box", "face": "pin", "y_mm": -22.0, "size_x_mm": 8.0, "size_y_mm": 9.0, "depth_mm": 6.0}
ACROSS = {
    "diameter_mm": 5.0,
    "outlet_radius_mm": 1.0,
    "web": "first",
    "from": {"on": "main_journal", "angle_deg": 170.0, "place_mm": 3.0},
    "to": {"on": "crankpin", "angle_deg": 10.0, "place_mm": 0.0},
}
"""A drilling of one half whose outlet lies half beyond the middle of the crankpin."""
SIZE_MM = 12.0
JOURNALS = ("main_journal", "crankpin")


def scene_with(throw: dict[str, Any] | None = None, **tables: Any) -> Scene:
    data = load_scene("mikron-iiic-plain").model_dump(mode="json", exclude_none=True, by_alias=True)
    data["throw"] |= throw or {}
    return scene_from_dict({**data, **tables}, whole=True)


def lopsided() -> Scene:
    """Two webs, four lengths of journal and a pocket beside the mirror plane, in one throw."""
    lengths = {"second_main_journal_length_mm": 50.0, "second_crankpin_length_mm": 40.0}
    return scene_with(lengths, second_web={**SECOND, "pocket": [{**POCKET, "x_mm": 9.0}]})


@pytest.mark.parametrize(
    "scene",
    [
        pytest.param(lopsided(), id="webs"),
        pytest.param(scene_with({"drilling": [ACROSS]}), id="drilling", marks=pytest.mark.slow),
    ],
)
def test_exact_solid_has_the_mass_of_the_closed_form(scene: Scene) -> None:
    """Drilled out and rounded the kernel is 1e-5 of the throw off; what the outlet takes beyond is 3e-4."""
    assert difference(scene)
    with cad_session("two halves") as gmsh:
        body = solid_properties(gmsh.model.occ, add_full_throw(gmsh.model.occ, scene))
    balance, density = throw_balance(scene), scene.material.density_kg_m3 * 1e-9
    mass = density * body.volume_mm3
    assert mass == pytest.approx(balance.mass_kg, rel=1.5e-5)
    assert mass * body.centre_mm[1] == pytest.approx(balance.throw_unbalance_kg_mm, rel=1.5e-5)
    assert mass * body.centre_mm[0] == pytest.approx(balance.lateral_unbalance_kg_mm, abs=2e-4)
    assert density * body.inertia_z_mm5 == pytest.approx(balance.inertia_kg_mm2, rel=1.5e-5)


def test_each_half_gives_half_of_a_throw_of_its_own() -> None:
    """Masses are exactly the means of the throws that both halves come from; so is the pitch."""
    scene = lopsided()
    ones = [throw_balance(half) for half in halves(scene)]
    found = throw_balance(scene)
    for name in ("mass_kg", "throw_unbalance_kg_mm", "inertia_kg_mm2", "journal_kg", "crankpin_kg"):
        mean = sum(getattr(one, name) for one in ones) / 2
        assert getattr(found, name) == pytest.approx(mean, rel=1e-12), name
    assert (found.web_kg, found.second_web_kg) == pytest.approx([one.web_kg for one in ones], rel=1e-12)
    assert scene.pitch_mm == pytest.approx(20 + 19 + 18 + 20 + 25 + 25)


def test_halves_that_are_alike_stay_the_scene_itself() -> None:
    scene = scene_with(second_web=WEB)
    assert not difference(scene)
    assert halves(scene) == (scene, scene)
    assert not mesh_throw(scene, SIZE_MM, graded=False).whole


@pytest.fixture(scope="module")
def meshed() -> TetMesh:
    mesh = mesh_throw(lopsided(), SIZE_MM, graded=False).mesh
    assert not mesh.mirrored
    return mesh


@pytest.fixture(scope="module")
def block(meshed: TetMesh) -> Superelement:
    return condense(elastic(meshed, lopsided()), lopsided(), "whole", "none")


def stiffnesses(block: Superelement) -> list[float]:
    torsion = [torsional_stiffness_Nm_per_rad(block, support, 1e6) for support in ("free", "held", "spring")]
    bending = [bending_stiffness_N_per_mm(block, support, 1e6) for support in ("pinned", "clamped", "spring")]
    return torsion + bending


def test_webs_in_the_other_order_have_the_same_stiffness(meshed: TetMesh, block: Superelement) -> None:
    """The throw seen from its other end, on the mirror image of the mesh."""
    scene = lopsided()
    near, far = halves(scene)
    lengths = {f"second_{key}_length_mm": getattr(near.throw, key).length_mm for key in JOURNALS}
    other = far.model_copy(update={"throw": far.throw.model_copy(update=lengths), "second_web": near.web})
    points = meshed.points_mm * [[1], [1], [-1]] + [[0], [0], [scene.pitch_mm]]
    image = replace(meshed, points_mm=points, cells=np.ascontiguousarray(meshed.cells[FLIPPED]))
    assert halves(other) == (far, near)
    found = condense(elastic(image, other), other, "whole", "none")
    assert stiffnesses(found) == pytest.approx(stiffnesses(block), rel=1e-7)


@pytest.mark.skipif(shutil.which("ccx") is None, reason="CalculiX is not installed")
def test_stiffness_against_calculix(meshed: TetMesh, block: Superelement, tmp_path: Path) -> None:
    """The same mesh between two rigid bodies of CalculiX: torsion with free ends, bending on two bearings."""
    scene = lopsided()
    (near, tilt), (far, turn) = (handles(meshed, end) for end in (0, 1))
    clamped = [(node, axis, 0.0) for node in (near, tilt) for axis in range(3)]
    twisted = displacements(tmp_path, meshed, scene, "whole", fixed=clamped, forces=[(turn, 2, 1e6)])
    assert torsional_stiffness_Nm_per_rad(block, "free") == pytest.approx(1e3 / twisted[turn, 2], rel=1e-5)
    model = elastic(meshed, scene)
    order = cKDTree(model.nodes_mm.T).query(meshed.points_mm.T)[1]
    mean = mean_displacement(model, 1, 39.0, 77.0).reshape(-1, 3)[order, 1]  # between the webs' inner faces
    forces = [(int(node), 1, -1e4 * float(mean[node])) for node in np.flatnonzero(mean)]
    pinned = [(node, axis, 0.0) for node in (near, far) for axis in (0, 1)] + [(near, 2, 0.0), (tilt, 2, 0.0)]
    bent = displacements(tmp_path, meshed, scene, "whole", fixed=pinned, forces=forces)
    sunk = -float(mean @ bent[: len(mean), 1])
    assert bending_stiffness_N_per_mm(block, "pinned") == pytest.approx(1e4 / sunk, rel=1e-5)


@pytest.mark.slow
def test_a_longer_journal_adds_the_twist_of_its_length() -> None:
    """300 mm more of the far journal twist by T L / (G J); 10 s."""
    plain, longer = scene_with(), scene_with({"second_main_journal_length_mm": 640.0})
    twists = [
        1 / torsional_stiffness_Nm_per_rad(condense(elastic(mesh, scene), scene, "whole", "odd"), "free")
        for scene in (plain, longer)
        for mesh in (mesh_throw(scene, 8.0, full=True).mesh,)
    ]
    shear = 210e3 / 2.6
    expected = 1e3 * 300.0 / (shear * math.pi / 32 * (42.0**4 - 24.0**4))
    assert twists[1] - twists[0] == pytest.approx(expected, rel=3e-3)


@pytest.mark.parametrize(
    ("throw", "second", "message"),
    [
        ({}, {**SECOND, "width_mm": 9.0}, "unknown key second_web.width_mm"),
        ({}, {**WEB, "width_mm": 38.0}, "(in the half beyond the crankpin)"),
        (
            {},
            {**SECOND, "pocket": [{**POCKET, "x_mm": 0.0, "depth_mm": 30.0}]},
            "second_web.pocket[0].depth_mm",
        ),
        (
            {"second_main_journal_length_mm": 2.0},
            WEB,
            "fillet_mm = 2.5: must be smaller than half the journal",
        ),
        (
            {"drilling": [ACROSS, {**ACROSS, "web": "second"}]},
            WEB,
            "throw.drilling[0]: meets throw.drilling[1]",
        ),
        ({"drilling": [ACROSS], "second_crankpin_length_mm": 8.0}, WEB, "beyond the crankpin's middle"),
    ],
)
def test_what_does_not_fit_is_refused_by_its_key(
    throw: dict[str, Any], second: dict[str, Any], message: str
) -> None:
    with pytest.raises(CranktopoError) as caught:
        scene_with(throw, second_web=second)
    assert message in str(caught.value)


def test_the_second_web_is_written_where_it_is_in_the_throw() -> None:
    """From 77 to 102 mm along the crank, its pocket beside x = 0 where the scene has it."""
    scene = lopsided()
    vertices = surface_of(scene, "second_web", 3.0).vertices_mm
    low, high = vertices.min(axis=0), vertices.max(axis=0)
    assert (low[2], high[2]) == pytest.approx((77.0, 102.0), abs=1e-4)
    floor = vertices[np.abs(vertices[:, 2] - 83.0) < 1e-4]
    assert (floor[:, 0].min(), floor[:, 0].max()) == pytest.approx((5.0, 13.0), abs=1e-4)


def test_the_plan_says_why_the_throw_is_modelled_whole() -> None:
    names = [effect.name for effect in plan(load_scene("mikron-iiic-plain")).effects]
    assert "whole_throw" not in names
    row = plan(lopsided())["whole_throw"]
    assert row.state == "on"
    assert row.reason.startswith("second_web makes the halves differ")
    assert row.cost.cells > 0


def test_stages_that_model_half_of_a_throw_refuse_it() -> None:
    data = lopsided().model_dump(mode="json", exclude_none=True, by_alias=True)
    with pytest.raises(CranktopoError, match="second_web: the halves of the throw differ"):
        scene_from_dict(data)
