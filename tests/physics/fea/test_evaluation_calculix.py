"""Evaluation against CalculiX: same ten-node tetrahedra (C3D10), matrices and supports of another code.

Both integrate the stiffness at the same four points, on curved elements too, so no mesh error enters and
only the six printed digits and the solvers' precision are left.
"""

from __future__ import annotations

import shutil
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest
from scipy.spatial import cKDTree

from cranktopo.bodies.mesh.solid_mesh import mesh_throw
from cranktopo.design.schema import Scene
from cranktopo.numerics.tetrahedra.elasticity import Elasticity, mean_displacement
from cranktopo.numerics.tetrahedra.mesh import TetMesh
from cranktopo.numerics.tetrahedra.rigid_motions import RZ
from cranktopo.numerics.tetrahedra.superelement import Superelement
from cranktopo.tasks.throw_fea.condense import (
    BendingSupport,
    TorsionSupport,
    bending_stiffness_N_per_mm,
    condense,
    torsional_stiffness_Nm_per_rad,
)
from tests.physics.fea import calculix
from tests.physics.fea.evaluation_cases import LOPSIDED, elastic, mikron_with

pytestmark = pytest.mark.skipif(shutil.which("ccx") is None, reason="CalculiX (ccx) is not installed")
X, Y, Z = range(3)
TWIST_RAD, TORQUE_NMM, FORCE_N, SPRING_N_PER_MM = 1e-3, 1e6, 1e4, 2e5
AGREEMENT = 1e-5
"""Ten times tighter than asked of two codes on one mesh; the printed digits end at 1e-6."""


@dataclass(frozen=True)
class Case:
    scene: Scene
    mesh: TetMesh
    model: Elasticity
    order: np.ndarray
    """Number in the evaluation's model of each node of the mesh."""
    twist: Superelement
    bend: Superelement


@pytest.fixture(scope="module", params=["sharp", "lopsided"])
def case(request: pytest.FixtureRequest) -> Case:
    """A half throw with sharp edges, and one with fillets (curved elements) and a hole on one side only."""
    scene = mikron_with(0.0) if request.param == "sharp" else mikron_with(2.5, pocket=[LOPSIDED])
    mesh = mesh_throw(scene, 13.0, quarter=False, graded=False).mesh
    model = elastic(mesh, scene)
    distance, order = cKDTree(model.nodes_mm.T).query(mesh.points_mm.T)
    assert distance.max() == 0.0
    twist, bend = (condense(model, scene, parity, "none") for parity in ("antisymmetric", "symmetric"))
    return Case(scene, mesh, model, order, twist, bend)


def test_field_of_a_unit_twist(case: Case, tmp_path: Path) -> None:
    """The section turned with no other motion: displacements of every node."""
    reference, rotation = calculix.handles(case.mesh)
    fixed = [(node, axis, 0.0) for node in (reference, rotation) for axis in (X, Y, Z)]
    fixed[-1] = (rotation, Z, TWIST_RAD)
    found = calculix.displacements(tmp_path, case.mesh, case.scene, "antisymmetric", fixed=fixed)[:-2]
    expected = TWIST_RAD * case.twist.displacement[:, RZ].reshape(-1, 3)[case.order]
    assert np.abs(found - expected).max() < AGREEMENT * np.abs(expected).max()


@pytest.mark.parametrize("support", ["free", "held", "spring"])
def test_torsion(case: Case, support: TorsionSupport, tmp_path: Path) -> None:
    """A torque on the rigid section; of its motions without reaction only the rigid ones are taken out."""
    reference, rotation = calculix.handles(case.mesh)
    fixed = [(reference, Z, 0.0)]
    if support == "held":
        fixed += [(reference, X, 0.0), (reference, Y, 0.0), (rotation, X, 0.0), (rotation, Y, 0.0)]
    spring = SPRING_N_PER_MM if support == "spring" else 0.0
    forces = [(rotation, Z, TORQUE_NMM)]
    found = calculix.displacements(
        tmp_path, case.mesh, case.scene, "antisymmetric", fixed=fixed, forces=forces, spring_N_per_mm=spring
    )
    expected = torsional_stiffness_Nm_per_rad(case.twist, support, spring)
    assert TORQUE_NMM / (2 * found[rotation, Z]) / 1000 == pytest.approx(expected, rel=AGREEMENT)


@pytest.mark.parametrize("support", ["pinned", "clamped", "spring"])
def test_bending(case: Case, support: BendingSupport, tmp_path: Path) -> None:
    """The pin's body force as nodal forces; the deflection is its work on CalculiX's displacements."""
    reference, rotation = calculix.handles(case.mesh)
    centre = [] if support == "spring" else [(reference, X, 0.0), (reference, Y, 0.0)]
    tilt = [(rotation, X, 0.0), (rotation, Y, 0.0)] if support == "clamped" else []
    mean = mean_displacement(case.model, Y, case.scene.web_z_mm[1]).reshape(-1, 3)[case.order, Y]
    forces = [(int(n), Y, -FORCE_N / 2 * mean[n]) for n in np.nonzero(mean)[0]]
    spring = SPRING_N_PER_MM if support == "spring" else 0.0
    found = calculix.displacements(
        tmp_path,
        case.mesh,
        case.scene,
        "symmetric",
        fixed=[*centre, *tilt, (rotation, Z, 0.0)],
        forces=forces,
        spring_N_per_mm=spring,
    )
    deflection = -float(mean @ found[:-2, Y])
    expected = bending_stiffness_N_per_mm(case.bend, support, spring)
    assert FORCE_N / deflection == pytest.approx(expected, rel=AGREEMENT)
