"""Torsional stiffness of four throws against the classical formulas of crank-shaft practice.

The mean of Carter's and Ker Wilson's formula for throws of ordinary proportions: web thickness 0.4 to 0.5 of
the main journal's diameter, web width 1.3 to 1.5, throw 0.75 to 1.15, solid journals or a moderate bore,
sections free to move laterally. These are the ranges of the throws below, not a published limit.
"""

from __future__ import annotations

import math

import pytest

from cranktopo.bodies.mesh.solid_mesh import mesh_throw
from cranktopo.design.schema import Scene
from cranktopo.tasks.throw_fea.condense import condense, torsional_stiffness_Nm_per_rad
from cranktopo.throw.outline import ObroundWeb
from tests.physics.fea.evaluation_cases import elastic, throw_scene

SHEAR_MPA = 210e3 / 2.6
MAIN, PIN = "main_journal", "crankpin"


def throw(main: tuple[float, ...], pin: tuple[float, ...], web: tuple[float, float], radius: float) -> Scene:
    """Journals (diameter, bore, length), obround web (thickness, width), throw radius, all mm."""
    names = ("outer_diameter_mm", "bore_diameter_mm", "length_mm")
    journals = {name: dict(zip(names, j, strict=True)) for name, j in ((MAIN, main), (PIN, pin))}
    thickness, width = web
    shape = {"thickness_mm": thickness, "outline": "obround", "width_mm": width}
    return throw_scene({"radius_mm": radius, **journals}, shape)


THROWS = {
    "car": throw((60, 0, 36), (54, 0, 34), (24, 80), 45),
    "long throw": throw((70, 0, 60), (70, 0, 50), (30, 90), 80),
    "industrial": throw((100, 0, 90), (100, 0, 90), (50, 140), 100),
    "medium speed, bored": throw((150, 60, 120), (150, 60, 110), (70, 220), 160),
}


def carter_and_ker_wilson(scene: Scene) -> tuple[float, float]:
    """k = (pi G / 32) / S in N m/rad, S being the sum of the parts' lengths over d^4."""
    main, pin, web = scene.throw.main_journal, scene.throw.crankpin, scene.web
    j = main.outer_diameter_mm**4 - main.bore_diameter_mm**4
    p = pin.outer_diameter_mm**4 - pin.bore_diameter_mm**4
    assert isinstance(web, ObroundWeb)
    flank = web.thickness_mm * web.width_mm**3
    radius, thickness = scene.throw.radius_mm, web.thickness_mm
    overlap = 0.2 * (main.outer_diameter_mm + pin.outer_diameter_mm)
    carter = (main.length_mm + 0.8 * thickness) / j + 0.75 * pin.length_mm / p + 1.5 * radius / flank
    wilson = (main.length_mm + 0.4 * main.outer_diameter_mm) / j
    wilson += (pin.length_mm + 0.4 * pin.outer_diameter_mm) / p + (radius - overlap) / flank
    factor = math.pi * SHEAR_MPA / 32 / 1000
    return factor / carter, factor / wilson


@pytest.mark.parametrize("name", THROWS)
def test_mean_of_carter_and_ker_wilson(name: str) -> None:
    scene = THROWS[name]
    size = scene.throw.crankpin.outer_diameter_mm / 7
    model = elastic(mesh_throw(scene, size, graded=False).mesh, scene)
    found = torsional_stiffness_Nm_per_rad(condense(model, scene, "antisymmetric", "odd"), "free")
    assert sum(carter_and_ker_wilson(scene)) / 2 == pytest.approx(found, rel=0.12)
