"""Three tasks of new users, from the first click to the files: no terminal, no TOML, actions counted."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import pytest

from cranktopo.bodies.solid.files import export_solid
from cranktopo.design.edits import changed_data
from cranktopo.design.loading import scene_from_dict
from cranktopo.design.toml_text import parse_toml
from cranktopo.tasks.bench.forms import new_design
from cranktopo.tasks.bench.proposals import counterweight_changes
from tests.browser.bench_page import JOB_MS, Actions, change_of, gauge, reads, settled, shown

pytest.importorskip("tornado")
pytestmark = pytest.mark.slow
PUBLISHED = Path(__file__).parents[1] / "data" / "public_crank" / "crankshaft.stp"


def begin(do: Actions, layout: str, answers: dict[str, str]) -> None:
    """Answer the questions of the first page."""
    do.click(do.page.get_by_label(layout, exact=True))
    for name, text in answers.items():
        do.type(do.page.locator(f"#questions [name={name}]"), text)
    do.click(do.page.get_by_role("button", name="Begin"))
    shown(do.page)


def test_a_motorcycle_twin(bench: Any, tmp_path: Path) -> None:
    """Half of the oscillating mass balanced, lighter at no less safety; STEP, drawing, page for the boss."""
    do = Actions(bench().page)
    answers = {"cylinders": "2", "bore_mm": "100", "stroke_mm": "67,5", "speed_rpm": "11500"}
    begin(do, "V", {**answers, "rod_length_mm": "124", "peak_pressure_MPa": "9,5", "name": "twin"})
    do.open("Engine", "masses", "gas", "Throw and journals", "Web")
    journals = {"main_journal": ("48", "30"), "crankpin": ("44", "44")}
    for name, (diameter, length) in journals.items():
        do.enter(f"throw.{name}.outer_diameter_mm", diameter)
        do.enter(f"throw.{name}.length_mm", length)
        do.enter(f"throw.{name}.fillet_mm", "2,5")
    do.enter("web.width_mm", "64")
    do.enter("web.thickness_mm", "22")
    do.enter("engine.masses.piston_group_kg", "0,40")
    do.enter("engine.masses.rod_reciprocating_kg", "0,13")
    do.enter("engine.masses.rod_rotating_kg", "0,30")
    do.enter("engine.gas.peak_angle_deg", "14")
    do.enter("engine.gas.compression_ratio", "12,5")
    reads(do.page, "gas_force", 73.817, 0.001)
    reads(do.page, "mean_torque", 159.2, 0.01)
    reads(do.page, "power", 192, 0.01)
    reads(do.page, "mean_pressure", 18.9, 0.005)
    do.enter("balance", "50")
    do.press("Add drilling")
    do.enter("throw.drilling[0].outlet_radius_mm", "1")
    reads(do.page, "balance_factor", 50, 0.05)
    do.click(do.page.get_by_role("button", name="Set as original"))
    settled(do.page)
    do.type(do.page.locator("#job [name=limit]"), "fatigue_safety >= 100 %; balance_factor >= 48 %")
    do.job("shape")
    do.press("Take")
    settled(do.page)
    assert gauge(do.page, "balance_factor") > 47.9
    mass = do.page.locator("[data-gauge=mass] .change").inner_text()
    assert mass.startswith("−"), "lighter"
    assert "fatigue safety" not in do.page.locator("#worse").inner_text(), "at no less safety"
    for kind in ("step-throw", "drawing-pdf", "compare"):
        do.write(kind)
    assert do.count <= 40
    assert (tmp_path / "twin.step").read_text(encoding="ascii").startswith("ISO-10303-21")
    assert (tmp_path / "twin.pdf").read_bytes().startswith(b"%PDF")
    page = (tmp_path / "twin-compare.html").read_text(encoding="utf-8")
    assert "twin-original" in page
    assert page.count("<figure") >= 3, "three pictures for the boss"
    assert len(re.findall(r"<td[^>]*>[^<]*\d", page)) >= 5, "and five numbers"
    commands = do.page.locator("#commands").inner_text()
    for line in (
        "designs new twin.toml",
        "designs copy bench/twin/",
        "shape bench/twin/jobs/001/design.toml",
    ):
        assert f"cranktopo {line}" in commands
    assert re.search(r"cranktopo export bench/twin/\d{4}\.toml twin\.step", commands)
    assert not re.search(r"(?m)^#", commands), "commands, not comments"


def test_a_marine_six(bench: Any, tmp_path: Path) -> None:
    """Power known; the rule's papers, vibration with a damper, 10 mm more web with the pitch kept."""
    do = Actions(bench().page)
    do.choose(do.page.locator("#questions [name=material]"), "34CrNiMo6")
    answers = {"cylinders": "6", "bore_mm": "320", "stroke_mm": "480", "speed_rpm": "750"}
    begin(do, "in-line", {**answers, "peak_pressure_MPa": "20", "power_kW": "6000", "name": "six"})
    do.open("Throw and journals", "Web")
    do.enter("web.width_mm", "400")
    do.enter("web.thickness_mm", "110")
    for name, diameter in {"main_journal": "290", "crankpin": "250"}.items():
        do.enter(f"throw.{name}.outer_diameter_mm", diameter)
        do.enter(f"throw.{name}.length_mm", "140")
        do.enter(f"throw.{name}.fillet_mm", "14")
    reads(do.page, "power", 6000, 0.01)
    do.open("Shaft line")
    do.press("Add shaft")
    for name in ("coupling", "driven", "damper"):
        do.press(f"Add {name}")
    values = {"coupling.stiffness_Nm_per_rad": "500000", "coupling.inertia_kg_m2": "100"}
    values |= {"driven.inertia_kg_m2": "800", "damper.damping_Nms_per_rad": "3000"}
    for key, text in {**values, "damper.ring_inertia_kg_m2": "60", "damper.hub_inertia_kg_m2": "10"}.items():
        do.enter(f"shaft.{key}", text)
    do.click(do.page.get_by_role("button", name="Set as original"))
    do.choose(do.page.get_by_label("what stays"), "pitch")
    do.enter("web.thickness_mm", "120")
    assert do.page.locator("[id='f-throw.main_journal.length_mm']").input_value() == "120", "pitch kept"
    settled(do.page)
    assert change_of(do.page, "bending_per_mass").startswith("+")
    do.press("Undo")
    do.choose(do.page.get_by_label("what stays"), "journals")
    do.enter("web.thickness_mm", "120")
    assert do.page.locator("[id='f-throw.main_journal.length_mm']").input_value() == "140", "journal kept"
    settled(do.page)
    assert change_of(do.page, "bending_per_mass") != "as original"
    do.job("UR M53")
    told = do.page.locator("#jobs li").first.inner_text()
    for word in ("by polynomials", "by elements", "govern"):
        assert word in told
    do.write("m53")
    do.write("vibration")
    assert do.count <= 45
    assert (tmp_path / "six-m53.pdf").read_bytes().startswith(b"%PDF")
    assert "Campbell" in (tmp_path / "six-vibration.html").read_text(encoding="utf-8")


def crank_step(path: Path) -> None:
    """Write a crank as CAD has it: one throw, counterweights, no word of engine or material."""
    data = parse_toml(
        new_design({"layout": "single", "cylinders": 1, "bore_mm": 80, "stroke_mm": 90})[0], "own"
    )
    data = changed_data(data, counterweight_changes(data, 30))
    export_solid(scene_from_dict(data, "own", whole=True), "crankshaft", path)


def give_engine(do: Actions, values: dict[str, str], masses_kg: tuple[str, str, str]) -> None:
    """Give a crank from CAD its engine: bore, rod, speed, peak pressure, masses of piston and rod ends."""
    do.open("Engine")
    do.press("Add engine")
    for key in ("bore_mm", "rod_length_mm", "speed_rpm"):
        do.enter(f"engine.{key}", values[key])
    do.press("Add gas")
    do.enter("engine.gas.peak_pressure_MPa", values["peak_pressure_MPa"])
    do.open("masses")
    for name, text in zip(("piston_group", "rod_reciprocating", "rod_rotating"), masses_kg, strict=True):
        do.enter(f"engine.masses.{name}_kg", text)


def test_a_published_crank_from_cad(bench: Any, tmp_path: Path) -> None:
    """Its counterweight and outline freed: 5 % lighter at no less safety, written. One web at a time."""
    do = Actions(bench().page)
    do.drop(PUBLISHED)
    shown(do.page, JOB_MS)
    told = do.page.locator("#message.calm")
    told.wait_for()
    assert "Outline: profile through stations with a counterweight" in told.inner_text()
    assert "Not read: 20 conical faces" in told.inner_text()
    values = {"bore_mm": "80", "rod_length_mm": "230", "speed_rpm": "2500", "peak_pressure_MPa": "4"}
    give_engine(do, values, ("0,7", "0,2", "0,5"))
    do.open("Original")
    do.press("Remove original")
    do.open("Search", "free")
    do.enter("shape.free.counterweight_radius_mm", "70, 100")
    do.enter("shape.free.counterweight_angle_deg", "40, 90")
    settled(do.page)
    do.click(do.page.get_by_role("button", name="Set as original"))
    do.type(do.page.locator("#job [name=limit]"), "fatigue_safety >= 100 %; torsion none; bending none")
    do.choose(do.page.locator("#job [name=web]"), "first")
    do.job("shape")
    do.press("Take")
    settled(do.page)
    change = do.page.locator("[data-gauge=mass] .change").inner_text()
    assert float(change.replace("−", "-").split()[0]) < -5, "lighter"
    assert "fatigue safety" not in do.page.locator("#worse").inner_text(), "at no less safety"
    do.write("step-crank")
    assert do.count <= 25
    assert (tmp_path / "crankshaft-crank.step").read_text(encoding="ascii").startswith("ISO-10303-21")


def test_a_crank_from_cad(bench: Any, tmp_path: Path) -> None:
    """Dropped, engine given, counterweight and outline freed: 5 % lighter at no less safety, written."""
    (tmp_path / "cad").mkdir()
    crank_step(tmp_path / "cad" / "crank.stp")
    do = Actions(bench().page)
    do.drop(tmp_path / "cad" / "crank.stp")
    shown(do.page, JOB_MS)
    assert do.page.locator("#name").inner_text() == "crank"
    do.page.wait_for_selector("#message.calm:has-text('Read from')")
    assert gauge(do.page, "mass") > 1
    values = {"bore_mm": "80", "rod_length_mm": "150", "speed_rpm": "4000", "peak_pressure_MPa": "9"}
    give_engine(do, values, ("0,7", "0,2", "0,5"))
    do.open("Search", "free")
    do.enter("shape.free.counterweight_radius_mm", "55, 90")
    settled(do.page)
    assert gauge(do.page, "fatigue_safety") > 0
    do.click(do.page.get_by_role("button", name="Set as original"))
    do.type(do.page.locator("#job [name=limit]"), "fatigue_safety >= 100 %; torsion none; bending none")
    do.job("shape")
    do.press("Take")
    settled(do.page)
    change = do.page.locator("[data-gauge=mass] .change").inner_text()
    assert float(change.replace("−", "-").split()[0]) < -5, "lighter"
    assert "fatigue safety" not in do.page.locator("#worse").inner_text(), "at no less safety"
    do.write("step-crank")
    assert do.count <= 25
    assert (tmp_path / "crank-crank.step").read_text(encoding="ascii").startswith("ISO-10303-21")
