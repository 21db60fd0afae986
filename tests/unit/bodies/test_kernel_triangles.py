"""Triangles that the kernel leaves out: slivers are closed, whole faces are not."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

import numpy as np
import pytest

from cranktopo.bodies.solid.files import surface_of
from cranktopo.bodies.solid.step import closed_surface
from cranktopo.design.loading import scene_from_dict
from cranktopo.numerics.surfaces.mesh import SurfaceMesh, manifold_fault
from tests.hostile.featured_engines import featured_engine

SIDES, RADIUS_MM, HEIGHT_MM = 60, 5.0, 3.0


def fan(corners: Sequence[int]) -> np.ndarray:
    """Triangles of a convex polygon."""
    first, *others = corners
    return np.array([[first, a, b] for a, b in pairwise(others)])


def prism(upper: np.ndarray) -> SurfaceMesh:
    """A prism with these triangles on top, of the corners from 0 on."""
    angle = 2 * np.pi * np.arange(SIDES) / SIDES
    ring = RADIUS_MM * np.column_stack([np.cos(angle), np.sin(angle)])
    points = np.vstack([np.column_stack([ring, np.full(SIDES, z)]) for z in (0.0, HEIGHT_MM)])
    at, after = np.arange(SIDES), np.roll(np.arange(SIDES), -1)
    walls = [np.column_stack([at, after, after + SIDES]), np.column_stack([at, after + SIDES, at + SIDES])]
    return SurfaceMesh(points, np.vstack([*walls, fan(range(SIDES))[:, ::-1], upper + SIDES]))


EXACT_MM3 = SIDES / 2 * RADIUS_MM**2 * np.sin(2 * np.pi / SIDES) * HEIGHT_MM


@pytest.mark.parametrize("left_out", [1, 2, 3, 6])
def test_a_hole_between_a_chord_and_its_arc_is_closed(left_out: int) -> None:
    """Beside the rounded outlet of a random engine five edges were left: a hole that no command took."""
    whole, holed = prism(fan(range(SIDES))), prism(fan(range(SIDES))[left_out:])
    assert manifold_fault(holed)
    found = closed_surface(holed)
    assert manifold_fault(found) == ""
    assert whole.volume_mm3 == pytest.approx(EXACT_MM3, rel=1e-12)
    assert found.volume_mm3 == pytest.approx(EXACT_MM3, rel=1e-12)


def test_holes_that_touch_in_vertices_are_closed() -> None:
    """Beside the outlets of two random engines: three arcs one after the other, each left out."""
    holed = prism(fan([0, 5, 10, *range(15, SIDES)]))
    assert manifold_fault(holed)
    found = closed_surface(holed)
    assert manifold_fault(found) == ""
    assert found.volume_mm3 == pytest.approx(EXACT_MM3, rel=1e-12)


def test_a_gap_between_two_chains_of_edges_is_closed() -> None:
    """A random engine had one of 60 edges where the halves of its throw meet in an outlet."""
    holed, arc = prism(fan(range(SIDES))), range(1, 20)
    inner = holed.vertices_mm[[corner + SIDES for corner in arc]] * [0.999, 0.999, 1.0]
    top = [SIDES, *range(2 * SIDES, 2 * SIDES + len(arc)), *range(SIDES + 20, 2 * SIDES)]
    faces = np.vstack([holed.faces[: -(SIDES - 2)], fan(top)])
    holed = SurfaceMesh(np.vstack([holed.vertices_mm, inner]), faces)
    assert manifold_fault(holed)
    found = closed_surface(holed)
    assert manifold_fault(found) == ""
    assert found.volume_mm3 == pytest.approx(EXACT_MM3, rel=1e-12)


def test_a_face_that_is_missing_stays_so() -> None:
    assert manifold_fault(closed_surface(prism(fan(range(SIDES))[SIDES - 2 :])))


@pytest.mark.slow
def test_facets_of_a_drilled_throw_are_closed_too() -> None:
    """A random engine whose facets of even size leave slivers out beside its drilling: no drawing before."""
    assert not manifold_fault(surface_of(scene_from_dict(featured_engine(40), whole=True), "throw"))
