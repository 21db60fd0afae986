"""Latency and memory of the bench: drags in Chromium, from pointer to changed numbers and painted picture.

    python -m tests.benchmarks.bench_drags [--drags 500] [DESIGN ...]

`imported-step` and `imported-stl` are cranks as CAD writes them, read as `import` does, their engines filled
in: one of random features with exact faces, a plain one of triangles.

A drag moves a slider, waits for the answer of that very move, for the next frame, and reads the pixels: a
canvas without a body is an error. Told are milliseconds by `performance.now()`, processor time a move of
server and browser, and the page's heap before and after.
"""

from __future__ import annotations

import argparse
import shutil
import tempfile
from pathlib import Path
from typing import Any

import numpy as np
import psutil

from cranktopo import export_solid, load_scene
from cranktopo.design.writing import toml_text
from cranktopo.tasks.crank_import.stage import import_crank
from tests.browser.bench_page import running_bench, settled, shown
from tests.browser.conftest import ARGUMENTS, NAMES
from tests.featured_throws import featured_crank

DESIGNS = {
    "mikron-iiic": "throw.crankpin.bore_diameter_mm",
    "car-diesel": "web.width_mm",
    "industrial-gas": "web.width_mm",
    "imported-step": "web.thickness_mm",
    "imported-stl": "web.width_mm",
}
_SEED = 26
"""Of a crank of four throws whose webs have a profile, a bevel, two pockets and a drilling."""
_LEAST_SHARE = 0.01
_DRAG = """async ([key, share]) => {
    const slider = document.querySelector(`input[type=range][data-key="${key}"]`);
    const viewer = document.getElementById("viewer"), dials = document.getElementById("dials");
    const before = Number(viewer.dataset.shown), told = dials.textContent;
    const middle = (Number(slider.min) + Number(slider.max)) / 2, begun = performance.now();
    slider.value = middle * (1 + share);
    slider.dispatchEvent(new Event("input", { bubbles: true }));
    while (Number(viewer.dataset.shown) <= before) await new Promise((done) => setTimeout(done, 1));
    await new Promise(requestAnimationFrame);
    const taken = performance.now() - begun, gl = viewer.querySelector("canvas").getContext("webgl2");
    const [width, height] = [gl.drawingBufferWidth, gl.drawingBufferHeight];
    const pixels = new Uint8Array(4 * width * height);
    gl.readPixels(0, 0, width, height, gl.RGBA, gl.UNSIGNED_BYTE, pixels);
    let painted = 0;
    for (let i = 3; i < pixels.length; i += 4) painted += pixels[i] > 0;
    return [taken, painted / (width * height), dials.textContent !== told];
}"""


def main() -> None:
    """Print a line for each design."""
    from playwright.sync_api import sync_playwright

    parser = argparse.ArgumentParser()
    parser.add_argument("--drags", type=int, default=500)
    parser.add_argument("designs", nargs="*", default=list(DESIGNS))
    asked = parser.parse_args()
    path = next(found for name in NAMES if (found := shutil.which(name)))
    with sync_playwright() as api:
        flags = [*ARGUMENTS, "--enable-precise-memory-info", "--js-flags=--expose-gc"]
        browser = api.chromium.launch(executable_path=path, args=flags)
        for design in asked.designs:
            print(_measured(browser, design, asked.drags))
        browser.close()


def _imported(folder: Path, name: str) -> str:
    """Return the file of a design that is read from a body, which is written first, with its engine."""
    exact = name == "imported-step"
    own = featured_crank(_SEED) if exact else load_scene("opposed-piston")
    body = folder / f"{name}.{'step' if exact else 'stl'}"
    export_solid(own, "crankshaft", body)
    import_crank(body, out=folder / "read")
    read = load_scene(folder / "read" / f"{name}.toml", whole=True)
    design = folder / f"{name}.toml"
    design.write_text(toml_text(read.model_copy(update={"engine": own.engine}), name), "utf-8")
    return design.name


def _measured(browser: Any, design: str, drags: int) -> str:
    folder = Path(tempfile.mkdtemp())
    target = _imported(folder, design) if design.startswith("imported") else design
    with running_bench(folder, target) as (process, address):
        page = browser.new_page(viewport={"width": 1500, "height": 950})
        page.goto(address)
        shown(page)
        settled(page)
        page.evaluate("() => document.querySelectorAll('#tree details').forEach((one) => (one.open = true))")
        shares = (0.02 + 0.06 * np.random.default_rng(1).random(drags + 10)) * (-1.0) ** np.arange(drags + 10)
        for share in shares[:10]:
            page.evaluate(_DRAG, [DESIGNS[design], share])
        heap, answers, cpu = [_heap(page)], [], _seconds(process.pid)
        for share in shares[10:]:
            answers.append(page.evaluate(_DRAG, [DESIGNS[design], share]))
        cpu = {name: (after - cpu[name]) / drags for name, after in _seconds(process.pid).items()}
        heap.append(_heap(page))
        page.close()
    shutil.rmtree(folder)
    least, changed = min(share for _, share, _ in answers), sum(moved for *_, moved in answers)
    assert least > _LEAST_SHARE, f"{design}: a canvas was blank"
    assert changed > 0.95 * drags, f"{design}: numbers stood still in {drags - changed} of {drags} moves"
    taken = np.array([ms for ms, *_ in answers])
    p50, p95 = np.percentile(taken, [50, 95])
    seconds = ", ".join(f"{name} {1e3 * value:.0f}" for name, value in cpu.items())
    return (
        f"{design}: {drags} drags, p50 {p50:.0f} p95 {p95:.0f} max {taken.max():.0f} ms; "
        f"processor ms a move: {seconds}; heap {heap[0]:.1f} to {heap[1]:.1f} MB"
    )


def _heap(page: Any) -> float:
    return float(page.evaluate("() => (gc(), gc(), performance.memory.usedJSHeapSize / 1e6)"))


def _seconds(server: int) -> dict[str, float]:
    """Processor seconds so far of the server's processes by what they do, and of the browser."""
    own = psutil.Process(server)
    found = {"server": _own_seconds(own)}
    children = sorted(own.children(recursive=True), key=lambda process: process.create_time())
    found["answers"] = sum(_own_seconds(child) for child in children)
    browsers = [p for p in psutil.Process().children(recursive=True) if "chrom" in p.name()]
    found["browser"] = sum(_own_seconds(browser) for browser in browsers)
    return found


def _own_seconds(process: psutil.Process) -> float:
    times = process.cpu_times()
    return float(times.user + times.system)


if __name__ == "__main__":
    main()
