"""Densities of bodies with a closed form come back: volume, distance, thickness; formats keep units."""

from __future__ import annotations

import io
import math
import zipfile
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest
import trimesh
from manifold3d import Manifold
from scipy import ndimage

from cranktopo.base.formats import SURFACES
from cranktopo.bodies.cells.grid import DensityGrid
from cranktopo.numerics.surfaces.files import write_surface
from cranktopo.numerics.surfaces.mesh import SurfaceMesh, mesh_of
from cranktopo.tasks.extraction.cutter import SIMPLIFY_MM, distances_mm, find_iso
from cranktopo.tasks.extraction.half_throw import extract_half_throw
from cranktopo.tasks.extraction.isosurface import iso_solid, resample, unsmoothed_solid
from cranktopo.tasks.extraction.stage import iso_distance_mm
from tests.unit.extraction.surface_cases import ball, grid_of, obround, scene_with, united

Array = np.ndarray
Shape = Callable[[Array, Array, Array], Array]
OFFSET = np.array([0.13, 0.27, -0.21])  # off the grid's planes and symmetries


def _sphere(x: Array, y: Array, z: Array) -> Array:
    return 20 - np.sqrt(x**2 + y**2 + z**2)


def _torus(x: Array, y: Array, z: Array) -> Array:
    return 7 - np.hypot(np.hypot(x, y) - 17, z)


def _cylinder(x: Array, y: Array, z: Array) -> Array:
    return np.minimum(12 - np.hypot(x, y), 18 - np.abs(z))


BODIES: dict[str, tuple[Shape, float]] = {
    "sphere": (_sphere, 4 / 3 * math.pi * 20**3),
    "torus": (_torus, 2 * math.pi**2 * 17 * 7**2),
    "cylinder": (_cylinder, math.pi * 12**2 * 36),
}


def _cell_fractions(shape: Shape, count: int = 60, samples: int = 6) -> DensityGrid:
    """Volume fraction of every 1 mm cell inside the shape, by samples^3 points."""
    steps = (np.arange(count * samples) + 0.5) / samples - count / 2
    density = np.empty((count,) * 3)
    y, z = (steps - OFFSET[1])[None, :, None], (steps - OFFSET[2])[None, None, :]
    for layer, x in enumerate((steps - OFFSET[0]).reshape(count, samples)):
        hits = shape(x[:, None, None], y, z) > 0
        density[layer] = hits.reshape(samples, count, samples, count, samples).mean(axis=(0, 2, 4))
    return DensityGrid(np.full(3, -count / 2), np.ones(3), density)


@pytest.mark.parametrize(
    "name", [pytest.param(name, marks=() if name == "cylinder" else pytest.mark.slow) for name in BODIES]
)
def test_known_body_comes_back(name: str) -> None:
    """Within 0.1 % of its volume and 0.1 cell in the mean, from nothing but the fractions of its cells."""
    shape, volume = BODIES[name]
    grid = _cell_fractions(shape)
    field = resample(grid, np.ones(grid.density.shape, bool))
    target = float(grid.density.sum())
    iso = find_iso(lambda value: float(iso_solid(field, value, SIMPLIFY_MM).volume()), target)
    solid = iso_solid(field, iso, SIMPLIFY_MM)
    assert solid.volume() == pytest.approx(volume, rel=1e-3)
    points = np.asarray(solid.refine_to_length(0.5).to_mesh64().vert_properties)[:, :3] - OFFSET
    distance = np.abs(shape(*points.T))
    assert distance.mean() < 0.1
    # Smoothing takes away the steps that the plain iso-surface still shows, and no volume.
    raw = np.asarray(unsmoothed_solid(field, iso).to_mesh64().vert_properties)[:, :3] - OFFSET
    assert distance.mean() < np.abs(shape(*raw.T)).mean()
    assert unsmoothed_solid(field, iso).volume() == pytest.approx(solid.volume(), rel=3e-3)


@pytest.mark.parametrize("cells", [(7, 11, 6), (1, 4, 2)])
def test_lattice_is_that_of_tricubic_splines(cells: tuple[int, int, int]) -> None:
    """SciPy's zoom, which sums all 64 terms of a point, finds the same values between the cells."""
    density = np.random.default_rng(5).random(cells)
    found = resample(DensityGrid(np.zeros(3), np.ones(3), density), np.ones(cells, bool)).values
    padded = np.pad(density, 3, mode="symmetric")
    expected = ndimage.zoom(padded, 2, order=3, mode="nearest", grid_mode=True)
    np.testing.assert_allclose(found[1:-1, 1:-1, 1:-1], expected, rtol=0, atol=1e-14)


def test_distances_to_a_ball_are_exact() -> None:
    sphere = mesh_of(Manifold.sphere(10.0, 256))
    points = np.random.default_rng(3).normal(size=(200, 3))
    points *= (np.linspace(7, 13, 200) / np.linalg.norm(points, axis=1))[:, None]
    np.testing.assert_allclose(distances_mm(points, sphere), np.abs(np.linspace(7, 13, 200) - 10), atol=0.01)


def test_iso_distance_is_small_and_sees_a_displaced_surface() -> None:
    scene = scene_with()
    shape = united(obround(), ball(20, 12, 37, 14))
    grid = grid_of(scene, shape, cell_mm=3.0)
    surface = extract_half_throw(grid, scene)
    distance = iso_distance_mm(surface, grid, scene)
    assert len(distance) > 1000
    assert distance.mean() < 0.05
    assert distance.max() < 1.0
    moved = SurfaceMesh(surface.web.vertices_mm + np.array([0.0, 0.0, 0.4]), surface.web.faces)
    shifted = iso_distance_mm(replace(surface, web=moved), grid, scene)
    assert shifted.max() > distance.max() + 0.1


@pytest.fixture(scope="module")
def box() -> SurfaceMesh:
    return mesh_of(
        Manifold.cube((10, 20, 30)).translate((1, 2, 3)) - Manifold.cube((4, 4, 50)).translate((4, 9, 0))
    )


@pytest.mark.parametrize("form", SURFACES)
def test_formats_hold_the_body_in_their_units(box: SurfaceMesh, tmp_path: Path, form: str) -> None:
    path = tmp_path / f"box.{form}"
    write_surface(path, box, form)
    first = path.read_bytes()
    write_surface(path, box, form)
    assert path.read_bytes() == first
    mesh = _read_3mf(first) if form == "3mf" else trimesh.load_mesh(path)
    scale = 1000.0 if form == "glb" else 1.0  # glTF demands metres
    assert mesh.is_watertight
    assert mesh.is_winding_consistent
    np.testing.assert_allclose(scale * mesh.bounds, [[1, 2, 3], [11, 22, 33]], rtol=1e-6)
    assert scale**3 * mesh.volume == pytest.approx(10 * 20 * 30 - 4 * 4 * 30, rel=1e-5)


def _read_3mf(content: bytes) -> trimesh.Trimesh:
    """The one object of a 3MF package, by the namespaces and units of its specification."""
    with zipfile.ZipFile(io.BytesIO(content)) as package:
        assert set(package.namelist()) == {"[Content_Types].xml", "_rels/.rels", "3D/3dmodel.model"}
        relations = ElementTree.fromstring(package.read("_rels/.rels"))
        assert relations[0].attrib["Target"] == "/3D/3dmodel.model"
        model = ElementTree.fromstring(package.read("3D/3dmodel.model"))
    assert model.attrib["unit"] == "millimeter"
    space = {"m": "http://schemas.microsoft.com/3dmanufacturing/core/2015/02"}
    vertices = [[float(v.attrib[a]) for a in "xyz"] for v in model.iterfind(".//m:vertex", space)]
    faces = [[int(t.attrib[f"v{i}"]) for i in (1, 2, 3)] for t in model.iterfind(".//m:triangle", space)]
    assert model.find("m:build/m:item", space) is not None
    return trimesh.Trimesh(vertices, faces, process=False)
