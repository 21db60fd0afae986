"""Cells of a step are drawn where they are, and only those that are dense enough: a grid without symmetry."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import trimesh

from cranktopo.bodies.cells.grid import DensityGrid
from cranktopo.numerics.surfaces.mesh import SurfaceMesh
from cranktopo.report.page import Page
from cranktopo.report.plot import picture
from cranktopo.report.report_file import html
from cranktopo.report.viewer.scene3d import DesignSnapshot, Scene3D, ShownBody
from tests.browser.conftest import NEXT_FRAMES


@pytest.fixture(scope="module")
def page(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """One cell at the lower left, two at the upper right of a 2 x 3 x 2 grid, a thin one between."""
    density = np.zeros((2, 3, 2))
    density[0, 0, 0] = 1.0
    density[1, 2, :] = 0.6
    density[0, 1, 0] = 0.1
    grid = DensityGrid(np.array([-10.0, -15.0, 10.0]), np.array([10.0, 10.0, 5.0]), density)
    box = trimesh.creation.box(bounds=[[-10, -15, 0], [10, 15, 30]])
    mesh = SurfaceMesh(np.asarray(box.vertices, np.float64), np.asarray(box.faces, np.int64))
    scene3d = Scene3D(
        (ShownBody("box", mesh, (10.0, 20.0), 30.0),), (DesignSnapshot(7, grid),), ("made by hand",)
    )
    still = picture("still", "a box without any meaning", lambda axes: axes.plot([0, 1]))
    path = tmp_path_factory.mktemp("page") / "cells.html"
    path.write_text(html(Page("Cells", "by hand", "None.", (), (), scene3d, still)), encoding="utf-8")
    return path


def triangles(page: Any) -> int:
    page.evaluate(NEXT_FRAMES)
    return int(page.locator("#viewer").get_attribute("data-triangles"))


def test_faces_between_cells_are_left_out(visit: Any, page: Path) -> None:
    seen = visit(page)
    whole = triangles(seen.page)
    assert whole == 12 + 8 + 12, "three boxes: journal, web without its cut faces, pin"
    seen.page.locator("[data-step]").press("Home")
    assert seen.page.locator("[data-step-text]").inner_text() == "Iteration 7: made by hand"
    assert triangles(seen.page) - 2 * 12 == 2 * (6 + 10)
    cut = seen.page.locator("[data-cut]")
    cut.press("Home")  # 0.05: the thin cell joins the first
    assert triangles(seen.page) - 2 * 12 == 2 * (10 + 10)
    cut.fill("0.7")
    assert triangles(seen.page) - 2 * 12 == 2 * 6


@pytest.mark.slow
def test_cells_are_where_they_are(visit: Any, page: Path) -> None:
    """From the front x points right and y up; the journal and pin boxes are seen from the side instead."""
    seen = visit(page)
    seen.page.locator("[data-step]").press("Home")
    seen.page.get_by_role("button", name="Side", exact=True).click()
    picture = seen.picture()
    hue = picture[:, :, 2] - picture[:, :, 0]
    dense, pale = hue > 40, (picture[:, :, 3] == 255) & (hue < 40) & (np.ptp(picture[:, :, :3], axis=2) > 12)
    assert dense.sum() > 500
    assert pale.sum() > 500
    rows, columns = np.nonzero(dense)
    assert rows.mean() > picture.shape[0] / 2, "the dense cell is at the bottom"
    pale_rows, pale_columns = np.nonzero(pale)
    assert pale_rows.mean() < picture.shape[0] / 2, "the others are at the top"
    # Seen against x, z points right: the dense cell fills the left half of the web's thickness alone.
    assert columns.mean() < pale_columns.mean()
