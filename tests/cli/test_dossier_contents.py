"""The dossier of the rule: engine, masses, shaft line, vibration, what is signed, and its PDF."""

from __future__ import annotations

import math
import re
from pathlib import Path

import pytest

from cranktopo.app.main import main
from cranktopo.base.errors import ExitCode
from cranktopo.design.engine import Gas
from cranktopo.design.loading import design_text, designs_folder, load_scene, parse_scene
from cranktopo.tasks.throw_fatigue.dossier_sections import engine_section
from cranktopo.tasks.vibration.stage import shaft_vibration
from tests.cli.test_rule_dossier import checked, row
from tests.physics.fea.test_two_webs import ACROSS, scene_with

SHAFT = """
[shaft]
throw_stiffness_Nm_per_rad = 1.5e5
cylinder_damping_Nms_per_rad = 1.5
[shaft.propeller]
inertia_kg_m2 = 0.6
"""


@pytest.fixture(autouse=True)
def no_solve(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("cranktopo.tasks.throw_fatigue.stage.check_rule", checked)


def dossier(tmp_path: Path, more: str, suffix: str = ".md") -> Path:
    design, path = tmp_path / "mine.toml", tmp_path / f"dossier{suffix}"
    text = (designs_folder() / "mikron-iiic-plain.toml").read_text(encoding="utf-8")
    treated = 'name = "31CrMoV9"\nheat_treatment = "quenched and tempered"'
    design.write_text(text.replace('name = "31CrMoV9"', treated) + more, encoding="utf-8")
    code = main(["fatigue", str(design), "--method", "m53", "--report", str(path), "--quiet"])
    assert code == ExitCode.CRITERION_NOT_MET
    return path


@pytest.mark.slow
def test_everything_that_a_reviewer_asks(tmp_path: Path) -> None:
    text = dossier(tmp_path, SHAFT).read_text(encoding="utf-8").replace("\\", "")
    assert row(text, "yield strength")[1] == "900 MPa"
    assert row(text, "heat treatment")[1] == "quenched and tempered"
    assert row(text, "firing order")[1] == "1-3-4-2"
    assert row(text, "maximum cylinder pressure (absolute)")[1] == "5.16 MPa"
    assert row(text, "piston group")[1].endswith(" kg")
    assert "inertia 0.6 kg m²" in row(text, "propeller")[1]
    assert row(text, "absolute damping of a cylinder")[1] == "1.5 N m s/rad"
    assert "## Torsional vibration" in text
    assert "## Critical speeds" in text
    assert _misfire_told(text) == pytest.approx(_misfire_computed(tmp_path / "mine.toml"), rel=1e-3)
    assert re.search(r"Document M53-mikron-iiic-plain-[0-9a-f]{8}\.", text)


def test_engine_data_of_the_design_and_unknown_for_what_it_does_not_give(tmp_path: Path) -> None:
    """Power by the mean pressure p V n / 2 of a four-stroke engine."""
    text = dossier(tmp_path, "").read_text(encoding="utf-8").replace("\\", "")
    swept_m3 = 4 * math.pi / 4 * 0.095**2 * 2 * load_scene("mikron-iiic-plain").throw.radius_mm / 1000
    (mean, _), (power, _) = (
        row(text, name)[1].split()
        for name in ("indicated mean pressure", "indicated power at rated speed, friction not taken off")
    )
    assert float(power) == pytest.approx(float(mean) * 1e3 * swept_m3 * 2100 / 120, rel=1e-3)
    assert row(text, "cylinder pressure over crank angle")[1].startswith("Wiebe combustion model")
    assert row(text, "compression ratio")[1] == "8 (given)"
    assert row(text, "charge-air pressure (intake, absolute)")[1] == "0.08793 MPa (given)"
    assert row(text, "pressure during exhaust (absolute)")[1].endswith("(assumed, ambient)")
    assert row(text, "burn duration")[1] == "60 deg (assumed)"
    assert "A load counts here by the stress that it makes; cranktopo loads and plan list the cases" in text
    for name in ("rated power", "sense of rotation, seen from the output end"):
        assert row(text, name)[1] == "unknown"


def test_every_value_of_the_gas_is_told_with_its_source_and_the_rated_power() -> None:
    """Burn duration, exhaust and intake were left out; rated power and rotation were unknown whatever."""
    text = design_text("mikron-iiic-plain")
    text = text.replace("[engine]\n", '[engine]\nrated_power_kW = 46.0\nrotation = "clockwise"\n')
    scene = parse_scene(text.replace("[engine.gas]\n", "[engine.gas]\nburn_duration_deg = 55.0\n"))
    rows = {str(one["what"]): str(one["value"]) for one in engine_section(scene, None).tables[0][1].rows}
    assert rows["rated power"] == "46 kW"
    assert rows["sense of rotation, seen from the output end"] == "clockwise"
    assert rows["burn duration"] == "55 deg (given)"
    assert rows["shape exponent of the Wiebe function"] == "2 (assumed)"
    assert scene.engine is not None
    assert scene.engine.gas is not None
    counted = set(type(scene.engine.gas).model_fields) - {
        "indicator_csv",
        "firing_deg",
        "map",
        "peak_pressure_MPa",
    }
    told = sum(value.endswith(("(given)", "(assumed)", "(assumed, ambient)")) for value in rows.values())
    assert told == len(counted), "every key of [engine.gas] that counts"


@pytest.mark.parametrize(
    ("keys", "charge"), [({}, "unknown"), ({"intake_pressure_MPa": 0.3}, "0.3 MPa (given)")]
)
def test_beside_a_measured_pressure_nothing_of_the_combustion_is_assumed(
    tmp_path: Path, keys: dict[str, float], charge: str
) -> None:
    """A given charge was left out, and a compression ratio of 9 was told as assumed."""
    trace = tmp_path / "trace.csv"
    lines = (f"{deg},{1 + 79 * math.exp(-(((deg - 10) / 30) ** 2)):.4f}" for deg in range(-360, 360))
    trace.write_text("\n".join(["crank_angle_deg,pressure_bar", *lines]))
    scene = load_scene("mikron-iiic-plain")
    assert scene.engine is not None
    gas = Gas(indicator_csv=str(trace), **keys)
    measured = scene.model_copy(update={"engine": scene.engine.model_copy(update={"gas": gas})})
    rows = {str(one["what"]): str(one["value"]) for one in engine_section(measured, None).tables[0][1].rows}
    assert rows["charge-air pressure (intake, absolute)"] == charge
    assert rows["compression ratio"] == "unknown"
    assert rows["pressure below the piston (absolute)"] == "0.101325 MPa (assumed)"
    assert "burn duration" not in rows


def test_masses_of_both_webs_where_they_differ() -> None:
    """A drilling through the first alone: the second has the mass of an undrilled one."""
    drilled = scene_with({"drilling": [ACROSS]})
    (_, masses), (_, plain) = (engine_section(scene, None).tables[1] for scene in (drilled, scene_with()))
    told, whole = ({str(row["what"]): str(row["value"]) for row in table.rows} for table in (masses, plain))
    assert told["second web"] == whole["web"]
    first, second = (float(told[f"{side} web"].split()[0]) for side in ("first", "second"))
    rise_mm = 48.0 + 2 * 21.0 * math.cos(math.radians(10.0)), drilled.pitch_mm / 2 - 3.0
    bore_kg = math.pi / 4 * 5.0**2 * 19.0 * math.hypot(*rise_mm) / rise_mm[1] * 7.85e-6
    assert second - first == pytest.approx(bore_kg, abs=1e-3), "to the last digit that is told"


def _misfire_told(text: str) -> list[float]:
    """Worst cylinder, its torque amplitude, and that over the judged one."""
    found = re.search(
        r"torque amplitude of ([\d.,]+) N m for every section of the crankshaft; where cylinder "
        r"(\d) does not fire, the worst of all, the largest "
        r"is ([\d.,]+) N m between .*? at \d+ rpm, ([\d.]+) of what is checked",
        text,
    )
    assert found
    judged, cylinder, amplitude, ratio = (float(group.replace(",", "")) for group in found.groups())
    assert ratio == pytest.approx(amplitude / judged, abs=6e-3)
    return [cylinder, amplitude]


def _misfire_computed(design: Path) -> list[float]:
    """Each cylinder as the design's own misfire, one study each."""
    found = [shaft_vibration(design, misfire=[cylinder]).response.worst_Nm for cylinder in (1, 2, 3, 4)]
    return [1.0 + found.index(max(found)), max(found)]


def test_no_signature_under_what_the_rule_does_not_use(tmp_path: Path) -> None:
    text = dossier(tmp_path, "").read_text(encoding="utf-8").replace("\\", "")
    signed = text[text.index("## Assumptions and signatures") :]
    assert "fatigue.process_factor" in signed
    assert not re.search(r"size_factor|survival_factor|specimen_diameter|roughness", signed)
    assert "shaft line and damping unknown" in text
    assert "Not calculated, nor what a misfire does: it takes [shaft]" in text


@pytest.mark.slow
def test_the_verdict_says_what_its_strength_does_not_hold_for(tmp_path: Path) -> None:
    """Of solid journals of 42 mm, where the library's strength is that of sections to 40 mm."""
    design = (designs_folder() / "mikron-iiic-plain.toml").read_text(encoding="utf-8")
    assert "strength" not in _headline(dossier(tmp_path, ""))
    path, design = tmp_path / "mine.toml", design.replace("bore_diameter_mm = 24.0", "bore_diameter_mm = 0.0")
    path.write_text(re.sub(r'(name = )"31CrMoV9"[^\[]*', '\\1"34CrNiMo6"\n', design), encoding="utf-8")
    assert main(["fatigue", str(path), "--method", "m53", "--report", str(tmp_path / "d.md"), "--quiet"]) == 6
    assert "Strength of the material: ultimate\\_MPa" in _headline(tmp_path / "d.md")
    own = re.sub(r'(name = )"31CrMoV9"[^\[]*', '\\1"34CrNiMo6"\nultimate_MPa = 900.0\n', design)
    path.write_text(own, encoding="utf-8")
    assert main(["fatigue", str(path), "--method", "m53", "--report", str(tmp_path / "d.md"), "--quiet"]) == 6
    text = (tmp_path / "d.md").read_text(encoding="utf-8").replace("\\", "")
    assert "Strength of the material" not in text, "M53 uses the tensile strength, which the design gives"
    assert "fatigue_tension_MPa" not in text
    assert row(text, "tensile strength")[1] == "900 MPa, of the design"
    assert row(text, "yield strength")[1].endswith("in proportion to the tensile strength")
    assert row(text, "remark")[1].startswith("yield_MPa = 736.364: those of 34CrNiMo6 in proportion")


def _headline(path: Path) -> str:
    text = path.read_text(encoding="utf-8")
    return next(line for line in text.splitlines() if "The throw is" in line)


@pytest.mark.slow
def test_pdf_with_numbered_pages(tmp_path: Path) -> None:
    data = dossier(tmp_path, "", ".pdf").read_bytes()
    assert data.startswith(b"%PDF")
    (pages,) = {int(count) for count in re.findall(rb"/Count (\d+)", data)}
    assert 4 <= pages <= 9
    assert sorted(path.name for path in tmp_path.iterdir()) == ["dossier.pdf", "mine.toml"]
