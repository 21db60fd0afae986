"""Outlets that the kernel rounds on the body itself: the closed form's ring, and tools where it fails."""

from __future__ import annotations

from functools import cache
from typing import Any

import gmsh
import pytest

from cranktopo.base.errors import CranktopoError, solver_error
from cranktopo.bodies.mesh import solid_mesh
from cranktopo.bodies.solid import crankshaft
from cranktopo.bodies.solid import drilled as drilled_module
from cranktopo.bodies.solid.checked import volume_mm3
from cranktopo.bodies.solid.throw import add_half_throw
from cranktopo.bodies.volume import half_throw_volume_mm3
from cranktopo.design.loading import load_scene, one_web, scene_from_dict
from cranktopo.design.schema import Scene
from cranktopo.numerics.gmsh_session import cad_session
from cranktopo.throw.drilling.moments import drilled
from tests.hostile.featured_engines import featured_engine
from tests.physics.throw.test_drillings import LEANING, STRAIGHT, mikron


def kernel_mm3(scene: Scene, **how: Any) -> float:
    with cad_session("half") as session:
        occ = session.model.occ
        return volume_mm3(occ, add_half_throw(occ, scene, **how))


def ring_mm3(drilling: dict[str, Any], rounding_mm: float, **how: Any) -> tuple[float, float]:
    """Return what the roundings of a half throw take by the kernel, and by the closed form."""
    scenes = [mikron({**drilling, "outlet_radius_mm": radius}) for radius in (0.0, rounding_mm)]
    less, more = (drilled(scene).volume for scene in scenes)
    return sharp_mm3(scenes[0]) - kernel_mm3(scenes[1], **how), more - less


@cache
def sharp_mm3(scene: Scene) -> float:
    """Without a rounding, however they are made."""
    return kernel_mm3(scene)


@pytest.mark.parametrize(
    ("drilling", "rounding_mm"),
    [
        pytest.param(STRAIGHT, 1.0, id="straight, 1 mm"),
        pytest.param(STRAIGHT, 2.0, id="straight, 2 mm", marks=pytest.mark.slow),
        pytest.param(LEANING, 1.0, id="leaning, 1 mm", marks=pytest.mark.slow),
        pytest.param(LEANING, 2.0, id="leaning, 2 mm", marks=pytest.mark.slow),
    ],
)
def test_they_take_the_ring_of_a_rolled_ball(drilling: dict[str, Any], rounding_mm: float) -> None:
    by_kernel, closed = ring_mm3(drilling, rounding_mm)
    assert by_kernel == pytest.approx(closed, rel=0.06)


@pytest.mark.slow
def test_a_tool_takes_the_same_where_the_kernel_cannot_round(monkeypatch: pytest.MonkeyPatch) -> None:
    on_body, _ = ring_mm3(STRAIGHT, 1.0)
    original = gmsh.model.occ.fillet

    def fails_on_bodies(*arguments: Any, **options: Any) -> Any:
        """As the kernel, which may leave a body that it could not round without some of its edges."""
        if options:
            gmsh.model.occ.dilate([(3, tag) for tag in arguments[0]], 0.0, 0.0, 0.0, 1.1, 1.1, 1.1)
            raise Exception("Could not compute fillet")
        return original(*arguments)

    monkeypatch.setattr(gmsh.model.occ, "fillet", fails_on_bodies)
    by_tool, closed = ring_mm3(STRAIGHT, 1.0)
    assert by_tool == pytest.approx(closed, rel=0.06)
    assert by_tool != on_body
    monkeypatch.undo()
    assert ring_mm3(STRAIGHT, 1.0, by_tools=True)[0] == pytest.approx(by_tool)


def test_a_crumb_beside_a_whole_crank_is_no_body(monkeypatch: pytest.MonkeyPatch) -> None:
    """Engine 50: the tool of an outlet stayed beside a crank of the right volume."""
    original = crankshaft.drilled_at

    def leaves_a_crumb(occ: Any, body: Any, *arguments: Any, **options: Any) -> Any:
        return [*original(occ, body, *arguments, **options), (3, occ.addSphere(0.0, 0.0, 500.0, 1.0))]

    monkeypatch.setattr(crankshaft, "drilled_at", leaves_a_crumb)
    scene = load_scene("mikron-iiic-plain", whole=True)
    with cad_session("crank") as session:
        assert len(crankshaft.add_crankshaft(session.model.occ, scene)) == 1


def test_a_rounding_that_took_too_much_is_not_believed(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(drilled_module, "_PLAUSIBLE", 1.0)  # nothing is then
    by_tool, closed = ring_mm3(STRAIGHT, 1.0)
    assert by_tool == pytest.approx(closed, rel=0.06)


def test_a_body_that_cannot_be_cut_is_meshed_with_tools(monkeypatch: pytest.MonkeyPatch) -> None:
    original, calls = solid_mesh.positive_x, []

    def fails_first(*arguments: Any, **options: Any) -> Any:
        calls.append(arguments)
        if len(calls) == 1:
            raise solver_error("the CAD kernel cannot cut this body", "")
        return original(*arguments, **options)

    monkeypatch.setattr(solid_mesh, "positive_x", fails_first)
    assert solid_mesh.mesh_throw(mikron(STRAIGHT), 20.0).mesh.mirrored
    assert len(calls) == 2
    calls.clear()
    with pytest.raises(CranktopoError, match="cannot cut"):
        solid_mesh.mesh_throw(mikron(), 20.0)


def test_a_tool_that_the_kernel_leaves_inside_out_is_no_body() -> None:
    """Engine 52 with its first web twice: a rounding that the plane of symmetry cuts through."""
    scene = one_web(scene_from_dict(featured_engine(52), whole=True), "first")
    assert kernel_mm3(scene) == pytest.approx(half_throw_volume_mm3(scene), rel=1e-5)
