"""The commands `loads` and `plan` as a user runs them."""

import csv
import json
import re

import pytest

from cranktopo.app.main import main

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
    assert "min_torque: -0.200 times max_torque" in out
    assert "acceleration 1.00 %" in out


def test_speed_sweep(capsys):
    code, out, _ = run(capsys, "loads", "--speed", "1000:2800:200")
    rows = out.strip().splitlines()
    assert code == 0
    assert [row.split()[0] for row in rows[-10:]] == [str(n) for n in range(1000, 2801, 200)]
    inertia = {int(row.split()[0]): float(row.split()[2]) for row in rows[-10:]}
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
    from cranktopo.design.loading import designs_folder

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
    from cranktopo.design.loading import designs_folder

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
    assert re.search(r"^centrifugal +off +5\.78 %", out, re.MULTILINE)
    assert max(len(line) for line in out.splitlines()) < 150


def test_plan_json(capsys):
    code, out, _ = run(capsys, "plan", "--json")
    payload = json.loads(out)
    assert code == 0
    assert (payload["schema_version"], payload["design"], len(payload["effects"])) == (
        1,
        "mikron-iiic",
        14,
    )


def test_plan_warns_of_what_a_shaft_leaves_out(tmp_path, capsys):
    from cranktopo.design.loading import designs_folder

    path, text = tmp_path / "mine.toml", (designs_folder() / "mikron-iiic-plain.toml").read_text()
    shaft = "[shaft]\npropeller = {inertia_kg_m2 = 0.6}\n"
    path.write_text(text.replace("[engine]\n", f"{shaft}[engine]\n"), encoding="utf-8")
    code, out, err = run(capsys, "plan", str(path))
    assert code == 0
    assert re.search(r"^torsional_vibration +on ", out, re.MULTILINE)
    assert "warning: shaft.flywheel is missing: the propeller alone" in err
    assert "shaft.throw_loss_factor = 0.02" in err
