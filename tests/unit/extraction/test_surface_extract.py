"""Surface of known densities: volume, place, roundness, symmetry, islands, hollows, envelopes."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import trimesh
from scipy.spatial import cKDTree

from cranktopo.base.errors import CranktopoError, ExitCode
from cranktopo.bodies.cells.grid import DensityGrid
from cranktopo.design.loading import scene_from_dict
from cranktopo.design.schema import Scene
from cranktopo.numerics.surfaces.mesh import shell_volumes_mm3, solid_of
from cranktopo.tasks.extraction.checked_surface import check_surface
from cranktopo.tasks.extraction.cutter import find_iso
from cranktopo.tasks.extraction.half_throw import WebSurface, extract_half_throw
from tests.unit.extraction.surface_cases import (
    ball,
    everywhere,
    grid_of,
    obround,
    scene_with,
    united,
    without,
)

BORES_MM2 = 2 * math.pi * 12**2
MAIN_MM3 = math.pi * (21**2 - 12**2) * 20
PIN_MM3 = math.pi * (21**2 - 12**2) * 18
COARSE_MM = 3.0
"""Cells for what does not depend on them."""


@pytest.fixture(scope="module")
def slot() -> WebSurface:
    scene = scene_with()
    return extract_half_throw(grid_of(scene, obround()), scene)


@pytest.fixture(scope="module")
def lopsided() -> tuple[DensityGrid, WebSurface]:
    scene = scene_with()
    shape = united(obround(), ball(20, 12, 37, 14), ball(-12, 62, 22, 12))
    grid = grid_of(scene, shape)
    return grid, extract_half_throw(grid, scene)


def _centroid(vertices: np.ndarray, faces: np.ndarray) -> np.ndarray:
    return np.asarray(trimesh.Trimesh(vertices, faces, process=False).center_mass)


def test_slot_has_its_closed_form_volume(slot: WebSurface) -> None:
    exact = (math.pi * 25**2 + 48 * 50 - BORES_MM2) * 19
    assert slot.volume_mm3 == pytest.approx(exact, rel=6e-3)  # the bores of the density are cell-wise
    assert slot.volume_mm3 == pytest.approx(slot.target_volume_mm3, rel=2e-4)
    assert slot.web.volume_mm3 == pytest.approx(slot.volume_mm3, rel=1e-6)
    assert slot.dropped_islands == 0
    assert slot.cavities == 0


def test_solid_fraction_makes_the_slot_exact() -> None:
    # Cells cut by a bore hold their true part, by 8 x 8 subsamples: now the target is the true volume.
    scene = scene_with()
    grid = grid_of(scene, obround())
    fraction = np.ones(grid.density.shape)
    offsets = (np.arange(8) + 0.5) / 8 - 0.5
    x, y = np.meshgrid(grid.centres_mm(0), grid.centres_mm(1), indexing="ij")
    solid = np.zeros(x.shape)
    for u in offsets:
        for v in offsets:
            px, py = x + u * grid.cell_mm[0], y + v * grid.cell_mm[1]
            solid += (np.hypot(px, py) > 12) & (np.hypot(px, py - 48) > 12)
    fraction *= (solid / 64)[:, :, None]
    unbored = scene_with(throw__main_journal__bore_diameter_mm=0.0, throw__crankpin__bore_diameter_mm=0.0)
    full = grid_of(unbored, obround(), blur_mm=0.6)
    surface = extract_half_throw(full, scene, fraction)
    exact = (math.pi * 25**2 + 48 * 50 - BORES_MM2) * 19
    # A blurred round edge encloses a little more than the edge: + pi var, var = (pi blur)^2 / 3.
    blurred = exact + 19 * math.pi * (math.pi * 0.6) ** 2 / 3
    assert surface.volume_mm3 == pytest.approx(blurred, rel=1e-3)
    flank = surface.web.vertices_mm
    distance = np.hypot(flank[:, 0], flank[:, 1] - np.clip(flank[:, 1], 0, 48)) - 25
    flank_only = np.abs(distance) < 1
    assert flank_only.sum() > 300
    assert np.abs(distance[flank_only]).max() < 0.06


def test_surface_lies_where_the_density_puts_it(lopsided: tuple[DensityGrid, WebSurface]) -> None:
    grid, surface = lopsided
    x, y, z = np.meshgrid(*(grid.centres_mm(axis) for axis in range(3)), indexing="ij")
    mass = grid.density.sum()
    expected = [(grid.density * axis).sum() / mass for axis in (x, y, z)]
    found = _centroid(surface.web.vertices_mm, surface.web.faces)
    assert abs(expected[0]) > 0.5
    np.testing.assert_allclose(found, expected, rtol=0, atol=0.05)
    assert not surface.x_symmetric


def test_ball_on_the_web_is_round(lopsided: tuple[DensityGrid, WebSurface]) -> None:
    _, surface = lopsided
    points = surface.web.vertices_mm
    radius = np.linalg.norm(points - [20, 12, 37], axis=1)
    free = (np.hypot(points[:, 0], points[:, 1] - np.clip(points[:, 1], 0, 48)) > 28) & (points[:, 0] > 0)
    free &= points[:, 2] < 38.9
    assert free.sum() > 100
    assert np.abs(radius[free] - 14).max() < 0.15


def test_journals_are_round_and_have_their_volume(lopsided: tuple[DensityGrid, WebSurface]) -> None:
    mesh = lopsided[1].half_throw
    main = mesh.vertices_mm[mesh.vertices_mm[:, 2] < 20 - 1e-3]
    pin = mesh.vertices_mm[mesh.vertices_mm[:, 2] > 39 + 1e-3]
    for points, y in ((main, 0.0), (pin, 48.0)):
        radius = np.hypot(points[:, 0], points[:, 1] - y)
        off = np.minimum(np.abs(radius - 12), np.abs(radius - 21))
        assert off.max() < 1e-4
        assert (np.abs(radius - 21) < 1e-4).sum() > 200
        assert (np.abs(radius - 12) < 1e-4).sum() > 100
    assert mesh.vertices_mm[:, 2].min() == 0
    assert mesh.vertices_mm[:, 2].max() == 57
    journals = mesh.volume_mm3 - lopsided[1].web.volume_mm3
    assert journals == pytest.approx(MAIN_MM3 + PIN_MM3, rel=3e-4)


def test_chords_stay_within_two_micrometres(slot: WebSurface) -> None:
    mesh = slot.half_throw
    corners = mesh.corners_mm
    wall = (np.abs(np.hypot(corners[..., 0], corners[..., 1]) - 21) < 1e-4) & (corners[..., 2] < 20.001)
    flats = corners[wall.all(axis=1)]
    flats = flats[np.ptp(flats[..., 2], axis=1) > 1]
    middle = flats.mean(axis=1)
    assert len(flats) > 400
    depth = 21 - np.hypot(middle[:, 0], middle[:, 1])
    assert 1e-3 < depth.max() < 0.002


def test_symmetric_density_gives_a_symmetric_surface(slot: WebSurface) -> None:
    assert slot.x_symmetric
    mesh = slot.half_throw
    mirrored = mesh.vertices_mm * [-1, 1, 1]
    distance, _ = cKDTree(mesh.vertices_mm).query(mirrored)
    assert distance.max() < 1e-4
    body = solid_of(mesh)
    right, left = (body.trim_by_plane((side, 0.0, 0.0), 0.0).volume() for side in (1.0, -1.0))
    assert right == pytest.approx(left, rel=1e-6)
    assert right == pytest.approx(mesh.volume_mm3 / 2, rel=1e-6)


@pytest.mark.slow
def test_same_input_same_surface(slot: WebSurface) -> None:
    scene = scene_with()
    again = extract_half_throw(grid_of(scene, obround()), scene)
    np.testing.assert_array_equal(again.half_throw.vertices_mm, slot.half_throw.vertices_mm)
    np.testing.assert_array_equal(again.half_throw.faces, slot.half_throw.faces)


@pytest.mark.slow
def test_islands_are_dropped_counted_and_weighed() -> None:
    scene = scene_with()
    shape = united(obround(), ball(38, 0, 29, 4), ball(-38, 60, 30, 3))
    surface = extract_half_throw(grid_of(scene, shape, cell_mm=1.0, blur_mm=0.3), scene)
    assert surface.dropped_islands == 2
    assert surface.dropped_volume_mm3 == pytest.approx(4 / 3 * math.pi * (64 + 27), rel=0.05)
    total = surface.volume_mm3 + surface.dropped_volume_mm3
    assert total == pytest.approx(surface.target_volume_mm3, rel=2e-4)
    assert np.abs(surface.half_throw.vertices_mm[:, 0]).max() < 26


def test_a_heavy_island_fails_the_check() -> None:
    scene = scene_with()
    shape = united(obround(), ball(37, 0, 29.5, 8))
    surface = extract_half_throw(grid_of(scene, shape, COARSE_MM), scene)
    assert surface.dropped_islands == 1
    with pytest.raises(CranktopoError, match=r"1 islands with .* mm3 left out") as caught:
        check_surface(surface)
    assert caught.value.code == ExitCode.CRITERION_NOT_MET


@pytest.mark.slow
def test_hollows_stay_and_those_of_islands_go_with_them() -> None:
    scene = scene_with()
    island = without(ball(37, 0, 29.5, 7.5), ball(37, 0, 29.5, 4))
    shape = united(without(obround(), ball(0, 24, 29.5, 5)), island)
    grid = grid_of(scene, shape, cell_mm=1.0, blur_mm=0.3)
    surface = extract_half_throw(grid, scene)
    assert surface.cavities == 1
    assert surface.dropped_islands == 1
    body, hollow = sorted(shell_volumes_mm3(surface.half_throw), reverse=True)
    assert -hollow == pytest.approx(4 / 3 * math.pi * 125, rel=0.1)
    slot_mm3 = (math.pi * 25**2 + 48 * 50 - BORES_MM2) * 19
    assert body - MAIN_MM3 - PIN_MM3 == pytest.approx(slot_mm3, rel=5e-3)


def test_overlapping_journals_leave_each_other_alone() -> None:
    scene = scene_with("opposed-piston")
    surface = extract_half_throw(grid_of(scene, obround(40, 45), cell_mm=2.0), scene)
    journals = math.pi * (31**2 * 19 + 28**2 * 18)
    assert surface.half_throw.volume_mm3 - surface.web.volume_mm3 == pytest.approx(journals, rel=3e-4)
    points = surface.half_throw.vertices_mm
    main = points[points[:, 2] < 19 - 1e-3]
    assert np.abs(np.hypot(main[:, 0], main[:, 1]) - 31).max() < 1e-4
    assert check_surface(surface).bodies == 1


def test_bore_of_one_journal_does_not_cut_the_other() -> None:
    # The 40 mm pin bore lies partly under the main journal, which must stay whole.
    scene = scene_with("opposed-piston", throw__crankpin__bore_diameter_mm=40.0)
    surface = extract_half_throw(grid_of(scene, obround(40, 45), cell_mm=2.0), scene)
    pin = math.pi * (28**2 - 20**2) * 18
    journals = surface.half_throw.volume_mm3 - surface.web.volume_mm3
    assert journals == pytest.approx(math.pi * 31**2 * 19 + pin, rel=3e-4)
    ceiling = trimesh.Trimesh(surface.half_throw.vertices_mm, surface.half_throw.faces, process=False)
    hits, _, _ = ceiling.ray.intersects_location([[0.1, 28.0, 60.0]], [[0.0, 0.0, -1.0]])
    # Down the bore from the mid-pin plane: nothing until the main journal's end face at the web.
    assert hits[:, 2].max() == pytest.approx(19.0, abs=1e-6)


_ENVELOPES: list[tuple[dict[str, Any], float]] = [
    ({"shape": "box", "half_width_mm": 40.0, "y_min_mm": -31.0, "y_max_mm": 77.0}, 80 * 108),
    ({"shape": "cylinder", "radius_mm": 62.0}, math.pi * 62**2),
    ({"shape": "outline", "points_mm": [[-30, -30], [42, -30], [30, 75], [-30, 75]]}, 66 * 105),
]


def _extract_full(scene: Scene, exact_mm3: float) -> WebSurface:
    """Solid in every cell, told by the solid fraction how much of the grid the envelope holds."""
    shape, cell = (80, 90, 10), np.array([1.8, 1.8, 1.9])
    origin = np.array([-72.0, -70.0, 20.0])
    fraction = np.full(shape, exact_mm3 / (np.prod(shape) * np.prod(cell)))
    return extract_half_throw(DensityGrid(origin, cell, np.ones(shape)), scene, fraction)


@pytest.mark.parametrize(
    ("envelope", "area_mm2"),
    [_ENVELOPES[0], *(pytest.param(*other, marks=pytest.mark.slow) for other in _ENVELOPES[1:])],
)
def test_full_density_fills_the_exact_envelope(envelope: dict[str, Any], area_mm2: float) -> None:
    scene = scene_with(envelope=envelope)
    exact = (area_mm2 - BORES_MM2) * 19
    assert _extract_full(scene, exact).volume_mm3 == pytest.approx(exact, rel=1e-4)


@pytest.mark.slow
def test_sides_of_the_envelope_are_met_squarely() -> None:
    # A bar that runs into the envelope's side wall: its section at the wall is that of its inside.
    scene = scene_with(envelope__half_width_mm=36.0)
    bar = united(obround(), lambda x, y, z: np.minimum(6 - np.abs(y - 24), x + 60))
    grid = grid_of(scene, bar, cell_mm=1.0, blur_mm=0.3)
    outside = np.abs(grid.centres_mm(0)) > 36
    density = grid.density.copy()
    density[outside] = 0.0
    surface = extract_half_throw(DensityGrid(grid.origin_mm, grid.cell_mm, density), scene)
    points = surface.web.vertices_mm
    wall = points[np.abs(points[:, 0] - 36) < 1e-4]
    assert points[:, 0].max() == pytest.approx(36, abs=1e-4)
    np.testing.assert_allclose([wall[:, 1].min(), wall[:, 1].max()], [18, 30], atol=0.1)
    np.testing.assert_allclose([wall[:, 2].min(), wall[:, 2].max()], [20, 39], atol=1e-5)


def test_stl_envelope_is_cut_exactly(tmp_path: Path) -> None:
    block = trimesh.creation.box(bounds=[[-33, -28, 10], [33, 76, 45]])
    block.export(tmp_path / "space.stl")
    scene = scene_with(envelope={"shape": "stl", "file": str(tmp_path / "space.stl")})
    exact = (66 * 104 - BORES_MM2) * 19
    assert _extract_full(scene, exact).volume_mm3 == pytest.approx(exact, rel=1e-4)


def test_broken_stl_envelope_is_refused(tmp_path: Path) -> None:
    block = trimesh.creation.box(extents=[60, 60, 60])
    trimesh.Trimesh(block.vertices, block.faces[1:]).export(tmp_path / "open.stl")
    scene = scene_with(envelope={"shape": "stl", "file": str(tmp_path / "open.stl")})
    grid = grid_of(scene, everywhere())
    with pytest.raises(CranktopoError, match="must be a closed surface"):
        extract_half_throw(grid, scene)
    missing = scene_with(envelope={"shape": "stl", "file": str(tmp_path / "absent.stl")})
    with pytest.raises(CranktopoError, match="cannot be read"):
        extract_half_throw(grid, missing)


def test_clearances_keep_the_web_away_and_the_journals_on() -> None:
    scene = scene_with(envelope__bearing_clearance_mm=3.0, envelope__rod_clearance_mm=2.0)
    grid = grid_of(scene, obround(), cell_mm=1.0)
    x, y, z = np.meshgrid(*(grid.centres_mm(axis) for axis in range(3)), indexing="ij")
    density = grid.density.copy()
    density[(z < 23) & (np.hypot(x, y) > 21)] = 0
    density[(z > 37) & (np.hypot(x, y - 48) > 21)] = 0
    surface = extract_half_throw(DensityGrid(grid.origin_mm, grid.cell_mm, density), scene)
    slot_mm2 = math.pi * 25**2 + 48 * 50 - BORES_MM2
    stub_mm2 = math.pi * (21**2 - 12**2)
    assert surface.volume_mm3 == pytest.approx(slot_mm2 * 14 + stub_mm2 * 5, rel=6e-3)
    points = surface.half_throw.vertices_mm
    collar = points[(points[:, 2] > 20.001) & (points[:, 2] < 22.999)]
    near_main = collar[np.hypot(collar[:, 0], collar[:, 1]) > 13]
    near_main = near_main[np.hypot(near_main[:, 0], near_main[:, 1] - 48) > 13]
    assert np.all(np.hypot(near_main[:, 0], near_main[:, 1]) < 21.0001)
    check_surface(surface)


def test_without_envelope_the_grid_bounds_the_web() -> None:
    data = scene_with().model_dump(exclude_none=True)
    del data["envelope"]
    scene = scene_from_dict(data)
    surface = extract_half_throw(grid_of(scene, obround(), COARSE_MM), scene)
    assert surface.volume_mm3 == pytest.approx(surface.target_volume_mm3, rel=2e-4)


def test_empty_density_is_refused() -> None:
    scene = scene_with()
    grid = grid_of(scene, everywhere())
    empty = DensityGrid(grid.origin_mm, grid.cell_mm, np.zeros(grid.density.shape))
    with pytest.raises(CranktopoError, match="density is empty") as caught:
        extract_half_throw(empty, scene)
    assert caught.value.code == ExitCode.CRITERION_NOT_MET


def test_uniform_grey_has_no_surface() -> None:
    scene = scene_with()
    grid = grid_of(scene, everywhere(), COARSE_MM)
    grey = DensityGrid(grid.origin_mm, grid.cell_mm, np.full(grid.density.shape, 0.3))
    with pytest.raises(CranktopoError, match="no iso-value encloses") as caught:
        extract_half_throw(grey, scene)
    assert "too grey" in caught.value.hint


def test_web_that_does_not_connect_is_refused() -> None:
    scene = scene_with()
    shape = united(ball(0, 0, 29.5, 22), ball(0, 60, 29.5, 22))
    grid = grid_of(scene, shape, COARSE_MM)
    gap = (grid.centres_mm(1) > 24) & (grid.centres_mm(1) < 36)
    density = grid.density.copy()
    density[:, gap] = 0.0
    with pytest.raises(CranktopoError, match="does not connect journal and crankpin"):
        extract_half_throw(DensityGrid(grid.origin_mm, grid.cell_mm, density), scene)


def test_grid_of_another_web_is_refused() -> None:
    scene = scene_with()
    grid = grid_of(scene, obround())
    shifted = DensityGrid(grid.origin_mm + np.array([0, 0, 0.5]), grid.cell_mm, grid.density)
    with pytest.raises(CranktopoError, match="must span the web from z = 20 to 39 mm"):
        extract_half_throw(shifted, scene)


@pytest.mark.parametrize("bad", [np.full((2, 2, 2), np.nan), np.full((2, 2, 2), 1.1), np.zeros((2, 2))])
def test_grid_refuses_what_is_no_density(bad: np.ndarray) -> None:
    with pytest.raises(ValueError, match="DensityGrid needs"):
        DensityGrid(np.zeros(3), np.ones(3), bad)


def test_find_iso_meets_a_smooth_target_and_reports_a_jump() -> None:
    evaluations: list[float] = []

    def volume(iso: float) -> float:
        evaluations.append(iso)
        return 1000 * (1 - iso) ** 3

    iso = find_iso(volume, 200.0)
    assert 1000 * (1 - iso) ** 3 == pytest.approx(200, rel=1e-4)
    assert len(evaluations) < 10
    beside = find_iso(lambda iso: 200.5 if iso < 0.546 else 199.9, 200.0)
    assert beside == pytest.approx(0.546, abs=1e-4)
    assert beside >= 0.546, "the side of the jump that is nearer"
    with pytest.raises(CranktopoError, match=r"jumps from 10 to 900 mm3 at 0\.7"):
        find_iso(lambda iso: 900.0 if iso < 0.7 else 10.0, 200.0)
