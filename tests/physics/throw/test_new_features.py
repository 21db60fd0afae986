"""Kinds of features that the package does not have: material that is added, and a hole along no axis.

Each is one body; section, mass, cells and exact solid must follow from it alone.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
import pytest

from cranktopo.base.arrays import Array
from cranktopo.base.spans import Span, holds
from cranktopo.bodies.solid.shapes import add_bodies
from cranktopo.design.schema import Scene
from cranktopo.numerics.gmsh_session import cad_session
from cranktopo.throw.feature import Body
from cranktopo.throw.moments import body_moments
from cranktopo.throw.primitives import Box, Cylinder, Solid
from cranktopo.throw.web import web_bodies, web_spans

RADIUS, LEAN = 3.0, math.radians(35.0)
WEIGHT_LOW, WEIGHT_HIGH = np.array([-40.0, -60.0, 20.0]), np.array([40.0, -10.0, 32.0])


@dataclass(frozen=True)
class Drilling(Body):
    """A hole through the web at y, leaning from the crank axis toward x."""

    y_mm: float
    radius_mm: float
    lean: float

    def spans(self, y_mm: Array, z_mm: Array) -> Sequence[Span]:
        """At a height its section is an ellipse about a centre that moves along x."""
        middle = (z_mm - sum(self.z_mm) / 2) * math.tan(self.lean)
        half = np.sqrt(np.maximum(self.radius_mm**2 - (y_mm - self.y_mm) ** 2, 0.0)) / math.cos(self.lean)
        return [(middle - half, middle + half)]

    @property
    def y_range_mm(self) -> tuple[float, float]:
        return self.y_mm - self.radius_mm, self.y_mm + self.radius_mm

    @property
    def changing_z_mm(self) -> tuple[tuple[float, float], ...]:
        return (self.z_mm,)

    def solids(self) -> tuple[Solid, ...]:
        axis = np.array([math.tan(self.lean), 0.0, 1.0]) * 4 * (self.z_mm[1] - self.z_mm[0])
        start = np.array([0.0, self.y_mm, sum(self.z_mm) / 2]) - axis / 2
        return (Cylinder(tuple(start.tolist()), tuple(axis.tolist()), self.radius_mm),)


@dataclass(frozen=True)
class Counterweight(Body):
    """A block of material over part of the web's thickness, beyond the outline."""

    low_mm: tuple[float, float]
    high_mm: tuple[float, float]
    adds: ClassVar[bool] = True

    def spans(self, y_mm: Array, z_mm: Array) -> Sequence[Span]:
        inside = (y_mm > self.low_mm[1]) & (y_mm < self.high_mm[1])
        inside = inside & (z_mm >= self.z_mm[0]) & (z_mm <= self.z_mm[1])
        return [(np.where(inside, self.low_mm[0], 0.0), np.where(inside, self.high_mm[0], 0.0))]

    @property
    def x_range_mm(self) -> tuple[float, float]:
        return self.low_mm[0], self.high_mm[0]

    @property
    def y_range_mm(self) -> tuple[float, float]:
        return self.low_mm[1], self.high_mm[1]

    def solids(self) -> tuple[Solid, ...]:
        low, high = np.array([*self.low_mm, self.z_mm[0]]), np.array([*self.high_mm, self.z_mm[1]])
        return (Box(tuple(low.tolist()), tuple((high - low).tolist())),)


@pytest.fixture
def bodies(mikron: Scene) -> list[Body]:
    low, high = WEIGHT_LOW, WEIGHT_HIGH
    weight = Counterweight("weight", (low[2], high[2]), tuple(low[:2].tolist()), tuple(high[:2].tolist()))
    return [*web_bodies(mikron), weight, Drilling("drilling", mikron.web_z_mm, 24.0, RADIUS, LEAN)]


def test_a_leaning_hole_takes_its_cylinder(mikron: Scene, bodies: list[Body]) -> None:
    """Cut at both faces, a leaning cylinder has the area of its ellipse times the thickness."""
    plain, drilled = body_moments(web_bodies(mikron)), body_moments([*web_bodies(mikron), bodies[-1]])
    taken = math.pi * RADIUS**2 / math.cos(LEAN) * 19.0
    assert plain.volume - drilled.volume == pytest.approx(taken, rel=1e-8)
    # About the crank axis: offset along y, the ellipse's own inertia, and the centre's way along x.
    own = (RADIUS**2 + (RADIUS / math.cos(LEAN)) ** 2) / 4
    way = (19.0 * math.tan(LEAN)) ** 2 / 12
    assert plain.polar - drilled.polar == pytest.approx(taken * (24.0**2 + own + way), rel=1e-8)


def test_added_material_counts_once(mikron: Scene, bodies: list[Body]) -> None:
    """Against the kernel: the block overlaps the outline and the bore, the hole leans through both."""
    with cad_session("new features") as gmsh:
        (solid,) = add_bodies(gmsh.model.occ, bodies)
        volume = gmsh.model.occ.getMass(*solid)
        x, y, _ = gmsh.model.occ.getCenterOfMass(*solid)
    found = body_moments(bodies)
    assert found.volume == pytest.approx(volume, rel=1e-7)
    assert found.first_y == pytest.approx(volume * y, rel=1e-7)
    assert found.first_x == pytest.approx(volume * x, abs=1e-6 * volume)


def test_sections_follow(mikron: Scene, bodies: list[Body]) -> None:
    """Points beyond the outline in and above the block, in the bore, in the leaning hole near both faces."""
    start, end = mikron.web_z_mm
    shift = 8.0 * math.tan(LEAN)
    expected = {
        (30.0, -50.0, start + 1): True,
        (30.0, -50.0, end - 1): False,
        (0.0, -11.0, start + 1): False,
        (shift, 24.0, end - 1.5): False,
        (-shift, 24.0, start + 1.5): False,
        (shift, 24.0, start + 1.5): True,
    }
    for (x, y, z), solid in expected.items():
        spans = zip(*web_spans(bodies, np.array([y]), np.array([z])), strict=True)
        assert bool(holds(list(spans), np.array([x]))[0]) == solid, (x, y, z)
