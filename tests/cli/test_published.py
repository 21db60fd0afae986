"""What is printed elsewhere about a design beside what `compare` computes; without the finite elements."""

from __future__ import annotations

import csv
import io
import json

import pytest

from cranktopo.app.main import main
from cranktopo.design.loading import load_scene
from cranktopo.tasks.compare.result import Entry, compare
from cranktopo.tasks.compare.text import comparison_result, comparison_tables
from cranktopo.tasks.throw_fatigue.result import FatigueResult
from cranktopo.tasks.throw_fatigue.text import FatigueComparison
from cranktopo.tasks.throw_fea.targets import resolve_target
from tests.cli.test_comparison_report import invented

BASE, CASTING, SECOND = (f"opposed-piston{variant}" for variant in ("", "-casting", "-variant-2"))
COMMAND = ["compare", CASTING, SECOND, "--baseline", BASE, "--quiet"]


@pytest.fixture(autouse=True)
def _without_finite_elements(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("cranktopo.tasks.throw_fea.stage.evaluate", invented)


def test_the_built_in_family_has_what_is_printed() -> None:
    """Variant II has a printed safety of 1.104 and a bending stiffness of 22.4e6 N/mm."""
    printed = load_scene(SECOND).published
    assert printed is not None
    assert printed.bending_stiffness_kN_per_mm == 22400.0
    assert [(one.method, one.printed_method, one.safety) for one in printed.fatigue] == [
        ("lsa", "", 1.104),
        ("fkm", "FEMFAT", 1.107),
    ]


def test_rows_of_the_json(capsys: pytest.CaptureFixture[str]) -> None:
    """Bending beside torsion, and a row for the variant whose geometry is not printed."""
    assert main([*COMMAND, "--json"]) == 0
    rows = {row["target"]: row for row in json.loads(capsys.readouterr().out)["published"]}
    assert rows[CASTING]["bending_published_percent"] == pytest.approx(100 * 16.2 / 19.9)
    assert rows[CASTING]["bending_difference_percent"] == pytest.approx(100 * (5 / 7 - 16.2 / 19.9))
    assert rows[SECOND]["safety_lsa_published_percent"] == pytest.approx(100 * 1.104 / 1.038)
    assert rows[SECOND]["safety_lsa_ours_percent"] is None
    only = rows["topology-optimised (printed)"]
    assert only["mass_published_percent"] == pytest.approx(100 * 9.7 / 8.6)
    assert only["mass_ours_percent"] is None


def test_table_and_csv(capsys: pytest.CaptureFixture[str]) -> None:
    """The table has a row for each quantity of each target, the CSV a row for each target."""
    assert main(COMMAND) == 0
    lines = [line.split() for line in capsys.readouterr().out.splitlines()]
    assert ["bending", CASTING, "81.4", "-10.0"] in lines
    assert ["safety", "fkm", "(FEMFAT)", SECOND, "104.1", "-"] in lines
    assert main([*COMMAND, "--format", "csv"]) == 0
    _, casting, _ = csv.DictReader(io.StringIO(capsys.readouterr().out))
    assert float(casting["bending_published_percent"]) == pytest.approx(100 * 16.2 / 19.9)


def test_both_methods_beside_what_is_printed(capsys: pytest.CaptureFixture[str]) -> None:
    """Ours by local stresses and by FKM, each with the printed value and their difference."""
    targets = [resolve_target(name) for name in (BASE, SECOND)]
    entries = [
        Entry(invented(target), target.scene.published, lsa, {"fkm": fkm})
        for target, lsa, fkm in zip(targets, (1.0, 1.3), (2.0, 2.5), strict=True)
    ]
    first, second = (
        FatigueComparison(
            (),
            (),
            FatigueResult(
                method=method, loads="extremes", baseline=BASE, fatigue=(), percent_of_baseline=None
            ),
        )
        for method in ("lsa", "fkm")
    )
    comparison = compare(entries, BASE, first, [second])
    values, percent, published = comparison_tables(comparison)
    assert [values.rows[1][key] for key in ("safety_lsa", "safety_fkm")] == [1.3, 2.5]
    assert percent.rows[1]["safety_fkm_percent"] == pytest.approx(125.0)
    found = {row["quantity"]: row for row in published.rows if row["target"] == SECOND}
    assert found["safety lsa"]["difference_percent"] == pytest.approx(130 - 100 * 1.104 / 1.038)
    assert found["safety fkm (FEMFAT)"]["difference_percent"] == pytest.approx(125 - 100 * 1.107 / 1.063)
    data = comparison_result(comparison).as_json()
    assert [data["fatigue"]["method"], *(one["method"] for one in data["further_fatigue"])] == ["lsa", "fkm"]


def test_every_method_is_assessed(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """`--fatigue lsa --fatigue fkm` asks for both, each once."""
    asked = []

    class Assessed:
        def __init__(self, method: str) -> None:
            self.method = method
            self.targets, self.baseline = [resolve_target(BASE)], 0

        def compared(self) -> FatigueComparison:
            result = FatigueResult(
                method=self.method, loads="extremes", baseline=BASE, fatigue=(), percent_of_baseline=None
            )
            safeties, verdict = (1.0, 1.5, 2.0), (f"verdict {self.method}",)
            return FatigueComparison(safeties, verdict, result, summaries=(None,) * 3)

    def assess(_: object, methods: list[str], **__: object) -> list[Assessed]:
        asked.extend(methods)
        return [Assessed(method) for method in methods]

    monkeypatch.setattr("cranktopo.tasks.compare.judged.assess_by_methods", assess)
    assert main([*COMMAND, "--fatigue", "lsa", "--fatigue", "fkm", "--fatigue", "lsa"]) == 0
    out = capsys.readouterr().out
    assert asked == ["lsa", "fkm"]
    heads = (f"Safety by {name}, over the extremes of the loads joined:" for name in ("lsa", "fkm"))
    blocks = (f"{head}\nverdict {name}" for head, name in zip(heads, ("lsa", "fkm"), strict=True))
    assert out.rstrip().endswith("\n\n".join(blocks))
