"""Several halves of a crank with one design have one solid of it: the CAD kernel builds it once."""

from __future__ import annotations

import pytest
from manifold3d import Manifold

from cranktopo import load_scene
from cranktopo.design.schema import Scene
from cranktopo.numerics.surfaces.mesh import SurfaceMesh, mesh_of
from cranktopo.tasks.crank_import import web_reading


def test_names_make_no_other_solid(monkeypatch: pytest.MonkeyPatch) -> None:
    built: list[float] = []

    def kernel(scene: Scene, _: str) -> SurfaceMesh:
        built.append(scene.web.thickness_mm)
        return mesh_of(Manifold.cube((1.0, 1.0, scene.web.thickness_mm)))

    monkeypatch.setattr(web_reading, "kernel_surface_of", kernel)
    web_reading._solid.cache_clear()
    scene = load_scene("mikron-iiic-plain")
    thick = scene.model_copy(update={"web": scene.web.model_copy(update={"thickness_mm": 25.0})})
    named = [one.model_copy(update={"name": name}) for name in ("a-1", "a-2") for one in (scene, thick)]
    volumes = [web_reading._scene_solid(one).volume() for one in named]
    web_reading._solid.cache_clear()
    assert volumes == pytest.approx([19.0, 25.0, 19.0, 25.0])
    assert built == [19.0, 25.0]
