"""Whole optimisations: what a die cannot release, by rays of another library; members as thick as asked."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest
import trimesh
from manifold3d import Manifold

from cranktopo.bodies.undercuts import Undercuts
from cranktopo.design.loading import load_scene
from cranktopo.design.schema import Scene
from cranktopo.numerics.precision import double_precision
from cranktopo.numerics.surfaces.mesh import SurfaceMesh, mesh_of, solid_of
from cranktopo.tasks.density import stage
from cranktopo.tasks.density.assess import assess
from cranktopo.tasks.density.problem import Assessment
from cranktopo.tasks.extraction.checked_surface import CheckedSurface, checked_surface
from cranktopo.tasks.extraction.walls import LeastWalls


@dataclass(frozen=True)
class Web:
    surface: CheckedSurface
    undercuts: Undercuts
    walls: LeastWalls
    assessment: Assessment


def optimised(scene: Scene, process: str, **lengths: float) -> Web:
    """The built-in design, forged as it asks for, or free."""
    settings = {"process": process, "resolution_mm": 4.5, "volume_fraction": 0.2, **lengths}
    ready = stage.prepare(scene.model_copy(update={"optimise": scene.optimise.model_copy(update=settings)}))
    assert (ready.plan["manufacturing_constraint"].state == "on") == (process == "forged")
    with double_precision():
        found = stage.optimise_density(ready)
        assert found.state.status == "converged"
        surface = checked_surface(ready.scene, ready.domain, found.design)
        assessment = assess(found.problem, ready.scene, ready.domain, found.design.physical)
    return Web(surface, surface.undercuts(ready.scene), surface.walls(ready.scene), assessment)


@pytest.fixture(scope="module")
def webs() -> dict[str, Web]:
    scene = load_scene("mikron-iiic-plain")
    assert scene.optimise.process == "forged"
    return {process: optimised(scene, process) for process in ("free", "forged")}


def trapped_mm3(mesh: SurfaceMesh, scene: Scene, step: float = 0.7) -> float:
    """Void between x = 0 and solid further out at x > 0, rays of trimesh, bores filled."""
    bores = [Manifold.cylinder(21, 12, 12, 128).translate((0, y, 19)) for y in (0.0, scene.throw.radius_mm)]
    whole = solid_of(mesh, "half throw")
    web = whole.trim_by_plane((0.0, 0.0, 1.0), 20.0).trim_by_plane((0.0, 0.0, -1.0), -39.0)
    body = mesh_of(sum(bores, Manifold()) + web)
    y, z = np.meshgrid(np.arange(-34.03, 82, step), np.arange(20.11, 39, step), indexing="ij")
    origin = np.stack([np.full(y.size, 1e-3), y.ravel(), z.ravel()], axis=1)
    surface = trimesh.Trimesh(body.vertices_mm, body.faces, process=False)
    points, rays, _ = surface.ray.intersects_location(origin, np.tile([1.0, 0.0, 0.0], (len(origin), 1)))
    total = 0.0
    for ray in np.unique(rays):
        cuts = np.unique(points[rays == ray, 0].round(5))
        starts = np.concatenate([[0.0], cuts]) if len(cuts) % 2 else cuts  # odd: it begins inside
        total += starts.max() - np.diff(starts.reshape(-1, 2)).sum()
    return total * step**2


def test_a_die_releases_the_default_run(default_run: Path, mikron: Scene) -> None:
    file = trimesh.load_mesh(default_run / "web.stl")
    mesh = SurfaceMesh(np.asarray(file.vertices, np.float64), np.asarray(file.faces, np.int64))
    assert trapped_mm3(mesh, mikron) < 1e-4 * file.volume


@pytest.mark.slow
def test_a_die_releases_the_forged_web_and_not_the_free_one(webs: dict[str, Web], mikron: Scene) -> None:
    trapped = {process: trapped_mm3(web.surface.surface.half_throw, mikron) for process, web in webs.items()}
    volume = webs["forged"].surface.surface.volume_mm3
    assert trapped["free"] > 0.02 * volume
    assert trapped["forged"] < 1e-4 * volume
    for process, web in webs.items():
        assert web.undercuts.negligible == (process == "forged")
        assert web.undercuts.volume_mm3 == pytest.approx(2 * trapped[process], rel=0.1, abs=1e-4 * volume)
    assert webs["forged"].surface.surface.cavities == 0


@pytest.mark.slow
def test_the_forged_web_has_its_draft(webs: dict[str, Web]) -> None:
    """5 deg less what a surface on such cells scatters; a free web has no draft to measure."""
    free, forged = (webs[process].walls.least_draft_deg for process in ("free", "forged"))
    assert free is None
    assert forged is not None
    assert forged > 4


@pytest.mark.slow
def test_what_the_die_costs(webs: dict[str, Web]) -> None:
    """So coarse and so light: at most a seventh of a stiffness at the same mass."""
    free, forged = (webs[process].assessment for process in ("free", "forged"))
    assert forged.throw_kg == pytest.approx(free.throw_kg, rel=1e-3)
    assert [case.kind for case in free.cases] == ["bending", "torsion"]
    for one, other in zip(free.cases, forged.cases, strict=True):
        assert one.stiffness is not None
        assert other.stiffness is not None
        assert 0.85 < other.stiffness / one.stiffness < 1.1


@pytest.mark.slow
def test_members_are_as_thick_as_asked(webs: dict[str, Web], mikron: Scene) -> None:
    """Two cells; without asking, the same web has members of less than half of it."""
    asked = optimised(mikron, "free", min_member_mm=9.0)
    least = asked.surface.walls(mikron).least_member_mm
    usual = webs["free"].surface.walls(mikron).least_member_mm
    assert least is not None
    assert usual is not None
    assert usual < 4.5
    assert least > 9.0
    assert asked.assessment.throw_kg == pytest.approx(webs["free"].assessment.throw_kg, rel=1e-3)
