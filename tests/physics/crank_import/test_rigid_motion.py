"""A rigid motion keeps the exact faces of a body: mass and moments in 50 attitudes."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from cranktopo import load_scene
from cranktopo.bodies.solid.files import export_solid
from cranktopo.bodies.solid.step import step_solid
from cranktopo.numerics.gmsh_session import cad_session
from cranktopo.tasks.importing.cad_body import moved_rigidly


def test_fifty_attitudes(tmp_path: Path) -> None:
    from scipy.spatial.transform import Rotation

    export_solid(load_scene("mikron-iiic"), "half", tmp_path / "half.step")
    with cad_session("attitudes") as gmsh:
        occ = gmsh.model.occ
        body = step_solid(gmsh, tmp_path / "half.step", "half")
        volume, centre = occ.getMass(*body), np.array(occ.getCenterOfMass(*body))
        kinds = sorted(gmsh.model.getType(2, tag) for _, tag in gmsh.model.getEntities(2))
        moments = np.linalg.eigvalsh(np.array(occ.getMatrixOfInertia(*body)).reshape(3, 3))
        for seed in range(50):
            copy = occ.copy([body])
            matrix = Rotation.random(random_state=seed).as_matrix()
            shift = 100 * np.random.default_rng(seed).normal(size=3)
            moved_rigidly(occ, copy, matrix, shift)
            occ.synchronize()
            assert abs(occ.getMass(*copy[0]) / volume - 1) < 1e-9
            assert np.allclose(occ.getCenterOfMass(*copy[0]), matrix @ centre + shift, atol=1e-9)
            turned = np.linalg.eigvalsh(np.array(occ.getMatrixOfInertia(*copy[0])).reshape(3, 3))
            assert np.allclose(turned, moments, rtol=1e-9)
            faces = gmsh.model.getBoundary(copy, oriented=False)
            assert sorted(gmsh.model.getType(2, tag) for _, tag in faces) == kinds
            occ.remove(copy, recursive=True)
