"""Fillets between counterweight and web: areas by formula, the exact solid, cells, refusals."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from cranktopo.base.errors import CranktopoError
from cranktopo.bodies.cells.domain import build_domain
from cranktopo.bodies.solid.files import export_solid
from cranktopo.bodies.volume import counterweight_mass, web_moments, web_volume_mm3
from cranktopo.design.schema import Scene
from cranktopo.engine.balance.throw import throw_balance
from cranktopo.tasks.refit.fit import scene_with_web
from cranktopo.throw.counterweight.tangent_circle import OutlineSection
from tests.unit.throw.counterweight_cases import DISC, OUTLINES, PLAIN, THIN, roomy_scene

THICK_MM = 19.0
STEP_MM = 0.025
OF_WEBS_MM2 = 6e-8
"""1e-11 of the sections of 6000 mm2 that are subtracted: what their quadrature is asked for."""


@pytest.fixture(scope="module")
def roomy(mikron: Scene) -> Scene:
    return roomy_scene(mikron)


def web_of(scene: Scene, outline: str, counterweight: dict[str, Any], **features: Any) -> Scene:
    web = {"thickness_mm": THICK_MM, **OUTLINES[outline], **features, "counterweight": counterweight}
    return scene_with_web(scene, web)


def added(scene: Scene, outline: str, counterweight: dict[str, Any]) -> Any:
    """Moments of both fillets over their thickness."""
    sharp = {key: value for key, value in counterweight.items() if key != "fillet_mm"}
    more = web_moments(web_of(scene, outline, counterweight)) - web_moments(web_of(scene, outline, sharp))
    return more.times(1 / counterweight.get("thickness_mm", THICK_MM))


def between_lines(radius: float, degrees: float) -> float:
    """Area of the fillet in a corner of an angle."""
    angle = math.radians(degrees)
    return radius**2 * (1 / math.tan(angle / 2) - (math.pi - angle) / 2)


@pytest.mark.parametrize("radius", [0.8, 6.0])
@pytest.mark.parametrize(
    ("outline", "counterweight", "corner_deg"),
    [
        ("rectangle", PLAIN, 120.0),  # the flank leaves through the vertical side
        ("rectangle", {**PLAIN, "half_angle_deg": 20.0}, 70.0),  # through the straight end
        ("obround", DISC, 90.0),
        ("widening", {**THIN, "half_angle_deg": 85.0}, None),
    ],
    ids=["side", "end", "half a disc", "tapered"],
)
def test_area_between_straight_lines(
    roomy: Scene, outline: str, counterweight: dict[str, Any], corner_deg: float | None, radius: float
) -> None:
    web = OUTLINES[outline]
    if corner_deg is None:  # between the flank and the common tangent of both circles
        lean = math.degrees(math.asin((web["main_radius_mm"] - web["pin_radius_mm"]) / roomy.throw.radius_mm))
        corner_deg = 90.0 + lean + 90.0 - counterweight["half_angle_deg"]
    found = added(roomy, outline, {**counterweight, "fillet_mm": radius})
    assert found.volume == pytest.approx(2 * between_lines(radius, corner_deg), rel=1e-9, abs=OF_WEBS_MM2)
    assert found.first_x == pytest.approx(0.0, abs=1e-6)


def test_area_between_flank_and_round_end(roomy: Scene) -> None:
    """The flank is radial to the end's circle: the triangle of centres less what both circles have of it."""
    end, r = 25.0, 7.0
    turn = math.asin(r / (end + r))
    flank = (end + r) * math.cos(turn)
    area = flank * r / 2 - end**2 * turn / 2 - r**2 * (math.pi / 2 - turn) / 2
    found = added(roomy, "obround", {**PLAIN, "fillet_mm": r})
    assert found.volume == pytest.approx(2 * area, rel=1e-9, abs=OF_WEBS_MM2)


def test_unbalance_and_inertia_by_points(roomy: Scene) -> None:
    """On an outline without a closed form: first and polar moments from points in the corner."""
    found = added(roomy, "profile", {**DISC, "half_angle_deg": 80.0, "fillet_mm": 6.0})
    scenes = [
        web_of(roomy, "profile", {**DISC, "half_angle_deg": 80.0, **fillet})
        for fillet in ({}, {"fillet_mm": 6.0})
    ]
    x, y = (np.arange(low, high, STEP_MM) + STEP_MM / 2 for low, high in ((25.0, 55.0), (-15.0, 15.0)))
    grid = np.meshgrid(x, y, indexing="ij")
    inside = [np.zeros(grid[0].shape, dtype=bool) for _ in scenes]
    for mask, scene in zip(inside, scenes, strict=True):
        weight = scene.web.counterweight
        assert weight is not None
        mask |= grid[0] < scene.web.half_width_mm(scene.throw.radius_mm, y)[None]
        for part in weight.parts(scene):
            mask |= part.contains(*grid, sum(scene.web_z_mm) / 2)
    only = inside[1] & ~inside[0]
    points = np.stack([grid[0][only], grid[1][only]])
    share = 2 * STEP_MM**2
    assert found.volume == pytest.approx(share * points.shape[1], rel=1e-3)
    assert found.first_y == pytest.approx(share * points[1].sum(), rel=1e-3)
    assert found.polar == pytest.approx(share * (points**2).sum(), rel=1e-3)


@pytest.mark.parametrize("outline", OUTLINES)
def test_touches_flank_and_outline_from_outside(roomy: Scene, outline: str) -> None:
    """For every kind of outline: no point of it is nearer than the radius, one is that near."""
    scene = web_of(roomy, outline, {**THIN, "fillet_mm": 4.0})
    weight = scene.web.counterweight
    assert weight is not None
    circle = weight.circle(scene)
    assert circle is not None
    low, high = scene.web.y_range_mm(scene.throw.radius_mm)
    y = np.linspace(low, high, 40_001)
    half = scene.web.half_width_mm(scene.throw.radius_mm, y)
    near = np.hypot(np.maximum(circle.centre[0] - half, 0), circle.centre[1] - y).min()
    assert near == pytest.approx(4.0, abs=1e-6)
    x, y_flank = circle.on_flank
    assert math.degrees(math.atan2(x, -y_flank)) == pytest.approx(75.0, abs=1e-9)
    assert math.dist(circle.centre, circle.on_flank) == pytest.approx(4.0, abs=1e-9)
    assert math.dist(circle.centre, circle.on_outline) == pytest.approx(4.0, abs=1e-9)


HOLE = {"shape": "cylinder", "y_mm": -45.0, "diameter_mm": 10.0}
SOLIDS: dict[str, tuple[str, dict[str, Any], dict[str, Any]]] = {
    "obround": ("obround", {**PLAIN, "fillet_mm": 7.0}, {}),
    "half a disc": ("obround", {**DISC, "fillet_mm": 12.0}, {}),
    "thin, bored": ("obround", {**THIN, "fillet_mm": 5.0}, {"pocket": [HOLE]}),
    "ellipse": ("ellipse", {**PLAIN, "half_angle_deg": 80.0, "fillet_mm": 5.0}, {}),
    "tapered": ("tapered", {**PLAIN, "fillet_mm": 3.0}, {}),
    "straight end": ("rectangle", {**PLAIN, "half_angle_deg": 20.0, "fillet_mm": 3.0}, {}),
    "profile": ("profile", {**DISC, "half_angle_deg": 80.0, "fillet_mm": 6.0}, {}),
}


@pytest.mark.parametrize(
    "name",
    [pytest.param(name, marks=[pytest.mark.slow] * (name in ("half a disc", "tapered"))) for name in SOLIDS],
)
def test_solid_and_cells_agree(roomy: Scene, name: str, tmp_path: Any) -> None:
    """The CAD kernel to 1e-6, cells to their steps."""
    outline, counterweight, features = SOLIDS[name]
    scene = web_of(roomy, outline, counterweight, **features)
    volume = export_solid(scene, "web", tmp_path / "web.step")
    assert volume == pytest.approx(web_volume_mm3(scene), rel=1e-6)
    domain = build_domain(scene, 3.0, "web", extent="quarter")
    assert 2 * float((domain.web * domain.volume_mm3).sum()) == pytest.approx(volume, rel=6e-4)


def test_counts_as_the_counterweights_own(roomy: Scene) -> None:
    """Its mass and unbalance are told with the counterweight's."""
    sharp, filleted = (web_of(roomy, "obround", {**DISC, **more}) for more in ({}, {"fillet_mm": 8.0}))
    more = counterweight_mass(filleted).volume - counterweight_mass(sharp).volume
    expected = 2 * between_lines(8.0, 90.0) * THICK_MM * roomy.material.density_kg_m3 * 1e-9
    assert more == pytest.approx(expected, rel=1e-6)
    masses = [throw_balance(scene).mass_kg for scene in (sharp, filleted)]
    assert masses[1] - masses[0] == pytest.approx(2 * expected, rel=1e-6)


def test_an_optimiser_keeps_the_sector_alone(roomy: Scene) -> None:
    sharp, filleted = (
        build_domain(web_of(roomy, "obround", {**DISC, **more}), 6.0) for more in ({}, {"fillet_mm": 8.0})
    )
    np.testing.assert_array_equal(sharp.passive_fraction, filleted.passive_fraction)
    np.testing.assert_array_equal(sharp.design_fraction, filleted.design_fraction)


def test_a_sharp_corner_costs_nothing(roomy: Scene, monkeypatch: pytest.MonkeyPatch) -> None:
    def refuse(*_: Any) -> None:
        raise AssertionError("asked for a fillet")

    monkeypatch.setattr(OutlineSection, "__init__", refuse)
    web_moments(web_of(roomy, "tapered", {**PLAIN, "outer_radius_mm": 61.7}))


REFUSED: dict[str, tuple[str, dict[str, Any], str]] = {
    "zero": ("obround", {**PLAIN, "fillet_mm": 0.0}, r"fillet_mm"),
    "negative": ("obround", {**PLAIN, "fillet_mm": -2.0}, r"fillet_mm"),
    "no number": ("obround", {**PLAIN, "fillet_mm": "large"}, r"fillet_mm"),
    "a wrong unit": ("obround", {**PLAIN, "fillet_mm": 0.005}, r"fillet_mm = 0.005.*unit"),
    "too large": ("obround", {**DISC, "fillet_mm": 45.1}, r"fillet_mm = 45.1: .*at most 4.*flank ends"),
    "no corner": (
        "rectangle",
        {"outer_radius_mm": 34.0, "half_angle_deg": 45.0, "fillet_mm": 2.0},
        r"fillet_mm = 2.0: .*no corner",
    ),
    "bolted": (
        "obround",
        {**PLAIN, "fillet_mm": 2.0, "density_kg_m3": 9000.0},
        r"fillet_mm = 2.0: .*part of its own",
    ),
}


@pytest.mark.parametrize("name", REFUSED)
def test_refused(name: str, roomy: Scene) -> None:
    outline, counterweight, message = REFUSED[name]
    with pytest.raises(CranktopoError, match=message):
        web_of(roomy, outline, counterweight)


def test_the_largest_that_is_named_is_accepted(roomy: Scene) -> None:
    """Its circle touches the straight side and the flank where that ends."""
    with pytest.raises(CranktopoError) as refusal:
        web_of(roomy, "obround", {**PLAIN, "fillet_mm": 200.0})
    largest = float(str(refusal.value).partition("at most ")[2].partition(" mm")[0])
    turn = math.radians(60.0)
    assert largest == pytest.approx((62.0 * math.sin(turn) - 25.0) / (1 - math.cos(turn)), abs=1e-3)
    web_of(roomy, "obround", {**PLAIN, "fillet_mm": largest})


def test_a_side_pocket_in_it_is_refused(roomy: Scene) -> None:
    slot = {"shape": "side", "y_mm": 4.5, "length_mm": 8.0, "height_mm": 5.0, "depth_mm": 5.0}
    web_of(roomy, "obround", DISC, pocket=[slot])
    with pytest.raises(CranktopoError, match=r"pocket\[0\]: runs into web.counterweight"):
        web_of(roomy, "obround", {**DISC, "fillet_mm": 40.0}, pocket=[slot])
