"""The command `balance` as a user runs it."""

import json
import re

import pytest

from cranktopo.app.main import main
from cranktopo.design.loading import designs_folder
from tests.engine_arrangements import MIKRON

V2 = (
    MIKRON.replace("cylinders = 4", "cylinders = 2")
    .replace("[1, 3, 4, 2]", "[1, 2]")
    .replace(
        "[engine.masses]",
        "[engine.arrangement]\nlayout = 'V'\nbank_angle_deg = 90.0\nthrow_angles_deg = [0.0]\n"
        "[[engine.arrangement.balancer_shaft]]\norder = 2\nturns = 'with'\n[engine.masses]",
    )
)


def run(capsys, *args):
    code = main(["balance", *args])
    out = capsys.readouterr()
    return code, out.out, out.err


@pytest.fixture
def vee(tmp_path):
    path = tmp_path / "v2.toml"
    path.write_text(V2)
    return str(path)


def test_json_has_the_contract_keys(capsys):
    code, out, err = run(capsys, "mikron-iiic-plain", "--json")
    found = json.loads(out)
    assert (code, err) == (0, "")
    assert (found["schema_version"], found["design"], found["speed_rpm"]) == (1, "mikron-iiic-plain", 2100.0)
    assert [(entry["order"], entry["kind"]) for entry in found["orders"]] == [
        (1, "rotating"),
        *((order, "oscillating") for order in (1, 2, 4, 6)),
    ]
    assert found["orders"][2]["force_N"] == pytest.approx(1740.93, abs=0.01)
    assert found["orders"][2]["moment_Nm"] == 0
    assert len(found["counterweights"]) == 8
    assert {"web", "unbalance_kg_mm", "deg"} <= set(found["counterweights"][0])
    assert sum(w["unbalance_kg_mm"] for w in found["counterweights"]) == pytest.approx(4 * 53.17, abs=0.02)
    assert [b["bearing"] for b in found["main_bearings"]] == [1, 2, 3, 4, 5]
    assert {"max_N", "deg"} <= set(found["main_bearings"][0])
    assert [(s["order"], s["turns"], s["in_scene"]) for s in found["balancer_shafts"]] == [
        (2, "with", False),
        (2, "against", False),
    ]
    assert "engine.gas.wiebe_shape" in [item["key"] for item in found["assumed"]]


def test_text_of_a_vee(capsys, vee):
    code, out, err = run(capsys, vee)
    assert code == 0
    assert "V, 2 cylinders, banks 90 deg apart, throws at 0 deg, 114 mm apart, firing at 0, 450 deg" in out
    assert re.search(r"^oscillating +1 +1473\.1 +1473\.1 +-", out, re.MULTILINE)
    assert re.search(r"^oscillating +2 +615\.5 +0\.0 +90\.0", out, re.MULTILINE)
    assert re.search(r"^with balancer shafts +2 +307\.8 +307\.8 +-", out, re.MULTILINE)
    assert "Balancer shafts\n" in out
    assert "assumed:" in err
    assert max(map(len, out.splitlines())) < 250


def test_page_and_markdown(capsys, vee, tmp_path):
    page, text = tmp_path / "b.html", tmp_path / "b.md"
    code, _, err = run(capsys, vee, "--report", str(page))
    assert (code, f"report: {page}" in err) == (0, True)
    html = page.read_text(encoding="utf-8")
    assert html.count("<svg") == 3
    assert "Free moment over a turn. order 1 as it is: at most 13.26 N m" in html
    assert not re.search(r"(?:src|href)=\"(?!data:|#)", html)
    assert run(capsys, vee, "--report", str(text), "--quiet")[2] == ""
    assert "with balancer shafts" in text.read_text(encoding="utf-8")
    assert len(list((tmp_path / "b-pictures").iterdir())) == 3


def test_life_of_roller_bearings_is_told_where_it_is_known(capsys, tmp_path):
    path = tmp_path / "d.toml"
    path.write_text(MIKRON.replace("[supports]", "[supports]\nroller_bearing = {name = 'HK6020'}"))
    known = json.loads(run(capsys, str(path), "--json")[1])["main_bearings"]
    assert all(bearing["life_h"] > 0 for bearing in known)
    assert "life" in run(capsys, str(path))[1]
    assert json.loads(run(capsys, "--json")[1])["main_bearings"][0]["life_h"] is None


def test_without_gas_it_says_so(capsys):
    code, out, _ = run(capsys, "opposed-piston")
    assert code == 0
    assert "Main bearings, without gas: none is given" in out


def test_bad_input_writes_nothing(capsys, tmp_path):
    page = tmp_path / "b.html"
    opposed = (designs_folder() / "opposed-piston.toml").read_text()
    for text, message in (
        (
            opposed[: opposed.index("[engine]")] + opposed[opposed.index("[envelope]") :],
            "engine = None: must be",
        ),
        (MIKRON.replace("speed_rpm = 2100.0", "speed_rpm = 0.0"), "engine.speed_rpm = 0.0: must be > 0 rpm"),
    ):
        (tmp_path / "d.toml").write_text(text)
        code, out, err = run(capsys, str(tmp_path / "d.toml"), "--report", str(page))
        assert (code, out, len(err.splitlines())) == (3, "", 1)
        assert message in err
    assert run(capsys, "--report", str(tmp_path / "b.pdf"))[0] == 2
    assert [path.name for path in tmp_path.iterdir()] == ["d.toml"]
