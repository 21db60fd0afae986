"""The feature that a refusal of the CAD kernel names, and the dimension that it advises."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import pytest

from cranktopo.base.errors import CranktopoError
from cranktopo.bodies.solid.checked import ClosedForm, check_body
from cranktopo.bodies.solid.culprit import Culprit, culprit
from cranktopo.bodies.solid.throw import add_half_throw
from cranktopo.design.loading import scene_from_dict
from cranktopo.design.schema import Scene
from cranktopo.numerics.gmsh_session import cad_session
from tests.physics.throw.test_drillings import STRAIGHT, mikron

HOLE = {"shape": "cylinder", "diameter_mm": 6.0}


@pytest.fixture(scope="module")
def featured() -> Scene:
    """Two pockets, a counterweight, two drillings, one of them with rounded outlets."""
    data: dict[str, Any] = mikron().model_dump(mode="json", exclude_none=True)
    del data["envelope"]
    data["web"]["pocket"] = [HOLE | {"x_mm": x, "y_mm": 24.0} for x in (-12.0, 12.0)]
    data["web"]["counterweight"] = {"outer_radius_mm": 60.0, "half_angle_deg": 60.0}
    across = {"on": "crankpin", "angle_deg": 90.0, "place_mm": 0.0}
    sharp = {"from": across, "to": {**across, "angle_deg": 270.0}, "diameter_mm": 4.0}
    data["throw"]["drilling"] = [sharp, {**STRAIGHT, "outlet_radius_mm": 2.0}]
    return scene_from_dict(data)


WRONG: dict[str, Callable[[Scene], bool]] = {
    "web.outline = 'obround'": lambda scene: True,
    "throw.main_journal.fillet_mm = 2.5": lambda scene: scene.throw.main_journal.fillet_mm > 0,
    "throw.crankpin.fillet_mm = 2.5": lambda scene: scene.throw.crankpin.fillet_mm > 0,
    "web.counterweight": lambda scene: scene.web.counterweight is not None,
    "web.pocket[0]": lambda scene: len(scene.web.pocket) > 0,
    "web.pocket[1]": lambda scene: len(scene.web.pocket) > 1,
    "throw.drilling[0].diameter_mm = 4": lambda scene: len(scene.throw.drilling) > 0,
    "throw.drilling[1].diameter_mm = 5": lambda scene: len(scene.throw.drilling) > 1,
}


@pytest.mark.parametrize("told", WRONG)
def test_the_first_wrong_feature_is_named(told: str, featured: Scene) -> None:
    found = culprit(featured, lambda scene: 2.0 * WRONG[told](scene))
    assert found.feature == told
    assert "by 0.1 mm" in found.hint


@pytest.mark.parametrize(
    ("largest_mm", "hint"), [(1.0, "Reduce it: 0.95 mm is made right."), (0.0, "Reduce it, or")]
)
def test_a_rounding_that_the_kernel_makes_is_advised(largest_mm: float, hint: str, featured: Scene) -> None:
    """It is one that was tried."""
    tried = list[float]()

    def misfit(part: Scene) -> float:
        radius = max((one.outlet_radius_mm for one in part.throw.drilling), default=0.0)
        tried.append(radius)
        return 5.0 if radius > largest_mm else 0.5

    found = culprit(featured, misfit)
    assert found.feature == "throw.drilling[1].outlet_radius_mm = 2"
    assert found.hint.startswith(hint)
    assert not largest_mm or any(f"{radius:g} mm" in found.hint for radius in tried)


def test_the_message_has_the_feature_and_what_to_do() -> None:
    found = Culprit("web.pocket[1]", "Move it.")
    with cad_session("box") as gmsh:
        occ = gmsh.model.occ
        box = [(3, occ.addBox(0, 0, 0, 1, 1, 1))]
        check_body(occ, box, ClosedForm(1.02, 0.4), "box", lambda: found)  # of roundings 5 % are let through
        with pytest.raises(CranktopoError) as told:
            check_body(occ, box, ClosedForm(1.03, 0.4), "box", lambda: found)
    assert str(told.value) == (
        "box: the CAD kernel built 1.00 mm3, the closed form is 1.03 mm3, from web.pocket[1] on. Move it."
    )


@pytest.mark.slow
@pytest.mark.parametrize(("radius_mm", "made"), [(2.0, True), (4.0, False)])
def test_roundings_of_outlets_by_the_kernel(radius_mm: float, made: bool) -> None:
    """The kernel's are no rolled balls: `pytest -m slow` of this file."""
    scene = mikron({**STRAIGHT, "outlet_radius_mm": radius_mm})
    with cad_session("half") as gmsh:
        if made:
            assert len(add_half_throw(gmsh.model.occ, scene)) == 1
            return
        with pytest.raises(CranktopoError, match=r"from throw.drilling\[0\].outlet_radius_mm = 4 on") as told:
            add_half_throw(gmsh.model.occ, scene)
    advised = float(told.value.hint.split()[2])
    with cad_session("half") as gmsh:
        smaller = mikron({**STRAIGHT, "outlet_radius_mm": advised})
        assert len(add_half_throw(gmsh.model.occ, smaller)) == 1


def test_bodies_that_fall_apart_are_told_with_the_smallest() -> None:
    """It named a pocket, of a crank without one."""
    with cad_session("two boxes") as gmsh:
        occ = gmsh.model.occ
        boxes = [(3, occ.addBox(0, 0, 0, 10, 10, 10)), (3, occ.addBox(20, 0, 0, 2, 2, 2))]
        with pytest.raises(CranktopoError) as refused:
            check_body(occ, boxes, ClosedForm(1000.0, 0.0), "crankshaft")
    assert refused.value.message == (
        "crankshaft: falls apart into 2 bodies; the smallest has 8 mm3 at (21.0, 1.0, 1.0) mm."
    )
    assert "or a drilling" in refused.value.hint
