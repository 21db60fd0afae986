"""Studies as jobs on the page: progress, stop, result, and the table and the command that stay."""

from __future__ import annotations

import json
import sys
from typing import Any

import pytest

from cranktopo.tasks.throw_fea.studies import StudyResult
from tests.browser.bench_page import JOB_MS, Actions, shown
from tests.filled import filled

pytest.importorskip("tornado")
STAND_IN = """
import pathlib, sys, time
print("[##----------] 12 of 60 s: optimiser, cells 3 mm", file=sys.stderr, flush=True)
try:
    time.sleep(600)
except KeyboardInterrupt:
    pathlib.Path("out").mkdir()
    pathlib.Path("out/accuracy.json").write_text(sys.argv[1])
    sys.exit(130)
"""
BY_TERM = "import signal; signal.signal(signal.SIGTERM, signal.default_int_handler)"


@pytest.mark.slow
def test_an_accuracy_study_shows_its_progress_and_leaves_a_table_when_it_is_stopped(
    quick: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    cheapest = {"ladder": "judge", "accuracy_percent": 2.0, "rung": "uniform 9.45 mm", "seconds": 4.25}
    study = filled(StudyResult, {"rungs": [], "limits": {}, "recommendations": [cheapest], "failures": []})
    line = [sys.executable, "-c", BY_TERM + STAND_IN, json.dumps(study)]
    monkeypatch.setattr("cranktopo.tasks.bench.jobs.own_command", lambda *words: line)
    seen = quick("mikron-iiic-plain")
    page = seen.page
    shown(page)
    form = page.locator("#job")
    form.locator("[name=kind]").select_option("iterate")
    assert form.locator("[name=steps]").is_visible()
    form.locator("[name=kind]").select_option("accuracy")
    for hidden in ("steps", "goal", "limit", "vary"):
        assert form.locator(f"[name={hidden}]").is_hidden()
    form.locator("[name=budget]").fill("60s")
    form.get_by_role("button", name="Start").click()
    page.wait_for_selector("#jobs progress[value='0.2']")
    assert page.locator("#jobs .left").inner_text() == "20 %, about 48 s left"
    page.locator("#jobs").get_by_role("button", name="Stop").click()
    table = page.get_by_role("region", name="Table of accuracy 001")
    table.wait_for()
    assert table.locator("tbody td").all_inner_texts()[:2] == ["body-fitted evaluation", "uniform 9.45 mm"]
    command = (
        "cranktopo accuracy bench/mikron-iiic-plain/jobs/001/design.toml --budget=60s --out accuracy-001"
    )
    assert command in page.locator("#commands").text_content()
    assert seen.complaints == []


LISTEN = """() => {
    window.told = [];
    const hear = () => {
        const text = document.querySelector("#jobs .left")?.textContent;
        if (text && window.told.at(-1) !== text) window.told.push(text);
    };
    new MutationObserver(hear).observe(document.querySelector("#jobs"), { subtree: true, childList: true });
}"""
"""Takes down how far a job is, as often as the page tells another text."""


@pytest.mark.slow
def test_a_loop_runs_to_its_end_and_comes_back_as_a_variant(quick: Any) -> None:
    """The whole of `iterate`, with one removal: its bar never goes back, and tells the time left."""
    seen = quick("mikron-iiic-plain")
    page, do = seen.page, Actions(seen.page)
    page.set_default_timeout(JOB_MS)
    shown(page)
    page.evaluate(LISTEN)
    do.choose(page.locator("#job [name=kind]"), "iterate")
    do.type(page.locator("#job [name=steps]"), "1")
    do.job("iterate")
    told = page.evaluate("() => window.told")
    shares = [int(text.split(" %")[0]) for text in told]
    assert shares == sorted(shares)
    assert len(set(shares)) > 1
    assert any(text.endswith("left") for text in told)
    rows = page.get_by_role("region", name="Table of iterate 001").locator("tbody th").all_inner_texts()
    assert rows == ["original", "1", "shape"]
    assert "iterate 001" in page.locator("tr[data-variant=v1] th").inner_text()
    do.press("Take")
    assert page.locator("[id='f-web.outline']").input_value() == "profile"
    assert seen.complaints == []
