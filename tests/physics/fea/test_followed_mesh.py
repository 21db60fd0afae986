"""Meshes that follow a body: on its surface, as good as new ones, and refused where another is needed."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from cranktopo.bodies.mesh.solid_mesh import MeshedThrow, follow_throw, mesh_throw
from cranktopo.design.edits import changed_data
from cranktopo.design.loading import design_text, scene_from_dict
from cranktopo.design.schema import Scene
from cranktopo.design.toml_text import parse_toml
from cranktopo.engine.plan.planning import planned_scene
from cranktopo.numerics.tetrahedra.elasticity import assemble
from cranktopo.tasks.bench.kept_mesh import KeptMesh
from cranktopo.tasks.throw_fatigue.fillets import fillet_nodes
from cranktopo.tasks.throw_fatigue.target_safety import fatigue_field
from cranktopo.tasks.throw_fea.targets import Target

PLAIN = parse_toml(design_text("mikron-iiic-plain"), "plain")
DRILLED = parse_toml(design_text("industrial-gas"), "drilled")
COARSE = 1.0
"""Element size in the fillets over their radius."""
UNLIKE = {**PLAIN, "second_web": {**PLAIN["web"], "thickness_mm": PLAIN["web"]["thickness_mm"] + 2}}
CASES: dict[str, tuple[dict[str, Any], dict[str, float]]] = {
    "fillets-and-web": (PLAIN, {"web.thickness_mm": 21.0, "throw.crankpin.fillet_mm": 2.8}),
    "outlets": (DRILLED, {"throw.radius_mm": 97.0, "throw.drilling[0].to.place_mm": 16.0}),
    "unlike-webs": (UNLIKE, {"second_web.thickness_mm": 20.0, "throw.main_journal.fillet_mm": 2.4}),
}


def scene_of(data: dict[str, Any], **changes: float) -> Scene:
    return scene_from_dict(changed_data(data, changes), "test", whole=True)


def meshed(scene: Scene) -> MeshedThrow:
    size = scene.web.thickness_mm / 1.5
    return mesh_throw(scene, size, fillet_fraction=COARSE, to_follow=True)


@pytest.fixture(scope="module", params=CASES)
def followed(request: pytest.FixtureRequest) -> tuple[MeshedThrow, MeshedThrow, Scene]:
    """A mesh, the same one moved, and the scene that it was moved to."""
    data, changes = CASES[request.param]
    first, scene = meshed(scene_of(data)), scene_of(data, **changes)
    moved = follow_throw(first, scene)
    assert moved is not None
    return first, moved, scene


Followed = tuple[MeshedThrow, MeshedThrow, Scene]


def test_its_elements_stay_and_fill_the_new_body(followed: Followed) -> None:
    first, moved, scene = followed
    assert moved.mesh.cells is first.mesh.cells
    anew = mesh_throw(scene, first.element_size_mm or 0.0, fillet_fraction=COARSE)
    assert moved.body.volume_mm3 == pytest.approx(anew.body.volume_mm3, rel=1e-12)
    copies = 2 if moved.mesh.mirrored else 1
    missing = [
        assemble(one.mesh, 2e5, 0.3).volume_error(copies, one.body.volume_mm3) for one in (first, moved, anew)
    ]
    assert abs(missing[1]) < 1.3 * max(abs(missing[0]), abs(missing[2])), missing


@pytest.mark.parametrize("followed", ["fillets-and-web", "outlets"], indirect=True)
def test_nodes_of_the_fillets_lie_on_the_new_fillets(followed: Followed) -> None:
    first, moved, scene = followed
    corners = np.unique(first.mesh.cells[:4])  # on coarse meshes some edges are straight
    before = scene_of(DRILLED if scene.name == "industrial-gas" else PLAIN)
    for fillet in ("journal", "pin"):
        was = fillet_nodes(before, fillet, first.mesh.points_mm[:, corners])
        now = fillet_nodes(scene, fillet, moved.mesh.points_mm[:, corners])
        assert was.sum() > 50
        np.testing.assert_array_equal(now, was)


def test_a_web_that_does_not_move_has_the_mesh_itself() -> None:
    first = meshed(scene_of(PLAIN))
    again = follow_throw(first, scene_of(PLAIN))
    assert again is not None
    np.testing.assert_allclose(again.mesh.points_mm, first.mesh.points_mm, rtol=0, atol=1e-9)


@pytest.mark.parametrize(
    "changes",
    [{"throw.crankpin.bore_diameter_mm": 0.0}, {"web.thickness_mm": 60.0}],
    ids=["another-face", "elements-that-flatten"],
)
def test_another_mesh_is_asked_for(changes: dict[str, float]) -> None:
    assert follow_throw(meshed(scene_of(PLAIN)), scene_of(PLAIN, **changes)) is None


def test_a_mesh_that_was_not_made_to_follow_follows_nothing() -> None:
    alone = replace(meshed(scene_of(PLAIN)), followed=None)
    assert follow_throw(alone, scene_of(PLAIN)) is None


def test_the_bench_keeps_a_mesh_until_it_cannot_follow(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("cranktopo.tasks.bench.kept_mesh.RULE_FRACTION", COARSE)
    kept = KeptMesh()
    first, moved, solid, again = (
        kept.of(Target("plain", scene_of(PLAIN, **changes)))
        for changes in (
            {},
            {"web.thickness_mm": 21.0},
            {"web.thickness_mm": 21.0, "throw.crankpin.bore_diameter_mm": 0.0},
            {"web.thickness_mm": 20.0, "throw.crankpin.bore_diameter_mm": 0.0},
        )
    )
    assert moved.mesh.cells is first.mesh.cells
    assert solid.mesh.cells is not first.mesh.cells
    assert again.mesh.cells is solid.mesh.cells


@pytest.mark.slow
@pytest.mark.parametrize("data", [PLAIN, DRILLED], ids=["plain", "drilled"])
def test_its_safety_is_that_of_a_new_mesh_within_the_scatter_of_meshes(data: dict[str, Any]) -> None:
    first = KeptMesh()
    first.of(Target("first", planned(data)))
    target = Target("moved", planned(data, **{"web.thickness_mm": 1.05 * data["web"]["thickness_mm"]}))
    followed, anew = (fatigue_field(target, "lsa", meshed=mesh) for mesh in (first.of(target), None))
    for fillet, safety in anew.fillet_safety.items():
        assert followed.fillet_safety[fillet] == pytest.approx(safety, rel=0.01)


def planned(data: dict[str, Any], **changes: float) -> Scene:
    return planned_scene(scene_of(data, **changes))
