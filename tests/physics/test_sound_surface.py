"""A density whose surface passed through itself: a late step of a loop, inside a re-modelled web."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from cranktopo.domain.build import build_domain
from cranktopo.effects import planned_scene
from cranktopo.optimise.chain import build_chain
from cranktopo.optimise.loop import design_of
from cranktopo.scene import load_scene, scene_from_dict
from cranktopo.surface.checked_surface import checked_surface
from cranktopo.triangles.surface_files import write_stl
from cranktopo.triangles.surface_mesh import SurfaceMesh

DATA = Path(__file__).parents[1] / "data" / "unsound_surface.npz"


@pytest.mark.usefixtures("float64")
def test_slivers_of_a_boolean_do_not_turn_faces_over(tmp_path: Path) -> None:
    stored = np.load(DATA)
    envelope = tmp_path / "envelope.stl"
    write_stl(envelope, SurfaceMesh(stored["vertices_mm"].astype(float), stored["faces"].astype(np.int64)))
    data = load_scene("mikron-iiic").model_dump(mode="json", exclude_none=True)
    data["optimise"]["process"] = "forged"
    data["envelope"] = {"shape": "stl", "file": str(envelope), "symmetric": True}
    scene = planned_scene(scene_from_dict(data))
    domain = build_domain(scene, scene.optimise.resolution_mm)
    design = design_of(build_chain(scene, domain), stored["x"].astype(float), float(stored["beta"]))
    found = checked_surface(scene, domain, design)
    assert found.surface.x_symmetric
    assert abs(found.surface.volume_mm3 / found.surface.target_volume_mm3 - 1) < 5e-3
