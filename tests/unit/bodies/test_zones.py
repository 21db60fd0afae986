"""Frozen zones and zones where alone material may be removed: cells, surfaces, rules of `shape`, refusals."""

from __future__ import annotations

import json
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from cranktopo.base.arrays import Array
from cranktopo.base.errors import CranktopoError
from cranktopo.bodies.cells.domain import Domain, build_domain
from cranktopo.bodies.prisms import feature_holes, kept_solid
from cranktopo.bodies.volume import web_volume_mm3
from cranktopo.bodies.zones import staying_at, zone_solids
from cranktopo.design.halves import envelope_asymmetry
from cranktopo.design.loading import load_scene, scene_from_dict
from cranktopo.design.schema import Scene
from cranktopo.tasks.refit.family import with_free
from cranktopo.tasks.refit.fit import usual_limits
from cranktopo.tasks.refit.parametric_web import ParametricWeb
from cranktopo.tasks.web_shape.start import first_on_cells, scene_start

POCKET = {"shape": "cylinder", "y_mm": 24.0, "diameter_mm": 10.0, "face": "pin", "depth_mm": 8.0}
BOX = {"shape": "box", "x_min_mm": -16.0, "x_max_mm": 16.0, "y_min_mm": 16.0, "y_max_mm": 32.0}
HALF_DEEP = {**BOX, "z_min_mm": 30.0, "z_max_mm": 40.0}
ROUND = {"shape": "cylinder", "y_mm": 24.0, "diameter_mm": 24.0}


def zoned(scene: Scene, **zones: Any) -> Scene:
    """The Mikron with its bevels and a blind pocket, and zones."""
    data = scene.model_dump(mode="json", exclude_none=True)
    data["envelope"] |= zones
    data["web"]["pocket"] = [POCKET]
    return scene_from_dict(data, "zoned")


@pytest.fixture(scope="module")
def plain() -> Scene:
    return load_scene("mikron-iiic-plain")


def cells_in(domain: Domain, zone: dict[str, Any]) -> Any:
    """Cells whose whole volume lies in a box."""
    grid = domain.grid
    ranges = [(zone["x_min_mm"], zone["x_max_mm"]), (zone["y_min_mm"], zone["y_max_mm"])]
    ranges.append((zone.get("z_min_mm", 27.0), zone.get("z_max_mm", 46.0)))
    inside = [
        (nodes[:-1] >= low - 1e-9) & (nodes[1:] <= high + 1e-9)
        for nodes, (low, high) in zip((grid.x_mm, grid.y_mm, grid.z_mm), ranges, strict=True)
    ]
    return np.ix_(*inside)


@pytest.mark.parametrize("zone", [BOX, HALF_DEEP], ids=["all through", "half deep"])
def test_a_frozen_zone_stays_as_it_is_to_the_last_cell(plain: Scene, zone: dict[str, Any]) -> None:
    """Its cells hold the web as it is, pocket included, and nothing of them is designable."""
    scene = zoned(plain, frozen=[zone])
    domain = build_domain(scene, 6.0, extent="half")
    own = build_domain(scene, 6.0, "web", "half", domain.grid)
    inside = cells_in(domain, zone)
    assert own.passive_fraction[inside].size >= 8
    np.testing.assert_allclose(domain.passive_fraction[inside], own.passive_fraction[inside], atol=2e-4)
    assert not domain.design_fraction[inside].any()
    assert (own.passive_fraction[inside] < 0.5).any()


def test_outside_removable_zones_the_web_stays(plain: Scene) -> None:
    """Material of the web is fixed but for the zone; space beside the web is free as ever."""
    scene = zoned(plain, removable=[BOX])
    domain, free = build_domain(scene, 6.0, extent="half"), build_domain(zoned(plain), 6.0, extent="half")
    own = build_domain(scene, 6.0, "web", "half", domain.grid)
    inside = cells_in(domain, BOX)
    first, last = domain.web_layers
    outside = np.ones(domain.grid.cells, bool)
    outside[..., :first] = outside[..., last:] = False
    x, y, _ = np.broadcast_arrays(
        domain.grid.x_mm[1:, None, None], domain.grid.y_mm[None, 1:, None], domain.grid.z_mm[None, None, 1:]
    )
    step_x, step_y, _ = domain.grid.steps_mm
    touched = (x > -16) & (x - step_x[:, None, None] < 16) & (y > 16) & (y - step_y[None, :, None] < 32)
    away = outside & ~touched
    np.testing.assert_allclose(domain.passive_fraction[away], own.passive_fraction[away], atol=2e-4)
    np.testing.assert_allclose(domain.design_fraction[inside], free.design_fraction[inside], atol=1e-6)
    whole = domain.passive_fraction + domain.design_fraction
    np.testing.assert_allclose(whole, free.passive_fraction + free.design_fraction, atol=2e-4)


@pytest.mark.slow
def test_its_body_is_cut_from_the_exact_web(plain: Scene) -> None:
    """The surface has the web's own material in the zone, and its pocket stays open."""
    scene = zoned(plain, frozen=[ROUND])
    kept, emptied = zone_solids(scene)
    hole = np.pi * 5.0**2 * 8.0
    assert emptied.volume() == pytest.approx(hole, rel=5e-3)
    assert kept.volume() + emptied.volume() == pytest.approx(np.pi * 12.0**2 * 19.0, rel=2e-3)
    assert kept_solid(scene).volume() == pytest.approx(kept.volume(), rel=1e-9)
    assert feature_holes(scene).volume() == pytest.approx(emptied.volume(), rel=1e-9)
    everywhere, _ = zone_solids(zoned(plain, removable=[{**BOX, "x_min_mm": 70.0, "x_max_mm": 71.0}]))
    assert everywhere.volume() == pytest.approx(web_volume_mm3(scene), rel=1e-3)


@pytest.mark.slow
def test_a_body_is_a_zone(plain: Scene, tmp_path: Path) -> None:
    from manifold3d import Manifold

    from cranktopo.numerics.surfaces.files import write_surface
    from cranktopo.numerics.surfaces.mesh import mesh_of

    path = tmp_path / "zone.stl"
    write_surface(path, mesh_of(Manifold.cube((32.0, 16.0, 30.0)).translate((-16.0, 16.0, 20.0))), "stl")
    body = {"shape": "body", "file": str(path), "symmetric": True}
    found, box = (
        build_domain(zoned(plain, frozen=[zone]), 6.0, extent="half").passive_fraction for zone in (body, BOX)
    )
    np.testing.assert_allclose(found, box, atol=1e-3)


@pytest.mark.parametrize(
    ("zones", "key"),
    [
        ({"frozen": [{**BOX, "x_min_mm": -10.0}]}, "envelope.frozen[0]"),
        ({"frozen": [{**ROUND, "x_mm": 5.0}]}, "envelope.frozen[0]"),
        ({"frozen": [{**ROUND, "x_mm": 15.0}, {**ROUND, "x_mm": -15.0}]}, ""),
        ({"removable": [BOX]}, ""),
    ],
    ids=["box aside", "cylinder aside", "pair", "symmetric"],
)
def test_the_model_follows_the_symmetry_of_zones(plain: Scene, zones: dict[str, Any], key: str) -> None:
    assert envelope_asymmetry(zoned(plain, **zones)) == key


def test_an_empty_zone_is_refused(plain: Scene) -> None:
    with pytest.raises(CranktopoError, match=r"envelope.frozen\[0\].y_max_mm.*above y_min_mm"):
        zoned(plain, frozen=[{**BOX, "y_max_mm": 10.0}])
    with pytest.raises(CranktopoError, match=r"envelope.removable\[0\].z_max_mm.*above z_min_mm"):
        zoned(plain, removable=[{**HALF_DEEP, "z_max_mm": 20.0}])


def broken(scene: Scene, **moved: float) -> dict[str, float]:
    """Rules of zones that the web of the family breaks with some parameters moved, by name."""
    web, start = family(scene.model_dump_json(exclude_none=True))
    values = start.copy()
    for name, step in moved.items():
        values[web.layout.names.index(name.replace("_dot_", "."))] += step
    pairs = zip(web.rule_names(values), web.constraints(values).tolist(), strict=True)
    return {name: over for name, over in pairs if over > 0 and ("stays" in name or "frozen" in name)}


@cache
def family(design: str) -> tuple[ParametricWeb, Array]:
    """The family of a design and where a search of it begins; to lay out the rules of zones takes longest."""
    scene = scene_from_dict(json.loads(design), "zoned")
    limits = usual_limits(scene)
    start = scene_start(scene, limits)
    layout, values = with_free(start.layout, start.values, scene, first_on_cells(scene, {}))
    return ParametricWeb(layout, scene, limits, (np.zeros(0),) * 3), values


CUT, FILLED = "what stays of the web is not cut by the cylinder pocket of the pin face", "frozen zone"


@pytest.mark.parametrize(
    ("zones", "moved", "rule"),
    [
        ({"frozen": [BOX]}, {}, ""),
        ({"frozen": [BOX]}, {"cylinder-pin_dot_depth": 1.0}, CUT),
        ({"frozen": [BOX]}, {"cylinder-pin_dot_depth": -1.0}, FILLED),
        pytest.param(
            {"frozen": [{**BOX, "y_max_mm": 20.0}]},
            {"cylinder-pin_dot_diameter": 2.0},
            CUT,
            marks=pytest.mark.slow,
        ),
        pytest.param(
            {"frozen": [{**BOX, "y_min_mm": 5.0, "y_max_mm": 14.0}]},
            {"cylinder-pin_dot_y": 1.0},
            "",
            marks=pytest.mark.slow,
        ),
        ({"removable": [BOX]}, {"cylinder-pin_dot_y": 1.0}, ""),
        ({"removable": [BOX]}, {"cylinder-pin_dot_y": 4.0}, CUT),
    ],
    ids=["as it is", "deeper", "shallower", "wider", "elsewhere", "within the zone", "out of the zone"],
)
def test_features_of_a_search_keep_zones(
    plain: Scene, zones: dict[str, Any], moved: dict[str, float], rule: str
) -> None:
    found = broken(zoned(plain, **zones), **moved)
    outline = {name for name in found if name.endswith("outline")}  # sampled at 7 stations
    assert not outline or "removable" in zones
    rest = found.keys() - outline
    assert all(rule and rule in name for name in rest)
    assert bool(rest) == bool(rule)


SIDE = {"shape": "side", "y_mm": 24.0, "length_mm": 20.0, "height_mm": 6.0, "depth_mm": 4.0}
SQUARE = {"shape": "box", "face": "pin", "y_mm": 22.0, "size_x_mm": 12.0, "size_y_mm": 10.0, "depth_mm": 4.0}
CORNERS = {"draft_deg": 5.0, "corner_radius_mm": 2.0}
AROUND = {"shape": "box", "x_min_mm": -24.0, "x_max_mm": 24.0, "y_min_mm": 6.0, "y_max_mm": 44.0}
TOP = {"shape": "box", "x_min_mm": -14.0, "x_max_mm": 14.0, "y_min_mm": 50.0, "y_max_mm": 66.0}
BOTTOM = {"shape": "box", "x_min_mm": -14.0, "x_max_mm": 14.0, "y_min_mm": -19.0, "y_max_mm": 5.0}
ACROSS = {"shape": "box", "x_min_mm": -24.0, "x_max_mm": 24.0, "y_min_mm": 20.0, "y_max_mm": 28.0}
RIM = {"shape": "box", "x_min_mm": -30.0, "x_max_mm": 30.0, "y_min_mm": 23.0, "y_max_mm": 25.0}


def held(design: str, zone: dict[str, Any], **pocket: Any) -> Scene:
    """A design with a frozen zone, and with one pocket in place of its own."""
    data = load_scene(design).model_dump(mode="json", exclude_none=True)
    data["envelope"]["frozen"] = [zone]
    data["web"]["pocket"] = [pocket] if pocket else []
    return scene_from_dict(data, "held")


_HELD = dict(
    zip(
        (
            "side",
            "side with draft",
            "side with much draft",
            "box",
            "box with a round floor",
            "cylinder",
            "groove",
            "groove with a round floor",
            "top",
            "foot",
            "outline",
        ),
        [
            (
                held("mikron-iiic-plain", AROUND, **SIDE, draft_deg=draft),
                {"side.y": 0.2, "side.length": 0.2, "side.height": 0.2, "side.floor": 0.2, "side.offset": 0.2}
                | ({"side.draft": 1.2} if draft else {}),
                "side pocket",
            )
            for draft in (0.0, 10.0, 30.0)
        ]
        + [
            (
                held("mikron-iiic-plain", AROUND, **SQUARE, **CORNERS, **rounding),
                {f"box-pin.{name}": 0.2 for name in ("y", "size_x", "size_y", "depth")},
                "box pocket",
            )
            for rounding in ({}, {"floor_radius_mm": 1.0})
        ]
        + [
            (
                held("mikron-iiic-plain", AROUND, **POCKET),
                {f"cylinder-pin.{name}": 0.2 for name in ("y", "diameter", "depth")},
                "cylinder pocket",
            ),
        ]
        + [
            (
                held("mikron-iiic-plain", ACROSS, **{**SIDE, "length_mm": 200.0}, draft_deg=10.0, **rounding),
                {"groove.height": 0.2, "groove.floor": 0.2, "groove.offset": 0.2},
                "groove",
            )
            for rounding in ({}, {"floor_radius_mm": 1.5})
        ]
        + [
            (held("mikron-iiic", TOP), {"bevel-journal.y": 0.2, "bevel-journal.depth": 0.2}, "journal bevel"),
            (held("mikron-iiic", BOTTOM), {"bevel-pin.y": 0.2, "bevel-pin.depth": 0.2}, "pin bevel"),
            (held("mikron-iiic-plain", RIM), {"half_width_3": 0.3}, "outline"),
        ],
        strict=True,
    )
)
_LONG = {
    "box",
    "box with a round floor",
    "cylinder",
    "side",
    "side with draft",
    "side with much draft",
    "groove",
    "groove with a round floor",
    "top",
    "foot",
}


@pytest.mark.parametrize(
    ("scene", "steps", "part"),
    [
        pytest.param(*case, id=name, marks=pytest.mark.slow if name in _LONG else ())
        for name, case in _HELD.items()
    ],
)
def test_no_dimension_of_a_feature_in_a_frozen_zone_moves(
    scene: Scene, steps: dict[str, float], part: str
) -> None:
    """Each by 0.2 mm, or a draft by as much at its mouth, either way: it cuts what stays or fills a void."""
    assert not broken(scene)
    for name, step in steps.items():
        for sign in (1, -1):
            found = broken(scene, **{name.replace(".", "_dot_"): sign * step})
            assert found, f"{name} {sign * step:+g}"
            assert all(part in rule or FILLED in rule for rule in found), found


LOW_CYLINDER = {"shape": "cylinder", "y_mm": -52.0, "diameter_mm": 16.0}
BEYOND_RIM = {"shape": "box", "x_min_mm": -4.0, "x_max_mm": 4.0, "y_min_mm": -67.8, "y_max_mm": -66.2}


def diesel(zone: dict[str, Any], **weight: Any) -> Scene:
    """The car diesel, whose counterweight reaches 31 mm below its outline, with a frozen zone."""
    data = load_scene("car-diesel").model_dump(mode="json", exclude_none=True)
    data["envelope"]["frozen"] = [zone]
    data["web"]["counterweight"] |= weight
    return scene_from_dict(data, "diesel")


@pytest.mark.parametrize(
    ("zone", "weight", "moved", "rule"),
    [
        (LOW_CYLINDER, {}, {}, ""),
        (LOW_CYLINDER, {}, {"counterweight_radius": -8.0}, "is not cut by the outline or counterweight"),
        (LOW_CYLINDER, {}, {"counterweight_angle": -60.0}, "is not cut by the outline or counterweight"),
        (BEYOND_RIM, {}, {}, ""),
        (BEYOND_RIM, {}, {"counterweight_radius": 0.5}, FILLED),
        pytest.param(LOW_CYLINDER, {"thickness_mm": 10.0}, {}, "", marks=pytest.mark.slow),
    ],
    ids=["as it is", "smaller", "narrower", "void beyond the rim", "larger", "thinner than the web"],
)
def test_a_free_counterweight_keeps_zones(
    zone: dict[str, Any], weight: dict[str, Any], moved: dict[str, float], rule: str
) -> None:
    found = broken(diesel(zone, **weight), **moved)
    assert all(rule and rule in name for name in found)
    assert bool(found) == bool(rule)


@pytest.mark.slow
@pytest.mark.parametrize(("axis", "y_mm"), [("axial", -52.0), ("radial", -38.0)])
def test_the_hole_of_a_plug_in_a_frozen_zone_stays_empty_as_it_is(axis: str, y_mm: float) -> None:
    """No dimension fills it, so that no rule asks for it."""
    plug = {"axis": axis, "y_mm": y_mm, "diameter_mm": 8.0, "length_mm": 10.0, "density_kg_m3": 17500.0}
    assert not broken(diesel(LOW_CYLINDER, plug=[plug]))


@pytest.mark.slow
def test_the_fillet_of_a_counterweight_in_a_frozen_zone_stays_as_it_is() -> None:
    corner = {"shape": "box", "x_min_mm": -50.0, "x_max_mm": 50.0, "y_min_mm": -34.0, "y_max_mm": -5.0}
    scene = diesel(corner, fillet_mm=10.0)
    assert not broken(scene)
    assert any("cut by the outline" in name for name in broken(scene, counterweight_angle=-3.0))


def test_a_balancing_hole_moves_with_the_rim_but_into_no_zone() -> None:
    """Its floor, 14 mm below the rim, comes 10 mm nearer to the crank axis."""
    zone = {**LOW_CYLINDER, "y_mm": -42.0}
    scene = diesel(zone, hole=[{"diameter_mm": 8.0, "depth_mm": 14.0}])
    assert not broken(scene)
    assert any("holes from the rim" in name for name in broken(scene, counterweight_radius=-10.0))


@pytest.mark.parametrize("kind", ["frozen", "removable"])
def test_a_body_aside_that_is_called_symmetric_is_refused(plain: Scene, kind: str, tmp_path: Path) -> None:
    import trimesh

    path = tmp_path / "aside.stl"
    trimesh.creation.box(bounds=[[2.0, 16.0, 20.0], [16.0, 32.0, 50.0]]).export(path)
    zones = {kind: [BOX, {"shape": "body", "file": str(path), "symmetric": True}]}
    message = rf"envelope\.{kind}\[1\]\.symmetric.*sides of .*aside\.stl' differ by 100 %.*false"
    with pytest.raises(CranktopoError, match=message):
        list(staying_at(zoned(plain, **zones), 36.0))


def test_a_free_thickness_moves_zones(plain: Scene) -> None:
    data = zoned(plain, frozen=[BOX]).model_dump(mode="json", exclude_none=True)
    data["shape"] = {"free": {"web_thickness_mm": [18.0, 20.0]}}
    with pytest.raises(CranktopoError, match=r"web_thickness_mm.*hold the web's faces"):
        scene_from_dict(data, "thick")
