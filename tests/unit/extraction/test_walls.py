"""Draft, members and gaps measured on bodies of known size; undercuts of each way out."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from manifold3d import Manifold

from cranktopo.bodies.prisms import drillings, kept_solid
from cranktopo.bodies.undercuts import Withdrawal, undercuts
from cranktopo.design.schema import Scene
from cranktopo.numerics.surfaces.mesh import SurfaceMesh, mesh_of
from cranktopo.tasks.extraction.cutter import closed
from cranktopo.tasks.extraction.walls import (
    Walls,
    drafts_deg,
    gaps_mm,
    least,
    measure,
    members_mm,
    walls_of,
)
from tests.unit.extraction.surface_cases import drilled_beside, scene_with

PLATE = Manifold.cube((60, 40, 6)).rotate((20, 0, 30))
SLOTTED = Manifold.cube((60, 40, 30)) - Manifold.cube((7, 50, 12)).translate((20, -5, 20))


def measured(body: Manifold, of: str, spacing_mm: float = 1.5) -> float:
    walls = walls_of(mesh_of(body), spacing_mm)
    widths = members_mm(walls, walls) if of == "member" else gaps_mm(walls, walls)
    return least(widths, walls.areas_mm2)


@pytest.mark.parametrize(
    ("body", "of", "size_mm"),
    [
        (PLATE, "member", 6.0),
        (SLOTTED, "member", 20.0),
        (SLOTTED, "gap", 7.0),
        (Manifold.cylinder(40, 4, 4, 64), "member", 8.0),
        (PLATE, "gap", np.inf),
    ],
    ids=["plate", "block beside a slot", "slot", "rod", "nothing opposite"],
)
def test_widths_of_known_bodies(body: Manifold, of: str, size_mm: float) -> None:
    assert measured(body, of) == pytest.approx(size_mm, abs=0.05)


def wedge(draft_deg: float) -> Manifold:
    """A hull that narrows by tan(draft) on either side of its parting plane x = 2."""
    fall = 20 * np.tan(np.radians(draft_deg))
    corners = [(2, sy * 15, sz * 15) for sy in (-1, 1) for sz in (-1, 1)]
    corners += [
        (x, sy * (15 - fall), sz * (15 - fall)) for x in (-18, 22) for sy in (-1, 1) for sz in (-1, 1)
    ]
    return Manifold.hull_points(corners)


@pytest.mark.parametrize("draft_deg", [3.0, 7.0])
def test_draft_of_a_wedge(draft_deg: float) -> None:
    walls = walls_of(mesh_of(wedge(draft_deg)), 2.0)
    sides = walls.where(np.abs(walls.normals[:, 0]) < 0.9)
    for way in (Withdrawal("die", 0, 2.0), Withdrawal("mould", 0, None)):
        assert least(drafts_deg(sides, way), sides.areas_mm2) == pytest.approx(draft_deg, abs=1e-3)
    held = drafts_deg(
        Walls(sides.points_mm - [40, 0, 0], sides.normals, sides.areas_mm2), Withdrawal("die", 0, 2.0)
    )
    assert held.min() == pytest.approx(-draft_deg, abs=1e-3)


def block(*voids: Manifold) -> SurfaceMesh:
    body = Manifold.cube((60, 100, 19)).translate((-30, -25, 20))
    for void in voids:
        body -= void
    return mesh_of(body)


def test_an_oil_drilling_is_no_wall_that_was_shaped() -> None:
    """It leans, so that a die would be held by its lower half, and is no gap."""
    drilled = drilled_beside(scene_with(effects__manufacturing_constraint="on"), 5.0)
    wide = Manifold.cube((200, 200, 60)).translate((-100, -100, 0))
    found, plain = (measure(block(tool), wide, drilled, 2.5) for tool in (drillings(drilled), Manifold()))
    assert found.least_draft_deg == pytest.approx(plain.least_draft_deg, abs=0.01)
    assert found.least_gap_mm == plain.least_gap_mm is None
    own = Manifold.cylinder(40, 2.5, 2.5, 64, center=True).rotate((0, 60, 0)).translate((20, 0, 30))
    assert measure(block(own), wide, drilled, 2.5).least_draft_deg < -20, "another hole is a wall"


@pytest.mark.slow
def test_a_counterweight_that_is_kept_is_no_wall_that_was_shaped() -> None:
    """Its flanks have 2 deg (90 - 88), the wedge on top of it 7."""
    weight = {"outer_radius_mm": 80.0, "half_angle_deg": 88.0}
    box = {"shape": "box", "half_width_mm": 82.0, "y_min_mm": -82.0, "y_max_mm": 82.0}
    on: dict[str, Any] = {"effects__manufacturing_constraint": "on", "envelope": box}
    scene = scene_with(**on, web__counterweight=weight)
    body = mesh_of(wedge(7.0).translate((-2, 50, sum(scene.web_z_mm) / 2)) + kept_solid(scene))
    wide = Manifold.cube((400, 400, 200)).translate((-200, -200, -50))
    assert measure(body, wide, scene, 1.5).least_draft_deg == pytest.approx(7.0, abs=1e-3)
    assert measure(body, wide, scene_with(**on), 1.5).least_draft_deg == pytest.approx(2.0, abs=1e-3)


def scene_of(**settings: object) -> Scene:
    return scene_with(**{f"optimise__{key}": value for key, value in settings.items()})


SLOT = Manifold.cube((6, 8, 30)).translate((14, 15, 32))  # open in the pin's face, closed to the sides
SIDE_SLOT = Manifold.cube((30, 8, 8)).translate((14, 15, 26))  # open at the side x = 30
HOLLOW = Manifold.cube((6, 8, 8)).translate((14, 15, 26))
UNDER_THE_PIN = Manifold.cube((8, 6, 30)).translate((-4, 61, 32))
DIE, FACES = {"process": "forged"}, {"process": "forged", "parting": "web_faces"}


@pytest.mark.parametrize(
    ("settings", "void", "volume_mm3"),
    [
        (DIE, SLOT, 6 * 8 * 7),
        (DIE, SIDE_SLOT, 0.0),
        pytest.param(FACES, SLOT, 0.0, marks=pytest.mark.slow),
        (FACES, SIDE_SLOT, 16 * 8 * 8),  # on either side of mid-web, z = 29.5
        pytest.param(FACES, UNDER_THE_PIN, 8 * 6 * 7, marks=pytest.mark.slow),
        ({"process": "cast"}, SLOT, 6 * 8 * 7),
        pytest.param({"process": "cast"}, SIDE_SLOT, 0.0, marks=pytest.mark.slow),
        ({"process": "milled"}, SLOT, 0.0),
        pytest.param({"process": "milled"}, SIDE_SLOT, 0.0, marks=pytest.mark.slow),
        ({"process": "milled"}, HOLLOW, 6 * 8 * 8),
        ({"process": "milled"}, UNDER_THE_PIN, 8 * 6 * 7),
    ],
)
def test_undercuts_of_each_way(settings: dict[str, str], void: Manifold, volume_mm3: float) -> None:
    found = undercuts(block(void), scene_of(**settings), 0.5)
    assert found.volume_mm3 == pytest.approx(volume_mm3, rel=0.03, abs=1.0)


def test_a_closed_field_keeps_its_draft() -> None:
    """Oracle: a peak dilates by a cone, one slope per layer."""
    field = np.zeros((20, 41, 41))
    field[0] = np.clip(1 - np.hypot(*np.mgrid[-20:21, -20:21]) / 6, 0, 1)
    slope = 0.2
    found = closed(field, (slope, slope))
    assert np.all(np.diff(found, axis=0) >= 0)
    reach = [(layer[20] >= 0.5).sum() / 2 for layer in found]
    assert reach[-1] - reach[0] == pytest.approx(19 * slope, abs=1.0)
    np.testing.assert_array_equal(closed(field, (0.0, 0.0)), np.maximum.accumulate(field))
