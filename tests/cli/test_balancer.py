"""The command `balancer` as a user runs it."""

import json
import math
import re
from datetime import datetime

import pytest

from cranktopo.app.main import main
from cranktopo.design.loading import designs_folder, load_scene
from cranktopo.design.named import with_values
from cranktopo.tasks.balancer.drawing import balancer_page
from cranktopo.tasks.balancer.stage import check_balancer
from cranktopo.tasks.drawing.sheet import pages_figure

TEXT = (designs_folder() / "balancer-shaft.toml").read_text(encoding="utf-8")


def run(capsys, *args):
    code = main(["balancer", *args])
    out = capsys.readouterr()
    return code, out.out, out.err


def test_text_and_json_tell_the_same(capsys):
    code, text, _ = run(capsys)
    assert code == 0
    assert "spline  269.0      0.0430     0.0500" in text
    _, out, _ = run(capsys, "--json")
    assert json.loads(out)["probes"][0]["deflection_mm"] == pytest.approx(0.043, abs=1e-4)


def test_too_much_deflection_and_bolts_are_told(capsys, tmp_path):
    design = tmp_path / "b.toml"
    bolt = 'unbalance_kg_mm = 45.268\n[balancer.weight.bolt]\nthread = "M8"\ngrip_mm = 20.0'
    strict = TEXT.replace("permitted_mm = 0.05", "permitted_mm = 0.025")
    design.write_text(strict.replace("unbalance_kg_mm = 45.268", bolt))
    code, text, err = run(capsys, str(design))
    assert code == 0, err
    assert "More than permitted: spline." in text
    assert "weight 1  M8 10.9" in text


@pytest.mark.parametrize(
    ("old", "new", "line"),
    [
        ("z_mm = 269.0", "z_mm = 369.0", "beyond its ends"),
        ("z_mm = 193.0", "z_mm = 32.0", "two radial bearings"),
        ("diameter_mm = 23.0", "diameter_mm = 26.0", "balancer.notch[0].diameter_mm"),
        ("diameter_mm = 25.0", "diameter_mm = 25.0\nbore_mm = 25.0", "balancer.step[2].bore_mm"),
    ],
)
def test_shafts_that_are_none(capsys, tmp_path, old, new, line):
    assert old in TEXT
    design = tmp_path / "b.toml"
    design.write_text(TEXT.replace(old, new))
    code, _, err = run(capsys, str(design))
    assert code == 3
    assert line in err


def test_the_strength_of_thin_sections_is_told_of_a_thick_shaft(capsys, tmp_path):
    """By the shaft's own thickness, not that of the crank: a bored shaft has its wall."""
    _, _, err = run(capsys)
    assert "balancer shaft: material: ultimate_MPa = 900 of 16MnCr5 is that of sections to 40 mm" in err
    assert "this shaft has 60 mm" in err
    design = tmp_path / "b.toml"
    design.write_text(re.sub(r"(\ndiameter_mm = (?:45|60)\.0)", r"\1\nbore_mm = 8.0", TEXT))
    _, _, err = run(capsys, str(design))
    assert "material: ultimate_MPa" not in err
    assert not [
        note for note in balancer_page(load_scene(str(design))).notes if "agreed with the forge" in note
    ]


def test_a_design_without_a_balancer_shaft(capsys):
    code, _, err = run(capsys, "mikron-iiic-plain")
    assert code == 3
    assert "[balancer] is missing" in err


def test_two_bearings_at_one_place(capsys, tmp_path):
    """Each would be told the reaction of both on the spring of one."""
    design = tmp_path / "b.toml"
    design.write_text(f"{TEXT}\n[[balancer.bearing]]\nz_mm = 193.0\nspring_N_per_mm = 1.0e5\n")
    code, _, err = run(capsys, str(design))
    assert code == 3
    assert "balancer.bearing" in err


def test_a_redesign_is_written_into_the_text_of_the_design(capsys, tmp_path):
    """Its comments stay; the file says of itself what the redesign was told to have."""
    file = tmp_path / "new-shaft.toml"
    code, text, err = run(capsys, "balancer-shaft", "--redesign", str(file))
    assert code == 0, err
    assert text.startswith("Every limit holds: mass of the shaft 3.348 -> ")
    assert "# 112.2, 43.4 and 40.8 N" in file.read_text(encoding="utf-8")
    told = json.loads(run(capsys, "balancer-shaft", "--redesign", str(tmp_path / "again.toml"), "--json")[1])
    again = json.loads(run(capsys, str(file), "--json")[1])
    assert again["mass_kg"] == told["redesign"]["result_kg"] < told["redesign"]["start_kg"]
    assert again["probes"][0]["deflection_mm"] == told["probes"][0]["deflection_mm"] < 0.025
    assert len(again["bearings"]) == 3 + told["redesign"]["added_bearings"] == 4


def test_a_redesign_that_there_is_none_of_writes_nothing(capsys, tmp_path):
    design, file = tmp_path / "b.toml", tmp_path / "new.toml"
    design.write_text(TEXT.replace("deflection_mm = 0.025", "deflection_mm = 0.0005"))
    code, _, err = run(capsys, str(design), "--redesign", str(file))
    assert code == 3
    assert "deflection of spline" in err
    assert not file.exists()
    code, _, err = run(capsys, "balancer-shaft", "--redesign", str(tmp_path / "new.json"))
    assert code == 2
    assert ".toml" in err


def test_the_drawing_of_the_shaft(capsys, tmp_path):
    """A PDF file, of the redesign where one is asked for."""
    file = tmp_path / "shaft.pdf"
    code, _, err = run(capsys, "balancer-shaft", "--drawing", str(file))
    assert code == 0, err
    assert file.read_bytes().startswith(b"%PDF")
    code, _, err = run(capsys, "--drawing", str(tmp_path / "shaft.dxf"))
    assert code == 2
    assert ".svg" in err


def test_the_drawing_says_what_the_scene_says():
    """Dimension lines are as long as their numbers; the section, turned about the axis, has the mass."""
    scene = load_scene("balancer-shaft")
    scene = with_values(scene, {"balancer.step[0].bore_mm": 20.0, "balancer.step[1].bore_mm": 12.0})
    end, along, detail = pages_figure([balancer_page(scene)], datetime(2026, 1, 1)).axes[:3]
    measured = [line.measured for line in along.texts if hasattr(line, "measured")]
    assert sorted(float(one.text) for one in measured) == [45.0, 75.0, 165.0, 285.0]
    assert all(one.end[0] - one.start[0] == pytest.approx(float(one.text)) for one in measured)
    words = [text.get_text() for text in along.texts]
    for word in ("⌀45 h6 (0/-0.016), bore ⌀20", "⌀60 h6 (0/-0.019), bore ⌀12", "⌀25", "M1, N2", "B3", "P1"):
        assert word in words
    assert {"M1, M2"} <= {text.get_text() for text in end.texts}
    assert {"R0.45", "⌀23", "1"} <= {text.get_text() for text in detail.texts}
    section = next(patch for patch in along.patches if patch.get_hatch()).get_path().vertices
    (z, r), (z1, r1) = section[:-1].T, section[1:].T
    volume = abs(((z1 - z) * (r * r + r * r1 + r1 * r1)).sum()) * math.pi / 3
    groove = math.pi * 2 * 0.45 * 1.0 * 24.0
    assert volume == pytest.approx(check_balancer(scene).mass_kg / 7.85e-6 - groove, abs=0.2 * groove)


@pytest.mark.parametrize("name", ["shaft.step", pytest.param("shaft.stl", marks=pytest.mark.slow)])
def test_the_shaft_as_a_body(capsys, tmp_path, name):
    """The body of the built-in shaft has grooves, which the drawing shows; masses have no shape."""
    file = tmp_path / name
    code = main(["export", "balancer-shaft", str(file), "--part", "balancer"])
    out = capsys.readouterr().out
    assert code == 0
    assert file.stat().st_size
    assert "balancer, 422897.4 mm3; without its masses, of which only the unbalance is known" in " ".join(
        out.split()
    )


def test_a_body_needs_a_shaft(capsys, tmp_path):
    file = tmp_path / "shaft.step"
    assert main(["export", "mikron-iiic", str(file), "--part", "balancer"]) == 3
    assert "[balancer] is missing" in capsys.readouterr().err
    assert not file.exists()
