"""Limits on the bench: those of a range from both sides, and a web that fails by fatigue."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from cranktopo.design.edits import changed_text
from cranktopo.design.toml_text import parse_toml
from cranktopo.tasks.bench.forms import new_design
from cranktopo.tasks.bench.proposals import counterweight_changes
from tests.browser.bench_page import Actions, gauge, set_slider, shown

pytest.importorskip("tornado")
ANSWERS = {"layout": "single", "cylinders": 1, "bore_mm": 80, "stroke_mm": 90}
KEY = "goal.limits.balance_factor"
LIMITS: dict[str, Any] = {"balance_factor": [">= 49 %", "<= 51 %"], "twist": "<= 0.3 deg"}


def balanced(path: Path) -> None:
    """Write a single that balances half of its oscillating mass, within a percent."""
    text = new_design(ANSWERS)[0]
    changes = counterweight_changes(parse_toml(text, "own"), 50)
    goal = {"goal": {"minimise": "mass", "limits": LIMITS}}
    path.write_text(changed_text(text, {**changes, **goal}, "own"), encoding="utf-8")


@pytest.mark.slow
def test_a_range_is_a_limit_from_both_sides(bench: Any, tmp_path: Path) -> None:
    """A factor that fell to 10 % of a range around 50 was shown without a limit, and nothing said so."""
    balanced(tmp_path / "own.toml")
    seen = bench("own.toml")
    page = seen.page
    shown(page)
    dial = page.locator("[data-gauge=balance_factor]")
    page.wait_for_selector("[data-gauge=balance_factor] .track u >> nth=1")
    assert dial.locator(".limit.holds").all_inner_texts() == ["limit >= 49 %", "limit <= 51 %"]
    assert "limit of twist, <= 0.3 deg" in page.locator("#notes").inner_text(), "no gauge has it"
    set_slider(page, "web.width_mm", 1.1 * gauge_of(page, "web.width_mm"), release=True)
    page.wait_for_selector("[data-gauge=balance_factor] .limit:has-text('not kept')")
    told = f"balance factor of the oscillating mass >= 49 % (it is {gauge(page, 'balance_factor'):g} %)"
    assert f"Limit not kept: {told}." in page.locator("#worse").inner_text(), "of both, the broken one"
    assert dial.locator(".change").inner_text().endswith("points")
    page.get_by_role("button", name="Undo").click()
    page.wait_for_selector("[data-gauge=balance_factor] .limit.holds >> nth=1")
    do = Actions(page)
    do.open("Goal and limits", "limits")
    field = page.locator(f"[id='f-{KEY}']")
    assert field.input_value() == ">= 49 %; <= 51 %"
    widths = field.evaluate("(input) => [input.scrollWidth, input.clientWidth]")
    assert widths[0] <= widths[1], "nothing is cut"
    do.enter(KEY, ">= 48,5 %; <= 52 %")
    assert dial.locator(".limit").all_inner_texts() == ["limit >= 48.5 %", "limit <= 52 %"]
    dial.locator("u").last.dblclick(force=True)
    page.wait_for_selector("#history li.here:has-text('no limit: balance factor')")
    assert field.input_value() == ">= 48.5 %", "the other one stays"
    help_ = page.locator("#job-help").inner_text()
    assert "Keeps the limits of the design: balance factor >= 48.5 %; twist <= 0.3 deg" in help_
    page.locator("#job [name=goal]").select_option("maximise=torsion_per_mass")
    assert "The limits of the design do not count" in page.locator("#job-help").inner_text()
    settle_as(page, 0.722)
    assert (
        page.locator("#worse").inner_text().startswith("It fails by fatigue: the safety of 0.722 is below 1")
    )
    assert page.locator("[data-gauge=fatigue_safety]").inner_text().endswith("below 1: it fails")
    settle_as(page, 1.5)
    assert "fails" not in page.locator("#gauges").inner_text()
    assert seen.complaints == []


def gauge_of(page: Any, key: str) -> float:
    """Value of a dimension in the forms."""
    return float(page.locator(f"[id='f-{key}']").input_value())


def settle_as(page: Any, safety: float) -> None:
    """Have the page hear a settled safety, as the server tells it after a solve."""
    page.evaluate(
        """async (safety) => {
            const [{ state }, { showGauges }] = [await import("./state.js"), await import("./gauges.js")];
            Object.assign(state, { settled: { fatigue_safety: safety }, fresh: true, dragging: false });
            showGauges();
        }""",
        safety,
    )
