"""Fields of unit loads: their sections carry exactly the forces that statics asks for."""

from __future__ import annotations

import numpy as np
import pytest

from cranktopo.bodies.mesh.solid_mesh import mesh_throw
from cranktopo.design.schema import Scene
from cranktopo.engine.balance.throw import throw_balance
from cranktopo.numerics.tetrahedra.elasticity import mean_displacement
from cranktopo.numerics.tetrahedra.rigid_motions import section_motions
from cranktopo.numerics.tetrahedra.stress import hooke
from cranktopo.tasks.throw_fea.unit_fields import UnitField, unit_fields
from tests.physics.fea.evaluation_cases import LOPSIDED, elastic, mikron_with

KINDS = ("bending", "tangential", "torsion", "centrifugal")
SIZE_MM = 7.5


def section_forces(scene: Scene) -> tuple[dict[str, np.ndarray], float]:
    """Section forces and moments of the half throw by load kind, shape (6,); y of the meshed pin."""
    meshed = mesh_throw(scene, SIZE_MM, graded=False)
    model = elastic(meshed.mesh, scene)
    section = np.nonzero(model.nodes_mm[2] < 1e-6)[0]
    motions = section_motions(model.nodes_mm, section)
    parts = 2 if meshed.mesh.mirrored else 1
    fields: tuple[UnitField, ...] = unit_fields(model, scene, meshed.mesh.mirrored, KINDS)
    pin_y_mm = mean_displacement(model, axis=1, z_from_mm=scene.web_z_mm[1])[1::3] @ model.nodes_mm[1]
    forces = {f.kind: parts * motions.T @ (model.stiffness @ f.displacement_mm) for f in fields}
    return forces, float(pin_y_mm)


@pytest.mark.parametrize("web", [{}, {"pocket": [LOPSIDED]}], ids=["quarter", "lopsided"])
def test_sections_carry_what_statics_asks_for(web: dict[str, object]) -> None:
    scene = mikron_with(**web)
    found, pin_y_mm = section_forces(scene)
    r, pull = scene.throw.radius_mm, throw_balance(scene).throw_unbalance_kg_mm * 1e-3
    # Bearings share the pin's force; torque about z answers the tangential force's lever, half at each end.
    assert found["bending"][1] == pytest.approx(0.5, rel=1e-6)
    assert found["tangential"][0] == pytest.approx(-0.5, rel=1e-6)
    assert found["tangential"][5] == pytest.approx(pin_y_mm / 2, rel=1e-6)
    assert pin_y_mm == pytest.approx(r, rel=3e-3)
    assert found["torsion"][5] == pytest.approx(1.0, rel=1e-6)
    assert found["centrifugal"][1] == pytest.approx(-pull / 2, rel=2e-3)
    assert np.abs(found["bending"][[2, 3]]).max() < 1e-6
    assert np.abs(found["torsion"][[0, 4]]).max() < 1e-6


def test_hooke_in_plane_strain() -> None:
    strain = np.array([1e-3, 0.0, 0.0, 5e-4, 0.0, 0.0])
    stress = hooke(strain, 2.0e5, 0.25)
    assert stress == pytest.approx([240.0, 80.0, 80.0, 80.0, 0.0, 0.0])
