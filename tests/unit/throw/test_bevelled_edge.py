"""The bevelled edge of a counterweight: closed form, solid, cells, shape, drawing, symmetry, refusals."""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.integrate import quad

from cranktopo.app.main import main
from cranktopo.base.errors import CranktopoError, ExitCode
from cranktopo.base.units import density_kg_per_mm3
from cranktopo.bodies.cells.domain import build_domain
from cranktopo.bodies.prisms import feature_holes, kept_solid
from cranktopo.bodies.raw_part import raw_mass_kg
from cranktopo.bodies.solid.files import export_solid
from cranktopo.bodies.volume import bolted_mass, web_moments, web_volume_mm3
from cranktopo.design.halves import envelope_asymmetry, mirror_image, web_asymmetry
from cranktopo.design.loading import load_scene, scene_from_dict
from cranktopo.design.schema import Scene
from cranktopo.design.writing import toml_text
from cranktopo.engine.balance.throw import product_of_inertia_kg_mm2, throw_balance
from cranktopo.numerics.surfaces.files import read_stl
from cranktopo.numerics.surfaces.mesh import solid_of
from cranktopo.tasks.crank_import.stage import import_crank
from cranktopo.tasks.drawing.views import Sheet
from cranktopo.tasks.refit.family import Layout
from cranktopo.tasks.refit.fit import scene_with_web, usual_limits
from cranktopo.tasks.refit.parametric_web import ParametricWeb
from cranktopo.tasks.web_shape.mesh_model import MeshModel
from cranktopo.tasks.web_shape.start import scene_start
from cranktopo.tasks.web_shape.web_faces import web_faces
from cranktopo.throw.primitives import Polyline
from tests.step_volume import step_volume_mm3
from tests.unit.throw.counterweight_cases import DISC, OUTLINES, PLAIN, THIN, roomy_scene, weighted

EDGE = {"flanks": "leading", "face": "both", "width_mm": 6.0, "depth_mm": 5.0, "length_mm": 20.0}
PIN = {**EDGE, "face": "pin"}
EDGED = {**PLAIN, "edge": EDGE}
BOTH = {**PLAIN, "edge": {**EDGE, "flanks": "both"}}


@pytest.fixture(scope="module")
def roomy(mikron: Scene) -> Scene:
    return roomy_scene(mikron)


def wedge(edge: dict[str, Any], radius: float, half_angle_deg: float) -> tuple[float, float, float, float]:
    """Volume, lateral and other first moment, polar moment of one cut, in polar coordinates about the crank.

    Independent of slices along the flank: rings about the crank axis, each from the flank on inward.
    """
    start, half = radius - edge["length_mm"], math.radians(half_angle_deg)

    def over(value: Any) -> float:
        def ring(rho: float) -> float:
            last = min(math.asin(edge["width_mm"] / rho), math.acos(min(1.0, start / rho)))

            def at(angle: float) -> float:
                tall = edge["depth_mm"] * (1 - rho * math.sin(angle) / edge["width_mm"])
                return float(value(rho, half - angle) * tall * rho)

            return float(quad(at, 0, last, epsabs=0, epsrel=1e-12)[0])

        kink = math.hypot(start, edge["width_mm"])
        return float(
            sum(quad(ring, *ends, epsabs=0, epsrel=1e-11)[0] for ends in ((start, kink), (kink, radius)))
        )

    return (
        over(lambda rho, angle: 1.0),
        over(lambda rho, angle: rho * math.sin(angle)),
        over(lambda rho, angle: -rho * math.cos(angle)),
        over(lambda rho, angle: rho**2),
    )


@pytest.mark.parametrize(("flanks", "cuts", "side"), [("leading", 2, -1), ("trailing", 2, 1), ("both", 4, 0)])
def test_mass_unbalance_and_inertia_by_the_closed_form(
    roomy: Scene, flanks: str, cuts: int, side: int
) -> None:
    """Both webs lose the cuts; the crank turns from +y toward +x, so the leading flank is that at x < 0."""
    edged = weighted(roomy, {**PLAIN, "edge": {**EDGE, "flanks": flanks}})
    plain, found = throw_balance(weighted(roomy, PLAIN)), throw_balance(edged)
    volume, x, y, polar = wedge(EDGE, 62.0, 60.0)
    lost = 2 * cuts * density_kg_per_mm3(roomy.material.density_kg_m3)
    assert plain.mass_kg - found.mass_kg == pytest.approx(lost * volume, rel=1e-9)
    moved = found.throw_unbalance_kg_mm - plain.throw_unbalance_kg_mm
    assert moved == pytest.approx(-lost * y, rel=1e-9)
    assert found.lateral_unbalance_kg_mm == pytest.approx(-side * lost * x, rel=1e-9, abs=1e-12)
    assert plain.inertia_kg_mm2 - found.inertia_kg_mm2 == pytest.approx(lost * polar, rel=1e-9)
    assert plain.own_counterweight_kg_mm - found.own_counterweight_kg_mm == pytest.approx(-lost * y, rel=1e-9)


def test_its_face_counts_in_the_couple(roomy: Scene) -> None:
    """One web alone is cut, from its pin face: the centre of a wedge's height is not in mid-cut."""
    edged = weighted(roomy, {**PLAIN, "edge": {**PIN, "flanks": "both"}})
    uneven = edged.model_copy(update={"second_web": weighted(roomy, PLAIN).web})
    density = density_kg_per_mm3(roomy.material.density_kg_m3)
    across = np.linspace(0, 6.0, 20001)
    middle = (across[1:] + across[:-1]) / 2
    tall, rim = 5.0 * (1 - middle / 6.0), np.sqrt(62.0**2 - middle**2)
    sine, cosine = math.sin(math.radians(60)), math.cos(math.radians(60))
    y = -cosine * (rim**2 - 42.0**2) / 2 - sine * middle * (rim - 42.0)
    arm = roomy.pitch_mm / 2 - (roomy.web_z_mm[1] - tall / 2)
    couple = density * 2 * float((y * tall * arm).sum()) * 6.0 / 20000
    assert product_of_inertia_kg_mm2(uneven).real == pytest.approx(couple, rel=1e-7)


SOLIDS = {
    "both": BOTH,
    "round corner": {**BOTH, "corner_mm": 4.0},
    "rounder than wide": {**EDGED, "corner_mm": 8.0, "edge": {**EDGE, "width_mm": 3.0}},
    "thin": {**THIN, "edge": {**PIN, "depth_mm": 9.0, "length_mm": 18.0}},
    "half a disc": {**DISC, "edge": {**EDGE, "face": "journal", "depth_mm": 15.0, "length_mm": 30.0}},
}


@pytest.mark.parametrize("name", SOLIDS)
def test_the_exact_solid_has_the_bevels(roomy: Scene, name: str, tmp_path: Path) -> None:
    """By the kernel, its file, and the sections of the cuts on a fine grid of the counterweight."""
    scene = weighted(roomy, SOLIDS[name])
    volume = export_solid(scene, "web", tmp_path / "web.step")
    assert volume == pytest.approx(web_volume_mm3(scene), rel=1e-9)
    assert step_volume_mm3(tmp_path / "web.step") == pytest.approx(volume, rel=1e-6)
    plain = weighted(roomy, {key: value for key, value in SOLIDS[name].items() if key != "edge"})
    taken = web_volume_mm3(plain) - volume
    assert scene.web.counterweight is not None
    sector, cuts = scene.web.counterweight.sector(scene), scene.web.counterweight.bevels(scene)
    y = np.linspace(-sector.radius_mm, 0.0, 4001)
    y = (y[1:] + y[:-1]) / 2
    z = np.linspace(*sector.z_mm, 401)
    z = ((z[1:] + z[:-1]) / 2)[:, None]
    half, cut_away = sector.half_width_mm(y), 0.0
    for left, right in (span for cut in cuts for span in cut.spans(y, z)):
        cut_away += float(np.maximum(np.minimum(right, half) - np.maximum(left, -half), 0.0).sum())
    step = sector.radius_mm / 4000 * (sector.z_mm[1] - sector.z_mm[0]) / 400
    assert cut_away * step == pytest.approx(taken, rel=2e-4)


@pytest.mark.slow
def test_no_optimiser_fills_or_covers_them(roomy: Scene) -> None:
    """The kept counterweight lacks them, the design space in front of flank and rim too; prisms agree."""
    plain, found = (build_domain(weighted(roomy, w), 6.0, extent="half") for w in (PLAIN, BOTH))
    taken = web_moments(weighted(roomy, PLAIN)).volume - web_moments(weighted(roomy, BOTH)).volume
    kept, designed = (
        (getattr(plain, kind) - getattr(found, kind)) * plain.volume_mm3
        for kind in ("passive_fraction", "design_fraction")
    )
    assert float(kept.sum()) == pytest.approx(taken, rel=1e-4)
    assert float(designed.min()) > -1e-4
    assert float(designed.sum()) > 4 * 6.0 * 5.0 * 20.0  # in front of four flanks, and beyond the rim
    scene = weighted(roomy, BOTH)
    tools = feature_holes(scene)
    assert (kept_solid(scene) ^ tools).volume() == pytest.approx(taken, rel=1e-3)
    solid = found.passive_fraction + found.design_fraction
    assert float((solid * found.volume_mm3).sum()) == pytest.approx(
        float(((plain.passive_fraction + plain.design_fraction) * plain.volume_mm3).sum())
        - float((kept + designed).sum())
    )


def test_symmetry_and_mirror_image(roomy: Scene) -> None:
    lonely, pair = weighted(roomy, EDGED), weighted(roomy, BOTH)
    for asymmetry in (web_asymmetry, envelope_asymmetry):
        assert asymmetry(lonely) == "web.counterweight"
        assert asymmetry(pair) == ""
    image = mirror_image(lonely)
    assert image.web.counterweight is not None
    assert image.web.counterweight.edge is not None
    assert image.web.counterweight.edge.flanks == "trailing"
    turned, own = throw_balance(image), throw_balance(lonely)
    assert turned.lateral_unbalance_kg_mm == pytest.approx(-own.lateral_unbalance_kg_mm)
    assert own.lateral_unbalance_kg_mm > 0  # less on the side that leads


@pytest.mark.slow
def test_it_is_machined_out_of_the_full(roomy: Scene) -> None:
    """The raw part is the same with and without."""
    data = roomy.model_dump(mode="json", exclude_none=True)
    forged = scene_from_dict({**data, "forging": {"allowance_mm": 2.0, "draft_deg": 5.0}}, "forged")
    plain, edged = (raw_mass_kg(weighted(forged, w)) for w in (PLAIN, EDGED))
    assert edged == pytest.approx(plain, rel=1e-12)


def test_a_bolted_counterweight_has_one_too(roomy: Scene) -> None:
    part = {"density_kg_m3": 7200.0}
    plain, found = (bolted_mass(weighted(roomy, {**w, **part})) for w in (PLAIN, BOTH))
    assert plain.volume - found.volume == pytest.approx(4 * 7.2e-6 * wedge(EDGE, 62.0, 60.0)[0], rel=1e-9)
    assert web_volume_mm3(weighted(roomy, {**BOTH, **part})) == pytest.approx(
        web_volume_mm3(weighted(roomy, {**PLAIN, **part})), rel=1e-12
    )


def test_the_drawing_shows_them(roomy: Scene) -> None:
    from manifold3d import Manifold

    drawn = Sheet(weighted(roomy, BOTH), Manifold()).features[-1]
    assert "BEVELLED EDGE, both flanks, both faces" in drawn.lines
    assert "   depth 5.00" in drawn.lines
    assert len(drawn.front) == 2  # one stroke for each flank
    for stroke in drawn.front:
        assert isinstance(stroke, Polyline)
        (x, y), *_ = stroke.points
        assert math.hypot(x, y) == pytest.approx(42.0)
        assert math.hypot(*stroke.points[-1]) == pytest.approx(62.0)


def test_shape_knows_its_faces(roomy: Scene) -> None:
    """A plane and a wall of each of two cuts; points of the removed wedge lie on them."""
    layout = Layout(3)
    faces = web_faces(weighted(roomy, EDGED), layout, mirrored=False)
    assert len(faces) - len(web_faces(weighted(roomy, PLAIN), layout, mirrored=False)) == 4
    along, out = np.array([-math.sin(math.pi / 3), -0.5]), np.array([-0.5, math.sin(math.pi / 3)])
    low, high = roomy.web_z_mm
    corners = [
        [*(s * along - u * out), face + into * d]
        for face, into in ((low, 1), (high, -1))
        for s, u, d in ((50.0, 6.0, 0.0), (50.0, 0.0, 5.0), (50.0, 3.0, 2.5), (42.0, 1.0, 1.0))
    ]
    near = [
        face.contact(np.array(corners).T, np.array([-25.0, 73.0, 25.0])).distance_mm for face in faces[:-1]
    ]
    met = (np.abs(near) < 1e-9).sum(axis=0)
    assert met.tolist() == 2 * [2, 2, 1, 2]  # face and bevel, flank and bevel, bevel, both walls in one plane


def test_an_outline_may_not_grow_into_it(roomy: Scene) -> None:
    """The rule is broken by as much as the outline passes the wall of the bevel, with the room beside it."""
    scene, layout = weighted(roomy, EDGED), Layout(3)
    axes = (np.zeros(1), np.zeros(1), np.zeros(1))
    web = ParametricWeb(layout, scene, usual_limits(scene), axes)
    name = "the outline stays clear of the bevelled edge"

    def over(half_width: float) -> float:
        values = np.array([-45.0, 73.0, half_width])
        return float(web.constraints(values)[web.rule_names(values).index(name)])

    assert over(25.0) < 0 < over(52.0) < 6.0


REFUSED: dict[str, tuple[dict[str, Any], str]] = {
    "through": ({"edge": {**PIN, "depth_mm": 19.0}}, r"edge\.depth_mm.*at most 18\.9 mm"),
    "through from both": ({"edge": {**EDGE, "depth_mm": 9.6}}, r"depth_mm.*at most 9\.45 mm.*both faces"),
    "to the outline": (
        {"edge": {**EDGE, "length_mm": 38.0}},
        r"length_mm.*at most .*the web's outline reaches",
    ),
    "to the journal": (
        {"half_angle_deg": 20.0, "edge": {**EDGE, "width_mm": 2.0, "length_mm": 38.2}},
        r"length_mm.*at most .*(outline|main_journal)",
    ),
    "to the fillet": ({"fillet_mm": 12.0, "edge": {**EDGE, "length_mm": 34.0}}, "its fillet reaches"),
    "in the round corner": (
        {"corner_mm": 8.0, "edge": {**EDGE, "length_mm": 6.0}},
        "length_mm.*larger than .*the flank ends",
    ),
    "over the rim": ({"edge": {**EDGE, "width_mm": 46.0}}, "width_mm.*at most .* at this length"),
    "over the middle": (
        {"half_angle_deg": 10.0, "edge": {**EDGE, "width_mm": 7.4}},
        "width_mm.*at most .* at this length",
    ),
    "into a plug": (
        {
            "edge": EDGE,
            "plug": [
                {
                    "axis": "axial",
                    "x_mm": -38.0,
                    "y_mm": -32.0,
                    "diameter_mm": 10.0,
                    "length_mm": 12.0,
                    "density_kg_m3": 17500.0,
                }
            ],
        },
        "plug.*meets web.counterweight.edge",
    ),
    "into a balancing hole": (
        {
            "edge": {**EDGE, "width_mm": 12.0, "depth_mm": 9.0},
            "hole": [{"angle_deg": -52.0, "diameter_mm": 12.0, "depth_mm": 14.0}],
        },
        "hole.*meets web.counterweight.edge",
    ),
}


@pytest.mark.parametrize("name", REFUSED)
def test_refused(name: str, roomy: Scene) -> None:
    keys, message = REFUSED[name]
    with pytest.raises(CranktopoError, match=message):
        weighted(roomy, {**PLAIN, **keys})


def test_a_pocket_may_not_meet_it(roomy: Scene) -> None:
    pocket = {
        "shape": "cylinder",
        "face": "pin",
        "x_mm": -41.0,
        "y_mm": -29.0,
        "diameter_mm": 8.0,
        "depth_mm": 4.0,
    }
    weighted(roomy, PLAIN, pocket=[pocket])
    with pytest.raises(CranktopoError, match=r"web.counterweight.edge: meets web.pocket\[0\]"):
        weighted(roomy, EDGED, pocket=[pocket])


@pytest.mark.parametrize("name", OUTLINES)
def test_every_outline_has_room_for_one(name: str, roomy: Scene) -> None:
    """As long as the refusal says, and no longer."""
    web = {
        "thickness_mm": 19.0,
        **OUTLINES[name],
        "counterweight": {**DISC, "edge": {**EDGE, "length_mm": 60.0}},
    }
    with pytest.raises(CranktopoError, match="at most") as caught:
        scene_with_web(roomy, web)
    longest = float(str(caught.value).split("at most ")[1].split(" mm")[0])
    web["counterweight"]["edge"]["length_mm"] = longest
    scene = scene_with_web(roomy, web)
    assert web_volume_mm3(scene) > 0
    web["counterweight"]["edge"]["length_mm"] = longest + 0.002
    with pytest.raises(CranktopoError, match="at most"):
        scene_with_web(roomy, web)


@pytest.mark.slow
def test_a_mesh_with_bevels_follows_outline_and_counterweight(roomy: Scene) -> None:
    """The gradients on the moved mesh are those of differences; the plane keeps its place on the flank."""
    free = {"free": {"counterweight_radius_mm": [58.0, 66.0], "counterweight_angle_deg": [50.0, 70.0]}}
    scene = weighted(roomy, EDGED)
    scene = scene_from_dict({**scene.model_dump(mode="json", exclude_none=True), "shape": free}, "free")
    start = scene_start(scene, usual_limits(scene))
    model = MeshModel(scene, start.layout, start.values, 12.0)
    found = model.responses(start.values, ["torsion"]).gradients
    for number in (3, len(start.values) - 2, len(start.values) - 1):
        step = 0.1 * np.eye(len(start.values))[number]
        above, below = (model.responses(start.values + side * step, ["torsion"]).values for side in (1, -1))
        for name in ("mass", "torsion"):
            assert found[name][number] == pytest.approx((above[name] - below[name]) / 0.2, rel=0.03)


@pytest.mark.slow
def test_from_design_to_surface_and_back_from_cad(
    roomy: Scene, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """An optimised web leaves the bevels empty; CAD of the half throw is read back as the same design."""
    scene = weighted(roomy, {**EDGED, "fillet_mm": 4.0})
    design = tmp_path / "edged.toml"
    design.write_text(toml_text(scene, "edged"), encoding="utf-8")
    run = tmp_path / "run"
    options = ["--resolution-mm", "4.5", "--max-iterations", "3", "--out", str(run), "--json"]
    assert main(["optimise", str(design), *options]) == ExitCode.NOT_CONVERGED
    assert json.loads(capsys.readouterr().out)["grid"]["extent"] == "half"
    web = solid_of(read_stl(run / "web.stl"), "web")
    tools = feature_holes(scene)
    assert (web ^ tools).volume() < 1e-6 * tools.volume()
    export_solid(scene, "half", tmp_path / "body.step")
    half = import_crank(tmp_path / "body.step", "edged", tmp_path / "out").halves[0]
    assert load_scene(half.design).web.counterweight == scene.web.counterweight
    assert half.design_volume_mm3 == pytest.approx(half.volume_mm3, rel=1e-6)
