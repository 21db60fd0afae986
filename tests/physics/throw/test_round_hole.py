"""The rounded floor of a round hole: the kernel makes a quarter of the torus a spline (random throw 153)."""

from __future__ import annotations

from collections import Counter
from dataclasses import replace
from typing import Any

import pytest

from cranktopo.bodies.solid import shapes
from cranktopo.bodies.solid.round_hole import add_round_hole, is_round
from cranktopo.numerics.gmsh_session import cad_session
from cranktopo.throw.primitives import Frustum
from cranktopo.throw.web import web_bodies
from tests.featured_throws import featured_throw

ROUND = {"Plane": 2, "Torus": 1, "Cone": 1}


def hole() -> Frustum:
    found = [solid for body in web_bodies(featured_throw(153)) if not body.adds for solid in body.solids()]
    (frustum,) = (solid for solid in found if isinstance(solid, Frustum))
    return frustum


def kinds(gmsh: Any, solid: Any) -> Counter[str]:
    gmsh.model.occ.synchronize()
    faces = gmsh.model.getBoundary(solid, oriented=False)
    return Counter(gmsh.model.getType(*face) for face in faces)


def test_a_floor_that_comes_as_a_spline_is_a_torus(monkeypatch: pytest.MonkeyPatch) -> None:
    with cad_session("hole") as gmsh:
        occ = gmsh.model.occ
        assert kinds(gmsh, shapes.add_solid(occ, hole())) == ROUND
        monkeypatch.setattr(shapes, "has_splines", lambda *_: False)
        as_it_comes = kinds(gmsh, shapes.add_solid(occ, hole()))
        assert as_it_comes["BSpline surface"] == 1, "the kernel makes a torus by itself: the turning can go"


@pytest.mark.parametrize("widening", [0.0, 2.0, -1.0])
def test_a_turned_hole_is_the_one_that_the_kernel_rounds(
    widening: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Of one volume to 1e-9, with a wall that is upright, opens or closes; along any axis."""
    corners, wide = ((-1, -1), (1, -1), (1, 1), (-1, 1)), 6.0 + widening
    rings = [[(size * x, 4.0 + height, size * y) for x, y in corners] for size, height in ((6, 0), (wide, 9))]
    frustum = Frustum(tuple(rings[0]), tuple(rings[1]), (6.0, wide), 2.5)
    monkeypatch.setattr(shapes, "has_splines", lambda *_: False)
    with cad_session("hole") as gmsh:
        occ = gmsh.model.occ
        ((_, rounded),) = shapes.add_solid(occ, frustum)
        turned = add_round_hole(occ, frustum)
        assert occ.getMass(3, turned) == pytest.approx(occ.getMass(3, rounded), rel=1e-8)
        boxes = [occ.getBoundingBox(3, tag) for tag in (turned, rounded)]
        assert boxes[0] == pytest.approx(boxes[1], abs=1e-3)


def test_a_hole_with_a_straight_side_is_not_round() -> None:
    assert is_round(hole())
    assert not is_round(replace(hole(), corner_radii=(5.0, 6.9)))
