"""Pictures of the bench at the sizes that it is used at, and the check that nothing of it is cut.

    python -m tests.studies.bench_pictures [FOLDER]

With a folder every size is pictured, light and dark, on the first page and with a design; without one the
picture of the documentation is taken anew.
"""

from __future__ import annotations

import sys
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from PIL import Image

from tests.browser.bench_page import running_bench, set_slider, settled, shown, stays_shown
from tests.browser.conftest import opened_browser

PICTURE = Path(__file__).parents[2] / "docs" / "pages" / "images" / "bench.png"
COLOURS = 128
SIZES: dict[str, dict[str, Any]] = {
    "desk": {"viewport": {"width": 1280, "height": 800}},
    "wide": {"viewport": {"width": 3840, "height": 2160}},
    "tablet": {"viewport": {"width": 820, "height": 1180}, "has_touch": True},
    "phone": {"viewport": {"width": 390, "height": 844}, "has_touch": True, "device_scale_factor": 2},
}
"""Windows of the browser by what they stand for."""
CUT = """() => {
    const width = document.documentElement.clientWidth, found = [];
    const named = (node) => node.id || node.className.baseVal || node.className || node.tagName;
    const whole = document.documentElement.scrollWidth;
    if (whole > width) found.push(`the page: ${whole}`);
    for (const node of document.body.querySelectorAll("*")) {
        if (node.closest("svg, .scroll, .skip, datalist") || !node.checkVisibility()) continue;
        const box = node.getBoundingClientRect();
        if (box.width && (box.right > width + 1 || box.left < -1))
            found.push(`${named(node)}: ${box.left} to ${box.right}`);
        const sideways = getComputedStyle(node).overflowX;
        const inner = node.scrollWidth - node.clientWidth;
        const clips = sideways !== "visible" || node.tagName === "BUTTON";
        if (inner > 1 && clips && !node.matches("input, select"))
            found.push(`${named(node)}: cut by ${inner}`);
    }
    return found;
}"""
"""Parts that stick out of the window, or are cut at its side; tables scroll in a box of their own."""


def main(folder: Path | None) -> None:
    """Take the pictures, and tell what is cut."""
    with TemporaryDirectory() as work, opened_browser() as browser:
        with running_bench(Path(work)) as (_, address):
            for name, window in SIZES.items() if folder else ():
                _first_page(browser, address, folder / f"first-{name}", window)
        with running_bench(Path(work), "mikron-iiic") as (_, address):
            for name, window in SIZES.items() if folder else ():
                _in_use(browser, address, folder / name, window)
            if folder is None:
                _documentation(browser, address)


def _first_page(browser: Any, address: str, path: Path, window: dict[str, Any]) -> None:
    page = browser.new_context(**window).new_page()
    page.goto(address)
    page.wait_for_selector("#begin:not([hidden])")
    _pictured(page, path)


def _in_use(browser: Any, address: str, path: Path, window: dict[str, Any]) -> None:
    page = _dragged(browser, address, window)
    _pictured(page, path)


def _dragged(browser: Any, address: str, window: dict[str, Any]) -> Any:
    page = browser.new_context(**window).new_page()
    page.goto(address)
    shown(page)
    settled(page)
    set_slider(page, "web.width_mm", 54, release=False)
    page.wait_for_function("() => Number(document.querySelector('#viewer').dataset.shown) > 0")
    stays_shown(page)
    return page


def _pictured(page: Any, path: Path) -> None:
    for scheme in ("light", "dark"):
        page.emulate_media(color_scheme=scheme)
        page.screenshot(path=f"{path}-{scheme}.png", full_page=True)
    for line in page.evaluate(CUT):
        print(f"{path.name}: {line}")
    page.context.close()


def _documentation(browser: Any, address: str) -> None:
    page = _dragged(browser, address, SIZES["desk"])
    page.locator("#hint button").click()
    page.wait_for_selector("[data-gauge=torsion] .ring:has-text('coarse')")
    page.screenshot(path=PICTURE)
    image = Image.open(PICTURE).convert("RGB").quantize(COLOURS, dither=Image.Dither.NONE)
    image.save(PICTURE, optimize=True)


if __name__ == "__main__":
    main(Path(sys.argv[1]) if len(sys.argv) > 1 else None)
