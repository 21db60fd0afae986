"""A body from CAD in any attitude: its exact faces put it back to rounding, with the stiffness it had."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from cranktopo import load_scene
from cranktopo.bodies.solid.files import export_solid
from cranktopo.bodies.solid.step import kernel_surface, step_solid
from cranktopo.design.schema import Scene
from cranktopo.numerics.gmsh_session import cad_session, quiet_stdout
from cranktopo.numerics.surfaces.mesh import SurfaceMesh, solid_of
from cranktopo.tasks.importing.cad_body import moved_rigidly
from cranktopo.tasks.importing.exact_motion import exact_motions
from cranktopo.tasks.importing.imported_body import mesh_file
from cranktopo.tasks.importing.placement import placed
from cranktopo.tasks.throw_fea.evaluation import evaluate
from cranktopo.tasks.throw_fea.targets import resolve_target


@pytest.fixture(scope="module")
def scene() -> Scene:
    return load_scene("mikron-iiic-plain")


@pytest.fixture(scope="module")
def lopsided(scene: Scene, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The half throw with a block on one side of its web."""
    folder = tmp_path_factory.mktemp("lopsided")
    export_solid(scene, "half", folder / "half.step")
    with cad_session("lopsided body") as gmsh, quiet_stdout():
        body = step_solid(gmsh, folder / "half.step", "half")
        gmsh.model.occ.fuse([body], [(3, gmsh.model.occ.addBox(20, 12, 21, 12, 20, 10))])
        gmsh.model.occ.synchronize()
        gmsh.write(str(folder / "lopsided.step"))
    return folder / "lopsided.step"


def attitude(seed: int) -> tuple[np.ndarray, np.ndarray]:
    from scipy.spatial.transform import Rotation

    return Rotation.random(random_state=seed).as_matrix(), 100 * np.random.default_rng(seed).normal(size=3)


@pytest.mark.parametrize("attitudes", [4, pytest.param(50, marks=pytest.mark.slow)])
def test_attitudes_are_told_to_rounding(scene: Scene, lopsided: Path, attitudes: int) -> None:
    """The motion that is found, after the one that was made, is none."""
    with cad_session("attitudes") as gmsh:
        body: Any = [step_solid(gmsh, lopsided, "body")]
        surface = kernel_surface(gmsh)
        turn, shift = np.eye(3), np.zeros(3)
        for seed in range(attitudes):
            more, step = attitude(seed)
            moved_rigidly(gmsh.model.occ, body, more, step)
            gmsh.model.occ.synchronize()
            turn, shift = more @ turn, more @ shift + step
            moved = solid_of(SurfaceMesh(surface.vertices_mm @ turn.T + shift, surface.faces), "body")
            found = placed(moved, scene, "body", True, lambda: exact_motions(gmsh, scene))
            assert found is not None
            assert found.exact
            assert np.abs(found.matrix @ turn - np.eye(3)).max() < 1e-9
            assert np.abs(found.matrix @ shift + found.shift_mm).max() < 1e-9


@pytest.mark.slow
@pytest.mark.parametrize("seed", [1, 2, 3])
def test_an_aligned_body_has_the_mesh_and_stiffness_that_it_had(
    seed: int, scene: Scene, lopsided: Path, tmp_path: Path
) -> None:
    moved = tmp_path / "moved.step"
    with cad_session("moved body") as gmsh, quiet_stdout():
        body: Any = [step_solid(gmsh, lopsided, "body")]
        moved_rigidly(gmsh.model.occ, body, *attitude(seed))
        gmsh.model.occ.synchronize()
        gmsh.write(str(moved))
    there, back = mesh_file(lopsided, scene, 9.0), mesh_file(moved, scene, 9.0, align=True)
    assert back.note.startswith("moved to where the journals are")
    assert "triangles" not in back.note
    assert np.array_equal(back.mesh.cells, there.mesh.cells)
    assert np.abs(back.mesh.points_mm - there.mesh.points_mm).max() < 1e-9
    assert back.web_volume_mm3 == pytest.approx(there.web_volume_mm3, rel=1e-9)
    wanted, found = (
        evaluate(resolve_target(str(file), scene.name, align=align), 9.0)
        for file, align in ((lopsided, False), (moved, True))
    )
    assert found.torsion_Nm_per_rad == pytest.approx(wanted.torsion_Nm_per_rad, rel=1e-6)
    assert found.bending_N_per_mm == pytest.approx(wanted.bending_N_per_mm, rel=1e-6)
    assert found.throw_kg == pytest.approx(wanted.throw_kg, rel=1e-9)
