"""The condensed half throw against the full throw in one piece, between two rigid sections.

The full model knows nothing of symmetry: its two sections carry twelve motions, its pin force is integrated
here. Once on the doubled half mesh, where the algebra must agree to the solver's precision, once on a mesh
of the full solid.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import pytest
from numpy.typing import NDArray
from skfem import Basis, ElementTetP2

from cranktopo.bodies.mesh.solid_mesh import mesh_throw
from cranktopo.design.schema import Scene
from cranktopo.numerics.tetrahedra.elasticity import Elasticity
from cranktopo.numerics.tetrahedra.mesh import TetMesh
from cranktopo.numerics.tetrahedra.rigid_motions import RX, RZ, UX, UY, plane_nodes, section_motions
from cranktopo.tasks.shaft.assembly import throw_blocks, throw_matrix
from cranktopo.tasks.throw_fea.condense import (
    bending_stiffness_N_per_mm,
    condense,
    torsional_stiffness_Nm_per_rad,
)
from tests.physics.fea.evaluation_cases import LOPSIDED, elastic, mikron_with

Array = NDArray[np.float64]
FLIPPED = [1, 0, 2, 3, 4, 6, 5, 8, 7, 9]
"""Node order of a ten-node tetrahedron seen in a mirror: corners 0 and 1 swapped."""
LENGTHS = np.array([1.0, 1.0, 1.0, 50.0, 50.0, 50.0] * 2)


@dataclass(frozen=True)
class FullThrow:
    """Stiffness over both sections' twelve motions; mean -u_y of the pin per motion and per unit force."""

    stiffness: Array
    load: Array
    load_compliance: float

    def torsion_Nm_per_rad(self, held: bool) -> float:
        """Equal and opposite torques over the relative rotation."""
        kept = [RZ, 6 + RZ] if held else list(range(12))
        torque = np.zeros(12)
        torque[[RZ, 6 + RZ]] = -1.0, 1.0
        return float(1.0 / (torque @ self._motion(kept, torque)) / 1000)

    def bending_N_per_mm(self, clamped: bool) -> float:
        """Pin force over mean deflection, both sections free to move axially."""
        held = {UX, UY, 6 + UX, 6 + UY} | ({RX, 4, RZ, 6 + RX, 10, 6 + RZ} if clamped else set())
        kept = [m for m in range(12) if m not in held]
        return 1.0 / (self.load_compliance + float(self.load @ self._motion(kept, self.load)))

    def _motion(self, kept: list[int], force: Array) -> Array:
        length = LENGTHS[kept]
        scaled = self.stiffness[np.ix_(kept, kept)] / np.outer(length, length)
        motion = np.zeros(12)
        motion[kept] = np.linalg.pinv(scaled, rcond=1e-8, hermitian=True) @ (force[kept] / length) / length
        return motion


def full_throw(mesh: TetMesh, scene: Scene) -> FullThrow:
    model = elastic(mesh, scene)
    ends = [plane_nodes(model.nodes_mm, 2, z) for z in (0.0, scene.pitch_mm)]
    rigid = np.hstack([section_motions(model.nodes_mm, nodes) for nodes in ends])
    held = np.concatenate([(3 * nodes[:, None] + np.arange(3)).ravel() for nodes in ends])
    mean = pin_mean(model, scene)
    fields = model.equations.solver(held)(np.column_stack([-(model.stiffness @ rigid), mean]))
    fields[:, :12] += rigid
    units = fields[:, :12]
    return FullThrow(units.T @ (model.stiffness @ units), units.T @ mean, float(mean @ fields[:, 12]))


def pin_mean(model: Elasticity, scene: Scene) -> Array:
    """Vector m with m.u the mean of -u_y over the material between the two webs' inner faces."""
    face = scene.web_z_mm[1]
    basis = Basis(model.mesh, ElementTetP2(), intorder=6)
    z = np.asarray(basis.global_coordinates())[2]
    inside = basis.dx * (np.abs(z - scene.pitch_mm / 2) < scene.pitch_mm / 2 - face - 1e-9)
    mean = np.zeros(model.nodes_mm.size)
    weights = np.stack([(np.asarray(phi[0]) * inside).sum(axis=1) for phi in basis.basis])
    np.add.at(mean, 3 * basis.element_dofs + UY, -weights)
    return mean / inside.sum()


def doubled(half: TetMesh, pitch_mm: float) -> TetMesh:
    """The half throw's mesh joined with its mirror image in the mid-pin plane."""
    count = half.points_mm.shape[1]
    image = half.points_mm * [[1], [1], [-1]] + [[0], [0], [pitch_mm]]
    number = np.arange(count, 2 * count)
    middle = plane_nodes(half.points_mm, 2, pitch_mm / 2)
    number[middle] = middle
    cells = np.hstack([half.cells, number[half.cells][FLIPPED]])
    used, compact = np.unique(cells, return_inverse=True)
    points = np.hstack([half.points_mm, image])[:, used]
    return TetMesh(np.ascontiguousarray(points), compact.reshape(cells.shape).astype(np.int64), False)


def stiffnesses(full: FullThrow) -> list[float]:
    torsion = [full.torsion_Nm_per_rad(held) for held in (False, True)]
    return torsion + [full.bending_N_per_mm(clamped) for clamped in (False, True)]


def condensed(half: TetMesh, scene: Scene) -> list[float]:
    model = elastic(half, scene)
    twist = condense(model, scene, "antisymmetric", "odd" if half.mirrored else "none")
    bend = condense(model, scene, "symmetric", "even" if half.mirrored else "none")
    torsion = [torsional_stiffness_Nm_per_rad(twist, "free"), torsional_stiffness_Nm_per_rad(twist, "held")]
    bending = [bending_stiffness_N_per_mm(bend, "pinned"), bending_stiffness_N_per_mm(bend, "clamped")]
    return torsion + bending


def test_same_algebra_on_the_doubled_mesh() -> None:
    """A throw with a hole on one side: both end motions, both parities, every support."""
    scene = mikron_with(pocket=[LOPSIDED])
    half = mesh_throw(scene, 12.0, graded=False).mesh
    assert not half.mirrored
    full = full_throw(doubled(half, scene.pitch_mm), scene)
    matrix = throw_matrix(throw_blocks(elastic(half, scene), scene, mirrored=False))
    scale = np.abs(full.stiffness / np.outer(LENGTHS, LENGTHS)).max()
    assert np.abs((matrix - full.stiffness) / np.outer(LENGTHS, LENGTHS)).max() < 1e-8 * scale
    assert condensed(half, scene) == pytest.approx(stiffnesses(full), rel=1e-7)


def test_the_whole_throw_has_the_stiffness_of_its_halves() -> None:
    """Condensed whole, its own error bounds among what must agree; with the mirror in x and without it."""
    lopsided, plain = (mikron_with(pocket=pocket) for pocket in ([LOPSIDED], []))
    for scene, split in ((lopsided, ("none", "none")), (plain, ("odd", "even"))):
        half = mesh_throw(scene, 12.0, graded=False).mesh
        whole = elastic(replace(doubled(half, scene.pitch_mm), mirrored=half.mirrored), scene)
        twist, bend = (condense(whole, scene, "whole", lateral) for lateral in split)
        torsion = [torsional_stiffness_Nm_per_rad(twist, support) for support in ("free", "held")]
        bending = [bending_stiffness_N_per_mm(bend, support) for support in ("pinned", "clamped")]
        assert torsion + bending == pytest.approx(condensed(half, scene), rel=1e-7)
        springs = [torsional_stiffness_Nm_per_rad(twist, "spring", 1e6)]
        springs += [bending_stiffness_N_per_mm(bend, "spring", 1e6)]
        assert springs == pytest.approx(on_springs(half, scene), rel=1e-7)


def on_springs(half: TetMesh, scene: Scene) -> list[float]:
    model, side = elastic(half, scene), ("odd", "even") if half.mirrored else ("none", "none")
    twist, bend = (
        condense(model, scene, parity, lateral)
        for parity, lateral in zip(("antisymmetric", "symmetric"), side, strict=True)
    )
    return [
        torsional_stiffness_Nm_per_rad(twist, "spring", 1e6),
        bending_stiffness_N_per_mm(bend, "spring", 1e6),
    ]


@pytest.mark.slow
@pytest.mark.parametrize("pocket", [[], [LOPSIDED]], ids=["symmetric", "lopsided"])
def test_full_solid(pocket: list[dict[str, object]]) -> None:
    """The quarter or half model against a mesh of the full solid."""
    scene = mikron_with(pocket=pocket)
    full = full_throw(mesh_throw(scene, 6.0, full=True, quarter=False).mesh, scene)
    assert condensed(mesh_throw(scene, 6.0).mesh, scene) == pytest.approx(stiffnesses(full), rel=2e-3)
