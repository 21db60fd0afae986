"""What a kit for pages costs beside the parts of the bench: one slider, 20,000 triangles that follow it.

    python -m venv /tmp/kits && /tmp/kits/bin/pip install nicegui panel
    python -m tests.studies.page_kits /tmp/kits/bin/python

NiceGUI and Panel are no dependencies: they are in an environment of their own, whose interpreter is named.
Both draw by the three.js that NiceGUI brings. Times are of processors, as others may use the machine.
"""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Iterable
from typing import Any

import psutil

from tests.browser.conftest import opened_browser
from tests.studies import page_kit_server
from tests.studies.page_kit_server import PORT

MOVES, WARM = 40, 5
_ADDRESS = f"http://127.0.0.1:{PORT}/"
_SIZES = """
import importlib.metadata as m, sys
def of(name, seen):
    name = name.lower().replace("_", "-")
    if name in seen:
        return
    try:
        found = m.distribution(name)
    except m.PackageNotFoundError:
        return
    seen[name] = sum(f.locate().stat().st_size for f in found.files or () if f.locate().is_file())
    for line in found.requires or ():
        if "extra ==" not in line:
            of(__import__("re").match(r"[\\w.-]+", line)[0], seen)
seen = {}
of(sys.argv[1], seen)
print(m.version(sys.argv[1]), len(seen), sum(seen.values()))
"""
_THREE = (
    "import nicegui, pathlib; print(pathlib.Path(nicegui.__file__).parent / 'elements/scene/dist/index.js')"
)


def main(interpreter: str) -> None:
    """Print one row per kit."""
    three = _said(interpreter, "-c", _THREE)
    print("kit version packages MB start_cpu_s move_server_ms move_browser_ms requests loaded_kB outside")
    for kit, python, package in (
        ("own", sys.executable, "tornado"),
        ("nicegui", interpreter, "nicegui"),
        ("panel", interpreter, "panel"),
    ):
        version, packages, size = _said(python, "-c", _SIZES, package).split()
        print(kit, version, packages, f"{int(size) / 1e6:.0f}", *_measured(kit, python, three))


def _said(python: str, *words: str) -> str:
    return subprocess.run([python, *words], capture_output=True, check=True, text=True).stdout.strip()


def _measured(kit: str, python: str, three: str) -> Iterable[str]:
    words = [python, page_kit_server.__file__, kit, three]
    with subprocess.Popen(words, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True) as process:
        try:
            assert process.stdout is not None
            while process.stdout.readline().strip() != "ready":
                assert process.poll() is None, f"{kit} ended"
            with opened_browser() as browser:
                yield from _moves(browser, psutil.Process(process.pid))
        finally:
            process.terminate()


def _moves(browser: Any, server: psutil.Process) -> Iterable[str]:
    page, asked, ended = browser.new_page(), list[str](), list[Any]()
    page.on("request", lambda request: asked.append(request.url))
    page.on("requestfinished", lambda request: ended.append(request))
    page.goto(_ADDRESS)
    _shown(page, 1)
    start_s = _processor_s([server])
    loaded = sum(one.sizes()["responseBodySize"] for one in list(ended))
    first = len(asked), loaded
    slider = page.locator("input[type=range], .q-slider [tabindex='0'], [role=slider][tabindex='0']").first
    slider.focus()
    before = (0.0, 0.0)
    for number in range(WARM + MOVES):
        if number == WARM:
            before = _processor_s([server]), _processor_s(_browsers())
        slider.press("ArrowRight" if number % 2 else "ArrowLeft")
        _shown(page, number + 2)
    spent = _processor_s([server]) - before[0], _processor_s(_browsers()) - before[1]
    outside = [url for url in asked if not url.startswith((_ADDRESS, "data:", "blob:"))]
    yield f"{start_s:.1f}"
    yield from (f"{1e3 * part / MOVES:.0f}" for part in spent)
    yield from (str(first[0]), f"{first[1] / 1e3:.0f}", str(len(outside)))
    for url in dict.fromkeys(outside):
        print(f"outside: {url}", file=sys.stderr)


def _shown(page: Any, number: int) -> None:
    page.wait_for_function(
        "(n) => Number(document.documentElement.dataset.shown ?? 0) >= n", arg=number, timeout=30_000
    )


def _browsers() -> list[psutil.Process]:
    return [one for one in psutil.Process().children(recursive=True) if "chrom" in one.name()]


def _processor_s(processes: Iterable[psutil.Process]) -> float:
    found = 0.0
    for one in processes:
        times = one.cpu_times()
        found += times.user + times.system
    return found


if __name__ == "__main__":
    main(sys.argv[1])
