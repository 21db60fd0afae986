"""Triangles that the kernel leaves out: slivers are closed, whole faces are not."""

from __future__ import annotations

import numpy as np
import pytest

from cranktopo.bodies.solid.step import _sound
from cranktopo.numerics.surfaces.mesh import SurfaceMesh, manifold_fault

SIDES, RADIUS_MM, HEIGHT_MM = 60, 5.0, 3.0


def prism(left_out: int) -> SurfaceMesh:
    """A prism without the fan of its upper face across its first sides: that of a chord and its arc."""
    angle = 2 * np.pi * np.arange(SIDES) / SIDES
    ring = RADIUS_MM * np.column_stack([np.cos(angle), np.sin(angle)])
    points = np.vstack([np.column_stack([ring, np.full(SIDES, z)]) for z in (0.0, HEIGHT_MM)])
    at, after = np.arange(SIDES), np.roll(np.arange(SIDES), -1)
    walls = [np.column_stack([at, after, after + SIDES]), np.column_stack([at, after + SIDES, at + SIDES])]
    fan = np.column_stack([np.zeros(SIDES - 2, int), np.arange(1, SIDES - 1), np.arange(2, SIDES)])
    return SurfaceMesh(points, np.vstack([*walls, fan[:, ::-1], fan[left_out:] + SIDES]))


@pytest.mark.parametrize("left_out", [1, 2, 3, 6])
def test_a_hole_between_a_chord_and_its_arc_is_closed(left_out: int) -> None:
    """Beside the rounded outlet of a random engine five edges were left: a hole that no command took."""
    whole, holed = prism(0), prism(left_out)
    assert manifold_fault(holed)
    found = _sound(holed)
    assert manifold_fault(found) == ""
    exact = SIDES / 2 * RADIUS_MM**2 * np.sin(2 * np.pi / SIDES) * HEIGHT_MM
    assert whole.volume_mm3 == pytest.approx(exact, rel=1e-12)
    assert found.volume_mm3 == pytest.approx(exact, rel=1e-12)


def test_a_face_that_is_missing_stays_so() -> None:
    assert manifold_fault(_sound(prism(SIDES - 2)))
