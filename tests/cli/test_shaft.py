"""`cranktopo shaft` assembles the throw that the effects plan leaves, as every other command evaluates it."""

from __future__ import annotations

import html
import io
import json
import math
import re
from contextlib import redirect_stderr, redirect_stdout
from pathlib import Path
from typing import Any
from unittest.mock import patch

import numpy as np
import pytest

from cranktopo.app.main import main
from cranktopo.base.errors import CranktopoError
from cranktopo.base.line_width import in_width
from cranktopo.design.loading import designs_folder, load_scene, parse_scene
from cranktopo.design.schema import Scene
from cranktopo.design.shaft import Supports
from cranktopo.engine.performance import pressure_words
from cranktopo.engine.throw_compliance import throw_stiffness_Nm_per_rad
from cranktopo.tasks.film.result import ConservingFilm, EdgeFilm
from cranktopo.tasks.shaft.result import ShaftBearing, ShaftEvaluation
from cranktopo.tasks.shaft.stage import shaft_tables
from cranktopo.tasks.shaft.web_sections import WebSections
from cranktopo.tasks.shaft_safety.page import shaft_page
from cranktopo.tasks.shaft_safety.plots import (
    BearingPolar,
    CrankSide,
    safety_pictures,
    side_picture,
    stress_picture,
    web_pictures,
)
from cranktopo.tasks.shaft_safety.result import (
    SafetySeconds,
    ShaftAssessment,
    ShaftSafety,
    SpeedSafety,
    StressOverCycle,
    WebSafety,
    WorstPlace,
    assessment,
)
from cranktopo.tasks.shaft_safety.stage import assess_shaft
from cranktopo.tasks.shaft_safety.text import bearing_table, safety_text, shaft_text
from cranktopo.tasks.throw_fatigue.mesh_quality import JudgedQuality, Quality
from cranktopo.tasks.throw_fatigue.result import CriticalPoint
from cranktopo.tasks.throw_fea.targets import Target
from cranktopo.tasks.vibration.stage import shaft_vibration
from tests.hostile.scenes import dumped
from tests.page_text import typed_page

pytestmark = pytest.mark.usefixtures("throws_made_once")

MIKRON = (designs_folder() / "mikron-iiic-plain.toml").read_text(encoding="utf-8")
KEPT = {"permitted_film_um": None, "permitted_pressure_MPa": None, "films_hold": True}
STEEL_KG_PER_MM3 = 7.85e-6


def shaft(design: str, size_mm: str) -> dict[str, Any]:
    out, err = io.StringIO(), io.StringIO()
    with redirect_stdout(out), redirect_stderr(err):
        assert main(["shaft", design, "--element-size-mm", size_mm, "--json", "--quiet"]) == 0
    assert err.getvalue() == ""
    data: dict[str, Any] = json.loads(out.getvalue())
    return data


@pytest.fixture(scope="module")
def bored() -> dict[str, Any]:
    """The shaft of the built-in engine, whose plan keeps the bores, on a coarse mesh."""
    return shaft("mikron-iiic-plain", "24")


def test_shaft_obeys_the_effects_plan(bored: dict[str, Any], tmp_path: Path) -> None:
    """Closed form: four throws, each bore 24 mm wide through its journal and both 19 mm webs."""
    path = tmp_path / "mine.toml"
    assert "[effects]\n" in MIKRON
    path.write_text(MIKRON.replace("[effects]\n", '[effects]\nbores = "off"\n'), encoding="utf-8")
    solid = shaft(str(path), "24")
    length = (40.0 + 2 * 19.0) + (36.0 + 2 * 19.0)
    missing = 4 * STEEL_KG_PER_MM3 * math.pi / 4 * 24.0**2 * length
    assert solid["mass_kg"] - bored["mass_kg"] == pytest.approx(missing, rel=1e-6)
    assert solid["torsion"]["end_to_end_Nm_per_rad"] > 1.02 * bored["torsion"]["end_to_end_Nm_per_rad"]


def test_what_is_assumed_is_said(
    bored: dict[str, Any], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Masses that the design leaves out change the frequencies, its gas what the bearings carry."""
    assert all(entry["key"].startswith("engine.gas.") for entry in bored["assumed"])
    path = tmp_path / "mine.toml"
    text = re.sub(r"(?m)^(piston_group_kg|rod_reciprocating_kg) = .*\n", "", MIKRON)
    path.write_text(text, encoding="utf-8")
    assert main(["shaft", str(path), "--element-size-mm", "24", "--json"]) == 0
    printed = capsys.readouterr()
    said = " ".join(printed.err.split())
    assert said.startswith("mikron-iiic-plain: assumed: engine.")
    assert "engine.masses.piston_group_kg = 0 (no inertia force of the" in said
    lighter = json.loads(printed.out)
    further = [entry["key"] for entry in lighter["assumed"] if entry not in bored["assumed"]]
    assert further == [
        "engine.masses.piston_group_kg",
        "engine.masses.rod_reciprocating_kg",
    ]
    assert lighter["natural_frequencies_Hz"][0] > 1.01 * bored["natural_frequencies_Hz"][0]


def test_the_gas_counts_where_it_gives_the_spring_of_a_bearing() -> None:
    scene = load_scene("mikron-iiic-plain")
    clearance = {"torsion": "spring", "bending": "spring", "bearing_clearance_mm": 0.05}
    plain = scene.model_copy(update={"supports": Supports(**clearance)})
    assert "engine" in shaft_tables(plain, "spring")
    assert "engine" not in shaft_tables(plain, "rigid")


def test_the_shaft_stands_on_all_its_bearings(
    bored: dict[str, Any], capsys: pytest.CaptureFixture[str]
) -> None:
    """Four equal throws, mirrored: alike from both ends; free bearings carry nothing."""
    (at,) = bored["on_bearings"]
    shares = [web["share"] for web in at["webs"]]
    assert shares == pytest.approx(shares[::-1], rel=1e-3)
    assert 0.4 < min(shares) < 0.65 < max(shares) < 0.9
    assert [bearing["bearing"] for bearing in at["main_bearings"]] == [1, 2, 3, 4, 5]
    assert main(["shaft", "mikron-iiic-plain", "--element-size-mm", "24", "--speeds", "900:2100:3"]) == 0
    lines = in_width(capsys.readouterr().out).splitlines()
    assert [line.split()[0] for line in lines if line.startswith(("900 ", "1500 ", "2100 "))]
    assert max(map(len, lines)) <= 80
    assert "The pressure is that of 2100 rpm at every speed: with less load it is lower;" in lines


def test_speeds_without_forces_on_bearings_are_wrong_use(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["shaft", "mikron-iiic-plain", "--bearings", "free", "--speeds", "900:2100:3"]) == 2
    assert "bearings that are not free" in capsys.readouterr().err
    assert main(["shaft", "mikron-iiic-plain", "--speeds", "900:2100"]) == 2
    assert "must be FROM:TO:NUMBER" in capsys.readouterr().err


@pytest.mark.slow
def test_a_shaft_in_its_oil_films(capsys: pytest.CaptureFixture[str]) -> None:
    """The stiffness is that in rigid bearings; the second bearing carries less; every journal gives way."""
    words = ["shaft", "car-diesel", "--element-size-mm", "14", "--json", "--quiet"]
    rigid, film = (_said([*words, "--bearings", kind], capsys) for kind in ("rigid", "film"))
    assert film["torsion"] == rigid["torsion"]
    (still,), (lying,) = rigid["on_bearings"], film["on_bearings"]
    forces = [[one["largest_N"] for one in at["main_bearings"]] for at in (still, lying)]
    assert forces[1][1] < 0.97 * forces[0][1]
    radial_um = 1e3 * load_scene("car-diesel").bearings.clearance_mm / 2
    for one in lying["main_bearings"]:
        assert 0.8 * radial_um < one["offset_um"] < radial_um
        assert one["film_um"] == pytest.approx(radial_um - one["offset_um"], abs=0.3)


def test_films_and_play_need_bearings_and_a_load(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    assert main(["shaft", "mikron-iiic", "--bearings", "film"]) == 3
    assert "[bearings] is missing" in capsys.readouterr().err
    assert main(["shaft", "mikron-iiic", "--bearings", "clearance"]) == 3
    assert "bearings.clearance_mm is missing: --bearings clearance needs it" in capsys.readouterr().err
    data = load_scene("car-diesel").model_dump(mode="json", exclude_none=True, exclude={"engine": {"gas"}})
    (tmp_path / "cold.toml").write_text(dumped(data), encoding="utf-8")
    assert main(["shaft", str(tmp_path / "cold.toml"), "--bearings", "film"]) == 2
    assert "--bearings film needs pressures [engine.gas]" in capsys.readouterr().err


def _said(words: list[str], capsys: pytest.CaptureFixture[str]) -> dict[str, Any]:
    assert main(words) == 0
    return dict(json.loads(capsys.readouterr().out))


def test_estimate_covers_a_finer_mesh(bored: dict[str, Any]) -> None:
    """Stiffness end to end on a finer mesh is within the estimate, which is not a wide guess."""
    fine = shaft("mikron-iiic-plain", "16")["torsion"]["end_to_end_Nm_per_rad"]
    coarse, estimate = bored["torsion"]["end_to_end_Nm_per_rad"], bored["error_estimate_percent"]["torsion"]
    assert 0.05 < 100 * (coarse / fine - 1) < estimate < 10


def test_engine_of_one_cylinder_has_a_shaft_of_one_throw(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["shaft", "opposed-piston", "--element-size-mm", "20", "--quiet"]) == 0
    text = capsys.readouterr().out
    throw = next(line for line in text.splitlines() if line.startswith("1 "))
    end = next(line for line in text.splitlines() if line.startswith("end to end"))
    assert throw.split()[-1] == end.split()[-3]
    assert text.rstrip().splitlines()[-1].startswith("stiffnesses +-")


@pytest.mark.parametrize(
    "command", [["shaft"], ["export", "--part", "crankshaft"], ["export", "--part", "reduced"]]
)
def test_without_an_engine_there_is_no_shaft(
    command: list[str], tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """It is refused before anything is meshed."""
    monkeypatch.setattr(
        "cranktopo.tasks.shaft.stage.mesh_target", lambda *_: pytest.fail("a throw is meshed")
    )
    head, tail = MIKRON.split("[engine]", 1)
    path = tmp_path / "bare.toml"
    path.write_text(head + "[" + tail[tail.index("[engine.masses]") :].split("\n[", 1)[1], encoding="utf-8")
    ending = "npz" if "reduced" in command else "step"
    files = [str(tmp_path / f"shaft.{ending}")] if command[0] == "export" else ["--quiet"]
    assert main([command[0], str(path), *files, *command[1:]]) == 3
    (error,) = capsys.readouterr().err.splitlines()
    assert "mikron-iiic-plain: [engine] is missing" in error
    assert list(tmp_path.iterdir()) == [path]


def test_safety_needs_loads_strength_and_fillets(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Each is told before anything is meshed."""
    free = ["shaft", "mikron-iiic-plain", "--method", "lsa", "--bearings", "free"]
    assert main(free) == 2
    assert "--method: the forces on all bearings need [engine.gas]" in capsys.readouterr().err
    sized = ["shaft", "mikron-iiic-plain", "--report", "page.html", "--element-size-mm", "9"]
    assert main(sized) == 2
    assert "--element-size-mm: with --method the mesh follows the fillets" in capsys.readouterr().err
    for key, line in (
        ("fillet_mm = 2.5", "fillet_mm = 0"),
        ('name = "31CrMoV9"', 'name = "mine"\nE_GPa = 200'),
    ):
        assert key in MIKRON
        path = tmp_path / "mine.toml"
        path.write_text(MIKRON.replace(key, line), encoding="utf-8")
        assert main(["shaft", str(path), "--method", "lsa"]) == 3
        said = capsys.readouterr().err
        assert "fillet_mm = 0" in said or "material." in said


STRESS = StressOverCycle(
    angle_deg=(0.0, 12.0, 372.0),
    signed_von_mises_MPa=(0.0, 110.0, -90.0),
    along_MPa=(0.0, 105.2, -95.0),
    around_MPa=(0.0, 30.0, -31.0),
    shear_MPa=(0.0, 9.6, 4.0),
    along=(0.0, 0.0, 1.0),
    around=(1.0, 0.0, 0.0),
)


def judged(**more: float) -> ShaftSafety:
    """Two webs at two speeds, alike; further parts of the webs with their safety."""
    place = CriticalPoint(
        place="pin fillet, +171 deg around, 35 deg along",
        fillet="pin",
        around_deg=171.0,
        along_deg=35.0,
        web=None,
        point_mm=(1.0, 2.0, 3.0),
        safety=1.2,
        amplitude_MPa=100.0,
        mean_MPa=10.0,
        gradient_per_mm=0.5,
        strength_MPa=300.0,
        amplitude_share=0.9,
        decided_by="amplitude",
        factors={},
        states=("12", "372"),
    )
    parts = {"pin_fillet": 1.2, "journal_fillet": 1.5, "elsewhere": 2.0} | more
    least = min(parts.values())
    webs = tuple(
        WebSafety(
            web=web,
            throw=(web + 1) // 2,
            **parts,
            safety=least,
            part=min(parts, key=lambda part: parts[part]),
            speed_rpm=900.0,
            over_speeds=(1.2, 1.3),
        )
        for web in (1, 2)
    )
    quality = Quality(0.4, 0.24, 10, 2.0, 4.0, 1.0, 1.0)
    return ShaftSafety(
        method="lsa",
        safety=least,
        worst=WorstPlace(
            web=2,
            throw=1,
            speed_rpm=900.0,
            highest_deg=12.0,
            lowest_deg=372.0,
            critical=place,
            over_cycle=STRESS,
        ),
        webs=webs,
        speeds=tuple(
            SpeedSafety(speed_rpm=rpm, safety=safety, web=2, part="pin_fillet")
            for rpm, safety in ((900.0, 1.2), (2100.0, 1.3))
        ),
        load_states=1440,
        quality=JudgedQuality(**vars(quality), within_rule=True),
        seconds=SafetySeconds(mesh=1.0, unit_fields=1.0, stresses=1.0, cycles=1.0, safety=1.0),
        assumed=(),
    )


def test_safety_in_words() -> None:
    """One row a web and a speed, absent parts left out, 80 columns, and where it is worst."""
    found = judged()
    text = "\n\n".join(safety_text(found))
    assert "outlets" not in text
    assert "Least safety 1.200: web 2 (throw 1) at 900 rpm, highest stress at 12 deg, lowest" in text
    assert [line.split()[-3:] for line in text.splitlines() if line.startswith("2100")] == [
        ["2", "pin", "fillet"]
    ]
    assert max(map(len, in_width(text).splitlines())) <= 80
    stress = (
        "Stress there at 12 and 372 deg, MPa: signed von Mises 110 and -90; along the fillet 105 and -95,"
    )
    assert f"{stress} around it 30 and -31, shear 10 and 4." in " ".join(text.split())


def test_the_page_draws_the_stress_of_the_worst_point_over_the_cycle() -> None:
    """Four curves at every angle, and a line at the highest and at the lowest."""
    drawn = stress_picture(judged().worst)
    curves = {line.get_label(): list(line.get_ydata()) for line in drawn.figure.axes[0].lines[:4]}
    assert list(curves) == ["signed von Mises", "along the fillet", "around it", "shear"]
    assert curves["shear"] == [0.0, 9.6, 4.0]
    assert [line.get_xdata()[0] for line in drawn.figure.axes[0].lines[4:]] == [12.0, 372.0]
    assert "signed von Mises 110 MPa at 12 deg to -90 MPa at 372 deg" in drawn.alt


def test_a_safety_on_a_mesh_that_misses_the_checks_is_not_shown_as_sure(bored: dict[str, Any]) -> None:
    loads = BearingPolar(900.0, np.array([0.0, 360.0]), (1,), np.ones((1, 2, 2)))
    missed = "the mesh misses the checks of IACS UR M53: jump between elements 9.4 % (at most 5 %)"
    unwritten = {"throw_inertias_kg_mm2": (1.0,) * 4, "throw_by_bearings_Nm_per_rad": {}, "weighed": "shaft"}
    for safety, status, told in (
        (judged(), "good", False),
        (judged().model_copy(update={"mesh_shortfall": missed}), "unknown", True),
        (judged(outlets=0.7).model_copy(update={"mesh_shortfall": missed}), "bad", True),
    ):
        data = {**bored, **unwritten, "safety": safety.as_json()}
        page = shaft_page(ShaftAssessment.model_validate(data), loads, one_throw(), "")
        fact = page.facts[0]
        assert fact.label == "Least safety"
        assert fact.status == status
        assert (missed in page.headline) == (missed in fact.note) == told
        printed = " ".join("\n".join(safety_text(safety)).split())
        assert (f"along. Not sure: {missed}; a smaller --fillet-fraction helps." in printed) == told
        assert "The pressure" not in page.sections[0].text
    told = page_of_one_pressure(data, loads)
    assert told.endswith("takes the pressure over speed.")


def test_films_beyond_the_permitted_are_told(bored: dict[str, Any]) -> None:
    """First on the terminal, in headline and card of the page, and in the JSON; each bearing at its worst."""
    bearings = "[bearings]\nclearance_mm = 0.05\noil = 'ISO VG 46'\ntemperature_C = 90.0\n"
    permitted = "permitted_film_um = 3.0\npermitted_pressure_MPa = 1000.0\n"
    scene = parse_scene(MIKRON.replace("[engine]\n", f"{bearings}{permitted}\n[engine]\n"))
    with patch(
        "cranktopo.tasks.film.stage.with_conserving", side_effect=lambda _, films, *rest: tuple(films)
    ):
        found = assess_shaft(scene, element_size_mm=24.0, speeds_rpm=(600.0, 2100.0))
    data = found.as_json()
    films = {
        (at["speed_rpm"], name): one["film_um"]
        for at in data["on_bearings"]
        for name, one in (
            *((f"main {one['bearing']}", one) for one in at["main_bearings"]),
            ("big end", at["big_ends"]),
        )
    }
    names = [*(f"main {number}" for number in range(1, 6)), "big end"]
    thin = [name for name in names if min(films[600.0, name], films[2100.0, name]) < 3.0]
    assert {"main 2", "big end"} <= set(thin)
    assert (data["films_hold"], data["permitted_film_um"]) == (False, 3.0)
    lines = shaft_text(found).split("\n\n")[0].splitlines()
    assert [line.split(":")[0] for line in lines] == ["below the permitted 3 um"] * len(thin)
    for line, name in zip(lines, thin, strict=True):
        least, rpm = min((films[rpm, name], rpm) for rpm in (600.0, 2100.0))
        assert line.endswith(f": {name} {least:.2f} um at {rpm:g} rpm")
    loads = BearingPolar(600.0, np.array([0.0, 360.0]), (1,), np.ones((1, 2, 2)))
    for permits, status in ((found, "bad"), (found.model_copy(update=KEPT), "good")):
        page = shaft_page(permits.model_copy(update={"safety": judged()}), loads, one_throw(), "")
        (fact,) = (one for one in page.facts if one.label == "Least oil film")
        assert (fact.status, lines[0] in fact.note, lines[0] in page.headline) == (
            status,
            status == "bad",
            status == "bad",
        )
    assert "films_hold" not in bored


@pytest.mark.slow
@pytest.mark.parametrize(("spring", "touches"), [(1e6, False), (None, True)])
def test_a_film_near_the_permitted_one_has_its_edge_beside(spring: float | None, touches: bool) -> None:
    """Bearings that resist tilt keep the journal off their ends; others are touched by it."""
    bearings = "[bearings]\nclearance_mm = 0.05\nviscosity_mPas = 9.0\npermitted_film_um = 2.2\n"
    supports = f"[supports]\nbearing_tilt_spring_Nm_per_rad = {spring}\n" if spring else "[supports]\n"
    text = MIKRON.replace("[engine]\n", f"{bearings}\n[engine]\n").replace("[supports]\n", supports)
    scene = parse_scene(text)
    found = assess_shaft(scene, element_size_mm=24.0, speeds_rpm=(2100.0,))
    (at,) = found.on_bearings
    near = [one for one in at.main_bearings if one.film_um is not None and one.film_um < 1.5 * 2.2]
    assert near == [one for one in at.main_bearings if one.conserving is not None]
    for one in near:
        own = one.conserving
        assert own is not None
        assert own.edge is not None
        assert own.edge.tilt_um == pytest.approx(17.5 * one.tilt_mrad, rel=0.01), "half a width of 35 mm"
        assert own.edge.film_um < 0.7 * own.film_um
        assert (own.edge.film_um == 0.0) is (own.edge.pressure_MPa is None) is touches
        assert touches or own.edge.pressure_MPa > 1.3 * own.pressure_MPa
    text = " ".join(shaft_text(found).split())
    assert "Mass-conserving films of those near what is permitted; then with the journal's tilt" in text
    assert ("where 0 is a journal that touches" in text) is touches
    assert ("in their oil films, with 1000000 N m/rad against tilt, at" in text) is (spring is not None)


@pytest.mark.slow
def test_the_worst_speed_of_a_vibrating_shaft_is_added_to_those_asked_for() -> None:
    """A six of 750 rpm was judged at four speeds between which its largest torque lay, and was 5 % safer."""
    line = "[shaft]\ncylinder_damping_Nms_per_rad = 0.2\n[shaft.propeller]\ninertia_kg_m2 = 0.6\n\n[engine]\n"
    scene = parse_scene(MIKRON.replace("[engine]\n", line))
    found = assess_shaft(scene, element_size_mm=24.0, speeds_rpm=(600.0, 2100.0))
    low, added, high = (at.speed_rpm for at in found.on_bearings)
    assert (low, high, found.added_speed_rpm) == (600.0, 2100.0, added)
    study = shaft_vibration(Target("mikron", scene), element_size_mm=24.0)
    swings = study.response.torque_amplitude_Nm[:, np.array(study.shaft.in_crankshaft)].max(axis=1)
    speeds = study.response.speeds_rpm
    inside = (speeds >= low) & (speeds <= high)
    assert added == pytest.approx(float(speeds[inside][swings[inside].argmax()]), rel=2e-3)
    said = f"{added:,.0f} rpm is added to the 2 speeds: there the torque"
    assert said in " ".join(shaft_text(found).split())
    again = assess_shaft(scene, element_size_mm=24.0, speeds_rpm=(600.0, added, 2100.0))
    assert (len(again.on_bearings), again.added_speed_rpm) == (3, None), "it is among them"


def page_of_one_pressure(data: dict[str, Any], loads: BearingPolar) -> str:
    """Text of the first section where the shaft turns at other speeds than that of its pressure."""
    words = pressure_words(load_scene("mikron-iiic-plain"), (900.0, 2100.0))
    assert words.startswith("The pressure is that of 2100 rpm at every speed")
    shaft = ShaftAssessment.model_validate({**data, "pressure": words})
    return shaft_page(shaft, loads, one_throw(), "").sections[0].text


def one_throw() -> Scene:
    """The Mikron with one cylinder, whose shaft has the two webs of `judged`."""
    return parse_scene(MIKRON.replace("cylinders = 4", "cylinders = 1").replace("[1, 3, 4, 2]", "[1]"))


def test_the_short_form_has_the_names_that_others_read(bored: dict[str, Any]) -> None:
    """By speed: bearings, webs and safety; the worst place; the time. All of it is told elsewhere in full."""
    (at,), (full,) = bored["speeds"], bored["on_bearings"]
    assert at.keys() == {"rpm", "bearings", "webs"}
    assert at["rpm"] == full["speed_rpm"] == 2100.0
    assert at["bearings"] == [
        {"section": one["bearing"], "max_N": one["largest_N"], "deg": one["at_deg"]}
        for one in full["main_bearings"]
    ]
    assert [web.keys() for web in at["webs"]] == [{"throw", "web", "moment_range_Nm", "torque_range_Nm"}] * 8
    assert [web["moment_range_Nm"] for web in at["webs"]] == [web["range_Nm"] for web in full["webs"]]
    torque = [web["torque_range_Nm"] for web in at["webs"]]
    assert torque[0] < 1e-6 * max(torque), "nothing turns the first web"
    assert not {"worst", "seconds"} & bored.keys()
    unwritten = {"throw_inertias_kg_mm2": (1.0,) * 4, "throw_by_bearings_Nm_per_rad": {}, "weighed": "shaft"}
    slow = {**full, "speed_rpm": 900.0}
    shaft = ShaftEvaluation.model_validate({**bored, **unwritten, "on_bearings": [slow, full]})
    data = assessment(shaft, judged()).as_json()
    assert data["speeds"][0]["safety"] == {"value": 1.2, "place": "pin_fillet", "throw": 1, "web": 2}
    assert data["speeds"][1]["safety"]["value"] == 1.3
    assert data["worst"] == {
        "rpm": 900.0,
        "deg": 12.0,
        "safety": 1.2,
        "place": "pin fillet, +171 deg around, 35 deg along",
        "throw": 1,
        "web": 2,
    }
    assert data["seconds"] == data["safety"]["seconds"]


def test_a_file_of_curves_is_refused_before_the_work(tmp_path: Path) -> None:
    with pytest.raises(CranktopoError, match="folder does not exist"):
        assess_shaft("mikron-iiic-plain", csv=tmp_path / "none" / "webs.csv")
    for words in (["--bearings", "free", "--csv", str(tmp_path / "webs.csv")],):
        assert main(["shaft", "mikron-iiic-plain", *words]) == 2


def test_the_map_and_the_crank_show_the_safety_of_each_web() -> None:
    """Colours over web and speed, the crank with one number a web, and the curves of the webs."""
    found = judged()
    *_, shades = safety_pictures(found)
    (mesh,) = (one for one in shades.figure.axes[0].collections)
    assert np.array_equal(mesh.get_array(), [[1.2, 1.3], [1.2, 1.3]])
    scene = one_throw()
    side = side_picture(found, (0.0, 114.0), CrankSide.of(scene))
    assert sorted(text.get_text() for text in side.figure.axes[0].texts) == ["1.20", "1.20"]
    boxes = [patch.get_bbox() for patch in side.figure.axes[0].patches]
    assert max(box.y1 for box in boxes) >= scene.throw.radius_mm + scene.throw.crankpin.outer_diameter_mm / 2
    curve = np.arange(8.0).reshape(1, 2, 4)
    sections = WebSections(np.arange(4.0), *(curve * number for number in range(1, 8)))
    first = web_pictures(900.0, sections)[0]
    assert [line.get_label() for line in first.figure.axes[0].lines] == ["web 1", "web 2"]
    assert first.figure.axes[0].lines[1].get_ydata() == pytest.approx([4.0, 5.0, 6.0, 7.0])


def test_the_bars_of_a_web_have_the_part_with_the_least_safety() -> None:
    """An outlet below 1 is seen beside fillets above."""
    for more, names in (
        ({}, ["pin fillet", "journal fillet", "elsewhere"]),
        (
            {"outlets": 0.71},
            ["pin fillet", "journal fillet", "outlets", "elsewhere"],
        ),
    ):
        found = judged(**more)
        axes = safety_pictures(found)[0].figure.axes[0]
        bars = {group.get_label(): [bar.get_height() for bar in group] for group in axes.containers}
        assert list(bars) == names
        assert min(map(min, bars.values())) == found.safety
        centres = sorted(bar.get_x() + bar.get_width() / 2 for group in axes.containers for bar in group)
        assert min(np.diff(centres)) > 0.1, "bars beside each other"


@pytest.mark.slow
def test_safety_of_every_web(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """The last web passes on the torque of all cylinders, and carries bending as the first one does."""
    page = tmp_path / "shaft.html"
    words = ["shaft", "mikron-iiic-plain", "--fillet-fraction", "0.5", "--speeds", "900:2100:3", "--json"]
    assert main([*words, "--report", str(page), "--quiet"]) == 0
    data = json.loads(capsys.readouterr().out)
    found = data["safety"]
    assert data["on_bearings"][0]["main_bearings"][1]["largest_N"] > 20e3
    assert [web["web"] for web in found["webs"]] == list(range(1, 9))
    safeties = [web["safety"] for web in found["webs"]]
    assert found["worst"]["web"] == 8 == 1 + safeties.index(min(safeties))
    assert found["safety"] == min(safeties) == found["worst"]["critical"]["safety"]
    assert found["safety"] == min(at["safety"] for at in found["speeds"])
    assert found["load_states"] == 3 * 720
    for web in found["webs"]:
        assert web["safety"] == min(web["over_speeds"]) == web[web["part"]]
    text = typed_page(page)
    assert found["mesh_shortfall"] in html.unescape(text), "elements of half a fillet are too coarse"
    for part in (
        "Safety of every web",
        "of each web over speed",
        "of each part of each web",
        "Force on main bearing 5",
    ):
        assert part in text


@pytest.mark.slow
def test_a_cylinder_that_does_not_fire(capsys: pytest.CaptureFixture[str]) -> None:
    """Alone, its throw carries less and the others what they did; in the shaft its neighbours feel it."""
    found = []
    for more in ([], ["--misfire", "2"]):
        assert (
            main(["shaft", "mikron-iiic-plain", "--element-size-mm", "30", "--json", "--quiet", *more]) == 0
        )
        found.append(json.loads(capsys.readouterr().out))
    healthy, dead = found
    assert "misfire" not in healthy
    assert dead["misfire"] == [2]
    (one,), (other,) = healthy["on_bearings"], dead["on_bearings"]
    for before, after in zip(one["webs"], other["webs"], strict=True):
        if before["throw"] == 2:
            assert after["alone_Nm"] < 0.5 * before["alone_Nm"]
        else:
            assert after["alone_Nm"] == before["alone_Nm"]
    ranges = [{web["web"]: web["range_Nm"] for web in at["webs"]} for at in (one, other)]
    assert any(ranges[0][web] != ranges[1][web] for web in (1, 2, 5, 6))
    assert dead["torsion"] == healthy["torsion"]


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["--misfire", "5"], "--misfire = [5]: must be numbers of cylinders, 1 to 4."),
        (["--misfire", "worst"], "must be the number of a cylinder, 1 at the free end."),
        (["--misfire", "2", "--bearings", "free"], "--misfire: the forces on all bearings need"),
    ],
)
def test_cylinders_that_are_none(words: list[str], said: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["shaft", "mikron-iiic-plain", "--quiet", *words]) == 2
    assert said in capsys.readouterr().err


def test_the_stiffnesses_of_other_commands_stand_beside_each_other(
    capsys: pytest.CaptureFixture[str],
) -> None:
    """That on free bearings is the evaluation's; that of load cases is what `vibration` tells of them."""
    assert main(["shaft", "mikron-iiic", "--element-size-mm", "20", "--quiet"]) == 0
    rows = dict(
        re.split(r"\s{2,}", line)[:2] for line in capsys.readouterr().out.splitlines() if "one throw" in line
    )
    assert main(["evaluate", "mikron-iiic", "--element-size-mm", "20", "--json", "--quiet"]) == 0
    free = json.loads(capsys.readouterr().out)["evaluations"][0]["torsion"]["free_Nm_per_rad"] / 1000
    closed = throw_stiffness_Nm_per_rad(load_scene("mikron-iiic")) / 1000
    assert rows["one throw, free bearings"] == f"{free:.2f} kN m/rad"
    assert rows["one throw, load cases, closed form"] == f"{closed:.2f} kN m/rad"


def test_a_thin_film_at_an_edge_is_told_beside_a_kept_one() -> None:
    """A tilted journal left 0.87 um at an edge, and the page had a card of 3.51 um in green."""
    edge = EdgeFilm(film_um=0.87, film_deg=10.0, pressure_MPa=536.0, tilt_um=5.0)
    own = {"film_um": 3.51, "film_deg": 9.0, "pressure_MPa": 60.0, "pressure_deg": 8.0}
    film = ConservingFilm(**own, least_filled=0.5, oil_cm3_per_s=1.0, oil_left_out=0.0, edge=edge)
    rest = {"largest_N": 1e4, "at_deg": 10.0, "halves_N": 1e4, "tilt_mrad": 0.1, "offset_um": 20.0}
    bearing = ShaftBearing(
        bearing=5, **rest, film_um=4.0, film_below_um=0.1, pressure_MPa=50.0, conserving=film
    )
    found = assess_shaft(parse_scene(MIKRON), element_size_mm=24.0)
    (at,) = found.on_bearings
    at = at.model_copy(update={"main_bearings": (bearing,)})
    permits = {"permitted_film_um": 3.0, "permitted_pressure_MPa": None, "films_hold": True}
    tilted = found.model_copy(update={"on_bearings": (at,), **permits})
    (line,) = tilted.beyond_permitted
    assert line.startswith("at the edge, by the tilt of journals in rigid bearings: main 5 0.87 um at")
    assert bearing_table(at).rows[0]["film_um"] == 3.51
    assert tilted.model_copy(update={"permitted_film_um": 0.8}).beyond_permitted == []
