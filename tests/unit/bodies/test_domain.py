"""Cells of the throw against closed-form volumes, for symmetric and lopsided bodies."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
import trimesh

from cranktopo.base.errors import CranktopoError
from cranktopo.bodies.cells.domain import Domain, build_domain, laterally_symmetric
from cranktopo.bodies.cells.grid import follow_grid, plan_grid
from cranktopo.bodies.memory import finest_resolution_mm, thinnest_wall_mm
from cranktopo.design.schema import Scene
from cranktopo.tasks.optimise.metrics import is_connected


def changed(scene: Scene, **tables: object) -> Scene:
    return Scene.model_validate({**scene.model_dump(), **tables})


def volume(domain: Domain, cells: np.ndarray) -> float:
    return float((cells * domain.volume_mm3).sum() / domain.symmetry_fraction)


def ring(outer: float, inner: float) -> float:
    return math.pi / 4 * (outer**2 - inner**2)


@pytest.mark.parametrize("resolution", [1.5, 2.3, 4.0])
def test_volumes_hold_on_any_grid(mikron: Scene, resolution: float) -> None:
    """Journals, web and envelope to 1e-6, however the grid cuts the cylinders."""
    web = build_domain(mikron, resolution, "web")
    holes = 2 * ring(24.0, 0.0)
    assert volume(web, web.web) == pytest.approx(2 * 19 * (50 * 48 + math.pi * 25**2 - holes), rel=1e-6)
    assert volume(web, web.pin) == pytest.approx(36 * ring(42.0, 24.0), rel=1e-6)
    envelope = build_domain(mikron, resolution)
    assert volume(envelope, envelope.design_fraction) == pytest.approx(2 * 19 * (96 * 116 - holes), rel=1e-6)
    journals = 36 * ring(42.0, 24.0) + 40 * ring(42.0, 24.0)
    assert volume(envelope, envelope.passive_fraction) == pytest.approx(journals, rel=1e-6)
    assert np.all(envelope.passive_fraction + envelope.design_fraction <= 1 + 1e-12)


def test_pockets_of_every_shape(mikron: Scene) -> None:
    plain = build_domain(mikron, 2.0, "web")
    pockets = {
        "through": {"shape": "cylinder", "x_mm": 12.0, "y_mm": 24.0, "diameter_mm": 10.0},
        "blind": {"shape": "cylinder", "face": "pin", "y_mm": 24.0, "diameter_mm": 10.0, "depth_mm": 5.0},
        "side": {"shape": "side", "y_mm": 24.0, "length_mm": 20.0, "height_mm": 10.0, "depth_mm": 6.0},
        "box": {
            "shape": "box",
            "face": "journal",
            "x_mm": -8.0,
            "y_mm": 24.0,
            "size_x_mm": 6.0,
            "size_y_mm": 12.0,
            "depth_mm": 7.0,
        },
    }
    removed = {
        "through": 19 * ring(10.0, 0),
        "blind": 5 * ring(10.0, 0),
        "side": 2 * 20 * 10 * 6,
        "box": 6 * 12 * 7,
    }
    for name, pocket in pockets.items():
        scene = changed(mikron, web={**mikron.web.model_dump(), "pocket": [pocket]})
        assert laterally_symmetric(scene, "web") == (name in ("blind", "side"))
        domain = build_domain(scene, 2.0, "web")
        missing = volume(plain, plain.web) - volume(domain, domain.web)
        assert missing == pytest.approx(2 * removed[name], rel=2e-4), name


def test_clearances_leave_the_journals(mikron: Scene) -> None:
    assert mikron.envelope is not None
    envelope = {**mikron.envelope.model_dump(), "bearing_clearance_mm": 1.0, "rod_clearance_mm": 2.5}
    domain = build_domain(changed(mikron, envelope=envelope), 2.0)
    holes = 2 * ring(24.0, 0.0)
    assert volume(domain, domain.design_fraction) == pytest.approx(2 * 15.5 * (96 * 116 - holes), rel=1e-6)
    stubs = 2 * 3.5 * ring(42.0, 24.0)
    journals = 76 * ring(42.0, 24.0)
    assert volume(domain, domain.passive_fraction) == pytest.approx(journals + stubs, rel=1e-6)


def test_envelope_shapes(mikron: Scene, tmp_path: Path) -> None:
    holes = 2 * ring(24.0, 0.0)
    cylinder = build_domain(changed(mikron, envelope={"shape": "cylinder", "radius_mm": 75.0}), 2.0)
    assert volume(cylinder, cylinder.design_fraction) == pytest.approx(
        38 * (math.pi * 75**2 - holes), rel=1e-6
    )
    points = [(-30, -30), (40, -30), (40, 80), (-30, 80)]  # not its own mirror image
    outline = build_domain(changed(mikron, envelope={"shape": "outline", "points_mm": points}), 2.0)
    assert outline.extent == "half"
    assert volume(outline, outline.design_fraction) == pytest.approx(38 * (70 * 110 - holes), rel=1e-6)
    cone = trimesh.creation.cone(radius=90.0, height=90.0, sections=96)  # narrows along the crank axis
    cone.apply_translation((0.0, 20.0, 10.0))
    cone.export(tmp_path / "space.stl")
    file = str(tmp_path / "space.stl")
    stl = build_domain(changed(mikron, envelope={"shape": "stl", "file": file}), 4.0)
    radii = np.array([100.0 - 20.0, 100.0 - 39.0])  # at the web faces z = 20 and 39
    frustum = math.pi * 19 / 3 * (radii[0] ** 2 + radii.prod() + radii[1] ** 2)
    assert volume(stl, stl.design_fraction) == pytest.approx(2 * (frustum - 19 * holes), rel=2e-3)


def test_quarter_is_half_of_the_half(mikron: Scene) -> None:
    quarter, half = build_domain(mikron, 3.0), build_domain(mikron, 3.0, extent="half")
    middle = int(half.grid.x_mm.searchsorted(-1e-9))
    right = half.design_fraction[middle:]
    np.testing.assert_array_equal(half.grid.z_mm, quarter.grid.z_mm)
    np.testing.assert_allclose(right, quarter.design_fraction[: len(right)], atol=1e-12)
    np.testing.assert_allclose(right, half.design_fraction[:middle][::-1], atol=1e-12)


def test_grid_meets_the_faces_and_halves(mikron: Scene) -> None:
    planes = (0.0, 20.0, 39.0, 57.0)
    grid = plan_grid((-48.0, 48.0), (-34.0, 82.0), planes, 1.5, "quarter")
    assert all(np.isclose(grid.z_mm, plane).any() for plane in planes)
    assert all(n % 2**grid.levels == 0 for n in grid.cells)
    assert max(step.max() for step in grid.steps_mm) <= 1.5 + 1e-12
    prime = plan_grid((-7.0, 13.0), (-11.0, 90.0), (0.0, 3.7, 9.1, 31.0), 0.97)
    assert all(n % 2**prime.levels == 0 for n in prime.cells)
    assert np.isclose(prime.x_mm, 0.0).any()


def test_a_body_that_moves_keeps_its_cells() -> None:
    before = (-48.0, 48.0), (-34.0, 82.0), (0.0, 20.0, 39.0, 57.0)
    after = (-50.0, 50.0), (-36.0, 90.0), (0.0, 22.0, 38.0, 60.0)
    grid = plan_grid(*before, 4.0, "quarter")
    found = follow_grid(grid, before, after)
    assert (found.levels, len(found.x_mm), len(found.z_mm)) == (grid.levels, len(grid.x_mm), len(grid.z_mm))
    assert np.isclose(found.x_mm, 50.0).any(), "the web's edge"
    assert found.y_mm[0] <= -36
    assert found.y_mm[-1] >= 90
    assert np.isclose(found.y_mm[:, None], grid.y_mm).any(axis=0).all(), "those along the throw stand"
    assert all(n % 2**found.levels == 0 for n in found.cells)
    for old, new in zip(before[2], after[2], strict=True):
        assert found.z_mm[np.isclose(grid.z_mm, old)] == pytest.approx(new)
    same = follow_grid(grid, before, before)
    assert (same.y_mm, same.z_mm) == (pytest.approx(grid.y_mm), pytest.approx(grid.z_mm))


def test_resolution_limits(mikron: Scene) -> None:
    assert thinnest_wall_mm(mikron) == 9.0
    finest = finest_resolution_mm(mikron, True, 2, 8000.0)
    assert (
        finest_resolution_mm(mikron, True, 2, 64000.0)
        < finest
        < finest_resolution_mm(mikron, False, 2, 8000.0)
    )


def test_envelope_that_misses_a_journal(mikron: Scene) -> None:
    envelope = {"shape": "box", "half_width_mm": 40.0, "y_min_mm": -30.0, "y_max_mm": 20.0}
    with pytest.raises(CranktopoError, match="crankpin"):
        build_domain(changed(mikron, envelope=envelope), 3.0)


def test_connectivity(mikron: Scene) -> None:
    domain = build_domain(mikron, 3.0)
    first, last = domain.web_layers
    density = np.ones(domain.design_fraction[:, :, first:last].shape)
    assert is_connected(domain, density)
    y = (domain.grid.y_mm[:-1] + domain.grid.y_mm[1:]) / 2
    density[:, (y > 22) & (y < 26)] = 0.0
    assert not is_connected(domain, density)
