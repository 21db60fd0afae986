from __future__ import annotations

import json
import shutil
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from tests.browser.bench_page import START_MS, quick_bench, running_bench

# Debian's Chromium; software rendering, because a test machine has no screen.
NAMES = ("chromium", "chromium-browser", "google-chrome")
ARGUMENTS = ["--no-sandbox", "--enable-unsafe-swiftshader"]

QUICK_MS = 120_000
READS = "GPU stall due to ReadPixels"
"""What the browser says where a test, not the page, reads pixels."""
NEXT_FRAMES = "() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)))"


@dataclass
class Visit:
    """A page that was opened, and what it said and asked for on the way."""

    page: Any
    complaints: list[str] = field(default_factory=list)
    requests: list[str] = field(default_factory=list)

    def listen(self) -> None:
        """Take down what the page says and asks for; that tests read its pixels is no complaint."""
        self.page.on("console", lambda message: self._heard(message.text))
        self.page.on("pageerror", lambda error: self._heard(str(error)))
        self.page.on("request", lambda request: self.requests.append(request.url))

    def _heard(self, text: str) -> None:
        if READS not in text:
            self.complaints.append(text)

    def picture(self) -> np.ndarray:
        """Pixels of the canvas, rows from the top, (h, w, 4), after the next frames."""
        self.page.evaluate(NEXT_FRAMES)
        flat, width, height = self.page.evaluate(
            """() => {
                const gl = document.querySelector("canvas").getContext("webgl2");
                const [w, h] = [gl.drawingBufferWidth, gl.drawingBufferHeight];
                const pixels = new Uint8Array(4 * w * h);
                gl.readPixels(0, 0, w, h, gl.RGBA, gl.UNSIGNED_BYTE, pixels);
                let text = "";
                for (let i = 0; i < pixels.length; i += 4096)
                    text += String.fromCharCode(...pixels.subarray(i, i + 4096));
                return [btoa(text), w, h];
            }"""
        )
        import base64

        pixels = np.frombuffer(base64.b64decode(flat), np.uint8).reshape(height, width, 4)
        return pixels[::-1].astype(int)


def chromium() -> str | None:
    """Path of the browser; None where there is none."""
    return next((found for name in NAMES if (found := shutil.which(name))), None)


@contextmanager
def opened_browser() -> Iterator[Any]:
    """A browser without a window; it closes with the block."""
    from playwright.sync_api import sync_playwright

    with sync_playwright() as playwright:
        opened = playwright.chromium.launch(executable_path=chromium(), args=ARGUMENTS)
        yield opened
        opened.close()


@pytest.fixture(scope="session")
def browser() -> Iterator[Any]:
    if chromium() is None:
        pytest.skip("no Chromium (apt-get install chromium): the report is not opened in a browser")
    pytest.importorskip("playwright.sync_api", reason="no playwright (pip install playwright)")
    with opened_browser() as opened:
        yield opened


@contextmanager
def windows(browser: Any) -> Iterator[Any]:
    """Open files in fresh browser windows and wait for their 3D views; all close with the block."""
    contexts = []

    def opened(path: Path, **window: Any) -> Visit:
        context = browser.new_context(**{"viewport": {"width": 900, "height": 600}, **window})
        contexts.append(context)
        found = Visit(context.new_page())
        found.listen()
        found.page.set_default_timeout(START_MS)
        found.page.goto(path.resolve().as_uri(), timeout=START_MS)
        found.page.wait_for_selector("#viewer[data-ready]")
        return found

    try:
        yield opened
    finally:
        for context in contexts:
            context.close()


@pytest.fixture
def visit(browser: Any) -> Iterator[Any]:
    """Open a file in a fresh browser window and wait for its 3D view."""
    with windows(browser) as opened:
        yield opened


@pytest.fixture
def bench(tmp_path: Path, browser: Any) -> Iterator[Any]:
    """Open a bench with these words in a browser window; all end with the test."""
    with ExitStack() as open_ones:

        def opened(*words: str, **window: Any) -> Visit:
            _, address = open_ones.enter_context(running_bench(tmp_path, *words))
            return _visited(browser, address, open_ones, window)

        yield opened


@contextmanager
def quick_benches(folder: Path, browser: Any) -> Iterator[Any]:
    """Open a bench that solves nothing with a design, or none, in a browser window, until the block ends."""
    with ExitStack() as open_ones:

        def opened(design: str = "", **window: Any) -> Visit:
            address = open_ones.enter_context(quick_bench(folder, design))
            found = _visited(browser, address, open_ones, window)
            found.page.set_default_timeout(QUICK_MS)
            return found

        yield opened


@pytest.fixture
def quick(tmp_path: Path, browser: Any) -> Iterator[Any]:
    """Open benches as `quick_benches`; all end with the test."""
    with quick_benches(tmp_path, browser) as opened:
        yield opened


def _visited(browser: Any, address: str, open_ones: ExitStack, window: dict[str, Any]) -> Visit:
    context = browser.new_context(**{"viewport": {"width": 1500, "height": 950}, **window})
    open_ones.callback(context.close)
    found = Visit(context.new_page())
    found.listen()
    found.page.set_default_timeout(START_MS)
    found.page.goto(address, timeout=START_MS)
    return found


@pytest.fixture(scope="session")
def run(browser: Any, default_run: Path) -> Path:
    """A run on a coarse grid, with its report."""
    return default_run


@pytest.fixture(scope="session")
def metrics(run: Path) -> dict[str, Any]:
    data: dict[str, Any] = json.loads((run / "metrics.json").read_text())
    return data
