"""What every form of a comparison says of fillets that are left out, and of safeties by several methods."""

from __future__ import annotations

import csv
import io
import json
from pathlib import Path

import pytest
from matplotlib.figure import Figure

from cranktopo.base.notes import redirected
from cranktopo.bodies.shown_solid import display_half
from cranktopo.design.loading import load_scene
from cranktopo.design.named import with_values
from cranktopo.numerics.surfaces.files import write_stl
from cranktopo.numerics.surfaces.mesh import mesh_of
from cranktopo.tasks.bound.result import NoBound
from cranktopo.tasks.compare.page import plot_stiffness_over_mass
from cranktopo.tasks.compare.printed import comparison_text
from cranktopo.tasks.compare.result import Entry, compare
from cranktopo.tasks.compare.stage import (
    ComparedTargets,
    compare_targets,
    comparison_bound,
    report_comparison,
)
from cranktopo.tasks.throw_fatigue.result import FatigueResult
from cranktopo.tasks.throw_fatigue.text import FatigueComparison
from cranktopo.tasks.throw_fea.evaluation import Evaluation
from cranktopo.tasks.throw_fea.targets import Target, resolve_target
from cranktopo.tasks.throw_fea.throw_stiffness import Stiffness

BASE, FORMS = "opposed-piston", ("table", "markdown", "latex")
LINE = "Mass and stiffness of all designs are without fillets, as the surface of my-run has none"


def invented(target: Target, *_: object) -> Evaluation:
    fine = Stiffness({"free": 100e3}, {"pinned": 70e3}, 1234, 4.0, 1.0, 2.0)
    return Evaluation(target.name, 2.0, 0.6, 5000, 50, fine, "free", "pinned", 0.3, 0.4, 3.0)


@pytest.fixture(autouse=True)
def _without_finite_elements(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("cranktopo.tasks.throw_fea.stage.evaluate", invented)


@pytest.fixture
def beside_a_run(tmp_path: Path) -> ComparedTargets:
    """A design, and the surface of a run."""
    scene = load_scene(BASE)
    surface = tmp_path / "web.stl"
    write_stl(surface, mesh_of(display_half(scene)))
    return compare_targets([Target("my-run", scene, surface, tmp_path)], BASE)


@pytest.mark.parametrize("form", FORMS)
def test_fillets_left_out_are_said_above_the_table(form: str, beside_a_run: ComparedTargets) -> None:
    text = comparison_text(beside_a_run.comparison, form)
    assert text.index(LINE) < text.index("kg"), "before the first table"
    alone = comparison_text(compare_targets(["opposed-piston-casting"], BASE).comparison, form)
    assert "fillets" not in alone


def test_files_hold_the_fillets_of_every_target(beside_a_run: ComparedTargets) -> None:
    rows = csv.DictReader(io.StringIO(comparison_text(beside_a_run.comparison, "csv")))
    assert [row["fillets"] for row in rows] == ["left out", "none"]
    found = json.loads(comparison_text(beside_a_run.comparison, "json"))
    assert found["fillets"] == {BASE: "left out", "my-run": "none"}
    alone = compare_targets(["opposed-piston-casting"], BASE).comparison
    assert set(json.loads(comparison_text(alone, "json"))["fillets"].values()) == {"as designed"}


@pytest.mark.slow
def test_page_and_plot_say_so(
    beside_a_run: ComparedTargets, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    page = tmp_path / "page.md"
    report_comparison(beside_a_run, page)
    head, _, rest = page.read_text(encoding="utf-8").partition("## ")
    assert LINE in head
    assert "no fillet in the scene" not in rest
    assert "| fillets | off | - | left out of this comparison: the surface of a run has none |" in rest
    titles: list[str] = []
    monkeypatch.setattr(Figure, "suptitle", lambda _, text, **__: titles.append(text))
    plot_stiffness_over_mass(beside_a_run.comparison, tmp_path / "plot.svg")
    assert titles == ["all designs without fillets, as the surface of a run has none"]


def test_a_baseline_partly_outside_of_its_envelope(monkeypatch: pytest.MonkeyPatch) -> None:
    """Said where a bound is shown, once."""
    monkeypatch.setattr("cranktopo.tasks.compare.stage.bounds_for_result", lambda *_: NoBound(none=""))
    short = with_values(load_scene("mikron-iiic-plain"), {"envelope.y_min_mm": -20.0})
    lines: list[str] = []
    with redirected(lines.append):
        comparison_bound(compare_targets([short], short))
    assert sum("2.95 % of it, lie outside of the envelope" in line for line in lines) == 1


@pytest.mark.parametrize("form", FORMS)
def test_two_methods_are_named(form: str) -> None:
    """In the heads, above the verdicts, and why their numbers do not compare."""
    targets = [resolve_target(name) for name in (BASE, "opposed-piston-casting")]
    entries = [Entry(invented(target), None, 1.2, {"fkm": 1.6}) for target in targets]
    fatigues = [
        FatigueComparison(
            (1.2, 1.2),
            (f"verdict of {method}",),
            FatigueResult(
                method=method, loads="extremes", baseline=BASE, fatigue=(), percent_of_baseline=None
            ),
        )
        for method in ("lsa", "fkm")
    ]
    text = comparison_text(compare(entries, BASE, fatigues[0], fatigues[1:]), form)
    for method in ("lsa", "fkm"):
        before = text[: text.index(f"verdict of {method}")]
        assert before.rstrip().endswith(f"Safety by {method}, over the extremes of the loads joined:")
    words = text.replace("|", " ").replace("&", " ").split()
    assert "lsa" in words[: words.index("Safeties")], "in a head"
    assert "fkm" in words[: words.index("Safeties")]
    assert text.count("Safeties of different methods do not compare as numbers") == 1
    assert "FKM asks for 1.2 to 1.5" in text
    alone = comparison_text(compare(entries, BASE, fatigues[0]), form)
    assert "do not compare" not in alone
    assert "Safety by lsa, over the extremes of the loads joined:" in alone
