"""The rod's sections and masses against the CAD kernel's solid."""

import pytest

from cranktopo.base.units import density_kg_per_mm3
from cranktopo.bodies.solid.rod import add_rod
from cranktopo.design.loading import load_scene
from cranktopo.design.named import with_values
from cranktopo.design.rod_body import rod_mass
from cranktopo.numerics.gmsh_session import cad_session

BASE = with_values(
    load_scene("mikron-iiic-rod"), {"rod.flange_mm": 5.0, "rod.web_mm": 6.0, "rod.shank_small_mm": 14.0}
)
SHAPES = {
    "I": {"rod.shank": "I"},
    "H and oil": {"rod.shank": "H", "rod.oil_hole_mm": 3.0, "rod.shank_fillet_mm": 4.0},
    "plain and sharp": {"rod.shank_fillet_mm": 0.0},
    "low bosses": {
        "rod.boss_above_mm": 5.0,
        "rod.shank": "I",
        "rod.oil_hole_mm": 2.0,
        "rod.bolt.held_in": "nut",
        "rod.bolt.grip_mm": 21.0,
    },
}


@pytest.mark.parametrize("changes", SHAPES.values(), ids=SHAPES)
def test_mass_and_inertia_against_the_solid(changes):
    """Without what is fitted: bolts, shells and bush."""
    bare = {"rod.bolt.hole_diameter_mm": 8.4, "rod.shells_kg": 0.0, "rod.bush_thickness_mm": 0.0}
    scene = with_values(BASE, {**bare, **changes})
    rod = scene.rod
    density = density_kg_per_mm3(rod.material.density_kg_m3)
    with cad_session("rod") as gmsh:
        body = add_rod(gmsh.model.occ, scene)
        volume = gmsh.model.occ.getMass(*body[0])
        centre = gmsh.model.occ.getCenterOfMass(*body[0])
        inertia = gmsh.model.occ.getMatrixOfInertia(*body[0])[8]
    found = rod_mass(rod, 166.0, scene.material)
    assert found.body_kg == pytest.approx(density * volume, rel=5e-6)
    bolts = found.total_kg - found.body_kg
    fitted = (found.y_mm[-3:] * found.y_kg[-3:]).sum() if bolts else 0.0
    assert found.total_kg * found.centre_mm - fitted == pytest.approx(density * volume * centre[1], rel=2e-5)
    spread = found.inertia_kg_mm2 + found.total_kg * found.centre_mm**2
    spread -= (found.y_mm[-3:] ** 2 * found.y_kg[-3:]).sum() + bolts * rod.bolt_distance_mm**2 / 4
    own_holes = 2 * density * 3.14159 / 64 * rod.bolt_hole_mm**4 * (rod.boss_above_mm + rod.boss_below_mm)
    exact = density * (inertia + volume * centre[1] ** 2)
    assert spread == pytest.approx(exact + own_holes, rel=2e-4)


def test_the_two_masses_have_the_rods_mass_and_centre():
    found = rod_mass(BASE.rod, 166.0, BASE.material)
    assert found.reciprocating_kg + found.rotating_kg == pytest.approx(found.total_kg, rel=1e-14)
    assert found.reciprocating_kg * 166.0 == pytest.approx(found.total_kg * found.centre_mm, rel=1e-14)


def test_a_lighter_rod_changes_the_engines_masses_at_once():
    lighter = with_values(BASE, {"rod.big_end_diameter_mm": 60.0})
    assert lighter.engine.masses.rod_rotating_kg < BASE.engine.masses.rod_rotating_kg
    found = rod_mass(lighter.rod, 166.0, lighter.material)
    assert lighter.engine.rod_parts_kg == (found.reciprocating_kg, found.rotating_kg)
