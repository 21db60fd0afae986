"""The place of the least safety is told wherever the safety is: `shape`, `sweep`, `compare`."""

from __future__ import annotations

import csv
import io
import json
import re
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from cranktopo.base.progress import StageMemory
from cranktopo.design.loading import load_scene
from cranktopo.runs.manifest import new_manifest
from cranktopo.tasks.compare.cards import best_facts
from cranktopo.tasks.compare.printed import comparison_text
from cranktopo.tasks.compare.result import Entry, compare
from cranktopo.tasks.sweep.fineness import Fineness
from cranktopo.tasks.sweep.page import sweep_html
from cranktopo.tasks.sweep.stages import run_stage
from cranktopo.tasks.sweep.text import frame_of, sweep_summary
from cranktopo.tasks.throw_fatigue.result import CriticalPoint, FieldFatigue
from cranktopo.tasks.throw_fatigue.target_safety import fatigue_field
from cranktopo.tasks.throw_fatigue.text import FatigueComparison
from cranktopo.tasks.throw_fea.quantities import SAFETY
from cranktopo.tasks.throw_fea.targets import Target
from cranktopo.tasks.web_shape import evaluated_web as module
from cranktopo.tasks.web_shape.evaluated_web import Judging, evaluated_web
from cranktopo.tasks.web_shape.page import quantity_fact, shape_page
from cranktopo.tasks.web_shape.result import ShapeResult
from cranktopo.tasks.web_shape.text import shape_headline, shape_summary
from tests.cli.test_comparison_report import NO_FATIGUE, evaluated
from tests.physics.fatigue.test_least_safety import drilled
from tests.sweep_cases import point_result
from tests.told_evaluation import told_evaluation
from tests.unit.shape.shape_results import invented_data
from tests.unit.sweep.test_sweep_shown import sweep

OUTLET = "oil outlet on the crankpin, x 0.1, y 55.7, z 30.0 mm"
FILLET = "pin fillet, +12 deg around, 45 deg along"
CUT, FAST = "the oil outlet is not judged.", "the least safety is that at the overspeed of 11500 rpm."
FIELD = SimpleNamespace(critical=SimpleNamespace(safety=0.97, place=OUTLET), on_bearings=None)


def shaped() -> ShapeResult:
    """A web whose oil outlet is the worst place, of an original whose pin fillet is."""
    data: dict[str, Any] = invented_data()
    data |= {"worst_case_percent": {"tolerance": 0.5}, "seconds": {"total": 1.0}}
    for web, safety, place in (("original", 1.01, FILLET), ("result", 0.97, OUTLET)):
        data[web] = {**told_evaluation(), "fatigue_safety": safety, "fatigue_place": place}
        data["values"][web] = {"mass": 2.0, "fatigue_safety": safety}
    data["rounds"] = []
    data["change_percent"], data["goal_on_cells"] = {"fatigue_safety": -4.0}, {"minimise": "mass"}
    return ShapeResult.of_json(data, "shape.json")


def test_an_evaluated_web_has_the_place_beside_its_safety(monkeypatch: pytest.MonkeyPatch) -> None:
    evaluation = SimpleNamespace(result=SimpleNamespace(as_json=told_evaluation))
    monkeypatch.setattr(module, "evaluate", lambda *_: evaluation)
    monkeypatch.setattr(module, "fatigue_field", lambda *_: FIELD)
    monkeypatch.setattr(module, "safety_remarks", lambda _: [CUT])
    scene = load_scene("mikron-iiic-plain")
    found = evaluated_web(scene, {"fatigue_safety"}, None, "web", StageMemory()).evaluation
    assert (found.fatigue_safety, found.fatigue_place) == (0.97, OUTLET)
    assert found.as_json()["fatigue_place"] == OUTLET
    assert found.fatigue_loads == "extremes"
    assert found.fatigue_remarks == (CUT,)


@pytest.mark.slow
def test_the_outlet_of_a_drilled_twin_is_named() -> None:
    """The same point as the assessment has, at the outlet of the pin."""
    scene, judging = drilled(), Judging(fillet_fraction=0.5)
    found = evaluated_web(scene, {"fatigue_safety"}, 14.0, "web", StageMemory(), judging).evaluation
    field = fatigue_field(Target(scene.name, scene), "lsa", fillet_fraction=0.5)
    assert found.fatigue_place == field.critical.place
    assert field.critical.place.startswith("oil outlet on the crankpin")
    assert found.fatigue_safety == pytest.approx(field.safety[:, field.model.judged].min(), rel=1e-12)


def test_shape_names_both_places(monkeypatch: pytest.MonkeyPatch) -> None:
    found = shaped()
    text = shape_summary(found, Path("out"))
    assert f"least fatigue safety 0.970 at {OUTLET}; of the original 1.010 at {FILLET}" in text
    assert quantity_fact(found, "fatigue_safety").note.endswith(f"least at {OUTLET}; below 1: it fails")
    monkeypatch.setattr("cranktopo.tasks.web_shape.page.gallery_picture", lambda *_: None)
    manifest = new_manifest(run="out", design="", command=(), scene={}, options={}, inputs={})
    page = shape_page(found, manifest, load_scene("mikron-iiic-plain"), ())
    assert f"at {OUTLET}; of the original" in page.sections[0].text


def test_shape_tells_what_its_safeties_leave_out(monkeypatch: pytest.MonkeyPatch) -> None:
    data = shaped().as_json()
    data["result"]["fatigue_remarks"], data["original"]["fatigue_remarks"] = [FAST, CUT], [CUT]
    found = ShapeResult.of_json(data, "shape.json")
    lines = shape_summary(found, Path("out")).splitlines()
    assert [line for line in lines if CUT in line or FAST in line] == [CUT, f"result: {FAST}"]
    monkeypatch.setattr("cranktopo.tasks.web_shape.page.gallery_picture", lambda *_: None)
    manifest = new_manifest(run="out", design="", command=(), scene={}, options={}, inputs={})
    page = shape_page(found, manifest, load_scene("mikron-iiic-plain"), ())
    assert f"{CUT.removesuffix('.')}; result: {FAST.removesuffix('.')}" in page.sections[0].text


def test_a_change_within_the_scatter_of_the_worst_node_is_no_gain() -> None:
    data = shaped().as_json()
    data["values"]["result"]["fatigue_safety"] = 1.02
    for percent, status in ((0.7, "neutral"), (-1.9, "neutral"), (2.1, "good"), (-2.1, "bad")):
        data["change_percent"] = {"fatigue_safety": percent}
        found = ShapeResult.of_json(data, "shape.json")
        fact = quantity_fact(found, "fatigue_safety")
        assert fact.status == status
        assert f"fatigue safety {fact.value if status == 'neutral' else f'{percent:+g} %'}" in shape_headline(
            found
        )


def test_a_result_of_an_earlier_version_names_none() -> None:
    data = shaped().as_json()
    del data["result"]["fatigue_place"], data["original"]["fatigue_place"]
    assert "least fatigue safety" not in shape_summary(ShapeResult.of_json(data, "shape.json"), Path("out"))


def test_a_point_of_a_sweep_has_it(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    assessed = SimpleNamespace(fields=(FIELD,), loads="extremes")
    monkeypatch.setattr("cranktopo.tasks.throw_fatigue.stage.assess_fatigue", lambda *_: assessed)
    monkeypatch.setattr("cranktopo.tasks.sweep.stages._judged", lambda *_: {"mass_kg": 2.0})
    monkeypatch.setattr("cranktopo.tasks.sweep.stages.web_view", lambda *_: "")
    told = run_stage("fatigue", load_scene("mikron-iiic-plain"), tmp_path, Fineness())
    assert (told["fatigue_safety"], told["fatigue_place"]) == (0.97, OUTLET)
    assert told["fatigue_loads"] == "extremes"


def test_sweep_names_it_in_picks_table_and_page() -> None:
    safe = point_result("a", design="d", mass_kg=2.0, fatigue_safety=0.97, fatigue_place=OUTLET)
    found = sweep().model_copy(update={"points": (safe,), "varied": (), "objectives": {"mass_kg": "less"}})
    assert f"lightest: a (d), least fatigue safety 0.970 at {OUTLET}" in sweep_summary(found, Path("run"))
    assert frame_of([safe], safe)["fatigue_place"][0] == OUTLET
    page = sweep_html(found, {})
    assert f"least fatigue safety 0.970 at {OUTLET}</strong>" in page
    over = point_result(
        "a", design="d", mass_kg=2.0, fatigue_safety=0.97, fatigue_place=OUTLET, fatigue_loads="cycle"
    )
    named = found.model_copy(update={"points": (over,)})
    assert f"0.970 over every angle of the cycle at {OUTLET}" in sweep_summary(named, Path("run"))
    (data,) = re.findall(r"<script[^>]*application/json[^>]*>(.*?)</script>", page)[:1]
    assert OUTLET in json.loads(data)["rows"][0]


def test_compare_names_it_on_the_terminal() -> None:
    places = {"a": (1.01, FILLET), "b": (0.97, OUTLET)}
    entries = tuple(
        FieldFatigue.model_construct(
            target=name,
            safety=safety,
            judged_as="throw_alone",
            critical=CriticalPoint.model_construct(place=place),
        )
        for name, (safety, place) in places.items()
    )
    told = FatigueComparison((1.01, 0.97), (), NO_FATIGUE.model_copy(update={"fatigue": entries}))
    targets = [Entry(evaluated(name, 90e3, 0.1), None, safety) for name, (safety, _) in places.items()]
    found = compare(targets, "a", told)
    text = comparison_text(found, "table")
    assert f"Least safety: a 1.010 at {FILLET}; b 0.970 at {OUTLET}." in text


def test_every_form_of_a_comparison_names_the_load_states_and_either_web() -> None:
    """Extremes joined and the whole cycle both were `Safety by lsa`; stderr alone told both webs."""
    webs = {"a": {"first": 0.642, "second": 0.715}, "b": {"first": 0.643, "second": 0.700}}
    worlds = {"a": "throw_alone", "b": "continuous_shaft"}
    entries = tuple(
        FieldFatigue.model_construct(
            target=name,
            safety=min(safeties.values()),
            judged_as=worlds[name],
            web_safety=safeties,
            critical=CriticalPoint.model_construct(place=OUTLET),
        )
        for name, safeties in webs.items()
    )
    result = NO_FATIGUE.model_copy(update={"fatigue": entries, "loads": "cycle"})
    told = FatigueComparison((0.642, 0.643), (), result)
    targets = [Entry(evaluated(one.target, 90e3, 0.1), None, one.safety) for one in entries]
    found = compare(targets, "a", told)
    states = (
        "a over every angle of the cycle; b over every angle of the cycle in the shaft on all its bearings"
    )
    for form in ("table", "markdown", "latex"):
        text = comparison_text(found, form)
        assert f"Safety by lsa, {states}:" in text
        assert "a first web 0.642, second web 0.715; b first web 0.643, second web 0.700" in text
    rows = list(csv.DictReader(io.StringIO(comparison_text(found, "csv"))))
    assert [row["safety_loads"] for row in rows] == ["cycle", "shaft"]
    card = next(fact for fact in best_facts(found) if fact.label == "Safest against fatigue")
    assert card.value == "no clear best"
    assert card.status == "bad", "both fail"
    assert card.note.endswith(f"by lsa, {states}")
    assert "+0.2 +-2.0 %" in card.note


def test_a_card_names_no_winner_within_the_error_whose_column_has_no_star() -> None:
    """0.04 % safer was `Safest against fatigue: b`; a clear winner stays one."""
    for safety, shown in ((1.3005, "no clear best"), (1.4, "b")):
        told = FatigueComparison((1.3, safety), (), NO_FATIGUE)
        targets = [Entry(evaluated(name, 90e3, 0.1), None, one) for name, one in (("a", 1.3), ("b", safety))]
        found = compare(targets, "a", told)
        card = next(fact for fact in best_facts(found) if fact.label == "Safest against fatigue")
        assert card.value == shown
        assert (found.best(SAFETY) is None) == (shown == "no clear best")
        assert card.note.endswith("by lsa, over the extremes of the loads joined")
        stiffest = next(fact for fact in best_facts(found) if fact.label == "Stiffest in torsion per mass")
        assert stiffest.value == "no clear best"
