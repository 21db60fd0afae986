"""The body of a balancer shaft in the CAD kernel against the closed form, and what it refuses."""

import math

import pytest

from cranktopo.base.errors import CranktopoError
from cranktopo.bodies.solid.balancer import add_balancer, balancer_mm3
from cranktopo.design.loading import load_scene, parse_scene
from cranktopo.design.writing import toml_text
from cranktopo.numerics.gmsh_session import cad_session

STEPS = [
    {"length_mm": 60.0, "diameter_mm": 40.0, "bore_mm": 16.0},
    {"length_mm": 30.0, "diameter_mm": 40.0},
    {"length_mm": 50.0, "diameter_mm": 30.0, "bore_mm": 8.0},
]
DEEP = {"kind": "groove", "z_mm": 20.0, "diameter_mm": 36.0, "radius_mm": 0.8}
SHALLOW = {"kind": "groove", "z_mm": 110.0, "diameter_mm": 29.0, "radius_mm": 2.0}
HOLE = {"kind": "hole", "z_mm": 40.0, "diameter_mm": 12.0}
CROSS_OF_A_SMALL_BORE = {"kind": "hole", "z_mm": 125.0, "diameter_mm": 10.0}


def shaft(*notches):
    scene = load_scene("balancer-shaft")
    data = scene.model_dump(mode="json", exclude_none=True)
    data["balancer"] |= {"step": STEPS, "notch": list(notches), "weight": [], "probe": [], "gear": None}
    data["balancer"]["bearing"] = [{"z_mm": 5.0}, {"z_mm": 135.0}]
    return parse_scene(toml_text(type(scene).model_validate(data), "test"), "test")


def volume_mm3(scene):
    with cad_session("balancer") as gmsh:
        return gmsh.model.occ.getMass(*add_balancer(gmsh.model.occ, scene)[0])


CYLINDERS = math.pi / 4 * (60 * (40**2 - 16**2) + 30 * 40**2 + 50 * (30**2 - 8**2))


@pytest.mark.parametrize(
    "notches",
    [(), (DEEP,), (SHALLOW,), (HOLE,), (CROSS_OF_A_SMALL_BORE,), (DEEP, SHALLOW, HOLE)],
    ids=["plain", "deep groove", "shallow groove", "hole", "hole wider than the bore", "all"],
)
def test_volume_by_the_kernel_is_that_of_cylinders_less_the_notches(notches):
    """To 1e-4 of the notches, where the kernel cuts curved faces; the export allows 2e-5 of the body."""
    scene = shaft(*notches)
    removed = CYLINDERS - volume_mm3(scene)
    assert removed == pytest.approx(CYLINDERS - balancer_mm3(scene.balancer), rel=1e-4, abs=1e-3)


def test_a_notch_beyond_its_step_is_refused_with_its_key():
    with pytest.raises(CranktopoError, match=r"balancer\.notch\[0\]\.z_mm.*must be 6 mm from the ends"):
        volume_mm3(shaft(HOLE | {"z_mm": 57.0}))
