"""Densities whose surface was not sound: late steps of loops, inside re-modelled webs."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from cranktopo.bodies.cells.domain import build_domain
from cranktopo.design.loading import load_scene, scene_from_dict
from cranktopo.engine.plan.planning import planned_scene
from cranktopo.numerics.surfaces.files import write_stl
from cranktopo.numerics.surfaces.mesh import SurfaceMesh
from cranktopo.tasks.density.build import build_chain
from cranktopo.tasks.density.loop import design_of
from cranktopo.tasks.extraction.checked_surface import checked_surface
from cranktopo.tasks.extraction.cutter import build_cutter, fine_field, iso_surface_distances_mm

DATA = Path(__file__).parents[2] / "data"


@pytest.mark.usefixtures("float64")
@pytest.mark.slow
@pytest.mark.parametrize("name", ["unsound_surface", "cracked_surface"])
def test_a_late_step_of_a_loop_has_a_sound_surface(name: str, tmp_path: Path) -> None:
    """One turned a face over where slivers went; one had a crack without width in the mirror plane."""
    stored = np.load(DATA / f"{name}.npz")
    envelope = tmp_path / "envelope.stl"
    write_stl(envelope, SurfaceMesh(stored["vertices_mm"].astype(float), stored["faces"].astype(np.int64)))
    data = load_scene("mikron-iiic-plain").model_dump(mode="json", exclude_none=True)
    data["optimise"] |= {"process": "forged", "draft_deg": 0.0}
    data["envelope"] = {"shape": "stl", "file": str(envelope), "symmetric": True}
    scene = planned_scene(scene_from_dict(data))
    domain = build_domain(scene, scene.optimise.resolution_mm)
    design = design_of(build_chain(scene, domain), stored["x"].astype(float), float(stored["beta"]))
    found = checked_surface(scene, domain, design)
    assert found.surface.x_symmetric
    assert abs(found.surface.volume_mm3 / found.surface.target_volume_mm3 - 1) < 1e-3
    cutter = build_cutter(found.grid, scene, found.usable, found.smooth)
    field = fine_field(cutter, found.grid, scene, found.usable, found.smooth)
    distances = iso_surface_distances_mm(cutter, field, found.surface.iso_value, found.surface.web)
    assert distances.max() < found.cell_mm / 4
