"""The seam of a hole that ends in a plane across the crank lies beyond, where nothing is left of it."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from cranktopo.bodies.solid.boundaries import faces_of
from cranktopo.bodies.solid.drilled import drilled
from cranktopo.bodies.solid.shapes import add_solid
from cranktopo.design.schema import Scene
from cranktopo.numerics.gmsh_session import DimTags, cad_session
from cranktopo.throw.drilling.table import drill_bores
from cranktopo.throw.primitives import Cylinder, Point
from tests.physics.throw.test_drillings import mikron

REACH_MM = 9.0


def radial(place_mm: float) -> Scene:
    """A drilling from the crankpin to its bore at right angles, so far from the middle."""
    end = {"on": "crankpin", "angle_deg": 40.0, "place_mm": place_mm}
    drilling = {"diameter_mm": 5.0, "outlet_radius_mm": 1.5, "from": end, "to": end | {"on": "crankpin_bore"}}
    return mikron(drilling, bore_diameter_mm=12.0)


def add_half_pin(occ: Any, scene: Scene) -> DimTags:
    """The crankpin up to its middle, bored and drilled."""
    pin, middle = scene.throw.crankpin, scene.pitch_mm / 2
    place = 0, scene.throw.radius_mm, middle - REACH_MM, 0, 0, REACH_MM
    bar, core = ([(3, occ.addCylinder(*place, radius))] for radius in (pin.radius_mm, pin.bore_radius_mm))
    return drilled(occ, list(occ.cut(bar, core)[0]), drill_bores(scene))


def test_no_strip_of_a_rounding_beside_the_middle() -> None:
    """The hole's middle is 0.14 mm off; a strip of that width was left of its rounding (random throw 714)."""
    with cad_session("half a crankpin") as gmsh:
        body = add_half_pin(gmsh.model.occ, radial(0.14))
        gmsh.model.occ.synchronize()
        kinds = [gmsh.model.getType(2, face) for face in faces_of(gmsh.model.occ, body)]
    assert kinds.count("BSpline surface") == 1


@pytest.mark.parametrize("seam", [1.0, -1.0])
@pytest.mark.parametrize("axis", [(3.0, -20.0, 0.0), (20.0, 5.0, 4.0), (-2.0, -9.0, -7.0)])
def test_the_seam_lies_toward_an_end(axis: Point, seam: float) -> None:
    """As near to it as the axis lets it, and the cylinder is the same."""
    start, radius = np.array([4.0, 30.0, -7.0]), 2.5
    with cad_session("hole") as gmsh:
        occ = gmsh.model.occ
        ((dim, tag),) = add_solid(occ, Cylinder((4.0, 30.0, -7.0), axis, radius, seam))
        occ.synchronize()
        assert occ.getMass(dim, tag) == pytest.approx(math.pi * radius**2 * math.dist(axis, (0, 0, 0)))
        (side,) = (face for face in faces_of(occ, [(3, tag)]) if gmsh.model.getType(2, face) == "Cylinder")
        points = gmsh.model.getValue(2, side, [0.0, 0.3, 0.0, 0.7]).reshape(-1, 3) - start
    along = np.array(axis) / math.dist(axis, (0, 0, 0))
    out = points - np.outer(points @ along, along)
    assert out[:, 2] == pytest.approx([seam * radius * math.hypot(*along[:2])] * 2)
