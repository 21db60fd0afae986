"""Dimensions that give no sound body are refused before meshing, with the key, the value and what fits."""

from __future__ import annotations

from typing import Any

import pytest

from cranktopo.errors import CranktopoError
from cranktopo.remodel.checks import check_solid
from cranktopo.remodel.meshing import mesh_throw
from cranktopo.remodel.session import cad_session
from cranktopo.remodel.throw_solid import add_half_throw, check_body
from cranktopo.scene import Scene, load_scene
from tests.physics.judge_cases import mikron_with

HOLE = {"shape": "cylinder", "x_mm": 0.0, "diameter_mm": 12.0}
BOX = {"shape": "box", "face": "pin", "x_mm": 0.0, "y_mm": 24.0, "size_x_mm": 6.0, "size_y_mm": 6.0}
REFUSED: dict[str, tuple[Scene, str]] = {
    "fillet over the edge": (mikron_with(fillet_mm=4.5), r"fillet_mm.*4\.5.*shoulder.*at most 3\.9 mm"),
    "journal wider than the web": (mikron_with(0.0, width_mm=22.0), r"bore_diameter_mm.*rim"),
    "pocket into a bore": (mikron_with(pocket=[{**HOLE, "y_mm": 17.0}]), r"pocket\[0\].*cuts the bore"),
    "pocket outside": (mikron_with(pocket=[{**HOLE, "y_mm": 24.0, "x_mm": 60.0}]), r"pocket\[0\].*outside"),
    "pocket too deep": (mikron_with(pocket=[{**BOX, "depth_mm": 19.0}]), r"depth_mm.*smaller than.*19 mm"),
}


@pytest.mark.parametrize("name", REFUSED)
def test_refused_before_any_solid(name: str) -> None:
    scene, message = REFUSED[name]
    with pytest.raises(CranktopoError, match=message):
        check_solid(scene)


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
        check_body(occ, [near], 1.0, "box")
        with pytest.raises(CranktopoError, match="closed form is"):
            check_body(occ, [near], 1.00001, "box")
        with pytest.raises(CranktopoError, match="2 bodies"):
            check_body(occ, [near, far], 2.0, "box")


def test_elements_too_large_for_a_thin_part_are_named() -> None:
    with pytest.raises(
        CranktopoError, match=r"variant-1: no mesh with elements of 21 mm: .*too large"
    ) as told:
        mesh_throw(load_scene("opposed-piston-variant-1"), 21.0)
    assert "smaller element size" in told.value.hint
