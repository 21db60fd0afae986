"""Arcs of drafted bevels in pieces: the same surface, for which the CAD kernel finds the right section."""

from __future__ import annotations

import math
from itertools import pairwise

import pytest

from cranktopo.bodies.solid.checked import volume_mm3
from cranktopo.bodies.solid.throw import add_half_throw
from cranktopo.bodies.volume import half_throw_volume_mm3
from cranktopo.design.schema import Scene
from cranktopo.numerics.gmsh_session import cad_session
from cranktopo.throw.bevel_arc import BevelArc
from tests.featured_throws import featured_throw


@pytest.mark.parametrize("crown_mm", [0.5, -0.5])
def test_pieces_lie_on_the_arc_and_have_one_length(crown_mm: float) -> None:
    arc = BevelArc(60.0, 75.0, 8.0, crown_mm, 1.0, 5.0)
    points = [(0.0, 60.0), *arc.between_mm(4), (8.0, 75.0)]
    assert [float(arc.distance_mm(*point)) for point in points] == pytest.approx([0.0] * 5, abs=1e-9)
    lengths = [math.dist(a, b) for a, b in pairwise(points)]
    assert lengths == pytest.approx([lengths[0]] * 4, rel=1e-9)
    assert arc.between_mm(1) == []


def bevelled() -> Scene:
    """A rectangle with round corners of whose bevel the kernel cut one side 8 % too much."""
    scene = featured_throw(777)
    return scene.model_copy(update={"web": scene.web.model_copy(update={"counterweight": None})})


def test_a_bevel_that_was_cut_wrong_is_cut_in_pieces() -> None:
    scene = bevelled()
    with cad_session("half throw") as gmsh:
        built_mm3 = volume_mm3(gmsh.model.occ, add_half_throw(gmsh.model.occ, scene))
    assert built_mm3 == pytest.approx(half_throw_volume_mm3(scene), rel=1e-7)
