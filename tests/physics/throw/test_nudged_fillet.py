"""Fillets where surfaces touch, which the CAD kernel loses a piece of or cannot join to the web."""

from __future__ import annotations

from typing import Any

import pytest

from cranktopo.bodies.solid import throw
from cranktopo.bodies.solid.throw import add_half_throw
from cranktopo.bodies.volume import half_throw_volume_mm3
from cranktopo.design.loading import load_scene, scene_from_dict
from cranktopo.design.schema import Scene
from cranktopo.numerics.gmsh_session import cad_session

JOURNAL = {"length_mm": 32.0, "fillet_mm": 2.6}
WEB: dict[str, Any] = {
    "thickness_mm": 22.0,
    "outline": "profile",
    "stations_mm": [-31.18, -24.85, -7.55, 16.08, 39.71, 57.01, 63.34],
    "half_widths_mm": [0.0, 16.26, 32.59, 38.8, 32.63, 17.55, 0.0],
    "counterweight": {"outer_radius_mm": 76.98, "half_angle_deg": 50.81, "fillet_mm": 6.0, "face": "journal"},
}


@pytest.fixture(scope="module")
def touching() -> Scene:
    """12 mm3 beside the fillet of a counterweight are lost, of one radius alone: found by `shape`."""
    material = load_scene("mikron-iiic-plain").material.model_dump(exclude_none=True)
    journals = {"main_journal": {"outer_diameter_mm": 52.0, **JOURNAL}}
    own = {"radius_mm": 37.5, **journals, "crankpin": {"outer_diameter_mm": 46.0, **JOURNAL}}
    return scene_from_dict({"name": "touching", "throw": own, "web": WEB, "material": material})


def _built_mm3(scene: Scene) -> float:
    with cad_session("touching") as gmsh:
        return float(sum(gmsh.model.occ.getMass(*pair) for pair in add_half_throw(gmsh.model.occ, scene)))


def test_it_is_built_by_the_closed_form(touching: Scene) -> None:
    assert _built_mm3(touching) == pytest.approx(half_throw_volume_mm3(touching), rel=1e-7)


def test_a_fillet_that_is_whole_is_not_nudged(touching: Scene, monkeypatch: pytest.MonkeyPatch) -> None:
    whole = {**WEB, "counterweight": {**WEB["counterweight"], "fillet_mm": 5.0}}
    scene = scene_from_dict({**touching.model_dump(mode="json", exclude_none=True), "web": whole})
    built: list[Scene] = []
    half = throw._half
    monkeypatch.setattr(throw, "_half", lambda occ, one, **how: built.append(one) or half(occ, one, **how))
    assert _built_mm3(scene) == pytest.approx(half_throw_volume_mm3(scene), rel=1e-9)
    assert built == [scene]


@pytest.mark.parametrize("inside_mm", [1e-6, pytest.param(1e-3, marks=pytest.mark.slow), 3e-3])
def test_a_fillet_that_ends_just_inside_the_other_bore(touching: Scene, inside_mm: float) -> None:
    """The kernel made three bodies of it, the largest a tenth of the throw."""
    data = touching.model_dump(mode="json", exclude_none=True)
    bore_mm = 2 * (touching.throw.radius_mm - touching.throw.crankpin.clear_radius_mm + inside_mm)
    data["throw"]["main_journal"]["bore_diameter_mm"] = bore_mm
    del data["web"]["counterweight"]
    scene = scene_from_dict(data)
    assert _built_mm3(scene) == pytest.approx(half_throw_volume_mm3(scene), rel=5e-6)
