"""Stress colours of the 3D view: a box whose stress rises along x, seen from the front."""

from __future__ import annotations

import re
import shutil
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import trimesh

from cranktopo.app.main import main
from cranktopo.bodies.cells.grid import DensityGrid
from cranktopo.engine.load_case import LoadCase
from cranktopo.numerics.surfaces.mesh import SurfaceMesh
from cranktopo.report.page import Page
from cranktopo.report.plot import picture
from cranktopo.report.report_file import html
from cranktopo.report.viewer.scene3d import DesignSnapshot, Scene3D, ShownBody, stress_scales
from cranktopo.tasks.throw_fea.unit_fields import CaseStress


@pytest.fixture(scope="module")
def page(tmp_path_factory: pytest.TempPathFactory) -> Path:
    box = trimesh.creation.box(bounds=[[-10, -15, 0], [10, 15, 30]])
    mesh = SurfaceMesh(np.asarray(box.vertices, np.float64), np.asarray(box.faces, np.int64))
    axes = [np.linspace(-10, 10, 21), np.linspace(-15, 15, 16), np.linspace(0, 30, 16)]
    points = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)
    rising = 5 * (points[:, 0] + 10)
    cases = tuple(LoadCase(name=name, kind="bending", radial_N=1000.0) for name in ("rising", "falling"))
    stress = CaseStress(cases, points, np.stack([rising, 100 - rising]), False, 1.0)
    grid = DensityGrid(np.array([-10.0, -15.0, 10.0]), np.array([10.0, 15.0, 10.0]), np.ones((2, 2, 1)))
    body = ShownBody("box", mesh, (10.0, 20.0), 30.0, stress)
    scene3d = Scene3D((body,), (DesignSnapshot(7, grid),), ("by hand",), stress_scales([(mesh, stress)]))
    still = picture("still", "a box without any meaning", lambda axes: axes.plot([0, 1]))
    path = tmp_path_factory.mktemp("page") / "stress.html"
    path.write_text(html(Page("Stress", "by hand", "None.", (), (), scene3d, still)), encoding="utf-8")
    return path


def sides(picture: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Mean colour of the left and the right tenth of the box, red, green, blue."""
    columns = np.nonzero((picture[:, :, 3] == 255).any(axis=0))[0]
    tenth = len(columns) // 10
    parts = (picture[:, columns[:tenth]], picture[:, columns[-tenth:]])
    left, right = (part[part[:, :, 3] == 255][:, :3].mean(axis=0) for part in parts)
    return left, right


@pytest.mark.slow
def test_colours_follow_the_stress(visit: Any, page: Path) -> None:
    seen = visit(page)
    seen.page.get_by_role("button", name="Front").click()
    plain = seen.picture()
    colours, legend = seen.page.get_by_label("Colours"), seen.page.locator(".legend")
    assert "journals" in legend.inner_text()
    colours.focus()
    seen.page.keyboard.press("ArrowDown")  # by keyboard: the first load case
    low, high = sides(seen.picture())
    assert low[2] > 1.5 * low[1], "violet where there is no stress"
    assert min(high[0], high[1]) > 2 * high[2], "yellow at the top"
    assert re.search(r"von Mises stress, rising, 1000 N: 0 to 99\.\d MPa and more", legend.inner_text())
    assert "journals" not in legend.inner_text()
    colours.select_option(label="stress, falling")
    low, high = sides(seen.picture())
    assert high[2] > 1.5 * high[1]
    assert min(low[0], low[1]) > 2 * low[2]
    colours.select_option(label="journals and web")
    np.testing.assert_array_equal(seen.picture(), plain)
    assert seen.complaints == []


@pytest.mark.slow
def test_steps_show_densities(visit: Any, page: Path) -> None:
    """Only the final surface has stresses: a step takes the choice away, the end gives it back."""
    seen = visit(page)
    colours = seen.page.get_by_label("Colours")
    colours.select_option(label="stress, rising")
    stressed = seen.picture()
    seen.page.locator("[data-step]").press("Home")
    assert colours.is_disabled()
    assert "density" in seen.page.locator(".legend").inner_text()
    seen.page.locator("[data-step]").press("End")
    assert colours.is_enabled()
    np.testing.assert_array_equal(seen.picture(), stressed)


@pytest.mark.slow
def test_run_gets_stresses_of_its_own_surface(visit: Any, default_run: Path, tmp_path: Path) -> None:
    """The evaluation solves the run's surface once; the next report finds the stresses in the run."""
    run = shutil.copytree(default_run, tmp_path / "run")
    assert main(["report", str(run), "--stress", "--quiet"]) == 0
    kept = (run / "stress.npz").stat().st_mtime_ns
    assert main(["report", str(run)]) == 0
    assert (run / "stress.npz").stat().st_mtime_ns == kept
    report = run / "report.html"
    assert report.stat().st_size < 8_000_000
    seen = visit(report)
    rows = seen.page.locator("#stress tbody tr")
    assert [name.split(",")[0] for name in rows.locator("td.text").all_inner_texts()] == [
        "bending",
        "torsion",
    ]
    plain = seen.picture()
    seen.page.get_by_label("Colours").select_option(label="stress, torsion")
    assert (seen.picture() != plain).any(axis=2).mean() > 0.05
    assert seen.complaints == []
    assert seen.requests == [report.resolve().as_uri()]
