"""The raw part: closed forms of its pieces, draft and allowance on the CAD kernel's faces, rules, words."""

from __future__ import annotations

import math
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from manifold3d import Manifold

from cranktopo.app.main import main
from cranktopo.base.errors import CranktopoError, solver_error
from cranktopo.bodies.raw_part import machined_of_half, machined_out, raw_half_volume_mm3, raw_mass_kg
from cranktopo.bodies.solid.files import export_solid, surface_of
from cranktopo.bodies.solid.raw_part import add_raw_half
from cranktopo.design.loading import load_scene, scene_from_dict
from cranktopo.design.schema import Scene
from cranktopo.numerics.gmsh_session import cad_session
from cranktopo.numerics.surfaces.mesh import solid_of
from cranktopo.tasks.drawing.raw_sheet import raw_pages
from cranktopo.throw.moments import body_moments
from cranktopo.throw.raw_part.bodies import Collar, RawHalf
from cranktopo.throw.raw_part.drafted_outline import drafted_outline
from cranktopo.throw.raw_part.half import raw_half
from cranktopo.throw.raw_part.table import Forging
from cranktopo.throw.web import web_bodies, web_spans
from tests.step_volume import step_volume_mm3
from tests.unit.throw.counterweight_cases import DISC, OUTLINES, PLAIN, roomy_scene, weighted

USUAL = {"allowance_mm": 2.0, "draft_deg": 5.0, "flash_mm": 2.0}
FLUSH = {"allowance_mm": 1.0, "draft_deg": 3.0, "flash_mm": 0.0}


def forged(scene: Scene, forging: dict[str, float] = USUAL, **tables: Any) -> Scene:
    data = scene.model_dump(mode="json", exclude_none=True)
    return scene_from_dict({**data, **tables, "forging": forging}, "forged", whole=True)


@pytest.fixture(scope="module")
def plain() -> Scene:
    return load_scene("mikron-iiic-plain")


def volume_mm3(half: RawHalf, **parts: Any) -> float:
    """Volume of some of the bodies of a raw half alone."""
    alone = {"web": (), "cuts": (), "journals": (), **parts}
    bodies = (*alone["web"], *alone["journals"])
    z_mm = min(body.z_mm[0] for body in bodies), max(body.z_mm[1] for body in bodies)
    return body_moments([RawHalf("part", z_mm, **alone)]).volume


@pytest.mark.parametrize("forging", [USUAL, FLUSH], ids=["land", "flush"])
def test_a_box_becomes_a_hipped_roof(plain: Scene, forging: dict[str, float]) -> None:
    """At a distance u from its widest place a rectangle, longer and thicker by 2 u tan d; in both halves."""
    web = {"outline": "rectangle", "width_mm": 60.0, "overhang_mm": 30.0, "thickness_mm": 19.0}
    scene = forged(plain, forging, web=web)
    long, thick = 48.0 + 2 * 30.0, 19.0 + 2 * forging["allowance_mm"]
    tangent, land = math.tan(math.radians(forging["draft_deg"])), forging["flash_mm"] / 2
    deep = 30.0 - land
    roof = long * thick * deep + (long + thick) * tangent * deep**2 + 4 / 3 * tangent**2 * deep**3
    middle = (long + 2 * tangent * deep) * (thick + 2 * tangent * deep) * land
    assert scene.forging is not None
    half = raw_half(scene, scene.forging)
    assert volume_mm3(half, web=half.web) == pytest.approx(2 * (roof + middle), rel=1e-9)


@pytest.mark.parametrize("forging", [USUAL, FLUSH], ids=["land", "flush"])
def test_a_circle_has_two_tangents_at_each_end(forging: dict[str, float]) -> None:
    """Area of a disc, of two kites less their sectors, less the tips that are narrower than the land."""
    draft, land, radius = math.radians(forging["draft_deg"]), forging["flash_mm"] / 2, 23.0
    table = Forging(**forging)
    outline = drafted_outline(
        lambda y: np.sqrt(np.maximum(radius**2 - y**2, 0.0)), (-radius, radius), table.draft_slope, land
    )
    assert outline.y_range_mm[1] == pytest.approx(radius / math.cos(draft) - land * math.tan(draft), rel=1e-9)
    y = np.unique(np.concatenate([np.linspace(*outline.y_range_mm, 200_001), outline.corners_mm]))
    half = outline.half_width_mm(y)
    area = float(((half[1:] + half[:-1]) * np.diff(y)).sum())
    exact = math.pi * radius**2 + 2 * radius**2 * (math.tan(draft) - draft) - 2 * land**2 * math.tan(draft)
    assert area == pytest.approx(exact, rel=1e-6)
    assert (np.abs(np.diff(half) / np.diff(y)) <= 1 / math.tan(draft) * (1 + 1e-6)).all()


def test_a_jump_and_a_notch_are_bridged() -> None:
    """Between walls steeper than the draft lie two lines that meet, or the land."""
    tangent = math.tan(math.radians(10.0))

    def notched(y: Any) -> Any:
        return np.where(np.abs(y) < 1.0, 2.0, 20.0)

    outline = drafted_outline(notched, (-10.0, 10.0), tangent, 0.5)
    (low, *_), valley, (*_, high) = outline.fillers
    assert (low[0], high[0]) == pytest.approx((-10 - 19.5 * tangent, 10 + 19.5 * tangent), abs=1e-6)
    deepest = 20.0 - 1.0 / tangent
    assert float(outline.half_width_mm(np.array(0.0))) == pytest.approx(deepest, abs=0.05)
    assert len(valley) == 3


def sampled(gmsh: Any, tag: int) -> tuple[np.ndarray, np.ndarray]:
    """Points of the faces of a solid and the normals there, by the kernel."""
    points, normals = [], []
    for _, face in gmsh.model.getBoundary([(3, tag)], oriented=False):
        low, high = gmsh.model.getParametrizationBounds(2, face)
        share = np.linspace(0.1, 0.9, 4)
        grid = np.array(
            [
                [a + s * (b - a) for a, b, s in zip(low, high, (u, v), strict=True)]
                for u in share
                for v in share
            ]
        )
        at = gmsh.model.getValue(2, face, grid.ravel()).reshape(-1, 3)
        inside = np.array([gmsh.model.isInside(2, face, point) for point in at.tolist()], bool)
        points.append(at[inside])
        normals.append(gmsh.model.getNormal(face, grid.ravel()).reshape(-1, 3)[inside])
    return np.concatenate(points), np.concatenate(normals)


CROWNED = {"bevel": [{"face": "journal", "y_mm": 54.0, "depth_mm": 12.0, "crown_mm": 1.5}]}
POCKET = {
    "shape": "side",
    "y_mm": 24.0,
    "length_mm": 24.0,
    "height_mm": 6.0,
    "depth_mm": 6.0,
    "draft_deg": 12.0,
}
CASES: dict[str, tuple[dict[str, Any], dict[str, float]]] = {
    "obround": ({**OUTLINES["obround"], **CROWNED}, USUAL),
    "rectangle": ({**OUTLINES["rectangle"], **CROWNED}, FLUSH),
    "ellipse": (OUTLINES["ellipse"], USUAL),
    "widening": ({**OUTLINES["widening"], "pocket": [POCKET]}, USUAL),
    "profile": (OUTLINES["profile"], {**USUAL, "allowance_mm": 0.0}),
}


DEAR = ("obround", "ellipse", "widening", "profile")


@pytest.mark.parametrize(
    "case", [pytest.param(case, marks=[pytest.mark.slow] if case in DEAR else []) for case in CASES]
)
def test_draft_and_allowance_of_the_kernels_faces(plain: Scene, case: str) -> None:
    """No face has less draft; journals, fillets and faces have the allowance; quadrature has its volume."""
    web, forging = CASES[case]
    scene = forged(plain, forging, web={"thickness_mm": 19.0, **web})
    least, land = math.sin(math.radians(forging["draft_deg"])), forging["flash_mm"] / 2
    with cad_session(case) as gmsh:
        body = add_raw_half(gmsh.model.occ, scene)
        gmsh.model.occ.synchronize()
        assert gmsh.model.occ.getMass(*body[0]) == pytest.approx(raw_half_volume_mm3(scene), rel=1e-6)
        points, normals = sampled(gmsh, body[0][1])
        z, end = points[:, 2], scene.pitch_mm / 2
        walls = (np.abs(points[:, 0]) > land + 1e-6) & (z > 1e-6) & (z < end - 1e-6)
        assert walls.sum() > 60
        assert np.abs(normals[walls, 0]).min() >= least - 1e-6
        inside = allowance_points(scene, forging["allowance_mm"] * (1 - 1e-6) - 1e-6)
        assert gmsh.model.isInside(3, body[0][1], inside.ravel().tolist()) == len(inside)
        beyond = np.array([[scene.throw.main_journal.radius_mm + forging["allowance_mm"] + 1e-4, 0.0, 5.0]])
        assert gmsh.model.isInside(3, body[0][1], beyond.ravel().tolist()) == 0


def some_web(random: np.random.Generator) -> dict[str, Any]:
    """An outline, alone or with a bevel or a counterweight."""
    name = str(random.choice(list(OUTLINES)))
    web = {**OUTLINES[name], "thickness_mm": float(random.choice([19, 24, 30]))}
    kind, draft = random.integers(3), float(random.choice([0, 4, 10]))
    if kind == 1:
        crown = float(random.choice([-1, 0, 1]))
        bevel = {"face": "journal", "y_mm": 54.0, "depth_mm": 7.0, "crown_mm": crown, "draft_deg": draft}
        return {**web, "bevel": [bevel]}
    if kind == 2:
        sizes = {
            "outer_radius_mm": random.choice([60, 70]),
            "half_angle_deg": random.choice([40, 65, 89, 90]),
        }
        thin = {"thickness_mm": 10.0, "face": str(random.choice(["pin", "journal"]))}
        weight = {key: float(value) for key, value in sizes.items()} | thin | {"corner_mm": 6.0}
        return {**web, "counterweight": weight}
    return web


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(20))
def test_random_raw_parts(plain: Scene, seed: int) -> None:
    """The kernel's volume is that of the quadrature, and no face has less than the draft."""
    random = np.random.default_rng(seed)
    forging = {
        "allowance_mm": float(random.choice([0, 0.3, 1, 2, 3.3])),
        "draft_deg": float(random.choice([0.5, 1, 3, 5, 7, 12])),
        "flash_mm": float(random.choice([0, 0.5, 2, 4])),
    }
    scene = forged(roomy_scene(plain), forging, web=some_web(random))
    with cad_session(str(seed)) as gmsh:
        body = add_raw_half(gmsh.model.occ, scene)
        gmsh.model.occ.synchronize()
        assert gmsh.model.occ.getMass(*body[0]) == pytest.approx(raw_half_volume_mm3(scene), rel=1e-6)
        points, normals = sampled(gmsh, body[0][1])
    x, z = np.abs(points[:, 0]), points[:, 2]
    walls = (x > forging["flash_mm"] / 2 + 1e-6) & (z > 1e-6) & (z < scene.pitch_mm / 2 - 1e-6)
    assert np.abs(normals[walls, 0]).min() >= math.sin(math.radians(forging["draft_deg"])) - 1e-6


def allowance_points(scene: Scene, beyond_mm: float) -> np.ndarray:
    """Points off the journals' cylinders, their fillets and the faces around them, along the normals."""
    found, turn = [], np.linspace(0, 2 * np.pi, 24, endpoint=False)
    for (journal, y), face, out in zip(scene.throw.journals, scene.web_z_mm, (-1, 1), strict=True):
        r, f = journal.radius_mm, journal.fillet_mm
        arc = [
            (r + f - (f - beyond_mm) * math.cos(a), (f - (f - beyond_mm) * math.sin(a)))
            for a in np.linspace(0, np.pi / 2, 7)
        ]
        for radius, height in [(r + beyond_mm, journal.length_mm / 4), *arc, (r + f + 0.3, beyond_mm)]:
            z = np.full(turn.shape, face + out * height)
            found.append(np.stack([radius * np.cos(turn), y + radius * np.sin(turn), z], axis=1))
    return np.concatenate(found)


BEVELLED = {
    "plain": {},
    "crowned": {"crown_mm": 1.5},
    "hollow": {"crown_mm": -1.5, "draft_deg": 2.0},
    "steeper": {"draft_deg": 8.0},
}


@pytest.mark.parametrize(
    ("outline", "bevel"),
    [*((one, "crowned") for one in OUTLINES), *(("obround", one) for one in BEVELLED if one != "crowned")],
)
def test_the_finished_web_lies_in_the_raw_one(plain: Scene, outline: str, bevel: str) -> None:
    """Random places and heights of the finished web: the raw half is as wide there or wider."""
    ends = (
        {"face": "journal", "y_mm": 54.0, "depth_mm": 12.0},
        {"face": "pin", "y_mm": -4.0, "depth_mm": 9.0},
    )
    bevels = [{**end, **BEVELLED[bevel]} for end in ends]
    scene = forged(plain, FLUSH, web={**OUTLINES[outline], "thickness_mm": 19.0, "bevel": bevels})
    assert scene.forging is not None
    random = np.random.default_rng(7)
    y, z = (random.uniform(*ends, 20_000) for ends in (scene.web.y_range_mm(48.0), scene.web_z_mm))
    left, right = web_spans(web_bodies(scene), y, z)
    finished = np.where(right > left, right, 0.0).max(axis=0)
    raw = raw_half(scene, scene.forging).half_mm(y, z)
    assert (raw - finished).min() >= -1e-9
    assert np.median((raw - finished)[finished > 0]) < 1.0


WIDE = {"outer_radius_mm": 75.0, "half_angle_deg": 60.0}
HALF_DISC = {**WIDE, "half_angle_deg": 90.0}
POCKETED: dict[str, dict[str, Any]] = {
    "drafted": {"pocket": [POCKET], "counterweight": WIDE},
    "rounded floor": {
        "pocket": [{**POCKET, "draft_deg": 5.0, "corner_radius_mm": 3.0, "offset_mm": 0.8}],
        "counterweight": WIDE,
        "bevel": [{"face": "journal", "y_mm": 54.0, "depth_mm": 8.0, "crown_mm": 1.0, "draft_deg": 5.0}],
    },
    "runs out": {"pocket": [{**POCKET, "y_mm": 50.0, "length_mm": 70.0}], "counterweight": WIDE},
    "groove": {"pocket": [{**POCKET, "y_mm": 24.0, "length_mm": 130.0}]},
    "round edges": {
        "pocket": [{**POCKET, "corner_radius_mm": 2.5, "floor_radius_mm": 2.0}],
        "counterweight": WIDE,
    },
    "groove with round edges": {
        "pocket": [{**POCKET, "y_mm": 24.0, "length_mm": 130.0, "floor_radius_mm": 2.0}]
    },
    "beside a half disc": {
        "pocket": [{**POCKET, "y_mm": 20.0, "length_mm": 33.0}],
        "counterweight": HALF_DISC,
    },
    "bevel": {
        "width_mm": 50.0,
        "bevel": [{"face": "journal", "y_mm": 54.0, "depth_mm": 8.0}],
        "counterweight": WIDE,
    },
}


def pocketed(plain: Scene, case: str) -> Scene:
    web = {"outline": "rectangle", "width_mm": 62.0, "overhang_mm": 30.0, "thickness_mm": 19.0}
    return forged(roomy_scene(plain), FLUSH, web={**web, **POCKETED[case]})


@pytest.mark.parametrize("case", POCKETED)
def test_side_pockets_leave_the_counterweight(plain: Scene, case: str) -> None:
    """Widths by the kernel's own order of union and cuts on intervals; the finished web lies in them."""
    scene = pocketed(plain, case)
    assert scene.forging is not None
    half, random = raw_half(scene, scene.forging), np.random.default_rng(3)
    y, z = random.uniform(*half.y_range_mm, 4000), random.uniform(*scene.web_z_mm, 4000)
    found, finished = np.zeros(y.shape), web_spans(web_bodies(scene), y, z)
    for part, cuts in zip(half.web, half.cuts_of, strict=True):
        left, right = web_spans([part, *cuts], y, z)
        widest = np.where(right > left, right, 0.0).max(axis=0)
        assert (right - left).sum(axis=0) == pytest.approx(2 * widest, abs=1e-9)  # the die leaves no hollow
        found = np.maximum(found, widest)
    for journal in half.journals:
        found = np.maximum(found, journal.half_mm(y, z))
    assert half.half_mm(y, z) == pytest.approx(found, abs=1e-9)
    assert (len(half.cuts_of[-1]) < len(half.cuts)) == (case == "beside a half disc")
    assert (found - np.where(finished[1] > finished[0], finished[1], 0.0).max(axis=0)).min() >= -1e-9
    assert machined_out(scene) == (
        "throw.main_journal.bore_diameter_mm",
        "throw.crankpin.bore_diameter_mm",
    )


@pytest.mark.slow
@pytest.mark.parametrize("case", POCKETED)
def test_the_kernel_builds_side_pockets(plain: Scene, case: str) -> None:
    scene = pocketed(plain, case)
    with cad_session(case) as gmsh:
        body = add_raw_half(gmsh.model.occ, scene)
        assert gmsh.model.occ.getMass(*body[0]) == pytest.approx(raw_half_volume_mm3(scene), rel=1e-6)


@pytest.mark.slow
@pytest.mark.parametrize(
    "weight", [{**PLAIN, "fillet_mm": 6.0}, {**DISC, "corner_mm": 8.0}], ids=["fillet", "half disc"]
)
def test_a_counterweight_has_the_draft_too(plain: Scene, weight: dict[str, Any]) -> None:
    """Its flanks at right angles to the throw slope as well; every facet of the whole part leaves the die."""
    scene = forged(weighted(roomy_scene(plain), weight))
    mesh = surface_of(scene, "raw", 3.0)
    body = mesh.as_trimesh()
    assert body.is_watertight
    assert body.volume == pytest.approx(2 * raw_half_volume_mm3(scene), rel=1e-3)
    centre, outward = body.triangles_center, body.face_normals[:, 0]
    walls = (np.abs(centre[:, 0]) > 1.01) & (centre[:, 2] > 1e-3) & (centre[:, 2] < scene.pitch_mm - 1e-3)
    leaves = (outward * np.sign(centre[:, 0]))[walls]
    assert leaves.min() >= math.sin(math.radians(5.0)) - 1e-3


@pytest.mark.slow
def test_the_finished_part_lies_in_the_raw_one(plain: Scene, mikron: Scene, tmp_path: Path) -> None:
    """With bevels that have no draft of their own, drillings and bores left full; read back from STEP."""
    scene = forged(mikron)
    volume = export_solid(scene, "raw", tmp_path / "raw.step")
    assert step_volume_mm3(tmp_path / "raw.step") == pytest.approx(volume, rel=1e-6)
    assert volume == pytest.approx(2 * raw_half_volume_mm3(scene), rel=1e-6)
    assert volume < 2 * raw_half_volume_mm3(forged(plain))
    left = solid_of(surface_of(scene, "throw", 2.0)) - solid_of(surface_of(scene, "raw", 2.0))
    assert left.volume() < 2e-4 * volume  # facets of one outline in both
    assert isinstance(left, Manifold)
    assert machined_out(scene) == ("throw.main_journal.bore_diameter_mm", "throw.crankpin.bore_diameter_mm")


def test_a_collar_holds_a_fillet_larger_than_the_allowance(plain: Scene) -> None:
    """The cone of 45 deg is the chord of the fillet's arc less the allowance, from end to end."""
    scene = forged(plain, FLUSH)
    assert scene.forging is not None
    main = next(one for one in raw_half(scene, scene.forging).journals if isinstance(one, Collar))
    journal = scene.throw.main_journal
    assert main.wide == pytest.approx((scene.web_z_mm[0] - 1.0, journal.radius_mm + journal.fillet_mm))
    assert main.narrow[1] == pytest.approx(journal.radius_mm + 1.0, rel=2e-3)
    assert main.wide[1] - main.narrow[1] == pytest.approx(main.wide[0] - main.narrow[0])
    assert not any(isinstance(one, Collar) for one in raw_half(scene, Forging(allowance_mm=2.5)).journals)


def test_pockets_that_the_die_does_not_release_are_machined(plain: Scene) -> None:
    pockets = [POCKET, {**POCKET, "y_mm": 4.0, "length_mm": 8.0, "draft_deg": 4.0}]
    round_one = {"shape": "cylinder", "face": "through", "x_mm": 0.0, "y_mm": 24.0, "diameter_mm": 6.0}
    web = {**OUTLINES["obround"], "thickness_mm": 19.0}
    scene, other = (
        forged(plain, web={**web, "pocket": found}) for found in ([pockets[1], round_one], [POCKET])
    )
    assert machined_out(scene) == (*machined_out(other), "web.pocket[0]", "web.pocket[1]")
    floor, beyond = np.array(24.0), np.array(sum(other.web_z_mm) / 2)
    both = (raw_half(one, Forging(**USUAL)).half_mm(floor, beyond) for one in (scene, other))
    assert [float(half) for half in both] == pytest.approx([25.0, 25.0 - 6.0])


def test_two_different_webs_each_have_their_raw_half(plain: Scene) -> None:
    second = {**OUTLINES["obround"], "thickness_mm": 24.0}
    scene = forged(plain, second_web=second)
    both = [forged(plain), forged(plain, web=second)]
    kg = raw_mass_kg(scene)
    assert kg == pytest.approx(sum(map(raw_mass_kg, both)) / 2, rel=1e-9)


@pytest.mark.parametrize(
    ("forging", "words"),
    [
        (
            {**USUAL, "allowance_mm": 18.0},
            "forging.allowance_mm = 18.0: with the draft of 5 deg raw webs meet",
        ),
        ({**USUAL, "flash_mm": 30.0}, "forging.flash_mm = 30.0: must be at most"),
        ({**USUAL, "draft_deg": 40.0}, "forging.draft_deg"),
        ({"draft_deg": 5.0}, "forging.allowance_mm"),
    ],
)
def test_what_cannot_be_forged_is_refused_when_it_is_read(
    plain: Scene, forging: dict[str, float], words: str
) -> None:
    with pytest.raises(CranktopoError, match=re.escape(words)):
        forged(plain, forging)


def test_each_half_names_what_is_machined_out_of_it(plain: Scene) -> None:
    """By the keys of the scene: the second half's only drilling is not its first one there."""
    drillings = [
        {
            "diameter_mm": 4.0,
            "web": web,
            "from": {"on": "main_journal", "angle_deg": 180.0, "place_mm": 6.0},
            "to": {"on": "crankpin", "angle_deg": 0.0, "place_mm": 6.0},
        }
        for web in ("first", "second")
    ]
    solid = {"main_journal": {"bore_diameter_mm": 0.0}, "crankpin": {"bore_diameter_mm": 0.0}}
    throw = plain.throw.model_dump(mode="json", exclude_none=True)
    for name, more in solid.items():
        throw[name] |= more
    scene = forged(plain, throw={**throw, "drilling": drillings})
    assert machined_of_half(scene, "first") == ("throw.drilling[0]",)
    assert machined_of_half(scene, "second") == ("throw.drilling[1]",)
    assert machined_out(scene) == ("throw.drilling[0]", "throw.drilling[1]")


def test_a_raw_part_that_cannot_be_built_costs_its_sheet_only(
    plain: Scene, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    def refused(*_: Any, **__: Any) -> None:
        raise solver_error("raw half throw: no.", "Change it.")

    monkeypatch.setattr("cranktopo.tasks.drawing.raw_sheet.surface_of", refused)
    with caplog.at_level("INFO"):
        assert raw_pages(forged(plain), []) == []
    assert "the drawing has no sheet of the raw part: raw half throw: no." in caplog.text
    assert raw_pages(plain, []) == []


def test_raw_part_without_forging(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["export", "mikron-iiic-plain", str(tmp_path / "a.step"), "--part", "raw"]) == 3
    assert "[forging] is missing" in capsys.readouterr().err
    assert not (tmp_path / "a.step").exists()


def design_with_forging(folder: Path) -> Path:
    text = (Path(__file__).parents[3] / "designs" / "mikron-iiic-plain.toml").read_text(encoding="utf-8")
    path = folder / "raw.toml"
    path.write_text(f"{text}\n[forging]\nallowance_mm = 2.0\nflash_mm = 2.0\n", encoding="utf-8")
    return path


def test_the_command_tells_masses_and_what_is_machined(
    plain: Scene, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    design = str(design_with_forging(tmp_path))
    assert main(["export", design, str(tmp_path / "raw.stl"), "--part", "raw", "--facet-mm", "6"]) == 0
    told = capsys.readouterr().out
    assert f"{raw_mass_kg(forged(plain)):.3f} kg; finished " in told
    assert "machined out of the full: throw.main_journal.bore_diameter_mm" in told


@pytest.mark.slow
def test_the_drawing_has_a_sheet_of_the_raw_part(
    plain: Scene, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["export", str(design_with_forging(tmp_path)), str(tmp_path / "raw.svg")]) == 0
    assert "2 sheets A3 one below the other, the last of the raw part" in capsys.readouterr().out
    drawn = (tmp_path / "raw.svg").read_text(encoding="utf-8")
    kg = raw_mass_kg(forged(plain))
    for words in (
        f"raw {kg:.3f} kg, finished",
        "finished part",
        "draft 5°",
        "die parts here: flash line",
        "⌀46",
    ):
        assert f"<!-- {words}" in drawn


@pytest.mark.slow
def test_a_raw_part_that_the_kernel_makes_wrong_names_the_feature(
    plain: Scene, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Here by a closed form that is 1 % off where the web has a counterweight."""
    scene = forged(weighted(roomy_scene(plain), PLAIN))

    def wrong(part: Scene) -> float:
        return raw_half_volume_mm3(part) * (1.01 if part.web.counterweight else 1.0)

    monkeypatch.setattr("cranktopo.bodies.solid.raw_part.raw_half_volume_mm3", wrong)
    with (
        cad_session("raw") as gmsh,
        pytest.raises(CranktopoError, match=r"raw half throw: .* from web.counterweight on"),
    ):
        add_raw_half(gmsh.model.occ, scene)
