"""Von Mises stress of a target under its load cases, on its evaluation mesh: for pictures, not fatigue."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from cranktopo.base.arrays import Array
from cranktopo.base.units import MPA_PER_GPA, NMM_PER_NM, angular_speed_rad_s
from cranktopo.design.halves import require_equal_halves
from cranktopo.design.scale import default_element_size_mm
from cranktopo.engine.load_case import LoadCase
from cranktopo.numerics.tetrahedra.elasticity import assemble
from cranktopo.numerics.tetrahedra.stress import nodal_stress, von_mises
from cranktopo.tasks.fea.evaluation import Info, mesh_target
from cranktopo.tasks.fea.targets import Target
from cranktopo.tasks.fea.unit_fields import FieldKind, unit_fields

_NEIGHBOURS = 4
_HAIR_MM = 1e-6
UNIT_LOADS: dict[FieldKind, Callable[[LoadCase], float]] = {
    "bending": lambda case: case.radial_N,
    "tangential": lambda case: case.tangential_N,
    "torsion": lambda case: case.torque_Nm * NMM_PER_NM,
    "centrifugal": lambda case: angular_speed_rad_s(case.speed_rpm) ** 2,
}
"""How many unit loads of each field a load case holds."""


@dataclass(frozen=True)
class CaseStress:
    """Von Mises stress of load cases at the nodes of a half throw.

    Attributes:
        points_mm: nodes, shape (n, 3).
        von_mises_MPa: shape (cases, n).
        mirrored: the nodes are those of the half x >= 0.
    """

    cases: tuple[LoadCase, ...]
    points_mm: Array
    von_mises_MPa: Array
    mirrored: bool
    element_size_mm: float

    def at(self, points_mm: Array) -> Array:
        """Stress at points of the surface, MPa, shape (cases, points).

        Mean of the nearest four nodes by the inverse of their distance: a node gives its own value.

        Args:
            points_mm: shape (points, 3).
        """
        from scipy.spatial import cKDTree

        where = np.array(points_mm, dtype=np.float64)
        if self.mirrored:
            where[:, 0] = np.abs(where[:, 0])
        distance, near = cKDTree(self.points_mm).query(where, k=_NEIGHBOURS)
        weight = 1 / np.maximum(distance, _HAIR_MM)
        weight /= weight.sum(axis=1, keepdims=True)
        return np.einsum("cpk,pk->cp", self.von_mises_MPa[:, near], weight)


def case_stress(
    target: Target,
    cases: Sequence[LoadCase],
    element_size_mm: float | None = None,
    progress: Info = lambda _: None,
) -> CaseStress:
    """Von Mises stress of a target under load cases, one condensation per symmetry that they need.

    At sharp re-entrant edges it has no limit, and in fillets it needs the finer mesh of
    `stress_model.solve_stresses`: the largest value depends on the mesh, all but the neighbourhood of such
    edges does not.

    Raises:
        CranktopoError: impossible geometry or a failed solve.
    """
    require_equal_halves(target.scene)
    size = element_size_mm or default_element_size_mm(target.scene)
    progress(f"{target.name}: stresses, element size {size:.3g} mm")
    meshed = mesh_target(target, size)
    youngs, poisson = target.scene.material.E_GPa * MPA_PER_GPA, target.scene.material.poisson
    model = assemble(meshed.mesh, youngs, poisson)
    wanted = [kind for kind, factor in UNIT_LOADS.items() if any(factor(case) for case in cases)]
    fields = unit_fields(model, target.scene, meshed.mesh.mirrored, wanted)
    share = np.array([[UNIT_LOADS[kind](case) for kind in (f.kind for f in fields)] for case in cases])
    found = nodal_stress(model, share @ np.stack([f.displacement_mm for f in fields]), youngs, poisson)
    stress = von_mises(found.nodal_MPa)
    return CaseStress(tuple(cases), model.nodes_mm.T, stress, meshed.mesh.mirrored, size)
