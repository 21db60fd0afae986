"""Deviation of each dimension that an import reads: of its own faces, by what was done to their corners."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from cranktopo import load_scene
from cranktopo.bodies.solid.files import export_solid, kernel_surface_of
from cranktopo.design.loading import scene_from_dict
from cranktopo.design.schema import Scene
from cranktopo.numerics.surfaces.files import write_stl
from cranktopo.numerics.surfaces.mesh import SurfaceMesh
from cranktopo.tasks.crank_import.page import _dimension_table
from cranktopo.tasks.crank_import.result import ImportedHalf
from cranktopo.tasks.crank_import.stage import import_crank

SCATTER_MM = 1e-3
PIN = "throw.crankpin.outer_diameter_mm"
BEVEL = "web.bevel[0].depth_mm"


@pytest.fixture(scope="module")
def bevelled() -> Scene:
    data = load_scene("mikron-iiic-plain").model_dump(mode="json", exclude_none=True, exclude={"published"})
    data["web"]["bevel"] = [{"face": "journal", "y_mm": 54.0, "depth_mm": 12.0}]
    return scene_from_dict(data)


def scattered(mesh: SurfaceMesh) -> SurfaceMesh:
    """Corners of the pin moved outwards or inwards by the scatter."""
    points, draw = mesh.vertices_mm.copy(), np.random.default_rng(1)
    signs = SCATTER_MM * draw.choice([-1.0, 1.0], len(points))
    out = np.hypot(points[:, 0], points[:, 1] - 48.0)
    on = (np.abs(out - 21.0) < 1e-4) & (points[:, 2] > 41.4)
    points[on, :2] += ((points[on, :2] - [0.0, 48.0]) / out[on, None]) * signs[on, None]
    return SurfaceMesh(points, mesh.faces)


def imported(file: Path, folder: Path) -> ImportedHalf:
    return import_crank(file, "body", folder, unit="mm").halves[0]


@pytest.mark.usefixtures("kernel_here", "fine_triangles")
def test_scatter_of_the_pin_is_told_beside_its_diameter_alone(bevelled: Scene, tmp_path: Path) -> None:
    write_stl(tmp_path / "body.stl", scattered(kernel_surface_of(bevelled, "half")))
    half = imported(tmp_path / "body.stl", tmp_path / "out")
    found = half.deviations_mm
    assert found.keys() == half.dimensions_mm.keys()
    # The first corners of its fillet, which are as near to the cylinder, count with it.
    assert SCATTER_MM < found[PIN] < 2 * SCATTER_MM
    assert found["throw.radius_mm"] == found[PIN]
    rounding = 5e-4  # of three decimals
    for key in ("throw.main_journal.outer_diameter_mm", "throw.crankpin.bore_diameter_mm", BEVEL):
        assert found[key] == pytest.approx(rounding, rel=1e-9), key
    cells = {row["what"]: row["deviation_mm"] for row in _dimension_table(half).rows}
    assert (cells[PIN], cells[BEVEL]) == ("0.002", "0.0005")


@pytest.mark.slow
@pytest.mark.usefixtures("kernel_here")
def test_exact_faces_have_the_rounding_of_the_design(bevelled: Scene, tmp_path: Path) -> None:
    export_solid(bevelled, "half", tmp_path / "body.step")
    found = imported(tmp_path / "body.step", tmp_path / "out").deviations_mm
    assert {value for key, value in found.items() if key != "web.width_mm"} == {5e-10}
