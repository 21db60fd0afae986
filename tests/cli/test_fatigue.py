"""`cranktopo fatigue`: its mistakes, its JSON and its files."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import meshio
import numpy as np
import pytest

from cranktopo.app.main import main
from cranktopo.base.errors import CranktopoError
from cranktopo.design.loading import designs_folder, load_scene
from cranktopo.runs.directories import create_run
from cranktopo.tasks.throw_fatigue import stage
from cranktopo.tasks.throw_fea.targets import Target, resolve_targets

MIKRON = (designs_folder() / "mikron-iiic-plain.toml").read_text(encoding="utf-8")
NO_DATA = 'name = "31CrMoV9"'
PLAIN = 'name = "plain"\nE_GPa = 210.0\npoisson = 0.3\ndensity_kg_m3 = 7850.0'
STEEL = PLAIN.replace("plain", "tensile strength alone") + "\nultimate_MPa = 900.0"


def design(tmp_path: Path, *changes: tuple[str, str]) -> str:
    text = MIKRON
    for old, new in changes:
        assert old in text
        text = text.replace(old, new)
    path = tmp_path / "changed.toml"
    path.write_text(text, encoding="utf-8")
    return str(path)


def without_engine() -> tuple[tuple[str, str], ...]:
    table = MIKRON[MIKRON.index("[engine]") : MIKRON.index("# Design space")]
    return ((table, ""),)


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        (((NO_DATA, PLAIN),), ("material.fatigue_tension_MPa", "missing", "'plain'")),
        ((("fillet_mm = 2.5", "fillet_mm = 0.0"),), ("main_journal.fillet_mm = 0", "singular")),
        (without_engine(), ("engine: is missing", "unit loads")),
        ((('tangential = "off"', 'fillets = "off"'),), ("effects.fillets = 'off'", "'auto' or 'on'")),
        (
            ((NO_DATA, STEEL), ("fillet_mm = 2.5", "fillet_mm = 0.8")),
            ("material.fatigue_tension_MPa: is missing", "'lsa'"),
        ),
        (((NO_DATA, PLAIN), ("fillet_mm = 2.5", "fillet_mm = 0.0")), ("material.fatigue_tension_MPa",)),
    ],
    ids=["material", "fillet", "loads", "fillets left out", "small fillets", "material before fillets"],
)
def test_mistakes(
    capsys: pytest.CaptureFixture[str],
    tmp_path: Path,
    changes: tuple[tuple[str, str], ...],
    words: tuple[str, ...],
) -> None:
    if "fillets = " in changes[0][1]:
        changes = (*changes, ("[effects]", '[effects]\nfatigue = "off"'))
    assert main(["fatigue", design(tmp_path, *changes), "--json"]) == 3
    captured = capsys.readouterr()
    error = json.loads(captured.out)["error"]
    for word in words:
        assert word in error["message"] + " " + error["hint"]
    assert "Traceback" not in captured.err


@pytest.mark.parametrize("method", ["fkm", "m53"])
def test_each_method_names_what_it_needs(
    capsys: pytest.CaptureFixture[str], tmp_path: Path, method: str
) -> None:
    assert main(["fatigue", design(tmp_path, (NO_DATA, PLAIN)), "--method", method]) == 3
    captured = capsys.readouterr()
    assert captured.out == ""
    assert "material.ultimate_MPa" in captured.err
    assert f"'{method}'" in captured.err


@pytest.mark.parametrize("method", ["findley", "dang_van"])
def test_methods_of_planes_name_what_they_need(
    capsys: pytest.CaptureFixture[str], tmp_path: Path, method: str
) -> None:
    assert main(["fatigue", design(tmp_path, (NO_DATA, PLAIN)), "--method", method]) == 3
    assert f"fatigue_tension_MPa: is missing, method '{method}' needs it" in capsys.readouterr().err
    weak = f"{NO_DATA}\nfatigue_torsion_MPa = 200.0"
    assert main(["fatigue", design(tmp_path, (NO_DATA, weak)), "--method", method]) == 3
    error = " ".join(capsys.readouterr().err.split())
    assert "material.fatigue_torsion_MPa = 200.0: must be at least half of fatigue_bending_MPa" in error


def test_a_shaft_is_judged_by_local_stresses_alone(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["shaft", "mikron-iiic-plain", "--method", "findley"]) == 2
    assert "'findley' is none of lsa, fkm." in capsys.readouterr().err


@pytest.mark.parametrize("effects", ["", 'fatigue = "on"'], ids=["auto", "on"])
@pytest.mark.parametrize(
    "command",
    ["fatigue {} --method fkm", "fatigue {} --method m53", "compare {} --baseline {} --fatigue fkm"],
)
def test_small_fillets_stay_where_the_method_needs_no_fatigue_strength(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, command: str, effects: str
) -> None:
    """Fillets of 0.8 mm change the stiffness by less than the threshold, so the plan leaves them out."""
    met = []

    def solved(target: Target, *_: object, **__: object) -> None:
        met.append(target.scene.throw.crankpin.fillet_mm)
        raise CranktopoError("met.")

    monkeypatch.setattr("cranktopo.tasks.throw_fatigue.target_safety.solve_stresses", solved)
    monkeypatch.setattr("cranktopo.tasks.throw_fatigue.rule_check.solve_stresses", solved)
    path = design(
        tmp_path,
        (NO_DATA, STEEL),
        ("fillet_mm = 2.5", "fillet_mm = 0.8"),
        ("[effects]", f"[effects]\n{effects}"),
    )
    assert main(command.format(path, path).split()) == 3
    assert met == [0.8]


def test_two_methods_share_the_unit_loads(monkeypatch: pytest.MonkeyPatch) -> None:
    """Every target is meshed and solved once, and its shaft's stiffness is found once, for lsa and fkm."""
    solved, told, held = [], [], []

    def solve(target: Target, kinds: object, _: float, **__: object) -> str:
        solved.append((target.name, kinds))
        return f"model {target.name}"

    def judged(model: str, method: str, _: object) -> tuple[str, str]:
        told.append((model, method))
        return model, method

    def with_stiffness(target: Target) -> Target:
        held.append(target.name)
        return target

    monkeypatch.setattr("cranktopo.tasks.throw_fatigue.target_safety.solve_stresses", solve)
    monkeypatch.setattr("cranktopo.tasks.throw_fatigue.target_safety.safety_field", judged)
    monkeypatch.setattr(stage, "with_throw_stiffness", with_stiffness)
    monkeypatch.setattr(stage, "_note_fields", lambda *_: None)
    monkeypatch.setattr(
        "cranktopo.tasks.throw_fatigue.target_safety.least_field", lambda found: next(iter(found))
    )
    names = ["mikron-iiic-plain", "opposed-piston"]
    found = stage.assess_by_methods(resolve_targets(names, fillets=True, whole=True), ["lsa", "fkm"])
    assert [name for name, _ in solved] == held == names
    assert told == [(f"model {name}", method) for name in names for method in ("lsa", "fkm")]
    assert [one.method for one in found] == ["lsa", "fkm"]
    assert [one.fields for one in found] == [
        tuple((f"model {name}", method) for name in names) for method in ("lsa", "fkm")
    ]


def test_a_later_target_is_checked_before_the_first_is_solved(
    capsys: pytest.CaptureFixture[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def solved(*_: object) -> None:
        raise AssertionError("solved before the inputs were checked")

    monkeypatch.setattr("cranktopo.tasks.throw_fatigue.target_safety.solve_stresses", solved)
    sharp = design(tmp_path, ("fillet_mm = 2.5", "fillet_mm = 0.0"))
    assert main(["fatigue", "mikron-iiic-plain", sharp]) == 3
    assert "singular" in capsys.readouterr().err


@pytest.mark.parametrize("missing", ["gas", "torque"])
def test_peak_loads_must_be_given(capsys: pytest.CaptureFixture[str], tmp_path: Path, missing: str) -> None:
    gas = MIKRON[MIKRON.index("[engine.gas]") : MIKRON.index("[engine.masses]")]
    line = "max_torque_Nm = 500.0\n" if missing == "gas" else "max_gas_force_N = 30000.0\n"
    path = design(tmp_path, (gas, ""), ("strokes = 4\n", f"strokes = 4\n{line}"))
    assert main(["fatigue", path]) == 3
    key = "max_gas_force_N" if missing == "gas" else "max_torque_Nm"
    assert f"engine.{key}: is missing" in capsys.readouterr().err


def test_a_surface_has_no_fillets(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    scene = load_scene("mikron-iiic-plain").model_dump(mode="json")
    command = ["cranktopo", "optimise"]
    out = tmp_path / "run"
    create_run(
        design="mikron-iiic-plain", design_toml=MIKRON, scene=scene, options={}, command=command, out=out
    )
    (out / "web.stl").write_bytes(b"")
    assert main(["fatigue", str(out)]) == 3
    assert "no true fillets" in capsys.readouterr().err


def test_rule_has_no_field(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["fatigue", "mikron-iiic-plain", "--method", "m53", "--out", "x"]) == 2
    assert "--out" in capsys.readouterr().err


def test_a_file_is_no_folder_for_results(
    capsys: pytest.CaptureFixture[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def solved(*_: object) -> None:
        raise AssertionError("solved before the destination was checked")

    monkeypatch.setattr("cranktopo.tasks.throw_fatigue.target_safety.solve_stresses", solved)
    (tmp_path / "mine").write_text("mine", encoding="utf-8")
    for out in (tmp_path / "mine", tmp_path / "mine" / "folder"):
        assert main(["fatigue", "mikron-iiic-plain", "--out", str(out)]) == 3
        assert f"'{tmp_path / 'mine'}' is a file. Choose another --out." in capsys.readouterr().err


@pytest.mark.slow
def test_result_and_files(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    """A coarse mesh: the numbers agree with each other and with the files."""
    arguments = [
        "fatigue",
        "mikron-iiic-plain",
        "--fillet-fraction",
        "0.45",
        "--out",
        str(tmp_path),
        "--json",
    ]
    assert main(arguments) == 0
    captured = capsys.readouterr()
    assert "the mesh misses the checks of IACS UR M53" in captured.err
    result: dict[str, Any] = json.loads(captured.out)
    assert json.loads((tmp_path / "fatigue.json").read_text(encoding="utf-8")) == result
    (entry,) = result["fatigue"]
    critical = entry["critical"]
    assert entry["safety"] == critical["safety"] == pytest.approx(min(entry["fillet_safety"].values()))
    assert critical["fillet"] in ("pin", "journal")
    used = critical["amplitude_MPa"] / critical["strength_MPa"] + max(critical["mean_MPa"], 0) / 1100
    assert critical["safety"] == pytest.approx(1 / used)
    assert set(entry["unit_loads"]) == {"bending", "torsion", "centrifugal"}
    assert entry["judged_as"] == "throw_alone"
    mesh = meshio.read(tmp_path / "fatigue-lsa-mikron-iiic-plain.vtu")
    safety, on = mesh.point_data["safety"], mesh.point_data["fillet"] > 0.5
    assert safety[on].min() == pytest.approx(entry["safety"])
    at = mesh.points[on][safety[on].argmin()]
    assert np.linalg.norm(at - critical["point_mm"]) < 1e-6
    assert mesh.points[:, 2].max() == pytest.approx(114.0)
    assert (tmp_path / "fatigue-lsa-mikron-iiic-plain.png").stat().st_size > 20_000
