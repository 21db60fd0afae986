"""A crank exported as STEP, turned by a random attitude and imported: every dimension comes back."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
import tomlkit

from cranktopo import load_scene
from cranktopo.app.main import main
from cranktopo.base.errors import CranktopoError, ExitCode
from cranktopo.bodies.solid.files import export_solid
from cranktopo.bodies.solid.step import step_solid
from cranktopo.design.crank_throws import throw_scenes
from cranktopo.design.halves import halves, mirror_image
from cranktopo.design.loading import builtin_designs, scene_from_dict
from cranktopo.design.schema import Scene
from cranktopo.numerics.gmsh_session import cad_session, quiet_stdout
from cranktopo.tasks.crank_import import web_reading
from cranktopo.tasks.crank_import.crank_finder import find_crank
from cranktopo.tasks.crank_import.design_text import crank_table
from cranktopo.tasks.crank_import.kernel_halves import crank_by_kernel
from cranktopo.tasks.crank_import.oil_drillings import (
    has_neighbours_bore,
    read_drillings,
    with_known_outlets,
)
from cranktopo.tasks.crank_import.result import CrankImport
from cranktopo.tasks.crank_import.stage import import_crank
from cranktopo.tasks.crank_import.text import import_text
from cranktopo.tasks.importing.cad_body import moved_rigidly
from cranktopo.tasks.importing.faces import CylinderFace, Faces, PlaneFace, exact_faces
from cranktopo.throw.drilling.table import Drilling, drill_bores
from tests.physics.throw.test_drillings_that_meet import marine


def turned(file: Path, seed: int) -> Path:
    """Return the file of the same body in a random attitude and place."""
    from scipy.spatial.transform import Rotation

    target = file.with_name(f"turned-{seed}.step")
    with cad_session("turned body") as gmsh:
        body = [step_solid(gmsh, file, "body")]
        place = 100 * np.random.default_rng(seed).normal(size=3)
        moved_rigidly(gmsh.model.occ, body, Rotation.random(random_state=seed).as_matrix(), place)
        gmsh.model.occ.synchronize()
        with quiet_stdout():
            gmsh.write(str(target))
    return target


def imported(scene: Scene, folder: Path, part: Any = "crankshaft", seed: int = 7) -> CrankImport:
    export_solid(scene, part, folder / "body.step")
    return import_crank(turned(folder / "body.step", seed), scene.name, folder / "out")


def flat(data: Any, key: str = "") -> dict[str, Any]:
    if isinstance(data, dict):
        return {k: v for name, one in data.items() for k, v in flat(one, f"{key}.{name}").items()}
    if isinstance(data, list):
        return {k: v for index, one in enumerate(data) for k, v in flat(one, f"{key}[{index}]").items()}
    return {key: data}


def dimensions(scene: Scene) -> dict[str, Any]:
    return flat(scene.model_dump(mode="json", include={"throw", "web"}, exclude_none=True))


def check_dimensions(own: Scene, scene: Scene, but: tuple[str, ...] = ()) -> None:
    found, wanted = dimensions(own), dimensions(scene)
    assert found.keys() == wanted.keys()
    for key, value in wanted.items():
        if key not in but:
            same = pytest.approx(value, rel=1e-6, abs=1e-6) if isinstance(value, float) else value
            assert found[key] == same, key


def check_same(scene: Scene, result: CrankImport, but: tuple[str, ...] = ()) -> None:
    half = result.halves[0]
    check_dimensions(load_scene(half.design), scene, but)
    assert half.design_volume_mm3 == pytest.approx(half.volume_mm3, rel=1e-6)
    assert len(result.halves) == 1


@pytest.mark.slow
def test_a_whole_crank_with_bevels(tmp_path: Path) -> None:
    scene = load_scene("mikron-iiic")
    result = imported(scene, tmp_path)
    check_same(scene, result)
    assert [throw.angle_deg for throw in result.throws] == pytest.approx([0, 180, 180, 0], abs=1e-6)
    assert len(result.main_journals) == 5
    assert [throw.bore_mm for throw in result.throws] == pytest.approx(
        [scene.throw.crankpin.bore_diameter_mm] * 4
    )
    assert len(result.halves[0].webs) == 8
    assert any("cut in their middle" in line for line in result.assumed)
    design = Path(result.halves[0].design)
    assert load_scene(str(design)).original is not None
    assert "fill in" in design.read_text(encoding="utf-8")
    assert json.loads((design.parent / "import.json").read_text())["throws"][1]["radius_mm"] == pytest.approx(
        48
    )
    assert "8  obround" in " ".join(import_text(result).split("\n")).replace("   ", "  ")


@pytest.mark.slow
def test_bevels_with_draft_come_back(tmp_path: Path) -> None:
    data = load_scene("mikron-iiic").model_dump(mode="json", exclude_none=True)
    for bevel, draft_deg in zip(data["web"]["bevel"], (5.0, 4.0), strict=True):
        bevel |= {"crown_mm": 0.0, "draft_deg": draft_deg}
    scene = scene_from_dict(data)
    check_same(scene, imported(scene, tmp_path, "throw"))


@pytest.mark.slow
def test_a_half_throw_with_a_counterweight(tmp_path: Path) -> None:
    scene = load_scene("car-diesel")
    export_solid(scene, "half", tmp_path / "body.step")
    result = import_crank(tmp_path / "body.step", "car", tmp_path / "out")
    check_same(scene, result)
    assert any("nearer to the file's origin" in line for line in result.assumed)


@pytest.mark.slow
def test_round_corners_and_round_pockets_come_back(tmp_path: Path) -> None:
    """A half disc with round corners and fillets, a hole through the web, blind ones from both faces."""
    data = load_scene("car-diesel").model_dump(mode="json", exclude_none=True)
    weight = {"outer_radius_mm": 66.0, "half_angle_deg": 90.0, "corner_mm": 7.0, "fillet_mm": 6.0}
    hole = {"shape": "cylinder", "diameter_mm": 9.0}
    pockets = [
        {**hole, "x_mm": 24.0, "y_mm": -44.0, "face": "through"},
        {**hole, "x_mm": -22.0, "y_mm": -44.0, "face": "journal", "depth_mm": 8.0},
        {**hole, "x_mm": 0.0, "y_mm": -52.0, "face": "pin", "depth_mm": 6.0},
    ]
    data["web"] |= {"counterweight": weight, "pocket": pockets}
    del data["envelope"], data["shape"]
    scene = scene_from_dict(data, "corners")
    export_solid(scene, "half", tmp_path / "body.step")
    result = import_crank(tmp_path / "body.step", "corners", tmp_path / "out")
    found = load_scene(result.halves[0].design).web
    assert found.counterweight == scene.web.counterweight
    assert set(found.pocket) == set(scene.web.pocket)
    assert result.halves[0].design_volume_mm3 == pytest.approx(result.halves[0].volume_mm3, rel=1e-6)


@pytest.mark.slow
def test_holes_of_plugs_come_back_or_are_told(tmp_path: Path) -> None:
    """Axial ones as pockets, a radial one in words: CAD has no mass of plugs."""
    data = load_scene("car-diesel").model_dump(mode="json", exclude_none=True)
    plug = {"axis": "axial", "x_mm": 22.0, "y_mm": -43.0, "diameter_mm": 20.0, "length_mm": 14.0}
    data["web"]["counterweight"] |= {
        "plug": [{**plug, "density_kg_m3": 17500.0}],
        "hole": [{"angle_deg": -20.0, "diameter_mm": 10.0, "depth_mm": 15.0}],
    }
    del data["envelope"]
    export_solid(scene_from_dict(data, "plugged"), "half", tmp_path / "body.step")
    result = import_crank(tmp_path / "body.step", "plugged", tmp_path / "out")
    (pocket,) = load_scene(result.halves[0].design).web.pocket
    assert (pocket.x_mm, pocket.y_mm, pocket.diameter_mm, pocket.depth_mm) == pytest.approx((22, -43, 20, 14))
    assert any("a hole of 10 mm across the crank" in line for line in result.halves[0].unread)


@pytest.mark.slow
def test_unlike_halves_become_a_design_each(tmp_path: Path) -> None:
    """A web 22 mm thick beyond the pin, and a longer main journal there."""
    scene = load_scene("mikron-iiic-plain", whole=True)
    data = scene.model_dump(mode="json", exclude_none=True, exclude={"published"})
    data["second_web"] = {**data["web"], "thickness_mm": 22.0}
    data["throw"] |= {"second_main_journal_length_mm": 46.0}
    result = imported(scene_from_dict(data, "pair", whole=True), tmp_path, "throw")
    assert len(result.halves) == 2
    thick = {half.dimensions_mm["web.thickness_mm"] for half in result.halves}
    assert sorted(thick) == pytest.approx([19.0, 22.0])
    lengths = {half.dimensions_mm["throw.main_journal.length_mm"] for half in result.halves}
    assert len(lengths) == 2


@pytest.mark.slow
@pytest.mark.parametrize(("ends", "length"), [("whole", 20.0), ("cut", 40.0)])
def test_end_journals_are_what_the_user_says(tmp_path: Path, ends: Any, length: float) -> None:
    export_solid(load_scene("mikron-iiic-plain"), "throw", tmp_path / "throw.step")
    result = import_crank(tmp_path / "throw.step", None, tmp_path / "out", ends=ends)
    assert result.halves[0].dimensions_mm["throw.main_journal.length_mm"] == pytest.approx(length)


@pytest.mark.slow
def test_the_design_has_the_name_asked_for(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    export_solid(load_scene("mikron-iiic-plain"), "half", tmp_path / "body.step")
    monkeypatch.chdir(tmp_path)
    command = ["import", "body.step", "--name", "mine", "--material", "34CrNiMo6", "--json"]
    assert main([*command]) == 0
    found = json.loads(capsys.readouterr().out)
    assert found["halves"][0]["design"] == "mine/mine.toml"
    assert load_scene("mine/mine.toml").material.name == "34CrNiMo6"


@pytest.mark.slow
def test_a_solid_of_an_assembly(tmp_path: Path) -> None:
    """A throw beside a block: the throw is taken, and a name that is not there is refused."""
    export_solid(load_scene("mikron-iiic-plain"), "throw", tmp_path / "throw.step")
    both = tmp_path / "both.step"
    with cad_session("assembly") as gmsh:
        step_solid(gmsh, tmp_path / "throw.step", "throw")
        gmsh.model.occ.addBox(200, 0, 0, 10, 10, 10)
        gmsh.model.occ.synchronize()
        with quiet_stdout():
            gmsh.write(str(both))
    result = import_crank(both, None, tmp_path / "out")
    assert [solid.looks_like_a_crank for solid in result.solids].count(True) == 1
    assert result.throws[0].radius_mm == pytest.approx(48.0)
    with pytest.raises(CranktopoError, match="holds no solid 'rod'"):
        import_crank(both, None, tmp_path / "again", solid="rod")


def with_ends(cylinders: int, output: list[dict[str, Any]] | None = None, **crank: Any) -> Scene:
    """The plain Mikron with a nose and a seat at the free end, and a flange at the output or other steps."""
    data = load_scene("mikron-iiic-plain").model_dump(mode="json", exclude_none=True, exclude={"published"})
    order = list(range(1, cylinders + 1)) if cylinders < 4 else [1, 3, 4, 2]
    data["engine"] |= {"cylinders": cylinders, "firing_order": order}
    seat = {"kind": "cylinder", "diameter_mm": 36.0, "length_mm": 16.0, "bore_diameter_mm": 10.0}
    nose = {"kind": "cylinder", "diameter_mm": 28.0, "length_mm": 22.0, "bore_diameter_mm": 0.0}
    flange = {"kind": "cylinder", "diameter_mm": 140.0, "length_mm": 12.0, "bore_diameter_mm": 16.0}
    ends = [{"side": "free", "step": [seat, nose]}, {"side": "output", "step": output or [flange]}]
    return scene_from_dict({**data, "crank": {"end": ends, **crank}}, "ends")


@pytest.mark.slow
def test_the_ends_of_a_crank_come_back(tmp_path: Path) -> None:
    scene = with_ends(1)
    export_solid(scene, "crankshaft", tmp_path / "body.step")
    result = import_crank(tmp_path / "body.step", "ends", tmp_path / "out")
    assert [journal.length_mm for journal in result.main_journals] == pytest.approx([40.0, 40.0])
    found, wanted = load_scene(result.halves[0].design).crank, scene.crank
    assert found is not None
    assert wanted is not None
    assert flat(found.model_dump(mode="json")) == pytest.approx(flat(wanted.model_dump(mode="json")))
    assert not [lack for lack in result.unread if lack.what.startswith("step of")]


@pytest.mark.slow
def test_cones_and_keyways_come_back(tmp_path: Path) -> None:
    """Both at the output: a seat with a keyway off the throw, a cone with a bore, a nose behind it."""
    key = {"kind": "keyway", "diameter_mm": 38.0, "length_mm": 20.0, "width_mm": 9.0, "depth_mm": 5.0}
    key |= {"angle_deg": 75.0, "bore_diameter_mm": 8.0}
    cone = {"kind": "cone", "diameter_mm": 34.0, "outer_end_diameter_mm": 27.0, "length_mm": 31.0}
    cone["bore_diameter_mm"] = 8.0
    nose = {"kind": "cylinder", "diameter_mm": 22.0, "length_mm": 14.0, "bore_diameter_mm": 0.0}
    wanted = with_ends(1, [key, cone, nose]).crank
    export_solid(with_ends(1, [key, cone, nose]), "crankshaft", tmp_path / "body.step")
    result = import_crank(tmp_path / "body.step", "ends", tmp_path / "out")
    found = load_scene(result.halves[0].design).crank
    assert found is not None
    assert wanted is not None
    assert flat(found.model_dump(mode="json")) == pytest.approx(flat(wanted.model_dump(mode="json")))
    assert not [lack for lack in result.unread if lack.what.startswith("step of")]


@pytest.mark.slow
def test_a_main_journal_of_its_own_comes_back(tmp_path: Path) -> None:
    scene = with_ends(4, main_journal=[{"number": 2, "length_mm": 50.0}])
    result = imported(scene, tmp_path)
    found = load_scene(result.halves[0].design, whole=True).crank
    assert found is not None
    assert [(own.number, own.length_mm) for own in found.main_journal] == [(2, pytest.approx(50.0))]
    assert found.throws == ("throw",) * 4
    assert len(found.end) == 2


def unlike_throws(folder: Path) -> Scene:
    """Two throws: the second 22 mm thick at its first web, a pocket aside in its other; a flange."""
    data = load_scene("mikron-iiic-plain").model_dump(mode="json", exclude_none=True, exclude={"published"})
    data["throw"]["crankpin"] |= {"fillet_mm": 2.5, "fillet_axial_mm": 4.0}
    data["throw"]["main_journal"] |= {"fillet_mm": 2.0, "recess_mm": 0.4}
    pocket = {
        "shape": "cylinder",
        "x_mm": 12.0,
        "y_mm": 24.0,
        "diameter_mm": 8.0,
        "face": "pin",
        "depth_mm": 5.0,
    }
    other = {key: data[key] for key in ("throw", "web", "material")} | {"name": "thick"}
    other |= {"web": data["web"] | {"thickness_mm": 22.0}, "second_web": data["web"] | {"pocket": [pocket]}}
    (folder / "thick.toml").write_text(tomlkit.dumps(other))
    data["engine"] |= {"cylinders": 2, "firing_order": [1, 2]}
    flange = {"kind": "flange", "diameter_mm": 140.0, "length_mm": 12.0, "bore_diameter_mm": 16.0, "bolts": 6}
    flange |= {"bolt_circle_mm": 110.0, "bolt_diameter_mm": 9.0, "first_bolt_deg": 20.0}
    data["crank"] = {
        "throws": ["throw", str(folder / "thick.toml")],
        "end": [{"side": "free", "step": []}, {"side": "output", "step": [flange]}],
        "main_journal": [{"number": 1, "length_mm": 46.0, "fillet_mm": 1.6}],
    }
    return scene_from_dict(data, "unlike", whole=True)


@pytest.mark.slow
def test_a_crank_of_unlike_throws_comes_back(tmp_path: Path) -> None:
    """Each distinct throw is a design that the crank's names; elliptical, recessed fillets, bolt holes."""
    scene = unlike_throws(tmp_path)
    export_solid(scene, "crankshaft", tmp_path / "body.step")  # turned, either end may be the free one
    result = import_crank(tmp_path / "body.step", "unlike", tmp_path / "out")
    found = load_scene(result.files.design, whole=True)
    assert found.crank is not None
    assert scene.crank is not None
    ends = [
        flat(crank.model_dump(mode="json", include={"end", "main_journal"}))
        for crank in (found.crank, scene.crank)
    ]
    assert ends[0] == pytest.approx(ends[1], abs=1e-6)
    assert [Path(name).name for name in found.crank.throws] == ["throw", "unlike-throw-2.toml"]
    assert [throw.same_as for throw in result.throws] == [None, None]
    for own, wanted in zip(throw_scenes(found), throw_scenes(scene), strict=True):
        for half, other in zip(halves(own), halves(wanted), strict=True):
            check_dimensions(half, other)
    assert result.design_volume_mm3 == pytest.approx(result.volume_mm3, rel=1e-6)
    assert not result.unread
    assert Path(result.files.picture).stat().st_size > 10_000


def cylinder(
    radius: float, span: tuple[float, float], x: float = 0.0, y: float = 0.0, *, bore: bool = False
) -> Any:
    """A whole cylinder along z."""
    point, axis = np.array([x, y, 0.0]), np.array([0.0, 0.0, 1.0])
    middle = np.array([x + radius, y, sum(span) / 2])
    return CylinderFace(point, axis, radius, span, 2 * np.pi, not bore, middle)


def synthetic(*more: Any, journal: bool = True) -> Faces:
    """Two throws with webs of 20 mm, or a flying one between their pins, and more faces."""
    at = (116.0, 136.0) if journal else (96.0, 96.0)
    mains = [(0.0, 20.0), *([(96.0, 116.0)] if journal else []), (at[1] + 76.0, at[1] + 96.0)]
    faces = [cylinder(20.0, span) for span in mains]
    faces += [cylinder(18.0, (40.0, 76.0), y=40.0)]
    low = 136.0 if journal else 96.0
    faces += [cylinder(18.0, (low, low + 36.0), y=-40.0)]
    return Faces((*faces, *more), (), (), ())


def test_a_flying_web_is_told() -> None:
    """Two pins without a main journal between them: said, the outer journals whole, no [crank] written."""
    crank = find_crank(synthetic(journal=False), "flying")
    assert len(crank.pins) == 2
    assert crank.flying == (1,)
    assert any("crankpins 1 and 2 have no main journal between them" in line for line in crank.unread)
    assert not any("cut in their middle" in line for line in crank.assumed)
    assert not crank_table(load_scene("mikron-iiic-plain"), crank)
    assert find_crank(synthetic(), "crank").flying == ()


def one_cut_end(*more: Any) -> Faces:
    """Two throws, the first main journal 10 mm long and the last 20 mm as the inner one."""
    faces = synthetic(*more)
    low = [cylinder(20.0, (10.0, 20.0)) if face.span_mm == (0.0, 20.0) else face for face in faces.cylinders]
    return replace(faces, cylinders=tuple(low))


def test_each_end_is_cut_or_whole_for_itself() -> None:
    """A crank with an output end alone, as `export` writes it: its first main journal is half a one."""
    flange = cylinder(70.0, (232.0, 244.0))
    crank = find_crank(one_cut_end(flange), "crank")
    assert [half.main_length_mm for half in crank.halves] == [20.0] * 4
    assert crank.ends[0] is None
    assert [step.radius_mm for step in crank.ends[1] or ()] == [70.0]
    assert any("first main journal is half as long" in line for line in crank.assumed)
    followed = find_crank(one_cut_end(flange, cylinder(14.0, (-20.0, 10.0))), "crank")
    assert followed.halves[0].main_length_mm == 10.0
    assert [step.radius_mm for step in followed.ends[0] or ()] == [14.0]


@pytest.mark.parametrize("turn_deg", [0.0, 7.0])
def test_bolt_holes_of_a_flange_are_read_or_told(turn_deg: float) -> None:
    """Six evenly spaced ones are a flange's; with one of them elsewhere each is told."""
    flange = cylinder(70.0, (232.0, 244.0))
    angles = np.radians(20.0 + 60.0 * np.arange(6) + np.array([0.0] * 5 + [turn_deg]))
    holes = [cylinder(4.5, (232.0, 244.0), 55 * np.sin(a), 55 * np.cos(a), bore=True) for a in angles]
    crank = find_crank(synthetic(flange, *holes), "crank")
    assert crank.ends[1] is not None
    (step,) = crank.ends[1]
    told = [
        line for line in crank.unread if "a hole of 9 mm in an end of the crank, 55 mm off its axis" in line
    ]
    if turn_deg:
        assert step.bolts is None
        assert len(told) == 6
        return
    table = crank_table(load_scene("mikron-iiic-plain"), crank)["end"][1]["step"][0]
    assert {key: table[key] for key in ("kind", "bolts", "bolt_circle_mm", "bolt_diameter_mm")} == {
        "kind": "flange",
        "bolts": 6,
        "bolt_circle_mm": pytest.approx(110.0),
        "bolt_diameter_mm": pytest.approx(9.0),
    }
    assert not told


@pytest.mark.slow
def test_missing_fillets_are_told_and_brep_is_read(tmp_path: Path) -> None:
    """The half throw with sharp corners at its journals, as BREP; its dimensions are exact."""
    data = load_scene("mikron-iiic-plain").model_dump(mode="json", exclude_none=True, exclude={"published"})
    for name in ("main_journal", "crankpin"):
        data["throw"][name]["fillet_mm"] = 0.0
    scene = scene_from_dict(data, "sharp")
    export_solid(scene, "half", tmp_path / "body.step")
    with cad_session("sharp") as gmsh, quiet_stdout():
        step_solid(gmsh, tmp_path / "body.step", "body")
        gmsh.model.occ.synchronize()
        gmsh.write(str(tmp_path / "body.brep"))
    result = import_crank(tmp_path / "body.brep", "sharp", tmp_path / "out")
    check_same(scene, result)
    told = [line for line in result.halves[0].unread if line.startswith("no round fillet was found at the")]
    assert len(told) == 2


def cut_half(folder: Path, box: tuple[float, ...]) -> Path:
    """The half throw of the plain Mikron as STEP, a box taken out of it."""
    export_solid(load_scene("mikron-iiic-plain"), "half", folder / "whole.step")
    with cad_session("cut") as gmsh, quiet_stdout():
        body = step_solid(gmsh, folder / "whole.step", "body")
        gmsh.model.occ.cut([body], [(3, gmsh.model.occ.addBox(*box))])
        gmsh.model.occ.synchronize()
        gmsh.write(str(folder / "body.step"))
    return folder / "body.step"


@pytest.mark.slow
def test_a_small_cut_is_told(tmp_path: Path) -> None:
    """A slot of 32 mm3, 0.03 % of the volume, in one side alone: a side pocket would be in both."""
    file = cut_half(tmp_path, (23.0, 18.0, 30.0, 5.0, 4.0, 4.0))
    (half,) = import_crank(file, "slot", tmp_path / "out").halves
    assert not load_scene(half.design).web.pocket
    (line,) = [line for line in half.unread if "the design adds" in line]
    told = re.fullmatch(r"the design adds 32 mm3, perhaps near \((.*), (.*), (.*)\) mm", line)
    assert told is not None, line
    assert [float(place) for place in told.groups()] == pytest.approx([24.0, 20.0, 32.0], abs=0.2)


BOX = {"shape": "box", "face": "pin", "size_x_mm": 12.0, "size_y_mm": 9.0, "depth_mm": 6.0, "y_mm": 20.0}
SIDE = {"shape": "side", "y_mm": 24.0, "length_mm": 16.0, "height_mm": 8.0, "depth_mm": 5.0}


@pytest.mark.slow
@pytest.mark.parametrize(
    "pockets",
    [
        [{**BOX, "size_x_mm": 4.0, "size_y_mm": 4.0, "depth_mm": 2.0, "corner_radius_mm": 1.0}],
        [{**BOX, "x_mm": -4.0, "corner_radius_mm": 3.0, "draft_deg": 5.0, "floor_radius_mm": 1.5}],
        [{**SIDE, "corner_radius_mm": 2.0}],
        [{**SIDE, "offset_mm": 1.0, "draft_deg": 5.0, "corner_radius_mm": 2.0}],
        [
            {**SIDE, "length_mm": 100.0, "height_mm": 4.0, "depth_mm": depth, "offset_mm": place}
            for place, depth in ((-5.0, 4.0), (5.0, 3.0))
        ],
    ],
    ids=["small box", "drafted box", "side", "drafted side", "two grooves"],
)
def test_box_and_side_pockets_come_back(tmp_path: Path, pockets: list[dict[str, Any]]) -> None:
    data = load_scene("mikron-iiic-plain").model_dump(mode="json", exclude_none=True, exclude={"published"})
    data["web"]["pocket"] = pockets
    scene = scene_from_dict(data, "pockets")
    export_solid(scene, "half", tmp_path / "body.step")
    result = import_crank(tmp_path / "body.step", "pockets", tmp_path / "out")
    found = sorted(load_scene(result.halves[0].design).web.pocket, key=str)
    for own, wanted in zip(found, sorted(scene.web.pocket, key=str), strict=True):
        assert own.model_dump() == pytest.approx(wanted.model_dump(), abs=1e-6)
    assert result.halves[0].design_volume_mm3 == pytest.approx(result.halves[0].volume_mm3, rel=1e-6)
    assert not result.halves[0].unread


@pytest.mark.slow
def test_side_pockets_that_run_out_come_back(tmp_path: Path) -> None:
    """Those of a variant, open at the ends of its elliptic web: their length beyond it is no dimension."""
    scene = load_scene("opposed-piston-variant-2")
    (half,) = imported(scene, tmp_path, "throw").halves
    web = load_scene(half.design).web
    inner = sorted((pocket.y_mm - np.sign(pocket.y_mm) * pocket.length_mm / 2) for pocket in web.pocket)
    assert inner == pytest.approx([-19.5, 64.5], abs=1e-6)
    for own, wanted in zip(web.pocket, scene.web.pocket, strict=True):
        keys = {"height_mm", "depth_mm", "offset_mm", "draft_deg", "corner_radius_mm"}
        assert own.model_dump(include=keys) == pytest.approx(wanted.model_dump(include=keys), abs=1e-6)
    assert half.design_volume_mm3 == pytest.approx(half.volume_mm3, rel=1e-6)
    assert not half.unread


def end_dimensions(scene: Scene) -> dict[str, Any]:
    """Numbers of ends and own main journals; no body tells words: a seat and a thread are cylinders."""
    if scene.crank is None:
        return {}
    found = flat(scene.crank.model_dump(mode="json", include={"end", "main_journal"}, exclude_none=True))
    return {key: value for key, value in found.items() if not isinstance(value, str)}


def run_out(scene: Scene) -> Iterator[str]:
    """Yield keys of slots that run out of the web: their length beyond it is no dimension of the body."""
    for index, pocket in enumerate(scene.web.pocket):
        if pocket.shape == "side":
            yield from (f".web.pocket[{index}].{key}" for key in ("length_mm", "y_mm"))


def built_in() -> list[str]:
    """Return the designs of cranks; those of connecting rods have the crank of another one."""
    return [name for name in builtin_designs() if "-rod" not in name]


@pytest.mark.slow
@pytest.mark.parametrize("name", built_in())
def test_built_in_cranks(tmp_path: Path, name: str) -> None:
    """Webs, drillings, ends and the whole volume to 1e-6; the radius of outlets within 1 %.

    Of a body that was turned either end may be the free one: a crank with ends is not.
    """
    scene = load_scene(name, whole=True)
    part: Any = "crankshaft" if scene.engine else "throw"
    if scene.crank:
        export_solid(scene, part, tmp_path / "body.step")
        result = import_crank(tmp_path / "body.step", name, tmp_path / "out")
    else:
        result = imported(scene, tmp_path, part)
    outlets = tuple(key for key in dimensions(scene) if key.endswith("outlet_radius_mm"))
    check_same(scene, result, (*outlets, *run_out(scene)))
    found = load_scene(result.files.design, whole=True)
    for key in outlets:
        assert dimensions(found)[key] == pytest.approx(dimensions(scene)[key], rel=0.01)
    ends, wanted = (end_dimensions(one) for one in (found, scene))
    assert ends == pytest.approx(wanted, rel=1e-6, abs=1e-6)
    if scene.engine:
        near = 1e-5 if outlets else 1e-6  # the kernel approximates the roundings of drillings
        assert result.design_volume_mm3 == pytest.approx(result.volume_mm3, rel=near)


@pytest.mark.slow
def test_an_oil_drilling_and_its_outlets(tmp_path: Path) -> None:
    """The outlets' radius within 1 %, and said."""
    scene = load_scene("industrial-gas")
    key = ".throw.drilling[0].outlet_radius_mm"
    result = imported(scene, tmp_path)
    check_same(scene, result, (key,))
    radius = load_scene(result.halves[0].design).throw.drilling[0].outlet_radius_mm
    assert radius == pytest.approx(2.0, rel=0.01)
    assert any("outlet_radius_mm = 2 is fitted to" in line for line in result.halves[0].unread)


def test_outlets_of_another_half_are_taken_where_the_drillings_are_alike() -> None:
    """As they are, and mirrored; none of a drilling on another line."""
    place = {"on": "main_journal", "angle_deg": 140.0, "place_mm": 0.0}
    own = {"diameter_mm": 8.0, "from": place, "to": {"on": "crankpin", "angle_deg": -30.0, "place_mm": 0.0}}
    scene = load_scene("industrial-gas")
    known = scene.with_drillings((Drilling.model_validate({**own, "outlet_radius_mm": 2.0}),))
    for half in (known, mirror_image(known)):
        assert with_known_outlets(own, [scene, half]) == {**own, "outlet_radius_mm": 2.0}
    assert with_known_outlets(own, [scene]) == own


@pytest.mark.parametrize("way", [1.0, -1.0])
def test_a_drilling_begins_at_the_main_journal(way: float) -> None:
    """Whichever way the axis of its face points: the same bore of two halves is the same drilling."""
    scene = load_scene("industrial-gas")
    (bore,) = drill_bores(scene)
    start, end = (np.array(outlet.point_mm) for outlet in bore.outlets)
    axis = way * (end - start) / np.linalg.norm(end - start)
    length = float(np.linalg.norm(end - start))
    face = CylinderFace(
        start, axis, bore.radius_mm, (min(0.0, way * length), max(0.0, way * length)), 6.2, False, start
    )
    half: Any = SimpleNamespace(faces=Faces((face,), (), (), ()))
    (found,) = read_drillings(half, scene)
    assert [found[key]["on"] for key in ("from", "to")] == ["main_journal", "crankpin"]
    assert found["from"]["angle_deg"] == 180.0
    assert not has_neighbours_bore(half, scene)


@pytest.mark.slow
def test_outlets_that_no_drilling_can_have_are_not_taken(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The drilling is then read with sharp ones."""

    def wide(table: dict[str, Any], *_: Any) -> dict[str, Any]:
        return {**table, "outlet_radius_mm": 100.0}

    monkeypatch.setattr(web_reading, "with_outlet_radius", wide)
    scene = load_scene("industrial-gas")
    own = load_scene(imported(scene, tmp_path).halves[0].design)
    assert own.throw.drilling[0].outlet_radius_mm == 0.0
    check_dimensions(own, scene, (".throw.drilling[0].outlet_radius_mm",))


@pytest.mark.slow
def test_drillings_of_neighbours_in_one_mouth_come_back(tmp_path: Path) -> None:
    """A half throw there has lost a piece of its neighbour's: its volume does not tell the outlets."""
    scene = marine({"diameter_mm": 18.0, "outlet_radius_mm": 2.0}, [1, 3, 2])
    export_solid(scene, "crankshaft", tmp_path / "body.step")
    result = import_crank(tmp_path / "body.step", "marine", tmp_path / "out")
    (drilling,) = load_scene(result.files.design, whole=True).throw.drilling
    assert drilling.outlet_radius_mm == pytest.approx(2.0, rel=0.01)
    assert result.design_volume_mm3 == pytest.approx(result.volume_mm3, rel=1e-5)
    assert not [lack for lack in result.unread if lack.where == "crank"]
    cut = [
        lack.where for lack in result.unread if "a drilling of a neighbouring throw ends in it" in lack.what
    ]
    assert cut == ["half 2", "half 3"]
    assert not [lack for lack in result.unread if "the design adds" in lack.what]


def unlike_webs(**throw: Any) -> Scene:
    """A throw whose pin is bored and whose webs differ in thickness: its pin is two faces to the kernel."""
    data = load_scene("mikron-iiic-plain").model_dump(mode="json", exclude_none=True)
    data["throw"]["crankpin"]["bore_diameter_mm"] = 20.0
    data["throw"] |= throw
    data["second_web"] = data["web"] | {"thickness_mm": data["web"]["thickness_mm"] + 3.0}
    return scene_from_dict(data, whole=True)


def test_a_pin_of_two_faces_is_one_pin(tmp_path: Path) -> None:
    """Also where the kernel leaves a plane between them, and the last digits of their ends differ."""
    scene = unlike_webs()
    export_solid(scene, "throw", tmp_path / "throw.step")
    with cad_session("throw") as gmsh:
        step_solid(gmsh, tmp_path / "throw.step", "throw")
        faces = exact_faces(gmsh)
    noise = np.random.default_rng(1).uniform(-1e-11, 1e-11, size=(len(faces.cylinders), 2))
    cylinders = [
        replace(face, span_mm=(face.span_mm[0] + low, face.span_mm[1] + high))
        for face, (low, high) in zip(faces.cylinders, noise, strict=True)
    ]
    off = scene.throw.radius_mm
    pins = [face for face in cylinders if face.outward and face.full and face.point_mm[1] > off / 2]
    assert len(pins) == 2
    end = PlaneFace(pins[0].axis, pins[0].point_mm, 0.1)
    crank = find_crank(replace(faces, cylinders=tuple(cylinders), planes=(*faces.planes, end)), "throw")
    (pin,) = crank.pins
    assert pin.length_mm == pytest.approx(scene.throw.crankpin.length_mm, rel=1e-9)
    assert pin.bore_mm == pytest.approx(20.0)
    assert len(crank.halves) == 2


@pytest.mark.slow
def test_outlets_over_the_middle_of_a_pin_leave_no_sliver(tmp_path: Path) -> None:
    """Both drillings lean otherwise, as the webs are not alike; a half of each would end in a step."""
    place = {"angle_deg": 0.0, "place_mm": 3.0}
    drilling = {"diameter_mm": 5.0, "outlet_radius_mm": 1.2}
    drilling |= {
        "from": {"on": "main_journal", **place, "angle_deg": 180.0},
        "to": {"on": "crankpin", **place},
    }
    scene = unlike_webs(drilling=[drilling])
    export_solid(scene, "throw", tmp_path / "throw.step")
    middle = halves(scene)[0].pitch_mm / 2
    with cad_session("throw") as gmsh:
        step_solid(gmsh, tmp_path / "throw.step", "throw")
        planes = exact_faces(gmsh).planes
    assert not [plane.area_mm2 for plane in planes if abs(plane.point_mm[2] - middle) < 1e-3]


def block(folder: Path, *boxes: tuple[float, ...], bars: int = 0) -> Path:
    """A STEP file of boxes, and of bars along z on one axis."""
    path = folder / "body.step"
    with cad_session("block") as gmsh:
        for box in boxes:
            gmsh.model.occ.addBox(*box)
        for number in range(bars):
            gmsh.model.occ.addCylinder(0, 0, 60 * number, 0, 0, 50, 10 + number)
        gmsh.model.occ.synchronize()
        with quiet_stdout():
            gmsh.write(str(path))
    return path


@pytest.mark.usefixtures("kernel_here")
def test_what_is_no_crank_is_refused_in_a_line(tmp_path: Path) -> None:
    with pytest.raises(CranktopoError, match="looks like no crank: no face is a full cylinder"):
        import_crank(block(tmp_path, (0, 0, 0, 10, 10, 10)), None, tmp_path / "out")
    with pytest.raises(CranktopoError, match="all full cylinders lie on one axis"):
        import_crank(block(tmp_path, bars=1), None, tmp_path / "out")
    with pytest.raises(CranktopoError, match=r"holds 3 solids, none of them looks like a crank.*--solid"):
        import_crank(block(tmp_path, (99, 0, 0, 1, 1, 1), bars=2), None, tmp_path / "out")
    assert not (tmp_path / "out").exists()
    with pytest.raises(CranktopoError, match="is no body from CAD by its name"):
        import_crank(tmp_path / "crank.iges", None, tmp_path / "out")


def test_a_folder_with_files_is_left_alone(tmp_path: Path) -> None:
    (tmp_path / "out").mkdir()
    (tmp_path / "out" / "mine.txt").write_text("kept")
    with pytest.raises(CranktopoError, match="is not empty") as raised:
        import_crank(block(tmp_path, bars=1), None, tmp_path / "out")
    assert raised.value.code == ExitCode.USAGE


def test_a_body_is_cut_apart_once(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """And once more for each distinct half; three cuts of the whole body a half made large bodies slow."""
    import gmsh

    calls: list[str] = []
    for name in ("fragment", "intersect"):
        own = getattr(gmsh.model.occ, name)

        def counted(*args: Any, name: str = name, own: Any = own, **more: Any) -> Any:
            calls.append(name)
            return own(*args, **more)

        monkeypatch.setattr(gmsh.model.occ, name, counted)
    export_solid(load_scene("mikron-iiic-plain"), "throw", tmp_path / "throw.step")
    calls.clear()
    found = crank_by_kernel(tmp_path / "throw.step", None, "auto", None, tmp_path)
    assert len(found.crank.halves) == 2
    assert len(found.halves) == 1
    assert calls == ["fragment", "intersect"]
