"""The command `bolts` as a user runs it."""

import json
import math
import re

import pytest

from cranktopo.app.main import main
from cranktopo.design.loading import designs_folder, load_scene, scene_from_dict
from cranktopo.tasks.bolts.stage import check_bolts

PLAIN = (designs_folder() / "mikron-iiic-plain.toml").read_text(encoding="utf-8")
JOINT = '\n[[bolted_joint]]\nname = "counterweight"\nthread = "M10"\ngrip_mm = 30.0\nmax_force_N = 9000.0\n'
MEMBER = "member_diameter_mm = 9.9\n"


def run(capsys, *args, name="bolts"):
    code = main([name, *args])
    out = capsys.readouterr()
    return code, out.out, out.err


def test_a_joint_is_told_and_written(capsys, tmp_path):
    design = tmp_path / "bolted.toml"
    design.write_text(PLAIN + JOINT)
    code, text, _ = run(capsys, str(design))
    assert code == 0
    assert "counterweight  M10 10.9" in text
    code, out, _ = run(capsys, str(design), "--json")
    (joint,) = json.loads(out)["joints"]
    assert joint["vdi_2230"]["torque_Nm"] > 60
    safeties = [joint["vdi_2230"][f"{name}_safety"] for name in ("clamp", "yield", "fatigue", "thread")]
    assert joint["smallest_safety"] == min(*safeties, joint["vdi_2230"]["head_pressure_safety"])


def test_bolts_of_a_balancer_shafts_masses_are_verified(capsys, tmp_path):
    """45.268 kg mm at 2460 rpm on two bolts: 1502 N each, as `balancer` has it for the same bolt."""
    text = (designs_folder() / "balancer-shaft.toml").read_text(encoding="utf-8")
    bolt = 'unbalance_kg_mm = 45.268\n[balancer.weight.bolt]\nthread = "M8"\ngrip_mm = 20.0'
    design = tmp_path / "b.toml"
    design.write_text(text.replace("unbalance_kg_mm = 45.268", bolt, 1))
    code, out, err = run(capsys, str(design), "--json")
    assert code == 0, err
    (joint,) = json.loads(out)["joints"]
    assert joint["name"] == "balancer weight 1"
    assert joint["max_force_N"] == pytest.approx(45.268e-3 * (2460 * math.pi / 30) ** 2 / 2)
    beside = json.loads(run(capsys, str(design), "--json", name="balancer")[1])["joints"]
    assert [one | {"name": joint["name"]} for one in beside] == [joint]


HELD = '\n[[bolted_joint]]\nholds = "web.counterweight"\nbolts = 3\nthread = "M8"\ngrip_mm = 30.0\n'
WEB = {"thickness_mm": 19.0, "outline": "rectangle", "width_mm": 60.0, "overhang_mm": 30.0}
HEAVY = {"outer_radius_mm": 70.0, "half_angle_deg": 90.0, "density_kg_m3": 17500.0}


def test_bolts_of_a_counterweight_have_its_centrifugal_force():
    """Half a disc of 70 mm less the web's 60 x 30 mm in it: 2 R^3 / 3 - b o^2 / 2, by 19 mm and density."""
    data = load_scene("mikron-iiic-plain").model_dump(mode="json", by_alias=True, exclude_none=True)
    joint = {"holds": "web.counterweight", "bolts": 3, "thread": "M8", "grip_mm": 30.0}
    data |= {"web": WEB | {"counterweight": HEAVY}, "bolted_joint": [joint]}
    data["engine"]["overspeed_rpm"] = 3000.0
    del data["envelope"]
    first = (2 * 70**3 / 3 - 60 * 30**2 / 2) * 19 * 17.5e-6
    (found,) = check_bolts(scene_from_dict(data)).joints
    by_hand = first / 1e3 * (3000 * math.pi / 30) ** 2 / 3
    assert found.max_force_N == pytest.approx(by_hand, rel=1e-6)
    (given,) = check_bolts(
        scene_from_dict(data | {"bolted_joint": [{"thread": "M8", "grip_mm": 30.0, "max_force_N": by_hand}]})
    ).joints
    assert found.smallest_safety == pytest.approx(given.smallest_safety, rel=1e-6)


@pytest.mark.parametrize(
    ("joint", "line"),
    [
        (HELD, "names a counterweight of its own density"),
        (HELD + "max_force_N = 1.0\n", "has no meaning beside `holds`"),
        (JOINT.replace("max_force_N = 9000.0", ""), "bolted_joint[0].max_force_N"),
    ],
)
def test_a_joint_has_one_force(capsys, tmp_path, joint, line):
    design = tmp_path / "held.toml"
    design.write_text(PLAIN + joint)
    code, _, err = run(capsys, str(design))
    assert code == 3
    assert line in " ".join(err.split())


def test_a_design_without_bolts_says_what_has_them(capsys):
    code, _, err = run(capsys, "mikron-iiic-plain")
    assert code == 3
    assert "[balancer.weight.bolt]" in err


def test_the_needed_preload_stands_beside_the_one_that_it_is_compared_with(capsys, tmp_path):
    """`needed`, which holds the scatter, stood without a word beside `least`, from which it is taken off."""
    design = tmp_path / "bolted.toml"
    joint = JOINT.replace("counterweight", "a")  # short, so that no head takes two lines
    design.write_text(PLAIN + joint)
    needed = json.loads(run(capsys, str(design), "--json")[1])["joints"][0]["vdi_2230"]["needed_preload_N"]
    design.write_text(PLAIN + joint + f"preload_N = {needed!r}\n")
    vdi = json.loads(run(capsys, str(design), "--json")[1])["joints"][0]["vdi_2230"]
    assert vdi["preload_N"] == vdi["needed_preload_N"] == needed
    assert vdi["clamp_safety"] == pytest.approx(1.0, rel=1e-12)
    text = run(capsys, str(design))[1]
    heads, _, _, row = text.split("\n\n")[2].splitlines()
    assert re.split(r" {2,}", heads)[3:6] == ["preload", "preload needed", "least"]
    assert row.split()[4] == row.split()[5] == f"{needed / 1000:.1f}"
    assert "`preload needed` what it must be for load, scatter and settling" in text


@pytest.mark.parametrize(
    ("boss_width_mm", "bolt_distance_mm", "width_mm", "edge_mm"),
    [(82.0, 62.0, 28.0, 6.5), (74.0, 62.0, 28.0, 6.0), (84.0, 66.0, 15.0, 7.5), (82.0, 58.2, 28.0, 4.725)],
)
def test_a_rod_bolt_clamps_what_its_boss_holds(boss_width_mm, bolt_distance_mm, width_mm, edge_mm):
    """Nearest is the bore of 49 mm, the outer face, a face across; the last is 1.05 of the hole of 9 mm."""
    rod = load_scene("mikron-iiic-rod").rod
    bolt = {"member_diameter_mm": None, "hole_diameter_mm": 9.0}
    sizes = {
        "boss_width_mm": boss_width_mm,
        "bolt_distance_mm": bolt_distance_mm,
        "big_end_bore_mm": 49.0,
        "big_end_width_mm": width_mm,
        "bolt": rod.bolt.model_copy(update=bolt),
    }
    found = rod.model_copy(update=sizes).clamping_bolt
    assert found.member_diameter_mm == pytest.approx(2 * edge_mm)


@pytest.mark.parametrize("name", ["bolts", "rod"])
def test_what_a_rod_bolt_clamps_is_told_where_it_is_not_given(capsys, tmp_path, name):
    """Bosses 71.9 mm wide with bolts 62 mm apart: their outer faces are nearer than the bore of 46 mm."""
    text = (designs_folder() / "mikron-iiic-rod.toml").read_text(encoding="utf-8")
    line, found = "member_diameter_mm = 16.0\n", {}
    assert text.count(line) == 1
    for which, own in (("left out", ""), ("given", MEMBER), ("wide", "member_diameter_mm = 60.0\n")):
        design = tmp_path / f"{which}.toml"
        design.write_text(text.replace(line, own))
        code, out, err = run(capsys, str(design), "--json", name=name)
        assert code == 0, err
        data = json.loads(out)
        assert ("assumed:" in err) == bool(data["assumed"]) == (which == "left out")
        assert (f"rod.bolt.{MEMBER.strip()} (the largest cylinder" in err) == (which == "left out")
        found[which] = (data["bolt"] if name == "rod" else data["joints"][0])["vdi_2230"]
    assert found["left out"] == pytest.approx(found["given"])
    assert found["left out"]["amplitude_MPa"] > 1.3 * found["wide"]["amplitude_MPa"]


def test_a_design_without_joints_and_a_thread_that_is_none(capsys, tmp_path):
    code, _, err = run(capsys, "mikron-iiic-plain")
    assert code == 3
    assert "[[bolted_joint]]" in err
    design = tmp_path / "bolted.toml"
    design.write_text(PLAIN + JOINT.replace("M10", "M13"))
    code, _, err = run(capsys, str(design))
    assert code == 3
    assert "ISO 261" in err


@pytest.mark.parametrize(
    ("line", "key"),
    [
        ("hole_diameter_mm = 20.0", "hole_diameter_mm"),
        ("hole_diameter_mm = 9.0", "hole_diameter_mm"),
        ("head_diameter_mm = 11.0", "head_diameter_mm"),
        ("member_diameter_mm = 11.0", "member_diameter_mm"),
        ("shank_mm = 31.0", "grip_mm"),
        ("shank_diameter_mm = 20.0", "shank_diameter_mm"),
        ("engagement_mm = 2.6", "engagement_mm"),
        ("min_force_N = 9001.0", "min_force_N"),
    ],
)
def test_bolts_that_cannot_be(capsys, tmp_path, line, key):
    design = tmp_path / "bolted.toml"
    design.write_text(f"{PLAIN}{JOINT}{line}\n")
    code, _, err = run(capsys, str(design))
    assert code == 3
    assert f"bolted_joint[0].{key}" in err


def test_a_joint_that_is_only_pushed_needs_its_smallest_force(capsys, tmp_path):
    design = tmp_path / "bolted.toml"
    pushed = JOINT.replace("max_force_N = 9000.0", "max_force_N = -9000.0")
    design.write_text(PLAIN + pushed)
    code, _, err = run(capsys, str(design))
    assert code == 3
    assert "bolted_joint[0].min_force_N" in err
    design.write_text(f"{PLAIN}{pushed}min_force_N = -10000.0\n")
    code, out, err = run(capsys, str(design), "--json")
    assert code == 0, err
    assert json.loads(out)["joints"][0]["vdi_2230"]["fatigue_safety"] > 0


@pytest.mark.parametrize("name", ["M" + 400 * "9", "M10x" + 400 * "9"])
def test_an_endless_thread_is_one_line(capsys, tmp_path, name):
    design = tmp_path / "bolted.toml"
    design.write_text(PLAIN + JOINT.replace("M10", name))
    code, _, err = run(capsys, str(design))
    assert code == 3
    assert "ISO 261" in err
