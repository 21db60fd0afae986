"""The commands `loads` and `plan` as a user runs them."""

import csv
import json
import math
import re
from pathlib import Path

import numpy as np
import pytest
from matplotlib.figure import Figure

from cranktopo.app.main import main
from cranktopo.design.loading import designs_folder, load_scene
from cranktopo.engine.analysis import analyse
from cranktopo.engine.forces import INERTIA_EFFECTS
from cranktopo.engine.gas import pressure_curve
from cranktopo.tasks.loads.plot import PANELS
from cranktopo.tasks.loads.section import loads_section
from cranktopo.tasks.vibration.stage import shaft_vibration
from tests.engine_arrangements import VEE, arranged
from tests.hostile.scenes import dumped

CURVES = [
    "gas_force_N",
    "inertia_force_N",
    "small_end_force_N",
    "rod_force_N",
    "side_force_N",
    "tangential_force_N",
    "radial_force_N",
    "torque_Nm",
    "main_journal_force_N",
]


def run(capsys, *args):
    code = main(list(args))
    out = capsys.readouterr()
    return code, out.out, out.err


@pytest.mark.parametrize("command", ["loads", "plan"])
def test_warnings_are_told_to_those_who_want_no_notes(command, tmp_path, capsys):
    """A peak far after top dead centre; what is assumed is a note."""
    text = (designs_folder() / "mikron-iiic-plain.toml").read_text(encoding="utf-8")
    path = tmp_path / "late.toml"
    path.write_text(re.sub("peak_angle_deg = .*", "peak_angle_deg = 40.0", text), encoding="utf-8")
    told = run(capsys, command, str(path))[2]
    code, _, quiet = run(capsys, command, str(path), "-q")
    assert code == 0
    warnings = [line for line in told.splitlines() if line.startswith("warning: ")]
    assert "the pressure is largest 40 deg after firing" in warnings[0]
    assert quiet.splitlines() == warnings


def test_loads_json_has_the_contract_keys(capsys):
    code, out, err = run(capsys, "loads", "mikron-iiic-plain", "--json")
    loads = json.loads(out)
    assert (code, err) == (0, "")
    assert loads["schema_version"] == 1
    assert (loads["design"], loads["speed_rpm"], loads["cycle_deg"]) == ("mikron-iiic-plain", 2100.0, 720.0)
    assert loads["points"] == 2880
    for name in CURVES:
        for end in ("max", "min"):
            assert set(loads["extremes"][name][end]) == {"value", "deg"}
            assert 0 <= loads["extremes"][name][end]["deg"] < 720
        assert loads["extremes"][name]["max"]["value"] > loads["extremes"][name]["min"]["value"]
    assert {"mean", "max", "min"} <= set(loads["engine_torque_Nm"])
    assert {"rotating_unbalance_kg_mm", "inertia_kg_mm2", "counterweight_kg_mm"} <= set(loads["balance"])
    keys = {"name", "kind", "radial_N", "tangential_N", "torque_Nm", "speed_rpm", "from"}
    assert all(set(case) == keys for case in loads["load_cases"])
    assert [case["name"] for case in loads["load_cases"]][:2] == ["bending", "torsion"]
    assert {"name", "state", "reason", "estimate_percent", "cost"} <= set(loads["effects"][0])


def test_loads_table_explains_redundant_states(capsys):
    code, out, _ = run(capsys, "loads")
    assert code == 0
    assert re.search(r"gas force +N +35857 +11 +-95\.0 +380", out)
    piston_kg = load_scene("mikron-iiic").engine.masses.piston_group_kg
    largest = piston_kg * 0.048 * (2100 * math.pi / 30) ** 2 * (1 + 48 / 166)
    assert re.search(rf"inertia force of piston +N +815\.5 +153 +-{largest:.1f} +0", out), (
        "the rod is not in it"
    )
    assert "min_torque: -0.200 times max_torque" in out
    assert "acceleration 1.00 %" in out


def test_speed_sweep(capsys):
    code, out, _ = run(capsys, "loads", "--speed", "1000:2800:200")
    rows = out.strip().splitlines()
    assert code == 0
    parts = [row.split() for row in rows if re.match(r" *\d", row)]  # folded into two tables
    assert [part[0] for part in parts] == 2 * [str(n) for n in range(1000, 2801, 200)]
    assert re.search(r"small end +piston inertia +web max +web min +tangential", out)
    inertia = {int(part[0]): float(part[2]) for part in parts[:10]}
    pull = [float(part[4]) for part in parts[:10]]
    assert pull == sorted(pull, reverse=True)  # it grows with the speed
    assert inertia[2000] == pytest.approx(4 * inertia[1000], abs=0.5)


def test_sweep_json_csv_and_plot(capsys, tmp_path):
    table, picture = tmp_path / "c.csv", tmp_path / "p.png"
    args = ("loads", "--speed", "1000:1400:200", "--json", "--csv", str(table), "--plot", str(picture))
    code, out, _ = run(capsys, *args)
    loads = json.loads(out)
    assert code == 0
    assert [entry["speed_rpm"] for entry in loads["sweep"]] == [1000.0, 1200.0, 1400.0]
    assert loads["speed_rpm"] == 1000.0
    with table.open() as file:
        rows = list(csv.DictReader(file))
    assert len(rows) == 3 * 2880
    assert {"speed_rpm", "angle_deg", "pressure_MPa", "torque_behind_throw_4_Nm", *CURVES} <= set(rows[0])
    last = [float(row["tangential_force_N"]) for row in rows if row["speed_rpm"] == "1400"]
    assert max(last) == pytest.approx(
        loads["sweep"][2]["extremes"]["tangential_force_N"]["max"]["value"], rel=1e-6
    )
    assert picture.read_bytes().startswith(b"\x89PNG")


def test_mean_pressure_power_and_the_pistons_motion(capsys, tmp_path):
    """Work over swept volume, work a second, and the textbook's speeds; the curves are in the CSV."""
    table = tmp_path / "c.csv"
    _, out, _ = run(capsys, "loads", "mikron-iiic-plain", "--json", "--csv", str(table))
    loads = json.loads(out)
    swept = math.pi / 4 * 0.095**2 * 0.096
    work = loads["indicated_work_per_cylinder_J"]
    assert loads["indicated_mean_pressure_MPa"] * 1e6 == pytest.approx(work / swept, rel=1e-12)
    assert loads["indicated_power_kW"] == pytest.approx(4 * work * 2100 / 120 / 1000, rel=1e-12)
    mean_torque = loads["engine_torque_Nm"]["mean"]
    assert loads["indicated_power_kW"] == pytest.approx(mean_torque * 2100 * math.pi / 30 / 1000, rel=1e-4)
    piston, rw, lam = loads["piston"], 0.048 * 2100 * math.pi / 30, 48 / 166
    assert (piston["stroke_mm"], piston["mean_speed_m_per_s"]) == (96.0, pytest.approx(2 * rw / math.pi))
    assert piston["acceleration_m_per_s2"]["max"] == {
        "value": pytest.approx(rw**2 / 0.048 * (1 + lam)),
        "deg": 0,
    }
    with table.open() as file:
        rows = list(csv.DictReader(file))
    speed, way = (
        [float(row[f"piston_{key}"]) for row in rows] for key in ("speed_m_per_s", "displacement_mm")
    )
    assert max(speed) == pytest.approx(piston["speed_m_per_s"]["max"]["value"], rel=1e-6)
    assert max(way) == pytest.approx(96.0)
    step_s = 0.25 / 360 / 2100 * 60
    assert (way[300] - way[298]) / 1000 / (2 * step_s) == pytest.approx(speed[299], rel=1e-4)
    _, out, err = run(capsys, "loads", "mikron-iiic-plain")
    assert "indicated mean pressure 1.078 MPa, power of the engine 51.3 kW" in out
    assert "mean speed 6.72 m/s, largest 10.99 m/s at 75 deg" in out
    assert (loads["warnings"], "warning" in err) == ([], False)


@pytest.fixture
def traced(tmp_path):
    """The Mikron with its own pressure as a measured trace, late by some degrees."""

    def write(late_deg, ratio="compression_ratio = 8.0", offset_MPa=0.0, factor=1.0):
        curve = pressure_curve(load_scene("mikron-iiic-plain"))
        pressure = np.interp(curve.angle_deg - late_deg, curve.angle_deg, curve.pressure_MPa, period=720.0)
        pressure = factor * pressure + offset_MPa
        rows = np.column_stack([curve.angle_deg, pressure])
        np.savetxt(
            tmp_path / "t.csv", rows, delimiter=",", header="crank_angle_deg,pressure_MPa", comments=""
        )
        text = (designs_folder() / "mikron-iiic-plain.toml").read_text()
        start, end = text.index("[engine.gas]"), text.index("[engine.masses]")
        design = tmp_path / "traced.toml"
        gas = f"[engine.gas]\nindicator_csv = 't.csv'\nambient_pressure_MPa = 0.10133\n{ratio}\n"
        design.write_text(text[:start] + gas + text[end:])
        return str(design)

    return write


@pytest.mark.parametrize(
    ("late_deg", "told"),
    [
        (0.0, []),
        (10.0, ["exponent 1.16, where gas has 1.2 to 1.45: the trace is late"]),
        (-10.0, ["exponent 1.46, where gas has 1.2 to 1.45: the trace is early"]),
        (360.0, ["largest 349 deg before firing top dead centre, which is 0 deg; an engine that fires has"]),
        (22.0, ["largest 33 deg after firing top dead centre", "mean pressure of 1.85 MPa", "exponent"]),
        (-15.0, ["largest 4 deg before firing top dead centre", "exponent"]),
    ],
)
def test_a_trace_at_wrong_angles_is_warned_of(capsys, traced, late_deg, told):
    code, out, err = run(capsys, "loads", traced(late_deg), "--json")
    warnings = json.loads(out)["warnings"]
    assert code == 0
    assert len(warnings) == len(told)
    for line, part in zip(warnings, told, strict=True):
        assert part in line
        assert f"warning: mikron-iiic-plain: {line}" in err


@pytest.mark.parametrize(
    ("offset_MPa", "told"),
    [
        (
            -0.085,
            ["0.00293 MPa before compression, less than any engine (0.02 MPa): its pressures are gauge"],
        ),
        (
            -0.055,
            ["no engine has more than 20 times: are the trace's pressures gauge", "are too low (they must"],
        ),
        (-0.02, []),
        (0.1, ["exponent 1.00, where gas has 1.2 to 1.45: the trace is late by some degrees"]),
    ],
)
def test_offset_pressures_of_a_trace_are_named(capsys, traced, offset_MPa, told):
    """And never the intake pressure, which a trace does not take."""
    warnings = json.loads(run(capsys, "loads", traced(0.0, offset_MPa=offset_MPa), "--json")[1])["warnings"]
    assert len(warnings) == len(told)
    assert all(part in line for line, part in zip(warnings, told, strict=True))
    assert not any("intake_pressure" in line for line in warnings)


def test_pressures_in_another_unit_than_the_header_says_are_named(capsys, traced):
    """A factor leaves the exponent of the compression; adding the ambient pressure would not mend it."""
    warnings = json.loads(run(capsys, "loads", traced(0.0, factor=0.1), "--json")[1])["warnings"]
    assert any("too low by a factor; check the unit in the header" in line for line in warnings)
    assert not any("ambient" in line for line in warnings)


def test_a_trace_that_counts_from_gas_exchange_is_told_the_key_and_its_value(capsys, traced):
    """The exponent, which would call the same trace early, is not told beside it."""
    (warning,) = json.loads(run(capsys, "loads", traced(360.0), "--json")[1])["warnings"]
    assert warning.endswith("write engine.gas.firing_deg = 360")
    for late_deg in (22.0, -15.0):
        told = json.loads(run(capsys, "loads", traced(late_deg), "--json")[1])["warnings"]
        assert told[0].endswith(": engine.gas.firing_deg says where the trace has firing top dead centre")


@pytest.mark.parametrize(
    ("late_deg", "firing_deg"),
    [
        (360.0, 360.0),
        (-15.0, 705.0),
        (4.25, 4.25),
        *(pytest.param(late, late, marks=pytest.mark.slow) for late in (22.0, 0.0)),
    ],
)
def test_firing_dead_centre_of_the_trace_gives_the_loads_of_the_same_trace_from_0_deg(
    capsys, traced, late_deg, firing_deg
):
    """And no warning."""
    loads = [
        json.loads(run(capsys, "loads", traced(*given), "--json")[1])
        for given in ((0.0,), (late_deg, f"compression_ratio = 8.0\nfiring_deg = {firing_deg}"))
    ]
    plain, shifted = (found["extremes"]["tangential_force_N"] for found in loads)
    assert shifted["max"]["deg"] == plain["max"]["deg"]
    assert shifted["max"]["value"] == pytest.approx(plain["max"]["value"], rel=1e-9)
    assert loads[1]["warnings"] == []
    assert ("t.csv, firing at its" in loads[1]["pressure_source"]) == bool(firing_deg)
    _, _, err = run(capsys, "loads", traced(0.0))
    assert "engine.gas.firing_deg = 0" in err


def test_the_value_counts_from_what_the_key_says_already(capsys, traced):
    (warning,) = json.loads(run(capsys, "loads", traced(10.0, "firing_deg = 370.0"), "--json")[1])["warnings"]
    assert "firing top dead centre, which is 370 deg; an engine" in warning
    assert warning.endswith("write engine.gas.firing_deg = 10")


def test_one_angle_serves_all_traces_of_a_map(capsys, traced):
    design = Path(traced(360.0, "compression_ratio = 8.0"))
    maps = "[[engine.gas.map]]\nrpm = 1000.0\nfile = 't.csv'\n[engine.masses]"
    text = (
        design.read_text()
        .replace("indicator_csv = 't.csv'", "firing_deg = 360.0")
        .replace("[engine.masses]", maps)
    )
    design.write_text(text)
    assert json.loads(run(capsys, "loads", str(design), "--json")[1])["warnings"] == []
    design.write_text(text.replace("firing_deg = 360.0\n", ""))
    (warning,) = json.loads(run(capsys, "loads", str(design), "--json")[1])["warnings"]
    assert warning.endswith("write engine.gas.firing_deg = 360")


def test_without_a_compression_ratio_only_peak_and_mean_pressure_are_judged(capsys, traced):
    (unchecked,) = json.loads(run(capsys, "loads", traced(10.0, ""), "--json")[1])["warnings"]
    assert "with engine.gas.compression_ratio they are compared" in unchecked
    assert len(json.loads(run(capsys, "loads", traced(22.0, ""), "--json")[1])["warnings"]) == 2


def test_a_charged_engine_without_its_intake_pressure_is_warned_of(capsys, tmp_path):
    """A medium-speed engine of 200 bar, with 4.5 bar before compression and without a word of it."""
    text = (designs_folder() / "industrial-gas.toml").read_text()
    gas = "[engine.gas]\npeak_pressure_MPa = 20.0\npeak_angle_deg = 12.0\ncompression_ratio = 15.0\n"
    start, end = text.index("[engine.gas]"), text.index("[engine.masses]")
    design = tmp_path / "marine.toml"
    for charged, expected in (("intake_pressure_MPa = 0.45\nexhaust_pressure_MPa = 0.35\n", 0), ("", 1)):
        design.write_text(text[:start] + gas + charged + text[end:])
        warnings = json.loads(run(capsys, "loads", str(design), "--json")[1])["warnings"]
        assert len(warnings) == expected
    assert "no engine has more than 20 times: give engine.gas.intake_pressure_MPa" in warnings[0]


def test_a_scene_with_peaks_only(capsys):
    _, out, _ = run(capsys, "loads", "opposed-piston", "--json")
    loads = json.loads(out)
    assert loads["extremes"]["gas_force_N"]["max"] == {"value": 85730.0, "deg": None}
    assert loads["extremes"]["torque_Nm"]["min"] == {"value": -684.4, "deg": None}
    assert loads["engine_torque_Nm"]["mean"] is None
    code, out, _ = run(capsys, "loads", "opposed-piston")
    assert code == 0
    assert "only peak loads" in out


def test_without_an_engine(capsys, tmp_path):
    text = (designs_folder() / "opposed-piston.toml").read_text()
    design = tmp_path / "d.toml"
    design.write_text(text[: text.index("[engine]")] + text[text.index("[envelope]") :])
    code, out, _ = run(capsys, "loads", str(design))
    assert code == 0
    assert "no engine, unit loads" in out
    code, out, _ = run(capsys, "loads", str(design), "--json")
    assert json.loads(out)["speed_rpm"] is None
    assert run(capsys, "loads", str(design), "--csv", str(tmp_path / "c.csv"))[0] == 3
    assert not (tmp_path / "c.csv").exists()


@pytest.mark.parametrize(
    "speed",
    ["fast", "3000rpm", "1000:2800", "2800:1000:200", "0:100:0", "-5", "1:2:1e-9", "nan", "1000:inf:10"],
)
def test_bad_speeds(capsys, speed):
    code, out, err = run(capsys, "loads", f"--speed={speed}")
    assert (code, out) == (2, "")
    assert f"'--speed': '{speed}': must be RPM or FROM:TO:STEP" in err
    assert len(err.splitlines()) == 1


def test_suffix_of_a_plot_in_capitals(capsys, tmp_path):
    assert run(capsys, "loads", "--plot", str(tmp_path / "a.PNG"))[0] == 0
    assert (tmp_path / "a.PNG").read_bytes().startswith(b"\x89PNG")


def test_bad_outputs(capsys, tmp_path):
    code, _, err = run(capsys, "loads", "--plot", str(tmp_path / "a.xyz"))
    assert (code, "must end in .png" in err) == (2, True)
    assert run(capsys, "loads", "--plot", str(tmp_path / "no" / "a.png"))[0] == 2
    missing = tmp_path / "no" / "a.csv"
    assert run(capsys, "loads", "--csv", str(missing))[0] == 3
    assert run(capsys, "loads", "opposed-piston", "--plot", str(tmp_path / "a.png"))[0] == 3
    assert list(tmp_path.iterdir()) == []


def test_bad_indicator_is_one_line(capsys, tmp_path):
    text = (designs_folder() / "mikron-iiic-plain.toml").read_text()
    peak = "peak_pressure_MPa = 5.16\npeak_angle_deg = 11.0"
    design = tmp_path / "d.toml"
    design.write_text(text.replace(peak, 'indicator_csv = "p.csv"'))
    (tmp_path / "p.csv").write_text("angle_deg,pressure_bar\n0,1\n1,2\n1,3\n")
    for command in ("loads", "plan"):
        code, out, err = run(capsys, command, str(design))
        assert (code, out) == (3, "")
        assert "p.csv': line 4: angle 1 deg repeats" in err
        assert len(err.splitlines()) == 1


def test_plan_prints_every_effect(capsys):
    code, out, _ = run(capsys, "plan", "mikron-iiic-plain")
    assert code == 0
    assert re.search(r"^torsion +on +100 %", out, re.MULTILINE)
    assert re.search(r"^centrifugal +off +6\.42 %", out, re.MULTILINE)
    assert max(len(line) for line in out.splitlines()) < 150


def test_plan_json(capsys):
    code, out, _ = run(capsys, "plan", "--json")
    payload = json.loads(out)
    assert code == 0
    assert (payload["schema_version"], payload["design"], len(payload["effects"])) == (
        1,
        "mikron-iiic",
        15,
    )


def test_plan_warns_of_what_a_shaft_leaves_out(tmp_path, capsys):
    path, text = tmp_path / "mine.toml", (designs_folder() / "mikron-iiic-plain.toml").read_text()
    shaft = "[shaft]\npropeller = {inertia_kg_m2 = 0.6}\n"
    path.write_text(text.replace("[engine]\n", f"{shaft}[engine]\n"), encoding="utf-8")
    code, out, err = run(capsys, "plan", str(path))
    assert code == 0
    assert re.search(r"^torsional_vibration +on ", out, re.MULTILINE)
    assert "warning: shaft.flywheel is missing: the propeller alone" in err
    assert "shaft.throw_loss_factor = 0.02" in err


def test_curves_of_one_web_of_two_say_whose_they_are(capsys, tmp_path):
    """Of two rods on a pin each web feels the nearer one more: table, file and plot have both."""
    scene = arranged(VEE + "throw_angles_deg = [0.0]", 2, (1, 2))
    data = scene.model_dump(mode="json", by_alias=True, exclude_none=True)
    (tmp_path / "twin.toml").write_text(dumped(data), encoding="utf-8")
    code, _, err = run(
        capsys,
        "loads",
        str(tmp_path / "twin.toml"),
        "--csv",
        str(tmp_path / "c.csv"),
        "--plot",
        str(tmp_path / "p.svg"),
    )
    place = analyse(scene).cycle.place
    assert code == 0
    assert place in ("web 1 of throw 1", "web 2 of throw 1")
    assert f"those of {place}, where the force on the web is largest" in err
    plotted = (tmp_path / "p.svg").read_text(encoding="utf-8")
    assert all(f"radial, web {number} of throw 1" in plotted for number in (1, 2))
    columns = np.genfromtxt(tmp_path / "c.csv", delimiter=",", names=True)
    radial, cycle = analyse(scene).cycle.extreme("radial_force_N")[0], analyse(scene).cycle
    other = columns[f"radial_force_{radial.place.replace(' ', '_')}_N"]
    assert other.max() == pytest.approx(radial.value, rel=1e-6)
    assert columns["web_force_N"] == pytest.approx(cycle.forces.web_force_N, rel=1e-6, abs=1e-3)
    alike = run(capsys, "loads", "mikron-iiic", "--csv", str(tmp_path / "m.csv"))[2]
    assert "place in their name" not in alike


@pytest.mark.slow
def test_the_torque_of_a_vibrating_shaft_is_called_by_its_section_and_speed(tmp_path: Path) -> None:
    """Its curve swings as `vibration` has it between the last throw and what follows, not as the engine's."""
    design = tmp_path / "turning.toml"
    text = (designs_folder() / "mikron-iiic-plain.toml").read_text(encoding="utf-8")
    shaft = "[shaft]\nthrow_stiffness_Nm_per_rad = 1.5e5\n[shaft.propeller]\ninertia_kg_m2 = 0.6\n"
    design.write_text(f"{text}\n{shaft}", encoding="utf-8")
    scene, study = load_scene(design), shaft_vibration(design)
    own = list(study.response.speeds_rpm).index(2100.0)
    assert study.shaft.sections[3] == "throw 4 - propeller"
    for effects, name in (
        (INERTIA_EFFECTS, "engine, 4 cylinders"),
        (INERTIA_EFFECTS | {"torsional_vibration"}, "behind throw 4 of the vibrating shaft, 2100 rpm"),
    ):
        analysis = analyse(scene, effects)
        axes = Figure().subplots()
        PANELS[2](axes, analysis)
        (curve,) = (line for line in axes.lines if line.get_label() == name)
        swing = float(np.ptp(np.asarray(curve.get_ydata()))) / 2
        vibrating = swing == pytest.approx(study.response.torque_amplitude_Nm[own, 3], rel=1e-6)
        assert vibrating == ("vibrating" in name)
        assert name in loads_section(analysis, ()).pictures[2].alt
