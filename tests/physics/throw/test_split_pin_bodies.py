"""Bodies of throws with split pins: each half turned by its own angle, their half pins overlapping."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from cranktopo.base.errors import CranktopoError
from cranktopo.bodies.solid.files import export_solid, surface_of
from cranktopo.bodies.volume import throw_volume_mm3
from cranktopo.design.crank_throws import straightened
from cranktopo.design.loading import load_scene, scene_from_dict
from cranktopo.design.schema import Scene
from cranktopo.numerics.surfaces.mesh import solid_of
from cranktopo.tasks.crank_import.stage import import_crank
from tests.physics.throw.test_crossing_drillings import drilled_twin
from tests.physics.throw.test_whole_crank import check_step_file

SPLAY = -30.0
WEIGHT = {"outer_radius_mm": 75.0, "half_angle_deg": 60.0}


def split(splay: float, cylinders: int = 2, web: str = "", place_mm: float = 4.0, **weight: Any) -> Scene:
    """V engine of 90 deg on split pins, with counterweights and, for `web`, a drilling that leans."""
    data = drilled_twin(place_mm, 0.0, web or "both").model_dump(
        mode="json", exclude_none=True, by_alias=True
    )
    if not web:
        data["throw"].pop("drilling")
    data["web"]["counterweight"] = WEIGHT | weight
    arrangement: dict[str, Any] = {"layout": "V", "bank_angle_deg": 90.0, "pin_splay_deg": splay}
    if cylinders == 2:
        arrangement["throw_angles_deg"] = [0.0]
    order = {2: [1, 2], 6: [1, 4, 3, 6, 2, 5]}[cylinders]
    data["engine"] |= {"cylinders": cylinders, "firing_order": order, "arrangement": arrangement}
    return scene_from_dict(data, "split", whole=True)


@pytest.mark.parametrize("splay", [SPLAY, 40.0])
def test_the_step_file_weighs_and_pulls_as_the_balance_has_it(splay: float, tmp_path: Path) -> None:
    """Mass, unbalance and couple of the exact faces against U1 exp(-i s/2) + U2 exp(i s/2) and its couple."""
    check_step_file(split(splay), tmp_path / "crank.step")


@pytest.mark.slow
@pytest.mark.parametrize(
    "scene",
    [split(SPLAY, 6), split(SPLAY, 6, "second", 1.0), split(SPLAY, 2, "first"), split(SPLAY, 2, "both", 0.0)],
    ids=["six", "six drilled across", "one side", "both sides across"],
)
def test_six_cylinders_and_drillings(scene: Scene, tmp_path: Path) -> None:
    check_step_file(scene, tmp_path / "crank.step", 10.0)


def test_each_half_pin_is_where_its_rod_runs() -> None:
    """Sections of the throw before and behind the middle of the pin: circles at -s/2 and s/2."""
    scene = split(SPLAY)
    whole = solid_of(surface_of(scene, "throw", 2.0), "throw")
    for off, turn in ((-3.0, -SPLAY / 2), (3.0, SPLAY / 2)):
        (circle,) = whole.translate((0.0, 0.0, -scene.pitch_mm / 2 - off)).slice(0.0).to_polygons()
        x, y = (circle.min(axis=0) + circle.max(axis=0)) / 2
        # the sense of rotation turns +y toward +x
        expected = scene.throw.radius_mm * np.array([np.sin(np.radians(turn)), np.cos(np.radians(turn))])
        np.testing.assert_allclose((x, y), expected, atol=0.1)


def test_bolted_counterweights_turn_with_their_webs(tmp_path: Path) -> None:
    scene = split(SPLAY, density_kg_m3=17000.0)
    assert export_solid(scene, "crankshaft", tmp_path / "crank.step") > 0.0


def test_half_pins_that_do_not_overlap_are_refused() -> None:
    with pytest.raises(CranktopoError, match=r"pin_splay_deg = 80\.0: must be within \+-78\.0.* deg"):
        surface_of(split(80.0), "throw")


@pytest.mark.parametrize("part", ["half", "raw", "raw_crankshaft", "plugs"])
def test_other_parts_are_refused(part: Any) -> None:
    with pytest.raises(CranktopoError, match=r"pin_splay_deg = -30\.0: split pins are not modelled here"):
        surface_of(split(SPLAY), part)


@pytest.mark.slow
def test_a_split_pin_from_cad_has_its_whole_half_throw_and_its_splay(tmp_path: Path) -> None:
    """Half pins were told as pins beside a flying web, each with a throw of half the pin's length."""
    scene = split(SPLAY)
    export_solid(scene, "crankshaft", tmp_path / "crank.step")
    found = import_crank(tmp_path / "crank.step", out=tmp_path / "found")
    told = " ".join(lack.what for lack in found.unread)
    assert "crankpins 1 and 2 meet without a web, 30 deg apart: split pins" in told
    assert "flying" not in told
    text = (tmp_path / "found" / "crank.toml").read_text(encoding="utf-8")
    assert f'layout = "V", pin_splay_deg = {SPLAY}, throw_angles_deg = [0.0]' in text
    half = load_scene(str(tmp_path / "found" / "crank.toml"))
    assert half.throw.crankpin.length_mm == pytest.approx(scene.throw.crankpin.length_mm, abs=1e-6)
    assert throw_volume_mm3(half) == pytest.approx(throw_volume_mm3(straightened(scene)), rel=1e-6)
