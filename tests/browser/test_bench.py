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
