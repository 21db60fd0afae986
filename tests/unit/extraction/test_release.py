"""Surfaces of densities that a process can make as they are: pockets, faces and edges stay in place."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from cranktopo.bodies.cells.grid import DensityGrid
from cranktopo.bodies.prisms import envelope_solid
from cranktopo.bodies.undercuts import Withdrawal, undercuts
from cranktopo.tasks.extraction.cutter import build_cutter, fine_field
from cranktopo.tasks.extraction.half_throw import WebSurface, extract_half_throw
from cranktopo.tasks.extraction.walls import Walls, from_parting_mm, measure
from tests.unit.extraction.surface_cases import Array, Distance, grid_of, obround, scene_with, united, without

CELL_MM, DRAFT_DEG, DEPTH_MM, MIDDLE_MM = 3.0, 5.0, 6.0, 29.5
SLOPE = np.tan(np.radians(DRAFT_DEG))
FACES: dict[str, Any] = {"process": "forged", "parting": "web_faces", "draft_deg": DRAFT_DEG}


def scene_of(settings: dict[str, Any]) -> Any:
    return scene_with(
        **{f"optimise__{key}": value for key, value in settings.items()},
        effects__manufacturing_constraint="on",
    )


def made(inside_mm: Distance, settings: dict[str, Any]) -> tuple[DensityGrid, WebSurface]:
    """The surface of a body, its density sharp and its filtered one falling over three cells."""
    scene = scene_of(settings)
    smooth = grid_of(scene, ramp_of(inside_mm), CELL_MM)
    grid = grid_of(scene, inside_mm, CELL_MM)
    return grid, extract_half_throw(grid, scene, smooth=smooth.density)


def ramp_of(inside_mm: Distance) -> Distance:
    """The distance whose logistic density is a straight ramp of three cells."""

    def of(x: Array, y: Array, z: Array) -> Array:
        share = np.clip(0.5 + inside_mm(x, y, z) / (3 * CELL_MM), 1e-9, 1 - 1e-9)
        return 0.6 * np.log(share / (1 - share))

    return of


def drafted(radius_mm: float) -> Distance:
    """A slot outline, widest in mid-web."""
    return lambda x, y, z: obround(radius_mm)(x, y, z) - SLOPE * np.abs(z - MIDDLE_MM)


def pocket(x: Array, y: Array, z: Array) -> Array:
    """Sunk from the pin's face, clear of both journals, wider toward the face."""
    floor = 39.0 - DEPTH_MM
    return np.minimum(11.0 + SLOPE * (z - floor) - np.hypot(x - 22.0, y - 24.0), z - floor)


@pytest.mark.slow
@pytest.mark.parametrize("settings", [FACES, FACES | {"process": "cast"}, {"process": "milled"}])
def test_a_shallow_pocket_stays_open(settings: dict[str, Any]) -> None:
    """Its depth is less than the three cells by which the field goes on beyond the face."""
    _, web = made(without(drafted(42.0), pocket), settings)
    assert web.iso_value == pytest.approx(0.5, abs=0.02)
    down = web.half_throw.as_trimesh().ray.intersects_location([[22.3, 24.2, 60.0]], [[0.0, 0.0, -1.0]])[0]
    assert down[:, 2].max() == pytest.approx(39.0 - DEPTH_MM, abs=0.25 * CELL_MM)


def test_walls_keep_their_draft_up_to_the_sides() -> None:
    """A bar across the whole envelope, highest in x = 0."""
    settings = {"process": "forged", "draft_deg": DRAFT_DEG}
    scene = scene_of(settings)
    grid, web = made(lambda x, y, z: 38.0 - SLOPE * np.abs(x) - np.abs(y - 24.0), settings)
    found = measure(web.half_throw, envelope_solid(scene, grid), scene, CELL_MM)
    assert found.least_draft_deg == pytest.approx(DRAFT_DEG, abs=0.5)


@pytest.mark.parametrize("settings", [{"process": "forged", "draft_deg": DRAFT_DEG}, FACES])
def test_the_field_is_released_beside_the_grid_too(settings: dict[str, Any]) -> None:
    """Whatever the density: what goes on beyond a face would else grow into a spur at it."""
    scene = scene_of(settings)
    grid = grid_of(scene, obround(30.0), CELL_MM)
    random = np.random.default_rng(1).random(grid.density.shape)
    grid = replace(grid, density=random)
    field = fine_field(build_cutter(grid, scene, None, None), grid, scene, None, None)
    axis, parted = (2, MIDDLE_MM) if "parting" in settings else (0, 0.0)
    places = field.origin_mm[axis] + field.spacing_mm[axis] * np.arange(field.values.shape[axis])
    values = np.moveaxis(field.values, axis, 0)
    far, near = values[places > parted], values[places < parted][::-1]
    assert max(np.diff(half[:-1], axis=0).max() for half in (far, near)) <= 0.0


def test_nothing_is_caught_where_one_half_ends() -> None:
    """A foot on one half only: its edge lies in the parting plane."""

    def foot(x: Array, y: Array, z: Array) -> Array:
        return np.minimum(drafted(36.0)(x, y, z), MIDDLE_MM - z)

    _, web = made(united(drafted(28.0), foot), FACES)
    found = undercuts(web.web, scene_of(FACES), CELL_MM / 2)
    assert found.negligible
    assert found.deepest_mm < 0.1 * CELL_MM


def test_a_mould_parts_where_walls_of_both_halves_meet() -> None:
    """A rod across the way with a plate beside it, whose sides face away from each other."""
    angles = np.linspace(0, 2 * np.pi, 400, endpoint=False) + 1e-3
    ring = np.stack([np.cos(angles), np.sin(angles), 0 * angles], axis=1)
    sides = np.array([[30.0, 0, 0], [31.0, 0, 0]])
    normals = np.concatenate([ring, [[-1.0, 0, 0], [1.0, 0, 0]]])
    walls = Walls(np.concatenate([10 * ring, sides]), normals, np.ones(402))
    found = from_parting_mm(walls, Withdrawal("mould", 0, None))
    away = np.minimum(np.abs(angles - np.pi / 2), np.abs(angles - 3 * np.pi / 2))
    near = away < 1.0
    np.testing.assert_allclose(found[:400][near], 20 * np.sin(away[near] / 2), atol=0.4)
    assert np.isinf(found[400:]).all()
    assert np.isinf(from_parting_mm(walls, Withdrawal("mill", None, None))).all()
    straight = np.stack([0.01 * np.sin(50 * angles), np.cos(angles), np.sin(angles)], axis=1)
    along = Walls(10 * straight, straight, np.ones(400))
    assert np.isinf(from_parting_mm(along, Withdrawal("mould", 0, None))).all()
    np.testing.assert_allclose(
        from_parting_mm(walls, Withdrawal("die", 0, 2.0)), np.abs(walls.points_mm[:, 0] - 2)
    )
