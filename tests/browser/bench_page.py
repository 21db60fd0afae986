"""A bench that runs, opened in a browser, and what a user does on its page."""

from __future__ import annotations

import asyncio
import os
import signal
import subprocess
import sys
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from cranktopo.base.errors import CranktopoError
from cranktopo.design.loading import design_text

PROGRAM = [sys.executable, "-c", "from cranktopo.app.launch import main; main()"]
START_MS = 600_000
JOB_MS = 1_800_000


@contextmanager
def running_bench(folder: Path, *words: str) -> Iterator[tuple[subprocess.Popen[str], str]]:
    """A bench in a folder, its process and the address that it prints; it ends with the block."""
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
    try:
        yield process, process.stdout.readline().strip()
    finally:
        process.send_signal(signal.SIGINT)
        process.wait(600)
        process.stdout.close()


@contextmanager
def quick_bench(folder: Path, design: str = "", **serving: Any) -> Iterator[str]:
    """A bench in a thread, its address: it answers drags, but solves nothing; it ends with the block."""
    from cranktopo.tasks.bench.server import Server
    from cranktopo.tasks.bench.session import Bench

    loop = asyncio.new_event_loop()
    thread = threading.Thread(target=loop.run_forever, daemon=True)
    thread.start()

    def do(work: Callable[[], Any]) -> Any:
        async def done() -> Any:
            return work()

        return asyncio.run_coroutine_threadsafe(done(), loop).result(600)

    def started() -> Any:
        bench = Bench(folder)
        for name in ("settle", "coarse"):
            setattr(bench.answers, name, lambda *asked: None)
        if design:
            bench.open_text(design_text(design), f"{design}.toml", f"opened {design}", "cranktopo bench")
        return Server(bench, **serving)

    server = do(started)
    try:
        yield server.address
    finally:
        do(server.close)
        loop.call_soon_threadsafe(loop.stop)
        thread.join(60)


def shown(page: Any, within_ms: int = START_MS) -> None:
    """Wait for the first picture."""
    page.wait_for_selector("#viewer[data-shown]", timeout=within_ms)


def settled(page: Any) -> None:
    """Wait for the body-fitted answer to the web in hand."""
    page.wait_for_function(
        "() => document.querySelector('#status').textContent === 'Settled'", timeout=JOB_MS
    )


def change_of(page: Any, name: str) -> str:
    """Return what a gauge says against the original, which settles after the web in hand."""
    selector = f"[data-gauge={name}] .change"
    page.wait_for_function(f"() => document.querySelector('{selector}')?.textContent", timeout=JOB_MS)
    return str(page.locator(selector).inner_text())


def stays_shown(page: Any) -> None:
    """Wait until the newest drag is answered and painted."""
    page.wait_for_function(
        """async () => {
            const { line } = await import("./talk.js");
            return line.answered >= line.seq && !line.waiting;
        }"""
    )
    page.wait_for_timeout(500)


def gauge(page: Any, name: str) -> float:
    """Value of a gauge as it is shown."""
    text = page.locator(f"[data-gauge={name}] .value").inner_text()
    return float(text.split()[0].replace(",", ""))


def reads(page: Any, name: str, value: float, within: float) -> None:
    """Wait until a gauge shows a value within a share of it."""
    page.wait_for_function(
        """([name, value, within]) => {
            const text = document.querySelector(`[data-gauge=${name}] .value`)?.textContent ?? "";
            return Math.abs(parseFloat(text.replaceAll(",", "")) - value) <= within * Math.abs(value);
        }""",
        arg=[name, value, within],
    )


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


class Actions:
    """What a user does, each counted: a click, a typed or chosen value, a dropped file."""

    def __init__(self, page: Any) -> None:
        self.page, self.count = page, 0

    def click(self, what: Any) -> None:
        self.count += 1
        what.click()

    def type(self, field: Any, text: str) -> None:
        self.count += 1
        field.fill(text)

    def choose(self, field: Any, value: str) -> None:
        self.count += 1
        field.select_option(value)

    def drop(self, file: Path) -> None:
        self.count += 1
        self.page.locator("#file").set_input_files(file)

    def press(self, name: str) -> None:
        """Press a button of the design, whose step is in the history then."""
        self._stepped(lambda: self.click(self.page.get_by_role("button", name=name, exact=True)))

    def open(self, *titles: str) -> None:
        """Open groups of the forms, where they are closed."""
        for title in titles:
            group = self.page.locator("#tree details").filter(
                has=self.page.locator(f"summary:text-is('{title}')")
            )
            if group.last.get_attribute("open") is None:
                self.click(group.last.locator("summary").first)

    def enter(self, key: str, text: str) -> None:
        """Type the value of a dimension and press Enter; the step is in the history then.

        Nothing is to be done where the value stands there already: it would be no step.
        """
        field = self.page.locator(f"[id='f-{key}']")
        if field.input_value() == text:
            return

        def act() -> None:
            self.type(field, text)
            field.press("Enter")

        self._stepped(act)

    def write(self, kind: str) -> None:
        """Have a file written, and wait for it."""
        made = self.page.locator("#made li").count()
        self.click(self.page.locator(f"#write [data-kind={kind}]"))
        self.page.wait_for_function(
            "(n) => document.querySelectorAll('#made li').length > n"
            " || document.querySelector('#message:not([hidden]):not(.calm)')",
            arg=made,
            timeout=JOB_MS,
        )
        assert self.page.locator("#message:not(.calm)").is_hidden(), self.page.locator(
            "#message"
        ).inner_text()

    def job(self, name: str) -> None:
        """Start a job, and wait until it has come back as a variant."""
        form, kept = self.page.locator("#job"), self.page.locator("tr[data-variant]").count()
        if form.locator("[name=kind]").input_value() != name:
            self.choose(form.locator("[name=kind]"), name)
        self.click(form.get_by_role("button", name="Start"))
        self.page.wait_for_function(
            "(n) => document.querySelectorAll('tr[data-variant]').length > n"
            " || document.querySelector('[data-job=failed]')"
            " || document.querySelector('#message:not([hidden]):not(.calm)')",
            arg=kept,
            timeout=JOB_MS,
        )
        told = self.page.locator("#jobs ul").inner_text() + self.page.locator("#message").inner_text()
        assert self.page.locator("tr[data-variant]").count() == kept + 1, told

    def _stepped(self, act: Any) -> None:
        before = self.page.locator("#history li.here").text_content()
        act()
        self.page.wait_for_function(
            "(was) => document.querySelector('#history li.here').textContent !== was"
            " || document.querySelector('#message:not([hidden]):not(.calm)')",
            arg=before,
        )
        if self.page.locator("#history li.here").text_content() == before:
            raise CranktopoError(self.page.locator("#message").inner_text())
