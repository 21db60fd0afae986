"""A whole throw from CAD whose far half differs is judged as it is, not by its near half."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from cranktopo import load_scene
from cranktopo.base.errors import CranktopoError
from cranktopo.bodies.solid.files import export_solid
from cranktopo.design.loading import scene_from_dict
from cranktopo.design.schema import Scene
from cranktopo.design.writing import save_scene
from cranktopo.numerics.surfaces.mesh import SurfaceMesh
from cranktopo.tasks.importing.imported_body import half_surfaces, half_throw_surface, mesh_file
from cranktopo.tasks.throw_fea.evaluation import evaluate
from cranktopo.tasks.throw_fea.targets import resolve_target


def bevelled_far_web() -> tuple[Scene, Scene]:
    """A design, and the same with a bevel on its second web alone."""
    scene = load_scene("mikron-iiic-plain")
    data = scene.model_dump(mode="json", exclude_none=True, exclude={"published"})
    bevel = [{"face": "journal", "y_mm": 54.0, "depth_mm": 12.0}]
    return scene, scene_from_dict({**data, "second_web": {**data["web"], "bevel": bevel}}, "pair", whole=True)


@pytest.mark.slow
def test_the_whole_is_taken_where_halves_differ(tmp_path: Path) -> None:
    scene, pair = bevelled_far_web()
    file = tmp_path / "throw.step"
    volume = export_solid(pair, "throw", file)
    meshed = mesh_file(file, scene, 15.0)
    assert meshed.whole
    assert "its halves differ: the second has" in meshed.note
    assert meshed.body.volume_mm3 == pytest.approx(volume, rel=1e-6)
    near, far = half_surfaces(scene, file, 2.0)
    assert far.volume_mm3 < 0.99 * near.volume_mm3
    with pytest.raises(CranktopoError, match="halves of the throw differ"):
        half_throw_surface(file, scene)


@pytest.mark.slow
def test_stiffness_is_that_of_the_whole(tmp_path: Path) -> None:
    scene, pair = bevelled_far_web()
    file, design = tmp_path / "throw.step", tmp_path / "plain.toml"
    volume = export_solid(pair, "throw", file)
    save_scene(scene, design)
    found = evaluate(resolve_target(str(file), str(design)), 12.0)
    assert found.throw_kg == pytest.approx(volume * scene.material.density_kg_m3 * 1e-9, rel=1e-6)
    wanted = evaluate(resolve_target(pair, whole=True), 12.0)
    assert found.torsion_Nm_per_rad == pytest.approx(wanted.torsion_Nm_per_rad, rel=0.01)


@pytest.mark.usefixtures("kernel_here")
def test_equal_halves_are_one(tmp_path: Path) -> None:
    scene, _ = bevelled_far_web()
    export_solid(scene, "throw", tmp_path / "throw.step")
    surface: SurfaceMesh = half_throw_surface(tmp_path / "throw.step", scene)
    assert np.ptp(surface.vertices_mm[:, 2]) == pytest.approx(scene.pitch_mm / 2)
