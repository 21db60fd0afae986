"""Bodies that come as triangles: topology and volume kept, stiffness as from the exact solid."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import trimesh
from manifold3d import Manifold

from cranktopo.base.errors import CranktopoError
from cranktopo.bodies.mesh.solid_mesh import mesh_throw
from cranktopo.bodies.prisms import journal_halves, web_bores
from cranktopo.bodies.solid.files import export_solid
from cranktopo.design.schema import Scene
from cranktopo.numerics.surfaces.files import write_stl
from cranktopo.numerics.surfaces.mesh import SurfaceMesh, mesh_of
from cranktopo.numerics.tetrahedra.mesh import tetrahedralise
from cranktopo.tasks.importing.imported_body import mesh_file
from cranktopo.tasks.throw_fea.throw_stiffness import condensed_stiffness
from tests.physics.fea.evaluation_cases import mikron_with

SIZE = 12.0
HOLE = {"shape": "cylinder", "x_mm": 12.0, "y_mm": 24.0, "diameter_mm": 12.0}


def signed_volumes(points: np.ndarray, cells: np.ndarray) -> np.ndarray:
    a, b, c, d = (points.T[cells[corner]] for corner in range(4))
    return np.einsum("ij,ij->i", np.cross(b - a, c - a), d - a) / 6


def test_a_hollow_and_a_tunnel_stay() -> None:
    """A block with a closed ball inside and a square hole through: neither is filled."""
    hole = trimesh.creation.box([8, 8, 40]).apply_translation([9, 2, 0])
    block = trimesh.boolean.difference([trimesh.creation.box([40, 30, 20]), hole], engine="manifold")
    ball = trimesh.creation.icosphere(3, 5.0).apply_translation([-9, 0, 1])
    surface = trimesh.boolean.difference([block, ball], engine="manifold")
    body = SurfaceMesh(np.asarray(surface.vertices), np.asarray(surface.faces))
    points, cells = tetrahedralise(body, 5.0, lambda p: np.full(len(p), 5.0), "block")
    volumes = signed_volumes(points, cells)
    assert volumes.min() > 0
    assert volumes.sum() == pytest.approx(40 * 30 * 20 - 8 * 8 * 20 - ball.volume, rel=1e-3)
    centres = points.T[cells[:4]].mean(axis=0)
    assert np.linalg.norm(centres - [-9, 0, 1], axis=1).min() > 4.5
    inside = (np.abs(centres[:, 0] - 9) < 3.9) & (np.abs(centres[:, 1] - 2) < 3.9)
    assert not inside.any()
    middle = points[:, cells[4]]
    np.testing.assert_allclose(middle, (points[:, cells[0]] + points[:, cells[1]]) / 2, atol=1e-12)


@pytest.mark.slow
@pytest.mark.parametrize("pocket", [[], [HOLE]], ids=["whole", "lopsided"])
def test_triangles_give_the_stiffness_of_the_solid(tmp_path: Path, pocket: list[dict[str, object]]) -> None:
    """The same throw as triangles and as an exact solid, whole and with a pocket on one side."""
    scene, path = mikron_with(fillet_mm=0.0, pocket=pocket), tmp_path / "half.stl"
    export_solid(scene, "half", path, 2.0)
    imported, exact = mesh_file(path, scene, SIZE), mesh_throw(scene, SIZE)
    assert imported.body.volume_mm3 == pytest.approx(exact.body.volume_mm3, rel=5e-3)
    assert imported.web_volume_mm3 == pytest.approx(exact.web_volume_mm3, rel=5e-3)
    ours, reference = (condensed_stiffness(p, scene, SIZE, 0.0) for p in (imported, exact))
    assert ours.torsion["free"] == pytest.approx(reference.torsion["free"], rel=0.01)
    assert ours.bending["pinned"] == pytest.approx(reference.bending["pinned"], rel=0.01)


def test_two_bodies_are_refused(mikron: Scene, tmp_path: Path) -> None:
    path = tmp_path / "two.stl"
    boxes = [trimesh.creation.box([10, 10, 57]).apply_translation([x, 0, 28.5]) for x in (0, 30)]
    trimesh.util.concatenate(boxes).export(path)
    with pytest.raises(CranktopoError, match="2 separate bodies"):
        mesh_file(path, mikron, SIZE)


@pytest.mark.slow
def test_the_mirror_is_used_only_where_both_sides_are_alike(mikron: Scene, tmp_path: Path) -> None:
    """Both journals and a block between them; the same with a dent of 2 mm3 on one side."""
    path, (start, end) = tmp_path / "body.stl", mikron.web_z_mm
    main, pin = journal_halves(mikron)
    block = Manifold.cube((56, 104, end - start)).translate((-28, -28, start)) - web_bores(mikron)
    body = main + block + pin
    dent = Manifold.cube((2, 1, 2), True).translate((12, 76, 30))
    for surface, alike in ((body, True), (body - dent, False)):
        write_stl(path, mesh_of(surface))
        assert mesh_file(path, mikron, SIZE).mesh.mirrored == alike


def test_a_surface_in_metres_is_told(tmp_path: Path, mikron: Scene) -> None:
    block = trimesh.creation.box(bounds=[[-0.03, -0.03, 0.0], [0.03, 0.08, 0.057]])
    block.export(tmp_path / "metres.stl")
    with pytest.raises(CranktopoError, match=r"0\.057 long") as caught:
        mesh_file(tmp_path / "metres.stl", mikron, 5.0)
    assert "in metres" in caught.value.hint
