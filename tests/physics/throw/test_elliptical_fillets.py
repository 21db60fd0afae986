"""Elliptical fillets as bodies and meshes: volume of the CAD kernel, nodes on the ellipse, concentration."""

from __future__ import annotations

import numpy as np
import pytest

from cranktopo.base.units import density_kg_per_mm3
from cranktopo.bodies.mesh.solid_mesh import mesh_throw
from cranktopo.bodies.solid.checked import solid_properties
from cranktopo.bodies.solid.throw import add_half_throw
from cranktopo.bodies.volume import half_throw_volume_mm3
from cranktopo.design.loading import scene_from_dict
from cranktopo.design.schema import Scene
from cranktopo.engine.balance.throw import throw_balance
from cranktopo.numerics.gmsh_session import cad_session
from cranktopo.tasks.throw_fatigue.fillets import Fillet, fillet_nodes
from tests.physics.fea.evaluation_cases import mikron_with


def flattened(main_mm: tuple[float, float], pin_mm: tuple[float, float]) -> Scene:
    """The Mikron with radial and axial semi-axes of both fillets."""
    data = mikron_with().model_dump(mode="json", exclude_none=True)
    for key, (radial, axial) in (("main_journal", main_mm), ("crankpin", pin_mm)):
        data["throw"][key] |= {"fillet_mm": radial, "fillet_axial_mm": axial}
    return scene_from_dict(data)


UNEVEN = ((3.0, 1.8), (2.0, 4.5))


def test_the_kernel_builds_the_volume_and_moments_of_the_closed_form() -> None:
    scene = flattened(*UNEVEN)
    with cad_session("half") as gmsh:
        half = solid_properties(gmsh.model.occ, add_half_throw(gmsh.model.occ, scene))
    balance, density = throw_balance(scene), density_kg_per_mm3(scene.material.density_kg_m3)
    assert half.volume_mm3 == pytest.approx(half_throw_volume_mm3(scene), rel=1e-7)
    assert 2 * half.volume_mm3 * density == pytest.approx(balance.mass_kg, rel=1e-7)
    assert 2 * half.inertia_z_mm5 * density == pytest.approx(balance.inertia_kg_mm2, rel=1e-7)
    unbalance = 2 * half.volume_mm3 * half.centre_mm[1] * density
    assert unbalance == pytest.approx(balance.throw_unbalance_kg_mm, rel=1e-7)


def test_nodes_lie_on_the_ellipse_and_are_found_there() -> None:
    scene = flattened(*UNEVEN)
    mesh = mesh_throw(scene, 14.0, fillet_fraction=1.0).mesh
    x, y, z = mesh.points_mm
    names: tuple[tuple[Fillet, float, float], ...] = (("journal", 0.0, -1.0), ("pin", 48.0, 1.0))
    for (name, axis, side), (radial, axial) in zip(names, UNEVEN, strict=True):
        on = fillet_nodes(scene, name, mesh.points_mm)
        face = scene.web_z_mm[0 if name == "journal" else 1]
        across = (21.0 + radial - np.hypot(x, y - axis)) / radial
        height = (face + side * axial - z) * side / axial
        assert np.hypot(across, height)[on] == pytest.approx(1.0, abs=1e-6)
        angle = np.degrees(np.arctan2(height, across))[on]
        assert on.sum() > 300
        assert (angle.min(), angle.max()) == pytest.approx((0.0, 90.0), abs=1e-3)
        lengths = np.histogram(angle, 9, (0.0, 90.0))[0]
        assert lengths.min() > 10
