"""`remodel` tells mass and balance of its throw as the other commands count them, what got worse first."""

from __future__ import annotations

from typing import Any

import pytest

from cranktopo.design.goal.balance_moved import MovedBalance
from cranktopo.design.loading import load_scene, scene_from_dict
from cranktopo.design.schema import Scene
from cranktopo.numerics.surfaces.mesh import mesh_of
from cranktopo.report.viewer.scene3d import ShownBody
from cranktopo.tasks.refit.masses import throw_masses, web_masses
from cranktopo.tasks.refit.page import refit_page, refit_text
from cranktopo.tasks.refit.result import RefitResult, RefitThrow, RefitThrows
from cranktopo.tasks.refit.shape_error import ShapeError
from tests.unit.bodies.test_seat import HEAVY, WEIGHT, with_weight
from tests.unit.refit.test_remodel_page import data

__all__ = ["data"]


def block(low: tuple[float, float, float], size: tuple[float, float, float]) -> Any:
    from manifold3d import Manifold

    return mesh_of(Manifold.cube(size).translate(low))


def heavier(scene: Scene) -> Scene:
    changed = scene.model_dump(mode="json", exclude_none=True)
    changed["web"]["counterweight"]["outer_radius_mm"] = 64.0
    return scene_from_dict(changed, "heavier")


def test_a_body_has_its_steel_and_what_is_bolted_to_both_webs() -> None:
    """By hand: a block of steel on either side of the mid-pin plane, a sector of heavy metal less a disc."""
    scene = with_weight(WEIGHT)
    low, size = (-10.0, 20.0, 0.0), (20.0, 30.0, 50.0)
    body = throw_masses(scene, scene, block(low, size)).body
    steel = 2 * 20 * 30 * 50 * scene.material.density_kg_m3 * 1e-9
    # sector of 120 degrees: area 60/180 pi (R2 - r2), first moment -2/3 (R3 - r3) sin 60 deg * 2
    area, first = 3.141592653589793 / 3 * (62**2 - 30**2), -2 / 3 * (62**3 - 30**3) * 0.75**0.5
    heavy = 2 * 19.0 * HEAVY * 1e-9
    assert body.mass_kg == pytest.approx(steel + heavy * area, rel=1e-6)
    assert body.unbalance_kg_mm == pytest.approx(steel * 35.0 + heavy * first, rel=1e-6)


def test_the_mass_of_a_web_counts_what_is_bolted_to_it() -> None:
    scene = with_weight(WEIGHT)
    near = ShapeError(0.9, 0.8, 0.1, 1.0, (0.0, 0.0, 0.0), 60e3, 50e3)
    found = web_masses(scene, scene, near)
    heavy = 19.0 * HEAVY * 1e-9 * 3.141592653589793 / 3 * (62**2 - 30**2)
    steel = scene.material.density_kg_m3 * 1e-9
    assert found.fitted == pytest.approx(60e3 * steel + heavy, rel=1e-6)
    assert found.body == pytest.approx(50e3 * steel + heavy, rel=1e-6)


def test_a_heavier_counterweight_moves_the_balance_factor() -> None:
    scene = with_weight(WEIGHT)
    found = throw_masses(scene, heavier(scene), block((-10.0, 20.0, 0.0), (20.0, 30.0, 50.0)))
    assert found.original is not None
    assert found.moved is not None
    assert found.fitted.mass_kg > found.original.mass_kg
    assert found.moved.balance_factor_percent == found.fitted.balance_factor_percent
    assert found.moved.original_percent == found.original.balance_factor_percent
    same = throw_masses(scene, scene, block((-10.0, 20.0, 0.0), (20.0, 30.0, 50.0)))
    assert same.moved is None


def test_a_body_of_a_file_has_no_original_to_compare_with() -> None:
    scene = load_scene("mikron-iiic-plain")
    from_file = scene.model_copy(update={"original": object()})
    found = throw_masses(from_file, scene, block((-10.0, 20.0, 0.0), (20.0, 30.0, 50.0)))
    assert found.original is None
    assert found.moved is None


def test_what_got_worse_comes_first(data: RefitResult) -> None:
    moved = MovedBalance(balance_factor_percent=64.0, original_percent=50.6, told="it moved")
    throws = RefitThrows(
        original=RefitThrow(mass_kg=5.0, unbalance_kg_mm=-39.2, balance_factor_percent=50.6),
        body=RefitThrow(mass_kg=4.9, unbalance_kg_mm=-36.9, balance_factor_percent=43.8),
        fitted=RefitThrow(mass_kg=5.2, unbalance_kg_mm=-44.1, balance_factor_percent=64.0),
        moved=moved,
    )
    told = data.model_copy(update={"throws": throws})
    lines = refit_text(told).splitlines()
    assert lines[0].startswith("worse than the original web: balance factor 64 %")
    assert lines[1] == "worse than the original web: 4.0 % heavier"
    assert lines[2] == "note: it moved"
    text = " ".join(" ".join(lines).split())
    assert "mass of the throw 5.200 kg, body 4.900 kg, original 5.000 kg (+4.0 %)" in text
    assert "unbalance -44.1 kg mm, body -36.9 kg mm, original -39.2 kg mm" in text
    assert "balance factor 64 %, body 43.8 %, original 50.6 %" in text
    scene = with_weight(WEIGHT)
    shown = ShownBody("body", block((0.0, 0.0, 0.0), (9.0, 9.0, 50.0)), scene.web_z_mm, scene.pitch_mm / 2)
    page = refit_page(told, (shown, shown), {}, "2026-01-01")
    assert page.headline.startswith("Worse than the original web: balance factor 64 %")
    facts = {fact.label: fact for fact in page.facts}
    assert facts["Mass of the throw"].status == "bad"
    assert facts["Balance factor"].note == "it moved"
