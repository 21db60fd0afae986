"""Bevels with draft: volumes by formula and CAD kernel, draft by rays and facets, distances, rules."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from cranktopo.base.errors import CranktopoError
from cranktopo.bodies.cells.domain import build_domain
from cranktopo.bodies.shown_solid import display_half
from cranktopo.bodies.solid.boundaries import faces_of
from cranktopo.bodies.solid.checked import volume_mm3
from cranktopo.bodies.solid.files import export_solid, surface_of
from cranktopo.bodies.solid.throw import add_web
from cranktopo.bodies.volume import half_throw_volume_mm3, web_volume_mm3
from cranktopo.design.schema import Scene
from cranktopo.numerics.gmsh_session import cad_session
from cranktopo.numerics.surfaces.mesh import SurfaceMesh, solid_of
from cranktopo.tasks.extraction.release import shaped_undercuts
from cranktopo.tasks.refit.family import Layout, exact_web_of
from cranktopo.tasks.refit.fit import scene_with_web, usual_limits
from cranktopo.tasks.refit.parametric_web import ParametricWeb
from cranktopo.tasks.refit.process import process_limits
from cranktopo.tasks.web_shape.feature_starts import end_starts
from cranktopo.tasks.web_shape.start import outline_start, scene_start
from cranktopo.throw.bevel import EndBevel, FittedBevel
from cranktopo.throw.bevel_arc import BevelArc
from cranktopo.throw.bevel_tool import DraftedBevelTool
from cranktopo.throw.fitted import Named
from cranktopo.throw.fitted_slot import FittedSlot
from cranktopo.throw.primitives import Polyline
from tests.unit.refit.remodel_cases import table
from tests.unit.throw.test_web_features import ARC, GROOVE, PLANE, RECTANGLE, removed_mm3, sharp

Array = NDArray[np.float64]
DRAFT_DEG = 5.0
DIE = {"process": "forged", "parting": "lateral", "draft_deg": DRAFT_DEG}
HOLLOW = {**ARC, "crown_mm": -2.5, "draft_deg": DRAFT_DEG}
BEVEL = {**PLANE, "y_mm": 52.0, "draft_deg": DRAFT_DEG}


@pytest.fixture
def throw(mikron: Scene) -> Scene:
    """The throw with small journals, so that a bevel may start near them."""
    return mikron.model_copy(update={"throw": sharp(mikron)})


def prism_mm3(depth_mm: float, rise_mm: float, half_mm: float, draft_deg: float) -> float:
    """Volume between x = -half and half under a plane that falls away from x = 0, to both sides, by a draft.

    At x the section is a triangle, similar to that of x = 0, deeper by |x| tan(draft) / cos(slope).
    """
    deeper = math.tan(math.radians(draft_deg)) * math.hypot(depth_mm, rise_mm) / rise_mm
    cubes = (depth_mm + deeper * half_mm) ** 3 - depth_mm**3
    return cubes / (3 * deeper) * rise_mm / depth_mm


@pytest.mark.parametrize("draft_deg", [0.5, 5.0, 12.0])
def test_a_plane_with_draft_takes_what_the_formula_says(
    throw: Scene, draft_deg: float, tmp_path: Path
) -> None:
    """Sections and CAD kernel to 1e-9."""
    bevel = {**PLANE, "draft_deg": draft_deg}
    taken = prism_mm3(8.0, 12.0, 30.0, draft_deg)
    assert removed_mm3(throw, bevel=[bevel]) == pytest.approx(taken, rel=1e-9)
    plain, cut = (scene_with_web(throw, {**RECTANGLE, "bevel": own}) for own in ([], [bevel]))
    solids = [export_solid(scene, "web", tmp_path / f"{k}.step") for k, scene in enumerate((plain, cut))]
    assert solids[0] - solids[1] == pytest.approx(taken, rel=1e-9)


@pytest.mark.parametrize(
    "features",
    [
        pytest.param({"bevel": [BEVEL]}, id="plane over a bore"),
        pytest.param({"bevel": [{**ARC, "draft_deg": DRAFT_DEG}]}, id="arc"),
        pytest.param(
            {"bevel": [HOLLOW, BEVEL], "pocket": [GROOVE]}, id="hollow, groove", marks=pytest.mark.slow
        ),
    ],
)
def test_sections_cells_and_kernel_agree(throw: Scene, features: dict[str, Any], tmp_path: Path) -> None:
    """Its edge runs over bores, a groove and the outline; sections and CAD kernel agree to 1e-8."""
    scene = scene_with_web(throw, table(**features))
    volume = export_solid(scene, "web", tmp_path / "web.step")
    assert web_volume_mm3(scene) == pytest.approx(volume, rel=1e-8)
    domain = build_domain(scene, 5.0, "web", extent="quarter")
    assert 2 * float((domain.web * domain.volume_mm3).sum()) == pytest.approx(volume, rel=3e-6)


def test_the_picture_of_a_drag_has_the_draft(throw: Scene) -> None:
    plain, cut = (scene_with_web(throw, {**RECTANGLE, "bevel": own}) for own in ([], [BEVEL]))
    taken = display_half(plain).volume() - display_half(cut).volume()
    exact = half_throw_volume_mm3(plain) - half_throw_volume_mm3(cut)
    assert taken == pytest.approx(exact, rel=1e-2)


def test_no_draft_is_the_bevel_as_it_was(throw: Scene) -> None:
    plain, zero = (scene_with_web(throw, table(bevel=[{**ARC, **own}])) for own in ({}, {"draft_deg": 0.0}))
    assert plain == zero
    (body,) = zero.web.bevel[0].bodies(zero, "web.bevel[0]")
    assert not isinstance(body, DraftedBevelTool)
    assert len(body.solids()) == 1


@pytest.mark.parametrize(("crown_mm", "cylinders"), [(-2.6e-3, 4), (0.02, 4), (1.2, 2)])
def test_an_arc_that_is_hardly_bent_is_a_cylinder(throw: Scene, crown_mm: float, cylinders: int) -> None:
    """Swept obliquely it is one of an ellipse, no different from a circle then (random throw 733)."""
    scene = scene_with_web(throw, {**RECTANGLE, "bevel": [{**PLANE, "draft_deg": 5.3, "crown_mm": crown_mm}]})
    with cad_session("web") as gmsh:
        body = add_web(gmsh.model.occ, scene)
        built_mm3 = volume_mm3(gmsh.model.occ, body)
        gmsh.model.occ.synchronize()
        kinds = [gmsh.model.getType(2, face) for face in faces_of(gmsh.model.occ, body)]
    assert kinds.count("Cylinder") == cylinders, "two of them are bores"
    assert built_mm3 == pytest.approx(web_volume_mm3(scene), rel=1e-9)


def slanted(scene: Scene, mesh: SurfaceMesh) -> tuple[Array, Array]:
    """Middles and outward normals, (n, 3) each, of the facets of the bevel of a half throw at x > 0."""
    corners = mesh.vertices_mm[mesh.faces]
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    area = np.linalg.norm(normal, axis=1)
    middle, normal = corners.mean(axis=1), normal / np.maximum(area, 1e-12)[:, None]
    x, y, z = middle.T
    arc, (start, end) = scene.web.bevel[0].arc(scene), scene.web_z_mm
    depth = z - start if arc.outward > 0 else end - z
    on = (np.abs(depth - arc.depth_at_mm(arc.outward * y, x)) < 0.02) & (depth > 0.05) & (area > 1e-3)
    leans = (np.abs(normal[:, 2]) > 0.05) & (np.abs(normal[:, 1]) > 0.05)
    return middle[on & leans & (x > 0.1)], normal[on & leans & (x > 0.1)]


def test_a_plane_has_the_draft_everywhere(throw: Scene) -> None:
    """By the facets of the solid."""
    scene = scene_with_web(throw, table(bevel=[BEVEL]))
    _, normal = slanted(scene, surface_of(scene, "half", 2.0))
    assert len(normal) > 100
    assert np.degrees(np.arcsin(normal[:, 0])) == pytest.approx(DRAFT_DEG, abs=1e-6)


@pytest.mark.parametrize("crown_mm", [1.2, -2.0])
def test_an_arc_has_the_draft_at_its_ends_and_more_between(throw: Scene, crown_mm: float) -> None:
    """By the slopes of the lateral intervals that its body takes out."""
    scene = scene_with_web(throw, table(bevel=[{**BEVEL, "crown_mm": crown_mm}]))
    (body,) = scene.web.bevel[0].bodies(scene, "web.bevel[0]")
    y, depth, step = np.linspace(45, 74.9, 300)[:, None], np.linspace(0.05, 12, 200), 1e-6

    def edge(along: float = 0.0, below: float = 0.0) -> Array:
        return body.spans(y + along, scene.web_z_mm[0] + depth + below)[1][0]

    by_y, by_z = ((edge(*h) - edge(*(-h))) / (2 * step) for h in step * np.eye(2))
    there = (edge() > 0.1) & (edge() < 40)
    angle = np.degrees(np.arctan(1 / np.hypot(by_y[there], by_z[there])))
    assert angle.min() == pytest.approx(DRAFT_DEG, abs=1e-4)
    assert 5.05 < angle.max() < 6.0


@pytest.mark.parametrize(
    ("draft_deg", "leaves"),
    [pytest.param(0.0, (True, False), marks=pytest.mark.slow), (DRAFT_DEG, (True, True))],
)
def test_rays_find_a_die_that_leaves_with_draft(
    throw: Scene, draft_deg: float, leaves: tuple[bool, bool]
) -> None:
    """Rays from the bevel along x, and turned toward the web by nearly its draft, meet nothing.

    A straight bevel lets a die out along x alone: turned by less than a degree, rays run into it.
    """
    scene = scene_with_web(throw, table(bevel=[{**BEVEL, "draft_deg": draft_deg}])).with_optimise(**DIE)
    mesh = surface_of(scene, "half", 2.0)
    at, normal = slanted(scene, mesh)
    solid, found = solid_of(mesh), []
    assert len(at) > 5
    for turn_deg in (0.0, DRAFT_DEG - 0.3):
        turned = math.tan(math.radians(turn_deg))
        into = normal * [0.0, -1.0, -1.0]
        into /= np.linalg.norm(into, axis=1)[:, None]
        starts = at + 1e-3 * normal
        way = np.array([1.0, 0.0, 0.0]) + turned * into
        hits = [solid.ray_cast(tuple(a), tuple(a + 60 * d)) for a, d in zip(starts, way, strict=True)]
        found.append(sum(bool(hit) for hit in hits) == 0)
    assert tuple(found) == leaves
    looked_at = shaped_undercuts(mesh, scene)
    assert looked_at.released
    assert looked_at.without_draft == (() if draft_deg else ("web.bevel[0]",))


@pytest.mark.parametrize(
    ("draft_deg", "named"), [(4.9, True), pytest.param(4.996, False, marks=pytest.mark.slow)]
)
def test_a_bevel_with_less_draft_than_asked_is_named(throw: Scene, draft_deg: float, named: bool) -> None:
    scene = scene_with_web(throw, table(bevel=[{**BEVEL, "draft_deg": draft_deg}])).with_optimise(**DIE)
    found = shaped_undercuts(surface_of(scene, "half", 2.0), scene)
    assert found.without_draft == (("web.bevel[0]",) if named else ())


REFUSED: dict[str, tuple[dict[str, Any], str]] = {
    "more than 30 deg": ({**PLANE, "draft_deg": 31.0}, r"draft_deg.*30"),
    "through the web": ({**PLANE, "depth_mm": 17.5, "draft_deg": 12.0}, r"draft_deg.*through the web"),
    "onto the fillet": (
        {**PLANE, "y_mm": 30.0, "draft_deg": 25.0},
        r"y_mm.*starts .* from the axis of throw",
    ),
}


@pytest.mark.parametrize("name", REFUSED)
def test_refused(name: str, mikron: Scene) -> None:
    bevel, message = REFUSED[name]
    with pytest.raises(CranktopoError, match=message):
        scene_with_web(mikron, {**RECTANGLE, "bevel": [bevel]})


def test_a_counterweight_is_out_of_its_way(mikron: Scene) -> None:
    weight = {"outer_radius_mm": 70.0, "half_angle_deg": 85.0, "thickness_mm": 19.0}
    data = {"thickness_mm": 19.0, "outline": "obround", "width_mm": 60.0, "counterweight": weight}
    plain = {"face": "journal", "y_mm": 52.0, "depth_mm": 6.0}
    small = mikron.model_copy(update={"throw": sharp(mikron), "envelope": None})
    scene_with_web(small, {**data, "bevel": [{**plain, "draft_deg": 3.0}]})
    with pytest.raises(CranktopoError, match=r"draft_deg.*over web\.counterweight"):
        scene_with_web(small, {**data, "bevel": [{**plain, "depth_mm": 2.0, "draft_deg": 6.0}]})


@pytest.mark.parametrize("crown_mm", [0.0, 1.5, pytest.param(-1.5, marks=pytest.mark.slow)])
@pytest.mark.parametrize("face", ["journal", "pin"])
def test_signed_distance_is_that_of_the_solid(throw: Scene, face: Any, crown_mm: float) -> None:
    """Its sign by the sections of the body; its size by a move along its own slope, whose length is 1."""
    y = 52.0 if face == "journal" else -6.0
    scene = scene_with_web(throw, table(bevel=[{**BEVEL, "face": face, "y_mm": y, "crown_mm": crown_mm}]))
    bevel = scene.web.bevel[0]
    (body,) = bevel.bodies(scene, "web.bevel[0]")
    read = FittedBevel.read(bevel, False, (0.0, 0.0, 0.0))
    assert read is not None
    part, values = read
    assert part == FittedBevel(face, hollow=True, draft_deg=DRAFT_DEG)
    named, ends = part.named(values), np.array(scene.web.y_range_mm(43.0))
    (low, high), random = scene.web_z_mm, np.random.default_rng(3)
    at = random.uniform([0, ends[0], low], [35, ends[1], high], (4000, 3)).T

    def off(points: Array) -> Array:
        return part.faces_mm(named, ends, (points[0], points[1], points[2]), (low, high))[0]

    removed = np.array([body.contains(x[None], y[None], z).item() for x, y, z in at.T])
    assert 200 < removed.sum() < 3800
    assert np.array_equal(removed, off(at) < 0)
    for _ in range(3):
        slope = np.stack([(off(at + h) - off(at - h)) / 2e-5 for h in 1e-5 * np.eye(3)[:, :, None]])
        at = at - off(at) * slope
    slope = np.stack([(off(at + h) - off(at - h)) / 2e-5 for h in 1e-5 * np.eye(3)[:, :, None]])
    near = (at[0] > 0.1) & (at[2] > low) & (at[2] < high) & (np.abs(off(at)) < 1e-9)
    assert near.sum() > 500
    assert np.linalg.norm(slope, axis=0)[near] == pytest.approx(1.0, abs=1e-6)


def family(scene: Scene) -> tuple[ParametricWeb, Array]:
    """Both bevels with draft, a groove and a pocket-free outline of the family, for the rules of a die."""
    limits = process_limits(scene, usual_limits(scene))
    parts = [part.manufactured(limits) for part in (FittedBevel("journal", True), FittedBevel("pin", True))]
    layout = Layout(7, (*(part for part in parts if part is not None), FittedSlot(through=True)))
    values = [50.0, 9.0, 0.6, -1.0, 8.0, -0.8, 5.0, 24.0, 0.3, 10.0]
    outline = outline_start(scene, limits)
    axes = np.linspace(1, 33, 9), np.linspace(-24, 72, 25), np.linspace(*scene.web_z_mm, 8)
    return ParametricWeb(layout, scene, limits, axes), np.array([*outline, *values])


def test_rules_and_their_slopes(mikron: Scene) -> None:
    web, values = family(mikron.with_optimise(**DIE))
    assert all(part.draft_deg == DRAFT_DEG for part in web.layout.parts[:2] if isinstance(part, FittedBevel))
    names, slopes, step = web.rule_names(values), web.gradients(values), 1e-4
    assert set(names) >= {
        "most depth of the journal bevel at the outline, 16 mm",
        "least wall between the bevels, 3 mm",
    }
    for k in range(len(values)):
        moved = [web.constraints(values + side * step * np.eye(len(values))[k]) for side in (1, -1)]
        measured = (moved[0] - moved[1]) / (2 * step)
        assert slopes[:, k] == pytest.approx(measured, rel=2e-3, abs=2e-3), web.layout.names[k]


def test_the_shoulder_knows_the_edge(mikron: Scene) -> None:
    """An arc with draft has a straight edge at both sides of x = 0: the rule by its distance from the axis.

    It is that of the worst rounding of all dimensions, by which the edge of a flat beginning moves far.
    """
    web, values = family(mikron.with_optimise(**DIE))
    off, found = 0.0051, dict(zip(web.rule_names(values), web.constraints(values), strict=True))
    start, rise, run, crown = 50.0 - off, values[1] - 50.0 + 2 * off, 9.0 - off, 0.6 + off
    flat = math.atan2(run, rise) - 2 * math.atan(2 * crown / math.hypot(rise, run))
    aside = math.tan(math.radians(DRAFT_DEG)) / math.sin(flat)
    nearest = np.hypot(x := np.linspace(0, 60, 600001), start - aside * x).min()
    needed = mikron.throw.main_journal.clear_radius_mm + 0.12
    rule = found["shoulder beside the fillet of the main journal"]
    assert rule == pytest.approx(needed - nearest, abs=1e-6)


@pytest.mark.parametrize("signs", np.array(np.meshgrid(*[[-1, 1]] * 3)).reshape(3, -1).T.tolist())
def test_what_the_shoulder_allows_is_accepted_rounded(mikron: Scene, signs: list[int]) -> None:
    """A bevel that begins flat, as near to the journal as the rule lets it."""
    web, values = family(mikron.with_optimise(**DIE))
    first = web.layout.names.index("bevel-journal.y")
    values[first : first + 3] = 46.0, 14.0, 2.5

    def rule(y: float) -> float:
        moved = np.concatenate([values[:first], [y], values[first + 1 :]])
        rules = dict(zip(web.rule_names(moved), web.constraints(moved), strict=True))
        return float(rules["shoulder beside the fillet of the main journal"])

    low, high = 30.0, 60.0
    for _ in range(40):
        middle = (low + high) / 2
        low, high = (middle, high) if rule(middle) > 0 else (low, middle)
    nearest = np.array([high, 14.0, 2.5]) + 0.005 * np.array(signs)
    bevel = {"face": "journal", "draft_deg": DRAFT_DEG, "y_mm": nearest[0], "depth_mm": nearest[1]}
    plain = exact_web_of(web.layout, values, mikron) | {
        "pocket": [],
        "bevel": [{**bevel, "crown_mm": nearest[2]}],
    }
    assert scene_with_web(mikron, plain).web.bevel[0].y_mm == nearest[0]


def test_slopes_of_a_field(mikron: Scene) -> None:
    """Derivatives of the signed distance by all parameters, against differences of another step."""
    arc = BevelArc(50.0, 74.0, 9.0, 1.5, 1.0, DRAFT_DEG)
    assert arc.distance_mm(arc.depth_at_mm(np.array([60.0]), 12.0), 60.0, 12.0) == pytest.approx(0, abs=1e-12)
    web, values = family(mikron.with_optimise(**DIE))
    part, own, ends = web.layout.parts[0], values[7:10], values[:2]
    axes, weight = (np.linspace(1, 33, 9), np.linspace(40, 72, 9), np.linspace(*mikron.web_z_mm, 8)), 1.0
    weights = weight * np.random.default_rng(5).standard_normal((9, 9, 8))
    by_own, by_ends = part.vjp(own, ends, axes, mikron.web_z_mm, weights)
    both, found = np.concatenate([own, ends]), np.concatenate([by_own, by_ends])
    for k, step in enumerate(1e-3 * np.eye(5)):
        fields = [
            part.field_mm((both + side * step)[:3], (both + side * step)[3:], axes, mikron.web_z_mm)
            for side in (1, -1)
        ]
        assert found[k] == pytest.approx(float(((fields[0] - fields[1]) * weights).sum()) / 2e-3, rel=1e-5)


def test_a_die_gives_bevels_its_draft(mikron: Scene) -> None:
    """The larger of the design's and the least of the workshop (3 deg); written, read back, kept."""
    for asked, draft in ((DRAFT_DEG, DRAFT_DEG), (1.0, 3.0)):
        scene = mikron.with_optimise(**{**DIE, "draft_deg": asked})
        limits = process_limits(scene, usual_limits(scene))
        bevels = [part for part, _ in end_starts(scene, limits) if isinstance(part, FittedBevel)]
        assert [part.draft_deg for part in bevels] == [draft, draft]
        for part, values in end_starts(scene, limits):
            if isinstance(part, FittedBevel):
                web = ParametricWeb(Layout(7, (part,)), scene, limits, (np.zeros(0),) * 3)
                both = np.concatenate([outline_start(scene, limits), values])
                rules = dict(zip(web.rule_names(both), web.constraints(both), strict=True))
                assert max(value for name, value in rules.items() if name.startswith("shoulder")) < 0.2
    for process in ({"process": "milled"}, {"process": "free"}, {**DIE, "parting": "web_faces"}):
        other = mikron.with_optimise(**process)
        part = FittedBevel("pin").manufactured(process_limits(other, usual_limits(other)))
        assert part == FittedBevel("pin")


@pytest.mark.parametrize(("own", "kept"), [(0.0, DRAFT_DEG), (DRAFT_DEG, DRAFT_DEG), (8.0, 8.0)])
def test_a_start_keeps_its_draft_or_gets_that_of_the_die(throw: Scene, own: float, kept: float) -> None:
    scene = scene_with_web(throw, table(bevel=[{**BEVEL, "draft_deg": own}])).with_optimise(**DIE)
    found = scene_start(scene, process_limits(scene, usual_limits(scene)))
    assert found.layout.parts == (FittedBevel("journal", True, kept),)
    (written,) = found.layout.parts[0].tables(Named(y=52.0, depth=8.0), (0.0, 0.0, 0.0))
    assert EndBevel(**written).draft_deg == kept


def test_the_drawing_says_the_draft(throw: Scene) -> None:
    scene = scene_with_web(throw, table(bevel=[BEVEL]))
    drawn = scene.web.bevel[0].drawing(scene)
    assert any(line.strip() == "draft 5.00° to both sides of x = 0" for line in drawn.lines)
    (edge,) = drawn.front
    assert isinstance(edge, Polyline)
    left, middle, right = edge.points
    assert middle == (0.0, 52.0)
    assert left == (-right[0], right[1])
    width = float(scene.web.half_width_mm(scene.throw.radius_mm, np.array([right[1]]))[0])
    assert right[0] == pytest.approx(width, abs=0.2)
    slope = math.tan(math.radians(DRAFT_DEG)) / math.sin(math.atan2(8.0, 23.0))
    assert right[1] == pytest.approx(52.0 - slope * right[0], abs=1e-9)
