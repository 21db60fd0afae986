"""The command `balance` as a user runs it."""

import json
import math
import re
from dataclasses import replace

import numpy as np
import pytest

from cranktopo.app.main import main
from cranktopo.design.clearance import room_words
from cranktopo.design.loading import designs_folder, load_scene
from cranktopo.engine.balance.whole_engine import LoadedMainBearings, engine_balance
from cranktopo.tasks.balance.needed import counterweight_words
from cranktopo.tasks.balance.page import _bearing_fact
from cranktopo.tasks.balance.result import balance_result
from tests.engine_arrangements import MIKRON
from tests.page_text import typed_page

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


BALANCED = """
[web.counterweight]
outer_radius_mm = 60.0
half_angle_deg = 70.0
"""


@pytest.fixture
def vee(tmp_path):
    path = tmp_path / "v2.toml"
    path.write_text(V2)
    return str(path)


@pytest.fixture
def weighted_vee(tmp_path):
    """The V2 with counterweights and half of its oscillating masses to be balanced; no envelope."""
    path = tmp_path / "weighted.toml"
    text = V2[: V2.index("[envelope]")].replace("[material]", f"{BALANCED}[material]", 1)
    path.write_text(text.replace("layout = 'V'", "layout = 'V'\nbalanced_oscillating_share = 0.5"))
    return path


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
    assert "Balancer shafts, beside the counterweights for each throw\n" in out
    assert "With counterweights and balancer shafts: free force of order 2 from 615.5 to 307.8 N" in out
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


def test_the_loads_of_throws_that_stand_alone_are_called_so(capsys, vee):
    _, out, _ = run(capsys, "mikron-iiic")
    _, table = out.split("Main bearings\n")
    assert "throws that stand alone between two bearings" in table
    _, one_throw, _ = run(capsys, vee)
    assert "stand alone" not in one_throw


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


def test_loads_and_balance_ask_for_the_same_counterweights(capsys, weighted_vee):
    """Both count the share of the oscillating masses; the two webs of a throw together."""
    found = json.loads(run(capsys, str(weighted_vee), "--json")[1])
    assert main(["loads", str(weighted_vee), "--json"]) == 0
    loads = json.loads(capsys.readouterr().out)["balance"]
    webs = [w for w in found["counterweights"] if w["throw"] == 1]
    needed = -sum(w["unbalance_kg_mm"] * math.cos(math.radians(w["deg"])) for w in webs)
    assert loads["counterweight_kg_mm"] == pytest.approx(needed, abs=1e-9)
    assert abs(needed - loads["rotating_unbalance_kg_mm"]) > 1
    assert found["balance_factor_percent"] == loads["balance_factor_percent"]


def test_the_balance_factor_is_that_of_its_definition(capsys, weighted_vee):
    """Mass times radius beyond the rotating masses, in percent of both rods' oscillating mass times throw."""
    scene = load_scene(str(weighted_vee))
    found = json.loads(run(capsys, str(weighted_vee), "--json")[1])
    assert main(["loads", str(weighted_vee), "--json"]) == 0
    rotating = json.loads(capsys.readouterr().out)["balance"]["rotating_unbalance_kg_mm"]
    oscillating = 2 * scene.engine.reciprocating_kg * scene.throw.radius_mm
    assert found["balance_factor_percent"] == pytest.approx(-100 * rotating / oscillating, rel=1e-12)
    out = run(capsys, str(weighted_vee))[1]
    assert f"Balance factor of each throw as it is: {found['balance_factor_percent']:.1f} %" in out
    assert "for the rotating and 50 % of the oscillating masses" in out


def test_a_proposed_counterweight_balances_the_share(capsys, weighted_vee):
    found = json.loads(run(capsys, str(weighted_vee), "--propose", "65%", "--json")[1])
    proposal = found["proposal"]
    assert (proposal["half_angle_deg"], proposal["refused"]) == (70.0, None)
    assert proposal["balance_factor_percent"] == pytest.approx(65, abs=0.05)
    assert found["arrangement"]["balanced_oscillating_share"] == 0.65
    text = weighted_vee.read_text()
    radius = f"outer_radius_mm = {proposal['outer_radius_mm']:g}"
    weighted_vee.write_text(text.replace("outer_radius_mm = 60.0", radius, 1))
    again = json.loads(run(capsys, str(weighted_vee), "--json")[1])
    assert again["balance_factor_percent"] == pytest.approx(65, abs=0.05)
    assert radius in run(capsys, str(weighted_vee), "--propose", "65")[1]


def test_an_order_that_a_proposal_makes_is_told_beside_the_largest(capsys, weighted_vee, tmp_path):
    """Half of the oscillating mass leaves a V2 of 90 deg no force of order 1; 60 % leave a fifth of one."""
    page = tmp_path / "b.html"
    weights = json.loads(run(capsys, str(weighted_vee), "--propose", "50%", "--json")[1])["proposal"]
    text = weighted_vee.read_text().replace(
        "outer_radius_mm = 60.0", f"outer_radius_mm = {weights['outer_radius_mm']:g}", 1
    )
    shaft = "[[engine.arrangement.balancer_shaft]]\norder = 2\nturns = 'with'\n"
    assert shaft in text
    weighted_vee.write_text(text.replace(shaft, ""))
    assert "of order 1" not in run(capsys, str(weighted_vee))[1].splitlines()[1].partition("moment")[0]
    code, out, _ = run(capsys, str(weighted_vee), "--propose", "60%", "--report", str(page))
    found = json.loads(run(capsys, str(weighted_vee), "--propose", "60%", "--json")[1])
    force = {(e["state"], e["order"]): e["force_N"] for e in found["free"]}
    made = force["with counterweights", 1]
    scene = load_scene(str(weighted_vee))
    oscillating = scene.engine.reciprocating_kg * 1e-3 * scene.throw.radius_mm * (2100 * math.pi / 30) ** 2
    assert made == pytest.approx(2 * 0.1 * oscillating, rel=2e-2)
    assert force["with counterweights", 2] == force["as it is", 2] > made
    told = re.search(r"With counterweights: free force of order 1 from [\d.]+ to ([\d.]+) N", out)
    assert (code, float(told[1])) == (0, pytest.approx(made, rel=1e-3))
    card = r'<div class="(\w+)"><dt>Free force</dt>.*?<dd class="note">([^<]*)<'
    status, note = re.search(card, page.read_text(encoding="utf-8")).groups()
    assert status == "bad"
    assert re.search(rf"; order 1 from [\d.]+ to {told[1]}\sN", note)


DRILLED = """
[[throw.drilling]]
diameter_mm = 5.0
web = "first"
from = {on = "main_journal", angle_deg = 170.0, place_mm = 3.0}
to = {on = "crankpin", angle_deg = 10.0, place_mm = 0.0}
"""


@pytest.mark.parametrize(
    ("key", "value", "before", "copy"),
    [
        (
            "throw.drilling[0].web",
            DRILLED,
            "[web]",
            "throw.drilling[0].web = 'both', or without that drilling",
        ),
        (
            "throw.second_main_journal_length_mm",
            "second_main_journal_length_mm = 50.0",
            "[throw.main_journal]",
            "two equal halves",
        ),
    ],
)
def test_a_proposal_needs_equal_halves_and_says_so(capsys, tmp_path, key, value, before, copy):
    """The command itself takes the design."""
    design = tmp_path / "d.toml"
    design.write_text(MIKRON.replace(before, f"{value}\n{before}"))
    assert run(capsys, str(design))[0] == 0
    code, _, err = run(capsys, str(design), "--propose", "50%")
    assert code == 3
    assert f"{key}: the halves of the throw differ, and --propose sizes one counterweight" in err
    assert f"Propose on a copy of the design with {copy}. Without --propose, balance takes" in err
    assert "Taken by" not in err


@pytest.mark.slow
def test_a_proposal_that_finds_no_place_says_so(capsys, tmp_path):
    page = tmp_path / "b.html"
    code, out, _ = run(capsys, "car-diesel", "--propose", "50%", "--report", str(page))
    assert code == 0
    first = '<div class="bad"><dt>Proposed counterweight</dt><dd class="value">does not fit</dd>'
    text = page.read_text(encoding="utf-8")
    assert 0 < text.index(first) < text.index("<dt>Free force</dt>")
    refused = "The proposed counterweight does not fit: web.counterweight.outer_radius_mm = 86.11"
    assert out.splitlines()[1].startswith(refused), "before what counterweights would do"
    assert text.index(refused) < text.index("with counterweights")
    assert '<div class="good">' not in text, "nothing is good with what does not fit"
    assert "with counterweights, which do not fit: " in text
    assert out.index("Nor does one with another half-angle") < out.index("[web.counterweight]")
    assert run(capsys, "car-diesel", "--propose", "20%", "--json")[0] == 0


def test_what_counterweights_make_worse_comes_first(capsys, tmp_path):
    page = tmp_path / "b.html"
    assert run(capsys, "industrial-gas", "--report", str(page))[0] == 0
    text = page.read_text(encoding="utf-8")
    cards = r'<div class="(\w+)"><dt>([^<]*)</dt><dd class="value">[^<]*</dd><dd class="note">([^<]*)<'
    answers = re.findall(cards, text)
    assert answers[0][:2] == ("bad", "Largest load, main bearing 2")
    assert re.fullmatch(r"with counterweights: [\d,]+\sN, \+2\.1\s%", answers[0][2])


def test_a_share_that_nothing_can_balance_is_refused(capsys, weighted_vee):
    code, _, err = run(capsys, "opposed-piston", "--propose", "50%")
    assert (code, "engine.masses" in err) == (3, True)
    text = weighted_vee.read_text()
    weighted_vee.write_text(text.replace("half_angle_deg = 70.0", "half_angle_deg = 5.0"))
    assert json.loads(run(capsys, str(weighted_vee), "--propose", "99%", "--json")[1])["proposal"][
        "own_angle_refused"
    ] == ("no outer radius balances so much")
    weighted_vee.write_text(
        text.replace("half_angle_deg = 70.0", "half_angle_deg = 70.0\nthickness_mm = 1.0")
    )
    code, _, err = run(capsys, str(weighted_vee), "--propose", "99%")
    assert (code, "--propose 99%: no outer radius" in err, "a thicker counterweight" in err) == (
        3,
        True,
        True,
    )


def pasted(text, out):
    """The design with the tables that `--propose` prints; it has none of them."""
    lines = out[out.index("[web.counterweight]") :].split("\n\n")[0]
    assert not re.search(r"^\[(web\.counterweight|engine\.arrangement)\]", text, re.MULTILINE)
    return f"{text}\n{lines}\n"


@pytest.mark.parametrize("percent", [pytest.param(0, marks=pytest.mark.slow), 50])
def test_what_a_proposal_prints_makes_both_commands_agree(capsys, tmp_path, percent):
    """A single without a counterweight: `loads` called the pasted one too heavy by the oscillating share."""
    single = MIKRON[: MIKRON.index("[envelope]")].replace("cylinders = 4", "cylinders = 1")
    design = tmp_path / "single.toml"
    design.write_text(single.replace("[1, 3, 4, 2]", "[1]"))
    code, out, _ = run(capsys, str(design), "--propose", f"{percent}%")
    assert (code, "does not fit" in out) == (0, False)
    design.write_text(pasted(design.read_text(), out))
    scene = load_scene(str(design))
    assert scene.engine.arrangement.balanced_oscillating_share == percent / 100
    found = json.loads(run(capsys, str(design), "--json")[1])
    own = found["counterweights"][0]["own_kg_mm"]
    assert all(weight["unbalance_kg_mm"] < 2e-3 * own for weight in found["counterweights"])
    assert found["balance_factor_percent"] == pytest.approx(percent, abs=0.05)
    assert main(["loads", str(design)]) == 0
    assert "counterweights as needed, inertia" in capsys.readouterr().out
    assert told_of_counterweights(capsys, design) == ("as needed", "as needed")
    force = {
        state: max(e["force_N"] for e in found["free"] if (e["state"], e["order"]) == (state, 1))
        for state in ("as it is", "with counterweights")
    }
    assert force["as it is"] == pytest.approx(force["with counterweights"], rel=2e-3)
    oscillating = scene.engine.reciprocating_kg * 1e-3 * scene.throw.radius_mm * (2100 * math.pi / 30) ** 2
    assert force["as it is"] == pytest.approx(oscillating * max(percent, 100 - percent) / 100, rel=2e-3)


def told_of_counterweights(capsys, design):
    """Words of the terminal on the counterweights of each throw, and the card of the page."""
    page = design.parent / "b.html"
    code, out, _ = run(capsys, str(design), "--report", str(page))
    assert code == 0
    text = typed_page(page)
    line = re.search(r"Counterweights of each throw: (.*)\.\n", out)
    card = re.search(r'Counterweights of a throw</dt><dd class="value">(.*?)</dd>', text)
    assert line is None or f"Counterweights of each throw: {line[1]}." in text
    return line and line[1], card[1]


@pytest.mark.parametrize("layout", [pytest.param("in line", marks=pytest.mark.slow), "V"])
def test_too_heavy_counterweights_are_told_as_too_heavy(capsys, tmp_path, weighted_vee, layout):
    """By as much as `loads` tells; a counterweight that lacks something is a bare number, as ever."""
    design, angle = tmp_path / "heavy.toml", "half_angle_deg = 70.0"
    text = MIKRON[: MIKRON.index("[envelope]")].replace("[material]", f"{BALANCED}[material]", 1)
    text = weighted_vee.read_text() if layout == "V" else text
    design.write_text(text.replace("outer_radius_mm = 60.0", "outer_radius_mm = 95.0"))
    line, card = told_of_counterweights(capsys, design)
    assert line == card
    assert main(["loads", str(design)]) == 0
    of_loads = re.search(r"too heavy by ([\d.]+) kg mm", capsys.readouterr().out)
    assert float(re.fullmatch(r"too heavy by ([\d.]+) kg mm", card)[1]) == pytest.approx(
        float(of_loads[1]), rel=1e-3
    )
    design.write_text(text.replace(angle, "half_angle_deg = 20.0"))
    line, card = told_of_counterweights(capsys, design)
    assert line is None
    assert re.fullmatch(r"[\d.]+ kg mm", card)


def test_throws_whose_counterweights_differ_are_told_apart():
    """The first throw has too much, the second lacks something, the third has what it needs."""
    data = balance_result(engine_balance("mikron-iiic-plain"))
    directions = dict(enumerate(data.arrangement.throw_angles_deg, start=1))
    of_throws = {1: (3.0, 0.0), 2: (2.0, 180.0), 3: (0.01, 0.0), 4: (0.01, 180.0)}
    webs = tuple(
        replace(
            one,
            own_kg_mm=40.0,
            unbalance_kg_mm=of_throws[one.throw][0],
            deg=directions[one.throw] + of_throws[one.throw][1],
        )
        for one in data.counterweights
    )
    told = counterweight_words(data.model_copy(update={"counterweights": webs}))
    assert told == (
        "Counterweights: throw 1 too heavy by 6 kg mm; throw 2 4 kg mm needed beyond what it has; "
        "throws 3 and 4 as needed."
    )


def test_another_half_angle_is_proposed_where_that_of_the_web_does_not_fit(capsys, tmp_path):
    """With 60 deg the radius would be 68.71 mm, with 90 deg 65.66 mm: the room is 66.2 mm."""
    design = tmp_path / "low.toml"
    low = re.sub(r"y_min_mm = .*", "y_min_mm = -66.2", MIKRON)
    low = re.sub(r"half_width_mm = .*", "half_width_mm = 70.0", low)
    design.write_text(low)
    page = tmp_path / "b.html"
    code, out, _ = run(capsys, str(design), "--propose", "0%", "--report", str(page))
    assert (code, "for the rotating masses alone" in out) == (0, True)
    room = r"room with the half-angle of the web<"
    assert re.search(rf"{room}.*outer_radius_mm = 68.71", page.read_text("utf-8"))
    assert re.search(r"half-angle of the web .* does not fit: .*outer_radius_mm = 68.71", out)
    design.write_text(pasted(design.read_text(), out))
    found = load_scene(str(design), whole=True).web.counterweight
    assert 65.66 < found.outer_radius_mm < 66.2
    told = "Balance factor of each throw as it is: 0.0 % of its oscillating mass.\n"
    code, out, _ = run(capsys, str(design))
    assert (found.half_angle_deg, code) == (80.0, 0)
    assert told in out, "-0.02 % are 0 %, and what is asked for"
    assert main(["loads", str(design)]) == 0
    assert "balance factor 0.0 % of the oscillating mass" in capsys.readouterr().out
    assert run(capsys, str(design), "--propose", "0%", "--report", str(page))[0] == 0
    text = page.read_text(encoding="utf-8")
    assert "balances the rotating masses alone" in text
    row = re.search(r"balanced share of the oscillating mass<.*?([-\d.]+)\W%", text)
    assert row[1] == "0.0"
    assert "room with the half-angle of the web" not in text, "it has 80 deg now"


@pytest.mark.parametrize("share", ["-1%", "101%", "half"])
def test_a_share_that_is_none_is_wrong_use(capsys, share):
    code, out, err = run(capsys, "car-diesel", f"--propose={share}")
    assert (code, out, len(err.splitlines())) == (2, "", 1)


def test_counterweights_for_an_assumed_engine_say_so(capsys, tmp_path):
    """The opposed-piston design names neither its cylinders nor its moving masses."""
    code, out, _ = run(capsys, "opposed-piston", "--report", str(tmp_path / "b.md"))
    told = "one cylinder, which is assumed; without piston and rod, whose masses are not given"
    assert (code, told in out, told in (tmp_path / "b.md").read_text()) == (0, True, True)
    assert "assumed" not in run(capsys, "mikron-iiic-plain")[1]


BARRED = """
[[web.bevel]]
face = "pin"
y_mm = 5.0
depth_mm = 12.0
draft_deg = 5.0
"""


def test_a_web_that_bars_every_counterweight_is_told_so(capsys, tmp_path):
    """A bevel at the counterweight's end takes its material, whatever its radius; it was told as too thin."""
    from cranktopo.design.loading import design_text

    design = tmp_path / "barred.toml"
    text = design_text("mikron-iiic-plain").replace("[material]", f"{BARRED}\n[material]", 1)
    design.write_text(text)
    told = "web.bevel[0]: bevels the main journal's end of the web"
    code, out, err = run(capsys, str(design), "--propose", "50%")
    assert (code, told in out + err) in ((0, True), (3, True))
    assert "draft" not in out + err
    assert "thicker" not in out + err
    design.write_text(
        text.replace(BARRED, "[web.counterweight]\nouter_radius_mm = 70.0\nhalf_angle_deg = 60.0\n" + BARRED)
    )
    code, _, err = run(capsys, str(design))
    assert code == 3
    assert f"{told}, where web.counterweight is. Remove web.bevel[0], or leave" in err


def test_the_card_of_bearings_compares_the_largest_loads_and_names_what_rises() -> None:
    """Of a six whose middle bearing is relieved by a third, while the largest of all falls by a percent."""
    angle = np.zeros(1)

    def loads(*sizes: float) -> LoadedMainBearings:
        return LoadedMainBearings(angle, np.array(sizes, dtype=complex)[:, None], gas=True)

    fact = _bearing_fact(loads(400.0, 700.0, 400.0), loads(600.0, 500.0, 690.0), True)
    assert fact.label == "Largest load, main bearing 2"
    assert "690 N, -1.4 %, main bearing 3; main bearings 1, 3: up to +72.5 %" in fact.note.replace(
        "\u00a0", " "
    )
    assert fact.status == "neutral"


def test_room_that_nothing_tells_is_not_a_yes(capsys, tmp_path, weighted_vee):
    page = tmp_path / "balance.html"
    code, out, _ = run(capsys, str(weighted_vee), "--propose", "60%", "--report", str(page))
    assert (code, room_words(load_scene(str(weighted_vee)))) == (0, "")
    assert "Room for the counterweight: not known, as [envelope.clearance]" in out
    assert "neither piston skirt nor crankcase" in page.read_text()
    assert room_words(load_scene("car-diesel")).endswith("mm to the crankcase")


def test_no_place_is_not_a_counterweight_that_lies_within_the_web(capsys, tmp_path):
    """A racing twin's design space ends just below the web: what reaches beyond the web has no place."""
    design = tmp_path / "twin.toml"
    size = "--bore-mm 100 --stroke-mm 63.6 --speed-rpm 11500 --peak-pressure-MPa 9 --rod-length-mm 118"
    assert main(["designs", "new", str(design), "--layout", "V", "--cylinders", "2", *size.split()]) == 0
    capsys.readouterr()
    code, _, err = run(capsys, str(design), "--propose", "50%")
    assert code == 3
    assert "no counterweight has a place" in err
    assert "reaches beyond the design space" in err
    assert "adds nothing" not in err
