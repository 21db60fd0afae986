"""Dimensions that give no sound body are refused before meshing, with the key, the value and what fits."""

from __future__ import annotations

from typing import Any

import pytest

from cranktopo.base.errors import CranktopoError
from cranktopo.bodies.solid.checked import ClosedForm, check_body
from cranktopo.bodies.solid.throw import add_half_throw
from cranktopo.design.loading import builtin_designs, load_scene, scene_from_dict
from cranktopo.design.schema import Scene
from cranktopo.numerics.gmsh_session import cad_session
from cranktopo.throw.outline import ObroundWeb
from tests.physics.fea.evaluation_cases import mikron_with
from tests.random_throws import random_throw

HOLE = {"shape": "cylinder", "x_mm": 0.0, "diameter_mm": 12.0}
BOX = {"shape": "box", "face": "pin", "x_mm": 0.0, "y_mm": 24.0, "size_x_mm": 6.0, "size_y_mm": 6.0}
OBROUND: dict[str, Any] = {"thickness_mm": 19.0, "outline": "obround", "width_mm": 50.0}
RECTANGLE = {"thickness_mm": 19.0, "outline": "rectangle", "width_mm": 60.0, "overhang_mm": 30.0}
ELLIPSE = {"thickness_mm": 19.0, "outline": "ellipse", "semi_axis_lateral_mm": 40.0}
REFUSED: dict[str, tuple[dict[str, Any], float, str]] = {
    "fillet over the edge": (OBROUND, 4.5, r"main_journal.fillet_mm = 4\.5.*shoulder.*at most 3\.9 mm"),
    "bore wider than the web": (
        {**OBROUND, "width_mm": 20.0},
        0.0,
        r"main_journal.bore_diameter_mm = 24.*rim.*smaller than 19\.8 mm.*widen the web",
    ),
    "corner": (
        {**RECTANGLE, "corner_radius_mm": 30.0},
        2.5,
        r"web.corner_radius_mm = 30.*smaller than half of web.width_mm \(30 mm\).*obround",
    ),
    "corner of a short web": (
        {**RECTANGLE, "width_mm": 120.0, "corner_radius_mm": 55.0},
        2.5,
        r"web.corner_radius_mm = 55.*at most half of the web's length \(54 mm\)",
    ),
    "ellipse between the journals": (
        {**ELLIPSE, "semi_axis_throw_mm": 23.0},
        2.5,
        r"web.outline = 'ellipse': does not reach around the axis of throw.main_journal at y = 0",
    ),
    "pocket into a bore": (
        {**OBROUND, "pocket": [{**HOLE, "y_mm": 17.0}]},
        2.5,
        r"web.pocket\[0\]: cuts the bore",
    ),
    "pocket outside": (
        {**OBROUND, "pocket": [{**HOLE, "y_mm": 24.0, "x_mm": 60.0}]},
        2.5,
        r"web.pocket\[0\]: lies outside",
    ),
    "pocket too deep": (
        {**OBROUND, "pocket": [{**BOX, "depth_mm": 19.0}]},
        2.5,
        r"web.pocket\[0\].depth_mm = 19.*smaller than.*19 mm.*thicken",
    ),
    "pocket without depth": (
        {**OBROUND, "pocket": [{**HOLE, "y_mm": 24.0, "x_mm": 15.0, "face": "pin"}]},
        2.5,
        r"web.pocket\[0\].depth_mm = None: is missing with face = 'pin'.*'through'",
    ),
    "depth of a hole right through": (
        {**OBROUND, "pocket": [{**HOLE, "y_mm": 24.0, "x_mm": 15.0, "depth_mm": 5.0}]},
        2.5,
        r"web.pocket\[0\].depth_mm = 5.*no meaning",
    ),
}


@pytest.mark.parametrize("name", REFUSED)
def test_refused_when_the_scene_is_read(name: str) -> None:
    """Every command reads the scene first, so none of them works on a web that cannot exist."""
    web, fillet_mm, message = REFUSED[name]
    data = load_scene("mikron-iiic-plain").model_dump(mode="json", exclude_none=True)
    for journal in ("main_journal", "crankpin"):
        data["throw"][journal]["fillet_mm"] = fillet_mm
    with pytest.raises(CranktopoError, match=message) as told:
        scene_from_dict({**data, "web": web})
    assert len(str(told.value).splitlines()) == 1


def test_refused_before_any_solid(mikron: Scene) -> None:
    """A scene that was changed in Python was not read."""
    narrow = mikron.model_copy(update={"web": ObroundWeb.model_validate({**OBROUND, "width_mm": 20.0})})
    with pytest.raises(CranktopoError, match="breaks through the web's rim"), cad_session("half") as gmsh:
        add_half_throw(gmsh.model.occ, narrow)


def test_sound_webs_are_accepted() -> None:
    assert [random_throw(seed).name for seed in range(200)] == [f"random-{seed}" for seed in range(200)]
    assert [load_scene(name).name for name in builtin_designs()] == builtin_designs()


@pytest.mark.parametrize("fillet_mm", [0.0, 2.5, 3.9])
def test_what_fits_is_built(fillet_mm: float) -> None:
    with cad_session("half throw") as gmsh:
        assert len(add_half_throw(gmsh.model.occ, mikron_with(fillet_mm=fillet_mm))) == 1


def test_overlapping_journals_are_one_body() -> None:
    """A short throw: journal and pin of 42 mm on axes 30 mm apart share 12 mm of the web."""
    data: dict[str, Any] = mikron_with(0.0, 0.0).model_dump(mode="json", exclude_none=True)
    data["throw"]["radius_mm"] = 30.0
    scene = Scene.model_validate({k: v for k, v in data.items() if k not in ("envelope", "optimise")})
    with cad_session("half throw") as gmsh:
        assert len(add_half_throw(gmsh.model.occ, scene)) == 1


def test_wrong_volume_and_loose_parts_are_noticed() -> None:
    with cad_session("boxes") as gmsh:
        occ = gmsh.model.occ
        near, far = (3, occ.addBox(0, 0, 0, 1, 1, 1)), (3, occ.addBox(5, 0, 0, 1, 1, 1))
        check_body(occ, [near], ClosedForm(1.0), "box")
        with pytest.raises(CranktopoError, match="closed form is"):
            check_body(occ, [near], ClosedForm(1.0001), "box")
        with pytest.raises(CranktopoError, match="2 bodies"):
            check_body(occ, [near, far], ClosedForm(2.0), "box")
