"""The bench as a user has it: opened in a browser, a dimension dragged, numbers and picture follow."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from tests.browser.conftest import Visit

pytest.importorskip("tornado")
PROGRAM = [sys.executable, "-c", "from cranktopo.app.launch import main; main()"]
START_MS = 120_000


def started(folder: Path, *words: str) -> tuple[subprocess.Popen[str], str]:
    """Start a bench in a folder; return its process and the address that it prints."""
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(filter(None, sys.path))}
    process = subprocess.Popen(
        [*PROGRAM, "bench", *words, "--no-browser"],
        cwd=folder,
        env=environment,
        stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL,
        text=True,
    )
    assert process.stdout is not None
    return process, process.stdout.readline().strip()


@pytest.fixture
def bench(tmp_path: Path, browser: Any) -> Iterator[Any]:
    """Open a bench with these words in a browser window; all end with the test."""
    processes: list[subprocess.Popen[str]] = []
    contexts = []

    def opened(*words: str, **window: Any) -> Visit:
        process, address = started(tmp_path, *words)
        processes.append(process)
        context = browser.new_context(**{"viewport": {"width": 1500, "height": 950}, **window})
        contexts.append(context)
        found = Visit(context.new_page())
        found.page.on("console", lambda message: found.complaints.append(message.text))
        found.page.on("pageerror", lambda error: found.complaints.append(str(error)))
        found.page.on("request", lambda request: found.requests.append(request.url))
        found.page.set_default_timeout(START_MS)
        found.page.goto(address, timeout=START_MS)
        return found

    yield opened
    for context in contexts:
        context.close()
    for process in processes:
        process.send_signal(signal.SIGINT)
        process.wait(30)
        assert process.stdout is not None
        process.stdout.close()


def shown(page: Any) -> None:
    page.wait_for_selector("#viewer[data-shown]", timeout=START_MS)


def gauge(page: Any, name: str) -> float:
    text = page.locator(f"[data-gauge={name}] .value").inner_text()
    return float(text.split()[0].replace(",", ""))


def set_slider(page: Any, key: str, value: float, release: bool) -> None:
    """Move a slider as a pointer does: an input for every place, a change at the end."""
    page.evaluate(
        """([key, value, release]) => {
            const slider = document.querySelector(`input[type=range][data-key="${key}"]`);
            slider.value = value;
            slider.dispatchEvent(new Event("input", { bubbles: true }));
            if (release) slider.dispatchEvent(new Event("change", { bubbles: true }));
        }""",
        [key, value, release],
    )


def test_a_drag_moves_numbers_and_picture(bench: Any, tmp_path: Path) -> None:
    seen = bench("mikron-iiic-plain")
    page = seen.page
    shown(page)
    before, mass = seen.picture(), gauge(page, "mass")
    assert (before[:, :, 3] == 255).mean() > 0.03, "the canvas is not blank"
    set_slider(page, "web.width_mm", 64, release=False)
    page.wait_for_function(
        f"() => !document.querySelector('[data-gauge=mass] .value').textContent.startsWith('{mass:g}')"
    )
    page.wait_for_function("() => Number(document.querySelector('#viewer').dataset.shown) > 0")
    assert gauge(page, "mass") > mass * 1.05
    assert (np.abs(seen.picture() - before).max(axis=2) > 30).mean() > 0.005, "the picture follows"
    assert page.locator("[data-gauge=torsion].stale").count() == 1, "what was not solved looks stale"
    assert "mass +" in page.locator("#worse").inner_text(), "what is worse is said"
    set_slider(page, "web.width_mm", 64, release=True)
    page.wait_for_selector("#history li.here:has-text('width: 64 mm')")
    number = page.locator("[data-row='web.thickness_mm'] input").first
    number.fill("20,5")
    number.press("Enter")
    page.wait_for_selector("#history li.here:has-text('thickness: 20.5 mm')")
    number.fill("0,01")
    page.wait_for_selector("[data-row='web.thickness_mm'].is-broken")
    assert "web.thickness_mm" in page.locator("[data-row='web.thickness_mm'] .broken").inner_text()
    page.get_by_role("button", name="Undo").click()
    page.wait_for_selector("#history li.here:has-text('width: 64 mm')")
    assert page.locator("#history li").count() == 3, "what breaks a rule is no step"
    assert [line for line in seen.complaints if "favicon" not in line] == []
    assert all(url.startswith(("http://127.0.0.1:", "blob:")) for url in seen.requests)
    assert len(list((tmp_path / "bench").glob("*/0002.toml"))) == 1, "each step is a file"


class Actions:
    """What a user does, each a click, a typed value or a dropped file, counted."""

    def __init__(self, page: Any) -> None:
        self.page, self.count = page, 0

    def type(self, field: Any, text: str) -> None:
        self.count += 1
        field.fill(text)

    def enter(self, key: str, text: str) -> None:
        """Type the value of a dimension and press Enter; the step is in the history then."""
        steps = self.page.locator("#history li").count()
        field = self.page.locator(f"input[data-key='{key}']:not([type=range])")
        self.page.evaluate("() => document.querySelectorAll('#tree details').forEach((d) => (d.open = true))")
        self.type(field, text)
        field.press("Enter")
        self.page.wait_for_function("(n) => document.querySelectorAll('#history li').length > n", arg=steps)

    def click(self, what: Any) -> None:
        self.count += 1
        what.click()

    def choose(self, field: Any, value: str) -> None:
        self.count += 1
        field.select_option(value)

    def write(self, kind: str) -> None:
        """Write a file and wait until it is there."""
        form, made = self.page.locator("#write"), self.page.locator("#made li").count()
        self.choose(form.get_by_label("As"), kind)
        self.click(form.get_by_role("button", name="Write"))
        self.page.wait_for_function("(n) => document.querySelectorAll('#made li').length > n", arg=made)


@pytest.mark.slow
def test_a_twin_from_six_answers_to_its_files(bench: Any, tmp_path: Path) -> None:
    """Balanced by half, lighter at no less stiffness, as STEP and drawing; no terminal, no TOML seen."""
    page = bench().page
    page.set_default_timeout(START_MS)
    do = Actions(page)
    do.click(page.get_by_label("V", exact=True))
    answers = {
        "Cylinders": "2",
        "Bore, mm": "100",
        "Stroke, mm": "67,5",
        "Speed, rpm": "11500",
        "Rod length": "124",
    }
    for label, text in {**answers, "Peak pressure": "9,5"}.items():
        do.type(page.get_by_label(label), text)
    do.type(page.locator("#questions").get_by_label("Name"), "twin")
    do.click(page.get_by_role("button", name="Begin"))
    shown(page)
    lengths = {"throw.main_journal.outer_diameter_mm": "48", "throw.main_journal.length_mm": "30"}
    lengths |= {
        "throw.crankpin.outer_diameter_mm": "44",
        "throw.crankpin.length_mm": "44",
        "web.width_mm": "64",
    }
    lengths |= {"engine.masses.piston_group_kg": "0,40", "engine.masses.rod_reciprocating_kg": "0,13"}
    for key, text in {**lengths, "engine.masses.rod_rotating_kg": "0,30", "web.thickness_mm": "22"}.items():
        do.enter(key, text)
    assert gauge(page, "gas_force") == pytest.approx(73.8, abs=0.1), "73 817 N by hand"
    do.click(page.get_by_role("button", name="Add counterweight"))
    page.wait_for_selector("[data-row='web.counterweight.outer_radius_mm']")
    do.enter("web.counterweight.outer_radius_mm", "62")
    page.wait_for_selector("[data-gauge=balance_factor]")
    do.click(page.get_by_role("button", name="Set as original"))
    do.enter("web.width_mm", "62,5")
    page.wait_for_function(
        "() => document.querySelector('[data-gauge=mass] .change').textContent.startsWith('−')"
    )
    do.click(page.get_by_role("button", name="Keep variant"))
    page.wait_for_selector("tr[data-variant]")
    for kind in (".step:throw", ".pdf:drawing", ".toml"):
        do.write(kind)
    assert do.count <= 40
    assert {"twin.step", "twin.pdf", "twin.toml"} <= {file.name for file in tmp_path.iterdir()}
    assert (tmp_path / "twin.step").read_text(encoding="ascii").startswith("ISO-10303-21")
    commands = page.locator("#commands").inner_text()
    assert "cranktopo designs new twin.toml" in commands
    assert "cranktopo export twin.toml twin.step" in commands


@pytest.mark.slow
def test_a_crank_from_cad_is_dropped_and_freed(bench: Any, tmp_path: Path) -> None:
    from cranktopo.bodies.solid.files import export_solid
    from cranktopo.design.loading import load_scene

    export_solid(load_scene("mikron-iiic-plain"), "crankshaft", tmp_path / "crank.step")
    page = bench().page
    page.set_default_timeout(10 * START_MS)
    do = Actions(page)
    do.count += 1
    page.locator("#file").set_input_files(tmp_path / "crank.step")
    shown(page)
    assert page.locator("#name").inner_text() == "crank"
    assert gauge(page, "mass") == pytest.approx(1.54, rel=0.03)
    do.enter("web.thickness_mm", "18,5")
    do.write(".step:web")
    assert do.count <= 25
