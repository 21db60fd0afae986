"""A die and an envelope with holes along the crank axis: drilled later; other voids cost material."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from manifold3d import Manifold

from cranktopo.bodies.cells.domain import build_domain
from cranktopo.bodies.undercuts import undercuts
from cranktopo.design.loading import load_scene, scene_from_dict
from cranktopo.design.schema import Scene
from cranktopo.engine.plan.planning import plan
from cranktopo.engine.plan.simulated import apply_physics_plan
from cranktopo.numerics.filters.processes import reachable
from cranktopo.numerics.surfaces.files import write_stl
from cranktopo.numerics.surfaces.mesh import mesh_of
from cranktopo.tasks.density.manufacturing import open_cells, parting_of, unreachable_share
from cranktopo.tasks.density.stage import notices
from tests.unit.extraction.surface_cases import drilled_beside

LOW, HIGH, HALF = -30.0, 78.0, 32.0
Z = (19.0, 40.0)


def block() -> Manifold:
    return Manifold.cube((2 * HALF, HIGH - LOW, Z[1] - Z[0])).translate((-HALF, LOW, Z[0]))


def hole(x: float, y: float, radius: float = 6.0, top: float | None = None) -> Manifold:
    """A hole along the crank axis, 64 sides; another radius at its upper end makes it a cone."""
    cone = Manifold.cylinder(Z[1] - Z[0] + 4, radius, radius if top is None else top, 64)
    return cone.translate((x, y, Z[0] - 2))


def forged(scene: Scene, folder: Path, voids: Sequence[Manifold], **extra: Any) -> Scene:
    body = block()
    for void in voids:
        body -= void
    write_stl(folder / "envelope.stl", mesh_of(body))
    envelope = {"shape": "stl", "file": str(folder / "envelope.stl"), **extra}
    data = scene.model_dump(mode="json", exclude_none=True) | {"envelope": envelope}
    data["optimise"] = {**data.get("optimise", {}), "process": "forged"}
    found = scene_from_dict(data)
    return apply_physics_plan(found, plan(found))


HOLES = {
    "on the mirror plane": ([hole(0, 24)], {"symmetric": True}),
    "a pair": ([hole(-20, 24), hole(20, 24)], {"symmetric": True}),
    "one beside": ([hole(20, 24)], {}),
    "conical": ([hole(18, 24, 4.0, 9.0)], {}),
    "stepped": ([hole(18, 24, 4.0), Manifold.cylinder(8, 8, 8, 64).translate((18, 24, 35))], {}),
}


@pytest.mark.parametrize(
    "name",
    [name if name in ("a pair", "stepped") else pytest.param(name, marks=pytest.mark.slow) for name in HOLES],
)
def test_nothing_is_cut_away_behind_a_hole(name: str, mikron: Scene, tmp_path: Path) -> None:
    voids, extra = HOLES[name]
    scene = forged(mikron, tmp_path, voids, **extra)
    domain = build_domain(scene, 4.0)
    first, last = domain.web_layers
    design = domain.design_fraction[:, :, first:last] > 0
    within = reachable(open_cells(scene, domain), parting_of(domain))
    # Cells that a boundary merely grazes may lie in the shadow of a corner of the holes' polygons.
    assert unreachable_share(scene, domain) < 1e-3
    assert np.count_nonzero(design & ~within) <= 0.01 * np.count_nonzero(design)
    assert not any("left out" in sentence for sentence in notices(scene, domain))


def test_nothing_is_cut_away_behind_an_oil_drilling() -> None:
    """Wide enough for cells without material: behind them a die left pits on one side of the web."""
    scene = drilled_beside(load_scene("mikron-iiic-plain"), 5.0)
    scene = apply_physics_plan(scene, plan(scene))
    domain = build_domain(scene, 1.5)
    first, last = domain.web_layers
    void = (domain.design_fraction + domain.passive_fraction)[:, :, first:last] == 0
    within = ~void | open_cells(scene, domain)
    assert np.count_nonzero(void & within) > 20, "cells in the drilling"
    assert unreachable_share(scene, domain) == pytest.approx(0.0, abs=1e-12)
    assert not any("left out" in sentence for sentence in notices(scene, domain))


def test_a_web_with_such_holes_leaves_its_die(mikron: Scene, tmp_path: Path) -> None:
    """The rays that check the finished surface know the same holes; a hole of its own they catch."""
    voids = [hole(20, 24), hole(-18, 30, 4.0, 8.0)]
    scene = forged(mikron, tmp_path, voids)
    start, end = scene.web_z_mm
    web = block().trim_by_plane((0, 0, 1), start).trim_by_plane((0, 0, -1), -end)
    for void in voids:
        web -= void
    assert undercuts(mesh_of(web), scene, 2.0).negligible
    assert not undercuts(mesh_of(web - hole(20, 60)), scene, 2.0).negligible


def test_a_hole_beside_the_web_is_no_solid(mikron: Scene, tmp_path: Path) -> None:
    """The web ends short of the hole: nothing of it lies outside of the gap between them."""
    scene = forged(mikron, tmp_path, [hole(22, 24)])
    start, end = scene.web_z_mm
    slim = Manifold.cube((24, HIGH - LOW, end - start)).translate((-12, LOW, start))
    assert undercuts(mesh_of(slim), scene, 2.0).negligible


def test_another_void_is_said_to_cost_material(mikron: Scene, tmp_path: Path) -> None:
    """A blind pocket of half the web's thickness: what lies outside of it is a 12 mm wide strip."""
    pocket = Manifold.cube((12, 30, 30)).translate((8, 10, 29.5))
    scene = forged(mikron, tmp_path, [pocket])
    domain = build_domain(scene, 2.0)
    expected = 12 * 30 * 9.5 / (2 * HALF * (HIGH - LOW) * 19.0 - 2 * np.pi * 12**2 * 19 - 12 * 30 * 9.5)
    assert unreachable_share(scene, domain) == pytest.approx(expected, rel=0.1)
    told = [sentence for sentence in notices(scene, domain) if "left out" in sentence]
    assert len(told) == 1
    assert f"forged: {100 * unreachable_share(scene, domain):.1f} % of the envelope's volume" in told[0]


def test_the_original_is_named_where_the_envelope_is_a_file(mikron: Scene, tmp_path: Path) -> None:
    scene = forged(mikron, tmp_path, [])
    told = notices(scene, build_domain(scene, 6.0))
    assert told == (
        "the original web is that of [web] in the design, not the body in 'envelope.stl', which is the "
        "envelope only; [original] file = ... names a body",
    )
    assert notices(mikron, build_domain(mikron, 6.0)) == ()
