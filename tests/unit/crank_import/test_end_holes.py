"""Bolt holes of an end as triangles tell them: alike but for the scatter of corners."""

from __future__ import annotations

import math

import numpy as np
import pytest

from cranktopo.tasks.crank_import.end_steps import EndFinder
from cranktopo.tasks.importing.faces import CylinderFace, Faces

ALONG = np.array([0.0, 0.0, 1.0])


def upright(x: float, y: float, radius_mm: float, outward: bool) -> CylinderFace:
    at = np.array([x, y, 0.0])
    return CylinderFace(at, ALONG, radius_mm, (0.0, 12.0), 2 * math.pi, outward, at + 6 * ALONG)


@pytest.mark.parametrize(("wider_mm", "left"), [(3e-6, 0), (0.01, 6)])
def test_bolt_holes_are_not_told_as_left(wider_mm: float, left: int) -> None:
    """One of six is wider by the scatter of an STL file; holes that are unlike are no circle of bolts."""
    flange = upright(0.0, 0.0, 40.0, True)
    places = 30.0 * np.exp(2j * np.pi * np.arange(6) / 6)
    radii = [4.0] * 5 + [4.0 + wider_mm]
    holes = [upright(at.real, at.imag, radius, False) for at, radius in zip(places, radii, strict=True)]
    finder = EndFinder(Faces((flange, *holes), (), (), ()), np.zeros(3), ALONG)
    steps = finder.steps_beyond([flange], 0.0, 1)
    assert len(list(finder.holes_left(steps, 0.0, 1))) == left
