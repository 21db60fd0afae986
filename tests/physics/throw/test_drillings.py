"""Oil drillings: closed form against rays and the exact solid, cells, surface, symmetry."""

from __future__ import annotations

import math
import re
from contextlib import nullcontext
from typing import Any

import numpy as np
import pytest
from manifold3d import Manifold

from cranktopo.base.errors import CranktopoError
from cranktopo.base.units import density_kg_per_mm3
from cranktopo.bodies.cells.domain import build_domain
from cranktopo.bodies.drill_tool import segments
from cranktopo.bodies.prisms import journal_halves, web_bores
from cranktopo.bodies.solid.checked import solid_properties
from cranktopo.bodies.solid.throw import add_half_throw
from cranktopo.design.halves import envelope_asymmetry, mirror_image, web_asymmetry
from cranktopo.design.loading import load_scene, scene_from_dict
from cranktopo.design.schema import Scene
from cranktopo.engine.balance.throw import throw_balance
from cranktopo.numerics.gmsh_session import cad_session
from cranktopo.numerics.surfaces.mesh import mesh_of
from cranktopo.tasks.importing.placement import misfits, ring_misfits
from cranktopo.throw.bevel_arc import BevelArc
from cranktopo.throw.drilling.moments import drilled
from cranktopo.throw.drilling.outlet import ring_points
from cranktopo.throw.drilling.table import drill_bores, drilling_asymmetry, drilling_rules
from cranktopo.throw.fitted import CLEAR_MM, Surroundings
from cranktopo.throw.manufacturing_limits import ManufacturingLimits
from tests.hostile.featured_engines import featured_engine

STEP = 1e-9


def drilling(start, end, diameter=5.0, rounding=0.0):
    ends = [dict(zip(("on", "angle_deg", "place_mm"), place, strict=True)) for place in (start, end)]
    return {"from": ends[0], "to": ends[1], "diameter_mm": diameter, "outlet_radius_mm": rounding}


LEANING = drilling(("main_journal", 160.0, 1.0), ("crankpin", 15.0, 2.0), rounding=1.0)
STRAIGHT = drilling(("main_journal", 180.0, 6.0), ("crankpin", 0.0, 6.0), rounding=1.0)
RADIAL = drilling(("crankpin", 60.0, 0.0), ("crankpin_bore", 60.0, 0.0), rounding=1.0)


def mikron(*drillings, **journals) -> Scene:
    data = load_scene("mikron-iiic-plain").model_dump(mode="json", exclude_none=True)
    data["throw"]["drilling"] = list(drillings)
    for name in ("main_journal", "crankpin"):
        data["throw"][name] |= journals
    return scene_from_dict(data)


def along_rays(scene: Scene, points: int) -> tuple[float, float]:
    """Volume and integral of x2 + y2 of a drilling's cylinder in journals and web, by rays along it."""
    (bore,) = drill_bores(scene)
    (low, high), along = bore.extent_mm, bore.direction
    radius, turn = np.meshgrid(
        bore.radius_mm * np.sqrt((np.arange(points) + 0.5) / points),
        2 * np.pi * (np.arange(2 * points) + 0.5) / (2 * points),
    )
    spokes = bore.around
    one, other = spokes[0], spokes[len(spokes) // 4]
    at = (radius * np.cos(turn)).ravel()[:, None] * one + (radius * np.sin(turn)).ravel()[:, None] * other
    at = at + np.array(bore.outlets[0].point_mm)

    def within(y, size, z):
        foot = at[:, :2] - [0.0, y]
        a, b, c = along[:2] @ along[:2], foot @ along[:2], (foot**2).sum(axis=1) - size**2
        root = np.sqrt(np.maximum(b * b - a * c, 0.0))
        ends = (np.array(z)[:, None] - at[:, 2]) / along[2]
        return np.maximum((-b - root) / a, np.maximum(ends.min(axis=0), low)), np.minimum(
            (-b + root) / a, np.minimum(ends.max(axis=0), high)
        )

    def integrals(span):
        start, stop = span[0], np.maximum(span[0], span[1])
        total = np.zeros(2)
        for share in np.polynomial.legendre.leggauss(3)[0]:
            place = start + (stop - start) * (1 + share) / 2
            flat = at[:, :2] + place[:, None] * along[:2]
            weight = (stop - start) * (8 / 18 if share == 0 else 5 / 18)
            total += [weight.mean(), (weight * (flat**2).sum(axis=1)).mean()]
        return total

    throw, (z1, z2), z3 = scene.throw, scene.web_z_mm, scene.pitch_mm / 2
    main, pin, r = throw.main_journal, throw.crankpin, throw.radius_mm
    total = integrals(within(0, main.radius_mm, (0, z1))) + integrals(within(r, pin.radius_mm, (z2, z3)))
    total = total + integrals(within(0, 1e4, (z1, z2)))
    total -= integrals(within(0, main.bore_radius_mm, (0, z2)))
    total -= integrals(within(r, pin.bore_radius_mm, (z1, z3)))
    area = math.pi * bore.radius_mm**2
    return float(total[0] * area), float(total[1] * area)


@pytest.mark.parametrize("bore", [0.0, 24.0])
def test_cylinder_is_exact(bore: float) -> None:
    scene = mikron({**LEANING, "outlet_radius_mm": 0.0}, bore_diameter_mm=bore)
    found, (volume, polar) = drilled(scene), along_rays(scene, 200)
    assert found.volume == pytest.approx(volume, rel=1e-5)
    assert found.polar == pytest.approx(polar, rel=1e-5)


def test_rounding_is_a_rolled_ball() -> None:
    """It touches the journal and the drilling."""
    scene = mikron(RADIAL)
    (bore,) = drill_bores(scene)
    outlet = bore.outlets[0]
    turn = np.linspace(0, 2 * np.pi, 37)
    ball = ring_points(bore.radius_mm, outlet, turn, np.zeros(37), np.ones(37))
    touch = ring_points(bore.radius_mm, outlet, turn, np.ones(37), np.ones(37))
    assert np.hypot(touch[:, 0], touch[:, 1] - 48.0) == pytest.approx(21.0, abs=STEP)
    assert bore.off_axis_mm(*ball.T) == pytest.approx(2.5, abs=STEP)


def test_solid_has_the_closed_form() -> None:
    scene = mikron(RADIAL, bore_diameter_mm=24.0)
    balance, density = throw_balance(scene), density_kg_per_mm3(scene.material.density_kg_m3)
    with cad_session("drilled") as gmsh:
        found = solid_properties(gmsh.model.occ, add_half_throw(gmsh.model.occ, scene))
    mass = 2 * density * found.volume_mm3
    assert balance.mass_kg == pytest.approx(mass, rel=1e-6)
    assert balance.throw_unbalance_kg_mm == pytest.approx(mass * found.centre_mm[1], rel=1e-6)
    assert balance.lateral_unbalance_kg_mm == pytest.approx(mass * found.centre_mm[0], abs=1e-4)
    assert balance.inertia_kg_mm2 == pytest.approx(2 * density * found.inertia_z_mm5, rel=1e-6)


@pytest.mark.slow
def test_leaning_solid() -> None:
    """The kernel errs in integration and in its rounding, a spline; `tests/cad_check` tells how much."""
    scene = mikron(LEANING)
    with cad_session("drilled") as gmsh:
        found = solid_properties(gmsh.model.occ, add_half_throw(gmsh.model.occ, scene))
    mass = 2 * density_kg_per_mm3(scene.material.density_kg_m3) * found.volume_mm3
    assert throw_balance(scene).mass_kg == pytest.approx(mass, rel=3e-6)


def test_cells_and_surface_have_it() -> None:
    scene = mikron(LEANING)
    bare = mikron()
    parts = [drilled(scene, part).volume for part in ("main_journal", "crankpin")]
    lost = [b.volume() - d.volume() for b, d in zip(journal_halves(bare), journal_halves(scene), strict=True)]
    assert lost == pytest.approx(parts, rel=2e-3)
    assert web_bores(scene).volume() > web_bores(bare).volume()
    sharp = mikron({**LEANING, "outlet_radius_mm": 0.0})
    for cell in (4.0, 2.0):
        domain = build_domain(sharp, cell, "web")
        whole = build_domain(bare, cell, "web", domain.extent, domain.grid)
        gone = float(((whole.passive_fraction - domain.passive_fraction) * domain.volume_mm3).sum())
        assert gone == pytest.approx(drilled(sharp).volume, rel=2e-4)


@pytest.mark.parametrize("drilling", [LEANING, STRAIGHT, RADIAL], ids=["leaning", "straight", "radial"])
def test_a_rounding_joins_its_bore_without_a_furrow(drilling) -> None:
    """A furrow would have folded triangles at every chord around the bore; single slivers do no harm."""
    scene, bare = mikron(drilling), mikron()
    for name, solid, whole in zip(
        ("main_journal", "crankpin"), journal_halves(scene), journal_halves(bare), strict=True
    ):
        turn_deg = np.degrees(mesh_of(solid).as_trimesh().face_adjacency_angles)
        assert (turn_deg > 150.0).sum() < 0.05 * segments(2.5)
        assert whole.volume() - solid.volume() == pytest.approx(drilled(scene, name).volume, rel=3e-4)


def test_design_space_keeps_hole_and_wall() -> None:
    scene, bare = mikron(LEANING), mikron()
    domain = build_domain(scene, 4.0)
    whole = build_domain(bare, 4.0, extent=domain.extent, grid=domain.grid)
    between = slice(*domain.web_layers)
    hole = ((whole.web - domain.web) * domain.volume_mm3)[:, :, between].sum()
    wall = (domain.passive_fraction * domain.volume_mm3)[:, :, between].sum()
    assert hole == pytest.approx(
        drilled(mikron({**LEANING, "outlet_radius_mm": 0.0}), "web").volume, rel=2e-4
    )
    assert wall == pytest.approx(3 * hole, rel=0.25)  # twice the radius: four times the section
    assert (
        (domain.passive_fraction + domain.design_fraction)
        <= whole.passive_fraction + whole.design_fraction + 1e-5
    ).all()


def test_mirror() -> None:
    assert drilling_asymmetry(mikron(LEANING)) == "throw.drilling[0]"
    assert web_asymmetry(mikron(LEANING)) == envelope_asymmetry(mikron(LEANING)) == "throw.drilling[0]"
    assert not drilling_asymmetry(mikron(STRAIGHT))
    across = drilling(("crankpin", 90.0, 0.0), ("crankpin", 270.0, 0.0))
    assert not drilling_asymmetry(mikron(across))
    pair = [drilling(("crankpin", a, 0.0), ("crankpin_bore", a, 0.0)) for a in (50.0, -50.0)]
    assert not drilling_asymmetry(mikron(*pair))
    assert drilling_asymmetry(mikron(pair[0])) == "throw.drilling[0]"
    straight = mikron(STRAIGHT)
    assert mirror_image(straight) == straight, "the drawing had it at -180 and -0 deg in the second web"
    turned = drilled(mirror_image(mikron(LEANING)))
    assert turned.first_x == pytest.approx(-drilled(mikron(LEANING)).first_x, rel=1e-6)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (
            {"diameter_mm": 20.0},
            "throw.drilling[0].diameter_mm = 20.0: is more than 0.4 of the diameter of throw.main_journal",
        ),
        (
            {"outlet_radius_mm": 6.0},
            "outlet_radius_mm = 6.0: is more than diameter_mm = 5 mm; must be at most 4.08",
        ),
        (
            {"from": {"on": "pin", "angle_deg": 0.0, "place_mm": 0.0}},
            "throw.drilling[0].from.on = 'pin': must",
        ),
        ({"from": {"on": "crankpin", "angle_deg": 0.0}}, "throw.drilling[0].from.place_mm is missing"),
        (
            {"from": {"on": "main_journal", "angle_deg": 400.0, "place_mm": 0.0}},
            "throw.drilling[0].from.angle_deg = 400.0: must be >= -360 and <= 360",
        ),
        (
            {"from": {"on": "main_journal", "angle_deg": 180.0, "place_mm": 21.0}},
            "from.place_mm = 21.0: lies beyond half the length of throw.main_journal, 20 mm; must be at most",
        ),
        (
            {"from": {"on": "main_journal", "angle_deg": 180.0, "place_mm": 16.0}},
            "from.place_mm = 16.0: the outlet runs into the fillet beside it; must be at most",
        ),
        (
            {"from": {"on": "main_journal", "angle_deg": 0.0, "place_mm": 6.0}},
            "throw.drilling[0].from: the drilling lies outside the main journal there",
        ),
        (
            {"from": {"on": "crankpin", "angle_deg": 60.0, "place_mm": 6.0}},
            "from: the drilling leans 60 deg from the normal of the crankpin, at most 50 deg",
        ),
        ({"to": {"on": "main_journal", "angle_deg": 180.0, "place_mm": 6.0}}, "begins where it ends"),
        ({"radius_mm": 3.0}, "unknown key throw.drilling[0].radius_mm"),
        (
            {"from": {"on": "crankpin_bore", "angle_deg": 0.0, "place_mm": 6.0}, "diameter_mm": "5"},
            "throw.drilling[0].diameter_mm = '5': must be a finite number",
        ),
    ],
)
def test_refused(change: dict[str, object], message: str) -> None:
    with pytest.raises(CranktopoError) as caught:
        mikron({**STRAIGHT, **change})
    assert message in str(caught.value)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize("journal", ["main_journal", "crankpin"])
@pytest.mark.parametrize("rounding_mm", [0.0, 1.0])
@pytest.mark.parametrize(
    ("over_diameter", "passes"),
    [(-0.0052, True), (-0.0048, False), (0.0, False), (8e-4, False), (12e-4, True)],
)
def test_a_rim_is_clear_of_the_middle(
    journal: str, rounding_mm: float, over_diameter: float, passes: bool
) -> None:
    """The rim of a radial drilling is its radius and that of the rounding beside its axis."""
    place = 2.5 + rounding_mm + 5.0 * over_diameter
    ends = (journal, 110.0, place), (f"{journal}_bore", 110.0, place)
    with nullcontext() if passes else pytest.raises(CranktopoError, match="where its half throw ends"):
        mikron(drilling(*ends, rounding=rounding_mm), bore_diameter_mm=20.0)


@pytest.mark.parametrize(("web", "passes"), [("both", False), ("first", True)])
def test_a_drilling_of_one_half_alone_may_end_anywhere_at_the_middle_of_the_pin(
    web: str, passes: bool
) -> None:
    ends = ("crankpin", 110.0, 3.5), ("crankpin_bore", 110.0, 3.5)
    data = mikron().model_dump(mode="json", exclude_none=True)
    data["throw"]["drilling"] = [drilling(*ends, rounding=1.0) | {"web": web}]
    data["throw"]["crankpin"]["bore_diameter_mm"] = 20.0
    with nullcontext() if passes else pytest.raises(CranktopoError, match="where its half throw ends"):
        scene_from_dict(data, whole=True)


def test_places_on_either_side_of_the_middle_are_told() -> None:
    """The outlet of the random engine 11 reached 3e-5 mm beyond: its file was inside out there."""
    data = featured_engine(11)
    start, length_mm = data["throw"]["drilling"][0]["from"], data["throw"]["main_journal"]["length_mm"]
    start["place_mm"] = 0.1 * length_mm
    with pytest.raises(CranktopoError) as caught:
        scene_from_dict(data, whole=True)
    told = re.search(
        r"^throw.drilling\[0\].from.place_mm = 0.7161: the rim of the outlet ends 3e-05 mm beyond the middle "
        r"of throw.main_journal, where its half throw ends; must be at most (\S+) mm or at least (\S+) mm.$",
        caught.value.message,
    )
    assert told, caught.value.message
    most, least = (float(limit) for limit in told.groups())
    assert 0.004 < 0.7161 - most < 0.006
    assert 0.001 < least - 0.7161 < 0.002
    for start["place_mm"] in (most, least):
        scene_from_dict(data, whole=True)


@pytest.mark.parametrize(("angle_deg", "nearest"), [(60.0, 81), (-60.0, -80), (300.0, 280)])
def test_the_nearest_angle_at_which_a_drilling_leans_less_is_told(angle_deg: float, nearest: int) -> None:
    """A chord over an angle c of the pin leans (180 - c) / 2 deg at both ends: c is at least 80 deg."""

    def begun(at_deg: float) -> Scene:
        start = {"on": "crankpin", "angle_deg": at_deg, "place_mm": 6.0}
        return mikron({**STRAIGHT, "from": start, "to": {**start, "angle_deg": 0.5}}, bore_diameter_mm=0.0)

    told = f"The nearest that fits is throw.drilling[0].from.angle_deg = {nearest}."
    with pytest.raises(CranktopoError) as caught:
        begun(angle_deg)
    assert told in caught.value.hint
    begun(float(nearest))


def changed(table: dict[str, Any], key: str, value: float) -> dict[str, Any]:
    end, _, name = key.rpartition(".")
    return table | ({end: table[end] | {name: value}} if end else {name: value})


@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize(
    ("key", "low", "high"),
    [
        ("from.place_mm", 15.0, 30.0),
        ("to.place_mm", 15.0, 30.0),
        ("diameter_mm", 17.0, 25.0),
        ("outlet_radius_mm", 7.0, 12.0),
    ],
)
def test_the_limit_that_a_refusal_tells_is_accepted(key: str, low: float, high: float, seed: int) -> None:
    """Of drillings drawn at random in sound places, then one value of them too large."""
    draw = np.random.default_rng((8, seed))
    ends = (
        ("main_journal", 180.0 + draw.uniform(-15, 15), draw.uniform(0, 8)),
        ("crankpin", draw.uniform(-15, 15), draw.uniform(0, 8)),
    )
    sound, value = drilling(*ends, draw.uniform(3, 6), draw.uniform(0, 1)), draw.uniform(low, high)
    with pytest.raises(CranktopoError) as caught:
        mikron(changed(sound, key, value), bore_diameter_mm=0.0)
    told = re.search(rf"\]\.{key} = .*must be at most (\S+) mm\.", caught.value.message)
    assert told
    limit = float(told[1])
    mikron(changed(sound, key, limit), bore_diameter_mm=0.0)
    with pytest.raises(CranktopoError):
        mikron(changed(sound, key, limit + 0.02), bore_diameter_mm=0.0)


def test_refused_together() -> None:
    with pytest.raises(CranktopoError, match=r"throw.crankpin has no bore"):
        mikron(RADIAL, bore_diameter_mm=0.0)
    with pytest.raises(CranktopoError, match=r"drilling\[0\]: meets throw.drilling\[1\]"):
        mikron(STRAIGHT, LEANING)
    with pytest.raises(CranktopoError, match=r"grazes the bore of throw.crankpin"):
        mikron(drilling(("crankpin", 30.0, 0.0), ("crankpin", 150.0, 0.0)))


def test_pocket_and_envelope_keep_clear() -> None:
    data = mikron(STRAIGHT).model_dump(mode="json", exclude_none=True)
    data["web"]["pocket"] = [{"shape": "cylinder", "x_mm": 4.0, "y_mm": 24.0, "diameter_mm": 8.0}]
    with pytest.raises(CranktopoError, match=r"throw.drilling\[0\]: runs into web.pocket\[0\]"):
        scene_from_dict(data)
    data["web"]["pocket"] = []
    data["envelope"] = {"shape": "box", "half_width_mm": 4.0, "y_min_mm": -34.0, "y_max_mm": 82.0}
    with pytest.raises(CranktopoError, match=r"does not hold throw.drilling\[0\]"):
        build_domain(scene_from_dict(data), 4.0)


def test_outline_with_a_waist_holds_a_leaning_one() -> None:
    """It is narrow where the drilling crosses x = 0, and wide where that is at its ends."""
    leaning = drilling(("main_journal", 130.0, 1.0), ("crankpin", 310.0, 2.0))
    data = mikron(leaning, bore_diameter_mm=0.0).model_dump(mode="json", exclude_none=True)
    right = [(26.0, -26.0), (26.0, 10.0), (8.0, 24.0), (26.0, 38.0), (26.0, 74.0)]
    for waist_mm, held in ((8.0, True), (5.0, False)):
        right[2] = waist_mm, 24.0
        points = [*right, *((-x, y) for x, y in right[::-1])]
        data["envelope"] = {"shape": "outline", "points_mm": points}
        with nullcontext() if held else pytest.raises(CranktopoError, match=r"does not hold throw.drilling"):
            build_domain(scene_from_dict(data), 4.0)


def rules_of(scene: Scene, wall_mm: float = 3.0) -> dict[str, float]:
    """Rules of the drillings beside a straight outline, a journal bevel and a box."""
    points = np.stack([np.full(401, 25.0), np.linspace(-25.0, 73.0, 401)], axis=1)
    arc = BevelArc(60.0, 73.0, 10.0, 0.0, 1.0)
    box = np.array([[8.0, 20.0, 0.0], [12.0, 30.0, 19.0]])
    around = Surroundings(scene, ManufacturingLimits(min_wall_mm=wall_mm), points, (arc,))
    return {name: float(value) for name, value in drilling_rules(around, [("pocket", box)])}


def test_pockets_bevels_and_outline_keep_a_wall() -> None:
    found = rules_of(mikron(STRAIGHT))
    outline, bevel, pocket = (
        found[f"least wall between throw.drilling[0] and the {name}, 3 mm"]
        for name in ("outline", "journal bevel", "pocket")
    )
    needed = 2.5 + 3.0 + CLEAR_MM
    assert outline == pytest.approx(needed - 25.0)
    assert pocket == pytest.approx(needed - 8.0)
    assert bevel < needed
    assert max(rules_of(mikron(STRAIGHT), 6.0).values()) >= pocket + 3.0 - 1e-9
    assert rules_of(mikron(drilling(("crankpin", 0.0, 0.0), ("crankpin", 180.0, 0.0)))) == {}
    assert rules_of(mikron()) == {}


@pytest.mark.parametrize("place", [0.0, 6.0])
def test_a_drilled_body_lies_where_the_throw_is(place: float) -> None:
    ends = ("main_journal", 180.0, place), ("crankpin", 0.0, place)
    scene = mikron(drilling(*ends, rounding=1.0))
    (main, pin), (start, end) = journal_halves(scene), scene.web_z_mm
    web = Manifold.cube((50.0, 98.0, end - start)).translate((-25.0, -25.0, start))
    body = main + pin + (web - web_bores(scene))
    assert not misfits(body, scene)
    assert misfits(body.translate((3.0, 0.0, 0.0)), scene)


def test_a_drilling_is_no_bore_of_a_solid_journal() -> None:
    """Where a section crosses it whole, known or not; the import of a crank asks for the rings alone."""
    scene = load_scene("industrial-gas")
    (main, pin), (start, end) = journal_halves(scene), scene.web_z_mm
    web = Manifold.cube((165.0, 285.0, end - start)).translate((-82.5, -95.0, start))
    body = main + pin + (web - web_bores(scene))
    plain = scene.model_copy(update={"throw": scene.throw.model_copy(update={"drilling": ()})})
    assert not ring_misfits(body, plain)
    assert not ring_misfits(body, scene)
    bored = body - Manifold.cylinder(200.0, 15.0, center=True)
    assert any("bore" in line for line in ring_misfits(bored, plain))
