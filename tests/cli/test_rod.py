"""The command `rod` as a user runs it, and the rod's solid."""

import json
import math
from datetime import datetime

import ezdxf
import meshio
import numpy as np
import pytest

from cranktopo.app.main import main
from cranktopo.design.loading import designs_folder, load_scene
from cranktopo.design.named import with_values
from cranktopo.design.rod_body import drilled, rod_mass, section
from cranktopo.tasks.bolts.result import BoltChecks
from cranktopo.tasks.bolts.text import bolts_text
from cranktopo.tasks.drawing.sheet import pages_figure
from cranktopo.tasks.rod.drawing import rod_page
from cranktopo.tasks.rod.outlines import front_outline
from cranktopo.tasks.rod.result import LighterRod
from cranktopo.tasks.rod.stage import check_rod_strength
from cranktopo.tasks.rod.text import least_safety, rod_text

TEXT = (designs_folder() / "mikron-iiic-rod.toml").read_text(encoding="utf-8")


def run(capsys, *args):
    code = main([*args])
    out = capsys.readouterr()
    return code, out.out, out.err


def test_text_and_json_tell_the_same(capsys):
    code, text, _ = run(capsys, "rod")
    assert code == 0
    assert "0.4690 kg; 0.1436 kg oscillate, 0.3254 kg rotate" in text
    least = "\nleast safety: yield 2.15 (shank buckling, motion); fatigue by lsa 1.45 (eye to shank)"
    assert f"{least}; bolts by VDI 2230 1.17 (yield)\n" in text
    code, out, _ = run(capsys, "rod", "--json")
    data = json.loads(out)
    assert data["buckling"][0]["yield_safety"] == pytest.approx(2.15, abs=0.005)
    assert {s["section"] for s in data["sections"]} >= {"eye, crown", "mid-shank", "cap", "big end"}
    assert data["bolt"]["name"] == "rod"


def test_elements_are_told_beside_the_closed_form(capsys, tmp_path):
    """On coarse elements; a folder gets the result, a picture and the surface."""
    out = tmp_path / "found"
    words = ("rod", "mikron-iiic-rod", "--fea", "--contact", "--element-size-mm", "12", "--out", str(out))
    code, text, _ = run(capsys, *words)
    assert code == 0
    assert "By finite elements on a quarter, rigid pins touch" in text
    assert {path.name for path in out.iterdir()} == {
        "rod.json",
        "rod-mikron-iiic-rod.png",
        "rod-mikron-iiic-rod.vtu",
    }
    data = json.loads((out / "rod.json").read_text())
    found, plain = data["elements"], json.loads(run(capsys, "rod", "--json")[1])
    assert {key: value for key, value in data.items() if key != "elements"} == plain
    places = {place["place"]: place for place in found["places"]}
    for name in ("eye to shank", "mid-shank"):
        closed = next(s for s in data["sections"] if s["section"] == name)
        assert places[name]["min_MPa"] == pytest.approx(closed["min_MPa"], rel=0.5)
        assert f"{places[name]['yield_safety']:.2f}" in text
    assert found["yield_safety"] == min(place["yield_safety"] for place in places.values())
    worst = min(places.values(), key=lambda place: place["fatigue_safety"])
    fails = min(found["yield_safety"], found["fatigue_safety"]) < 1
    told = next(line for line in text.splitlines() if "least safety: " in line)
    assert (told == text.splitlines()[0]) == told.startswith("NOT SAFE: ") == fails
    assert f"fatigue by lsa {worst['fatigue_safety']:.2f} ({worst['place']}, by elements)" in told
    preload = found["preload"]
    assert (
        preload["least_N"] < preload["mean_N"] < preload["largest_N"] == data["bolt"]["vdi_2230"]["preload_N"]
    )
    assert f"The mean preload, {preload['mean_N']:,.0f} N in each bolt" in text
    assert ("THE SPLIT OPENS" in text) == (preload["least_pressure_MPa"] <= 0)
    surface = meshio.read(out / "rod-mikron-iiic-rod.vtu")
    assert np.abs(surface.points).max(axis=0) == pytest.approx([35.95, 185.3, 15.0], abs=0.1)
    judged = surface.point_data["judged"] > 0
    highest = surface.point_data["largest_von_mises_MPa"][judged].max()
    told = max(max(place["max_MPa"], -place["min_MPa"]) for place in places.values())
    assert highest == pytest.approx(told)


def test_elements_too_fine_for_the_memory(capsys):
    code, _, err = run(capsys, "rod", "--fea", "--element-size-mm", "0.01")
    assert code == 3
    assert "too fine" in err


def test_a_bolt_that_fails_is_told_first(capsys):
    """As a section that fails is: the least safety of a rod is that of its joint, too."""
    strength = check_rod_strength("mikron-iiic-rod")
    failing = strength.model_copy(
        update={
            "bolt": strength.bolt.model_copy(update={"smallest_safety": 0.9, "governing": "head pressure"})
        }
    )
    assert least_safety(strength).startswith("least safety: ")
    assert least_safety(failing).startswith("NOT SAFE: least safety: ")
    assert least_safety(failing).endswith("bolts by VDI 2230 0.90 (head pressure)")
    checks = BoltChecks(design="rod", joints=(failing.bolt,), assumed=())
    assert bolts_text(checks).startswith("NOT SAFE: smallest safety by VDI 2230: 0.90, head pressure of rod.")


def test_its_bolts_are_told_by_bolts_too(capsys):
    code, out, _ = run(capsys, "bolts", "mikron-iiic-rod", "--json")
    assert code == 0
    assert json.loads(out)["joints"][0]["name"] == "rod"


def test_its_masses_are_those_of_the_loads(capsys):
    _, out, _ = run(capsys, "balance", "mikron-iiic-rod", "--json")
    assert not [a for a in json.loads(out)["assumed"] if "rod_" in a["key"]]


@pytest.mark.parametrize(
    ("old", "new", "key"),
    [
        ("bolt_distance_mm = 62.0", "bolt_distance_mm = 50.0", "rod.bolt_distance_mm"),
        ("boss_width_mm = 71.9", "boss_width_mm = 65.0", "rod.boss_width_mm"),
        ("small_end_bore_mm = 24.0", "small_end_bore_mm = 39.0", "rod.small_end_diameter_mm"),
        ("shank_fillet_mm = 30.0", "shank_fillet_mm = 300.0", "rod.shank_fillet_mm"),
        ("rod_length_mm = 166.0", "rod_length_mm = 51.0", "rod.big_end_diameter_mm"),
        ("bore_diameter_mm = 12.0", "bore_diameter_mm = 18.0", "rod.pin.bore_diameter_mm"),
        ("boss_distance_mm = 32.0", "boss_distance_mm = 78.0", "rod.pin.length_mm"),
        ("boss_distance_mm = 32.0", "boss_distance_mm = 27.0", "rod.small_end_width_mm"),
    ],
)
def test_dimensions_that_give_no_body(capsys, tmp_path, old, new, key):
    assert old in TEXT
    design = tmp_path / "rod.toml"
    design.write_text(TEXT.replace(old, new))
    code, _, err = run(capsys, "rod", str(design))
    assert code == 3
    assert key in err


def oblique(tmp_path, angle_deg, *changes):
    design = tmp_path / "oblique.toml"
    text = TEXT.replace("bolt_distance_mm = 62.0", f"bolt_distance_mm = 62.0\nsplit_angle_deg = {angle_deg}")
    for old, new in changes:
        assert old in text
        text = text.replace(old, new)
    design.write_text(text)
    return str(design)


@pytest.mark.parametrize(
    ("angle_deg", "changes", "key"),
    [
        (55.0, (), "rod.split_angle_deg = 55.0: must be at most 51.6 deg: beyond, the split cuts the shank"),
        (70.0, (), "rod.split_angle_deg"),
        (45.0, (("shank_fillet_mm", "oil_hole_mm = 2.0\nshank_fillet_mm"),), "rod.bolt_distance_mm"),
        (45.0, (("grip_mm = 16.0", "grip_mm = 35.0"),), "rod.bolt.grip_mm = 35.0: must be 16 to 32.26 mm"),
        (45.0, (("grip_mm = 16.0", 'grip_mm = 46.26\nheld_in = "nut"'),), "the upper nut meets the shank"),
        (45.0, (("boss_width_mm = 71.9", "boss_width_mm = 360.0"),), "rod.boss_width_mm"),
    ],
)
def test_an_oblique_split_that_gives_no_rod(capsys, tmp_path, angle_deg, changes, key):
    code, _, err = run(capsys, "rod", oblique(tmp_path, angle_deg, *changes))
    assert code == 3
    assert key in err


def test_an_oblique_split_is_told(capsys, tmp_path):
    code, text, _ = run(capsys, "rod", oblique(tmp_path, 45.0))
    assert code == 0
    size = "72.2 mm across the rod, 78.2 mm over its corners"
    assert text.splitlines()[2] == f"the big end without its cap, {size}, passes the bore of 95 mm"
    assert "Split oblique by 45 deg: force of the cap along the bolts and along the joint" in text
    assert (
        "NOT HELD BY FRICTION: 0.81 of the shear at 0.15; serrations, a shoulder or dowels must carry" in text
    )


@pytest.mark.slow
def test_an_oblique_split_by_elements(capsys, tmp_path):
    """Half of the rod, and a surface with both of its sides; points of both ways to mount it."""
    out = tmp_path / "found"
    words = ("--fea", "--contact", "--element-size-mm", "5", "--out", str(out))
    code, text, _ = run(capsys, "rod", oblique(tmp_path, 45.0), *words)
    assert code == 0
    assert "By finite elements on a half, rigid pins touch" in text
    found = json.loads((out / "rod.json").read_text())["elements"]
    assert found["residual"] < 1e-6
    surface = meshio.read(next(out.glob("*.vtu")))
    x, y, _ = surface.points.T
    assert y[x > 0].min() < y[x < 0].min() - 3.0  # the boss that the split lowers
    judged = surface.point_data["judged"] == 1
    told = max(max(place["max_MPa"], -place["min_MPa"]) for place in found["places"])
    assert surface.point_data["largest_von_mises_MPa"][judged].max() == pytest.approx(told)
    least = surface.point_data["fatigue_safety"][judged].min()
    assert least == pytest.approx(found["fatigue_safety"])


def test_a_big_end_wider_than_the_cylinder_is_said(capsys, tmp_path):
    design = tmp_path / "wide.toml"
    design.write_text(TEXT.replace("boss_width_mm = 71.9", "boss_width_mm = 92.0"))
    code, text, _ = run(capsys, "rod", str(design))
    assert code == 0
    assert text.splitlines()[0].startswith("NOT THROUGH THE CYLINDER: the big end without its cap, 92.0 mm")


def test_a_design_without_a_rod(capsys):
    code, _, err = run(capsys, "rod", "mikron-iiic-plain")
    assert code == 3
    assert "[rod] is missing" in err


def test_its_solid_is_written_and_read_back(capsys, tmp_path):
    file = tmp_path / "rod.step"
    code, out, _ = run(capsys, "export", "mikron-iiic-rod", str(file), "--part", "rod")
    assert code == 0, out
    assert "mikron-iiic-rod rod" in file.read_text()


@pytest.mark.slow
def test_a_lighter_rod_is_found_and_written(capsys, tmp_path):
    file = tmp_path / "lighter.toml"
    code, out, _ = run(capsys, "rod", "--lighter", str(file), "--json")
    assert code == 0
    data = json.loads(out)
    found = data["lighter"]
    assert found["result_kg"] < 0.9 * found["start_kg"]
    assert data["masses"]["total_kg"] == pytest.approx(found["result_kg"])
    code, text, _ = run(capsys, "rod", str(file))
    assert code == 0
    assert f"{found['result_kg']:.4f} kg" in text


@pytest.mark.parametrize(
    ("rods", "words"),
    [
        (4, "A lighter rod at no less safety, by elements too: 4 rods were judged"),
        (None, "A lighter rod at no less safety"),
    ],
)
def test_a_lighter_rod_says_what_elements_have_judged(rods, words):
    rod = check_rod_strength("mikron-iiic-rod")
    searched = LighterRod(
        start_kg=0.54,
        result_kg=0.52,
        smallest_yield_safety=(2.95, 2.95),
        smallest_fatigue_safety=(2.33, 2.36),
        small_end_ovalisation_um=(16.8, 15.9),
        big_end_ovalisation_um=(36.8, 35.0),
        elements_small_end_ovalisation_um=rods and (7.4, 7.9),
        result_without_limits_kg=0.515,
        elements_yield_safety=rods and (2.47, 2.53),
        elements_fatigue_safety=rods and (1.94, 1.98),
        rods_by_elements=rods,
        speed_rpm=2800.0,
        crankpin_pull_N=(5620.0, 5528.0),
        rotating_unbalance_kg_mm=(17.6, 16.8),
        dimensions=(),
    )
    text = rod_text(rod.model_copy(update={"lighter": searched}))
    assert text.splitlines()[0] == words
    assert ("1.94 -> 1.98" in text) == ("7.4 -> 7.9" in text) == bool(rods)
    assert "cost of the ovalisation's limits" in text
    assert "0.0050 kg" in text


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "size_mm", "share"),
    [("mikron-iiic-rod-h", "6", 0.985), ("mikron-iiic-rod-i", "3", 0.89), ("mikron-iiic-rod", "3", 0.95)],
)
def test_a_lighter_rod_is_no_less_safe_by_elements(capsys, tmp_path, name, size_mm, share):
    """The written design is evaluated anew."""
    file, out = tmp_path / "lighter.toml", tmp_path / "found"
    mesh = ("--fea", "--contact", "--element-size-mm", size_mm, "--json")
    code, text, err = run(capsys, "rod", name, "--lighter", str(file), "--out", str(out), *mesh)
    assert code == 0, err
    data = json.loads(text)
    assert json.loads((out / "rod.json").read_text()) == data
    searched = data["lighter"]
    assert searched["result_kg"] < share * searched["start_kg"]
    assert searched["crankpin_pull_N"][1] < searched["crankpin_pull_N"][0]
    assert data["masses"]["total_kg"] == pytest.approx(searched["result_kg"])
    own, again = (json.loads(run(capsys, "rod", one, *mesh)[1]) for one in (name, str(file)))
    assert again["masses"]["total_kg"] == data["masses"]["total_kg"]
    for kind in ("yield_safety", "fatigue_safety"):
        before, after = searched[f"elements_{kind}"]
        assert before == pytest.approx(own["elements"][kind], rel=1e-9)
        assert after == pytest.approx(again["elements"][kind], rel=1e-9)
        assert after >= before


def test_a_lighter_rod_needs_a_toml_file(capsys, tmp_path):
    code, _, err = run(capsys, "rod", "--lighter", str(tmp_path / "rod.step"))
    assert code == 2
    assert ".toml" in err


def test_a_bore_that_changes_too_much_is_said_first(capsys, tmp_path):
    design = tmp_path / "limited.toml"
    design.write_text(TEXT.replace("[rod.material]", "small_end_ovalisation_um = 15.0\n[rod.material]"))
    code, text, _ = run(capsys, "rod", str(design))
    assert code == 0
    said = "TOO OVAL: the bore of the small end changes by 15.5 um under the pull; permitted are 15 um"
    assert text.splitlines()[:2] == [said, ""], "as of a film that is too thin"
    assert "Change of the bores' diameters, pressed by the cosine" in text


def test_a_rod_below_a_safety_of_one_is_said_first(capsys, tmp_path):
    """The same rod under twice the pressure."""
    design = tmp_path / "strong.toml"
    strong = TEXT.replace("peak_pressure_MPa = 5.16", "peak_pressure_MPa = 10.4")
    assert strong != TEXT
    design.write_text(strong)
    code, text, _ = run(capsys, "rod", str(design))
    assert code == 0
    assert text.splitlines()[0].startswith("NOT SAFE: least safety: yield 1.0")
    assert "shank at" in text.splitlines()[2]


@pytest.mark.parametrize("shank", ["I", "H", "plain"])
def test_the_drawing_says_what_the_scene_says(shank):
    """Dimension lines are as long as their numbers; cut areas are those of the rod, its section by hand."""
    values = {
        "rod.shank": shank,
        "rod.shank_small_mm": 12.0,
        "rod.shank_width_mm": 20.0,
        "rod.oil_hole_mm": 2.0,
    }
    scene = with_values(load_scene("mikron-iiic-rod"), values)
    rod, page = scene.rod, rod_page(scene)
    front, along, across = pages_figure([page], datetime(2026, 1, 1)).axes[:3]
    told = {
        axes: [t.measured for t in axes.texts if hasattr(t, "measured")] for axes in (front, along, across)
    }
    assert {one.text for one in told[front]} == {"30.26", "16", "166 ±0.05", "62", "71.9"}
    assert {one.text for one in told[along]} == {"28", "30"}
    magnified = next(one for one in told[across] if one.text == "20")
    factor = (magnified.end[1] - magnified.start[1]) / 20.0
    for axes, scale in ((front, 1.0), (along, 1.0), (across, factor)):
        for one in told[axes]:
            ends = np.abs(np.subtract(one.end, one.start))
            assert scale * float(one.text.split()[0]) == pytest.approx(
                ends[0] or ends[1], abs=0.01 * scale
            ) or (one.text == "166 ±0.05" and ends[1] == pytest.approx(166.0))
    words = {text.get_text() for axes in (front, along, across) for text in axes.texts}
    assert {"⌀24 H6 (+0.013/0)", "bush ⌀22 H6 (+0.013/0)", "⌀46 H6 (+0.016/0)", "2 x M8x1", "⌀2"} <= words
    assert {"∥", "0.009", "B", "4 x R30"} <= words
    text = "\n".join((*page.lines, *page.notes, page.mass))
    for word in ("⌀65, bore ⌀46 H6 (+0.016/0)", "tightened to 40.8 N m", "Ra 0.8", "EN-AW-2031"):
        assert word in text
    assert f"{rod_mass(rod, 166.0, scene.material).total_kg:.3f} kg" in page.mass
    at = np.array([float(next(t for t in words if t.startswith("A-A")).split()[3].rstrip(","))])
    shank_area = drilled(rod, section(rod, 166.0, at)).area_mm2[0]
    assert hatched_mm2(across) == pytest.approx(factor**2 * shank_area, rel=2e-3)
    web = {"I": rod.web_mm, "H": 20.0, "plain": 20.0}[shank]
    eyes = 28.0 * (38.63 - 24.0) + 30.0 * (65.0 - 46.0 + 0.0) + 28.0 * 2 * rod.bush_thickness_mm
    free = 166.0 - (38.63 + 65.0) / 2
    hole = 2.0 * (166.0 - (24.0 + 46.0) / 2)
    assert hatched_mm2(along) == pytest.approx(eyes + web * free - hole, rel=1e-3)


def hatched_mm2(axes):
    cut = [patch.get_path() for patch in axes.patches if patch.get_hatch()]
    return sum(ring_mm2(ring) for path in cut for ring in path.to_polygons(closed_only=True))


def ring_mm2(ring):
    """Area by the shoelace formula, negative of a hole."""
    (x, y), (x1, y1) = ring.T, np.roll(ring, -1, axis=0).T
    return float((x * y1 - x1 * y).sum()) / 2


@pytest.mark.parametrize("angle_deg", [0.0, 40.0])
def test_the_outline_of_the_drawing_is_that_of_the_solid(angle_deg):
    """Its area times the width, where all of the rod is as wide, is the volume without holes of bolts."""
    values = {"rod.small_end_width_mm": 27.41, "rod.big_end_width_mm": 27.41}
    values |= {"rod.bolt.hole_diameter_mm": 8.4, "rod.split_angle_deg": angle_deg}
    scene = with_values(load_scene("mikron-iiic-rod"), values)
    rod, front = scene.rod, front_outline(scene.rod, 166.0)
    area = sum(ring_mm2(ring) for ring in front)
    holes = math.pi / 2 * 8.4**2 * (rod.boss_above_mm + rod.boss_below_mm)
    volume = rod_mass(rod, 166.0, scene.material).body_kg / rod.material.density_kg_m3 * 1e9
    assert 27.41 * area - holes == pytest.approx(volume, rel=5e-4)


def test_the_drawing_of_an_oblique_split():
    """The split at its angle through the axis, the angle's number on its bisector, the cut hole of a bolt."""
    scene = with_values(load_scene("mikron-iiic-rod-i"), {"rod.split_angle_deg": 45.0})
    rod, page = scene.rod, rod_page(scene)
    assert "            width 20, split oblique by 45° at the axis" in page.lines
    front, along = pages_figure([page], datetime(2026, 1, 1)).axes[:2]
    angle = next(text for text in front.texts if text.get_text() == "45°")
    x, y = angle.get_position()
    assert math.degrees(math.atan2(-y, x)) == pytest.approx(22.5)
    chains = [np.asarray(chain) for one in front.collections for chain in one.get_segments()]
    split = [chain for chain in chains if len(chain) and np.abs(chain.sum(axis=1)).max() < 1e-9]
    ends = sorted(float(np.hypot(*point)) for chain in split for point in chain)
    assert ends == pytest.approx([rod.big_end_bore_mm / 2] * 2 + [rod.boss_width_mm / 2] * 2)
    hole = rod.bolt_hole_mm / 2
    y = np.linspace(0.0, rod.boss_above_mm * math.sqrt(2), 200_001)
    reach = np.abs(rod.bolt_distance_mm / 2 - y * math.sqrt(0.5))
    cut = np.trapezoid(2 * np.sqrt(np.maximum(hole**2 - reach**2, 0.0)), y)
    top = rod.boss_above_mm * math.sqrt(2)
    eyes = 22.0 * (36.0 - 26.0) + 20.0 * (top + 30.0 - 46.0)
    bush = 22.0 * 2 * rod.bush_thickness_mm
    web = rod.web_mm * (166.0 - 18.0 - top)
    assert hatched_mm2(along) == pytest.approx(eyes + bush + web - cut, rel=1e-3)


@pytest.mark.parametrize("kind", ["pdf", "dxf"])
def test_the_drawing_is_written(capsys, tmp_path, kind):
    file = tmp_path / f"rod.{kind}"
    code, _, err = run(capsys, "rod", "--drawing", str(file))
    assert code == 0, err
    if kind == "pdf":
        assert file.read_bytes().startswith(b"%PDF")
    else:
        measured = [one for one in ezdxf.readfile(file).modelspace() if one.dxftype() == "DIMENSION"]
        assert any(one.get_measurement() == pytest.approx(166.0) for one in measured)
    code, _, err = run(capsys, "rod", "--drawing", str(tmp_path / "rod.step"))
    assert code == 2
    assert ".dxf" in err
