"""Mass properties of the exact solids against closed forms, and of their meshes against the solids."""

from __future__ import annotations

import math

import pytest

from cranktopo.bodies.mesh.solid_mesh import mesh_throw
from cranktopo.bodies.solid.checked import SolidProperties, solid_properties
from cranktopo.bodies.solid.throw import add_half_throw
from cranktopo.design.schema import Scene
from cranktopo.engine.balance.throw import throw_balance
from cranktopo.numerics.gmsh_session import cad_session
from cranktopo.tasks.throw_fea.evaluation import evaluate
from cranktopo.tasks.throw_fea.targets import Target
from tests.physics.fea.evaluation_cases import LOPSIDED, elastic, mikron_with, throw_scene

STEEL_KG_PER_MM3 = 7.85e-6


def exact(scene: Scene) -> SolidProperties:
    """Properties of the half throw from the CAD kernel."""
    with cad_session("half throw") as gmsh:
        return solid_properties(gmsh.model.occ, add_half_throw(gmsh.model.occ, scene))


def by_hand(fillet: float, bore: float) -> tuple[float, float, float]:
    """Volume (mm3), first moment in y (mm4) and polar moment (mm5) of the full Mikron throw.

    Discs and a rectangle by Steiner's theorem; fillet rings as thin shells of height f - sqrt(f2 - d2).
    """
    radius, throw, web = 21.0, 48.0, (25.0, 19.0)
    ring, own = math.pi * (radius**2 - bore**2 / 4), math.pi / 2 * (radius**4 - bore**4 / 16)
    area = 50 * throw + math.pi * web[0] ** 2 - 2 * math.pi * bore**2 / 4
    polar = 50 * throw**3 / 3 + throw * 50**3 / 12
    polar += (
        math.pi * web[0] ** 4 / 2 + 2 * throw * 2 / 3 * web[0] ** 3 + math.pi * web[0] ** 2 / 2 * throw**2
    )
    polar -= 2 * math.pi / 2 * bore**4 / 16 + math.pi * bore**2 / 4 * throw**2
    corner, turned = _fillet(radius, fillet)
    main, pin, sides = 40.0, 36.0, 2
    volume = ring * (main + pin) + sides * (area * web[1] + 2 * corner)
    first = throw * (ring * pin + sides * corner) + sides * web[1] * area * throw / 2
    inertia = own * (main + pin) + ring * pin * throw**2
    inertia += sides * (polar * web[1] + 2 * turned + corner * throw**2)
    return volume, first, inertia


def _fillet(radius: float, fillet: float, shells: int = 200_000) -> tuple[float, float]:
    """Volume of a fillet ring (Pappus) and its polar moment about its own axis (shells)."""
    if not fillet:
        return 0.0, 0.0
    centroid = radius + fillet * (10 - 3 * math.pi) / (12 - 3 * math.pi)
    volume = (1 - math.pi / 4) * fillet**2 * 2 * math.pi * centroid
    step = fillet / shells
    depths = ((i + 0.5) * step for i in range(shells))
    polar = sum(
        2 * math.pi * (radius + d) ** 3 * (fillet - math.sqrt(fillet**2 - (fillet - d) ** 2)) * step
        for d in depths
    )
    return volume, polar


@pytest.mark.parametrize(("fillet", "bore"), [(0.0, 0.0), (0.0, 24.0), (2.5, 0.0), (2.5, 24.0)])
def test_throw_by_hand(fillet: float, bore: float) -> None:
    scene = mikron_with(fillet, bore)
    half = exact(scene)
    volume, first, inertia = by_hand(fillet, bore)
    assert 2 * half.volume_mm3 == pytest.approx(volume, rel=1e-6)
    assert 2 * half.volume_mm3 * half.centre_mm[1] == pytest.approx(first, rel=1e-6)
    assert 2 * half.inertia_z_mm5 == pytest.approx(inertia, rel=1e-6)


OUTLINES = {
    "obround, hole": {"outline": "obround", "width_mm": 50.0, "pocket": [LOPSIDED]},
    "ellipse": {"outline": "ellipse", "semi_axis_throw_mm": 56.0, "semi_axis_lateral_mm": 37.0},
    "tapered, pockets": {
        "outline": "tapered",
        "main_radius_mm": 35.0,
        "pin_radius_mm": 25.0,
        "pocket": [
            {"shape": "side", "y_mm": 24.0, "length_mm": 20.0, "height_mm": 8.0, "depth_mm": 12.0},
            {"shape": "box", "face": "pin", "x_mm": 20.0, "y_mm": 2.0, "size_x_mm": 12.0, "size_y_mm": 10.0}
            | {"depth_mm": 5.0},
        ],
    },
    "profile": {
        "outline": "profile",
        "stations_mm": [-26.0, -8.0, 20.0, 56.0, 74.0],
        "half_widths_mm": [12.0, 36.0, 28.0, 31.0, 14.0],
    },
}


def outlined(name: str) -> Scene:
    journal = {"outer_diameter_mm": 42.0, "bore_diameter_mm": 16.0}
    return throw_scene(
        {
            "radius_mm": 48.0,
            "main_journal": {**journal, "length_mm": 40.0},
            "crankpin": {**journal, "length_mm": 36.0},
        },
        {"thickness_mm": 19.0, **OUTLINES[name]},
    )


@pytest.mark.parametrize("name", OUTLINES)
def test_solid_against_the_load_analysis(name: str) -> None:
    """Two routes to one throw: CAD kernel here, quadrature over the web's sections there."""
    scene = outlined(name)
    half, expected = exact(scene), throw_balance(scene)
    throw_kg = 2 * half.volume_mm3 * STEEL_KG_PER_MM3
    assert throw_kg == pytest.approx(expected.mass_kg, rel=1e-5)
    assert throw_kg * half.centre_mm[1] == pytest.approx(expected.throw_unbalance_kg_mm, rel=1e-5)
    assert throw_kg * half.centre_mm[0] == pytest.approx(expected.lateral_unbalance_kg_mm, abs=1e-3)
    inertia = 2 * half.inertia_z_mm5 * STEEL_KG_PER_MM3
    assert inertia == pytest.approx(expected.inertia_kg_mm2, rel=1e-5)


def test_evaluation_reports_them() -> None:
    hole = {"shape": "cylinder", "y_mm": 26.0, "diameter_mm": 8.0}
    scene = mikron_with(pocket=[{**hole, "x_mm": 18.0}, {**hole, "x_mm": -18.0}])
    found, expected = evaluate(Target("throw", scene), 12.0), throw_balance(scene)
    assert found.throw_kg == pytest.approx(expected.mass_kg, rel=1e-5)
    assert found.web_kg == pytest.approx(expected.web_kg, rel=1e-5)
    assert found.inertia_kg_mm2 == pytest.approx(expected.inertia_kg_mm2, rel=1e-5)
    assert found.unbalance_kg_mm == pytest.approx(expected.throw_unbalance_kg_mm, rel=1e-5)


def test_mesh_fills_the_solid() -> None:
    """Quadratic faces on round surfaces: the meshed volume, of the half x >= 0 where there is a mirror."""
    for scene, parts in ((mikron_with(), 2), (mikron_with(pocket=[LOPSIDED]), 1)):
        meshed = mesh_throw(scene, 6.0)
        assert meshed.mesh.mirrored == (parts == 2)
        assert parts * elastic(meshed.mesh, scene).volume_mm3 == pytest.approx(
            meshed.body.volume_mm3, rel=5e-4
        )
