"""The page of a sweep with 500 points, as a reader has it: opened from disk in a browser."""

from __future__ import annotations

import random
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from cranktopo.pipeline.sweep.front import front_of, picks_of
from cranktopo.report.pages.sweep_page import sweep_html

POINTS, MOST_BYTES, MOST_MS = 500, 10_000_000, 100.0
TORSION = "torsion_Nm_per_rad"
# A step of the user, and the layout that the browser makes of it.
TIMED = """() => {{
    const began = performance.now();
    ({act})();
    document.body.offsetHeight;
    return performance.now() - began;
}}"""


def points() -> list[dict[str, Any]]:
    draw, rows = random.Random(5), []
    for number in range(POINTS):
        width, thickness = draw.uniform(44, 60), draw.uniform(16, 22)
        mass, safety = 0.9 + 0.008 * width * thickness / 15, 1.2 + draw.gauss(0, 0.1)
        torsion = 2500 * width + draw.gauss(0, 900)
        rows.append(
            {
                "id": f"{number:012x}",
                "run": f"points/{number:012x}",
                "status": "done",
                "reason": "",
                "design": "mikron-iiic",
                "stage": "shape",
                "varied": {"web.width_mm": width, "web.thickness_mm": thickness},
                "mass_kg": mass,
                TORSION: torsion,
                "bending_N_per_mm": 2000 * width * thickness / 19,
                "torsion_per_mass_Nm_per_rad_kg": torsion / mass,
                "torsion_error_percent": 1.5,
                "fatigue_safety": safety,
                "bound_mass_kg": 1.2,
            }
        )
    rows[7] |= {"status": "impossible", "reason": "web.width_mm = 3: </script> <b>too thin</b> & more."}
    for name in [name for name in rows[7] if name.endswith(("_kg", "_rad", "_mm", "_safety", "_percent"))]:
        del rows[7][name]
    return rows


@pytest.fixture(scope="module")
def record() -> dict[str, Any]:
    rows = points()
    finished = [row for row in rows if row["status"] == "done"]
    original = {
        **rows[0],
        "id": "original",
        "mass_kg": 1.6,
        TORSION: 130_000.0,
        "bending_N_per_mm": 100_000.0,
    }
    front, objectives = front_of(finished)
    return {
        "run": "a-sweep",
        "design": "mikron-iiic",
        "varied": ["web.width_mm", "web.thickness_mm"],
        "points": rows,
        "ends": {"done": POINTS - 1, "impossible": 1},
        "original": original,
        "objectives": dict.fromkeys(objectives, "more"),
        "front": front,
        "picks": picks_of(finished, original),
        "files": {"table": "table.csv"},
    }


@pytest.fixture(scope="module")
def page_file(record: dict[str, Any], tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("sweep") / "report.html"
    path.write_text(sweep_html(record), encoding="utf-8")
    assert path.stat().st_size < MOST_BYTES
    return path


@pytest.fixture
def opened(browser: Any, page_file: Path) -> Iterator[Any]:
    """Open the page in a window; whatever it asks for or complains about fails the test."""
    contexts, said = [], list[str]()

    def visit(**window: Any) -> Any:
        contexts.append(browser.new_context(**{"viewport": {"width": 1200, "height": 800}, **window}))
        page = contexts[-1].new_page()
        page.on("console", lambda message: said.append(message.text))
        page.on("pageerror", lambda error: said.append(str(error)))
        page.on("request", lambda request: said.append(request.url))
        page.goto(page_file.as_uri())
        page.wait_for_selector("html[data-ready]", timeout=30_000)
        return page

    yield visit
    for context in contexts:
        context.close()
    assert set(said) == {page_file.as_uri()}


def timed(page: Any, act: str) -> float:
    """Least time of three of a step, ms: others use the machine too."""
    return min(float(page.evaluate(TIMED.format(act=act))) for _ in range(3))


def table_ids(page: Any) -> list[str]:
    found: list[str] = page.locator("[data-table] tbody tr:not(.base) th").all_inner_texts()
    return found


def test_plots_and_table_show_the_points(opened: Any, record: dict[str, Any]) -> None:
    page = opened()
    assert page.locator("[data-scatter] circle:not(.ring)").count() == POINTS - 1
    assert page.locator("[data-scatter] circle.front").count() == len(record["front"])
    assert page.locator("[data-scatter] .original").count() == 1
    assert page.locator("[data-scatter] .bound").count() == 1, "of the mass, which is across"
    assert page.locator("[data-parallel] path.row").count() == POINTS
    assert table_ids(page)[0] == record["points"][0]["id"]
    reason = page.locator("[data-table] td.reason").nth(7).inner_text()
    assert reason == "impossible: web.width_mm = 3: </script> <b>too thin</b> & more."
    line = page.locator("[data-front]").get_attribute("d")
    reached = [float(y) for y in re.findall(r"L[\d.]+ ([\d.]+)", line)]
    assert reached == sorted(reached, reverse=True), "the front goes up with the mass"


def test_filter_sort_and_hover_are_linked_and_quick(opened: Any, record: dict[str, Any]) -> None:
    page = opened()
    names = page.evaluate(
        'JSON.parse(document.getElementById("sweep-data").textContent).columns.map((c) => c.name)'
    )
    mass, torsion = names.index("mass_kg"), names.index(TORSION)
    sort = f"() => document.querySelector('[data-sort=\"{torsion}\"]').click()"
    assert timed(page, sort) < MOST_MS
    rows = [row for row in record["points"] if TORSION in row]
    highest = sorted(rows, key=lambda row: -float(f"{row[TORSION]:.6g}"))
    assert table_ids(page)[:3] == [row["id"] for row in highest[:3]]
    field = f'document.querySelector(\'[data-filter="{mass}"][data-end="1"]\')'
    told = "dispatchEvent(new Event('input', {bubbles: true}))"
    put = f"() => {{ const field = {field}; field.value = 1.4; field.{told}; }}"
    assert timed(page, put) < MOST_MS
    light = [row for row in rows if row["mass_kg"] <= 1.4]
    assert page.locator("[data-count]").inner_text() == f"{len(light)} of {POINTS} points"
    assert page.locator("[data-scatter] circle:not(.out):not(.ring)").count() == len(light)
    assert page.locator("[data-parallel] path.row:not(.out)").count() == len(light)
    dot = page.locator("[data-scatter] circle:not(.out)").first
    dot.scroll_into_view_if_needed()
    box = dot.bounding_box()
    page.mouse.move(box["x"] + box["width"] / 2, box["y"] + box["height"] / 2)
    shown = page.locator("[data-detail] .title").inner_text().split(",")[0]
    assert shown in {row["id"] for row in light}
    assert page.locator("[data-scatter] .error").count() == 1, "the error of the torsion"
    spot = f"clientX: {box['x']} + 9 * Math.random(), clientY: {box['y']}, bubbles: true"
    moved = f"new PointerEvent('pointermove', {{{spot}}})"
    hover = f"() => document.querySelector('[data-scatter] svg').dispatchEvent({moved})"
    assert timed(page, hover) < MOST_MS
    page.get_by_role("button", name="Clear").click()
    assert page.locator("[data-count]").inner_text() == f"{POINTS} of {POINTS} points"


def test_a_range_is_dragged_along_an_axis(opened: Any) -> None:
    page = opened()
    page.locator("#coordinates").scroll_into_view_if_needed()
    box = page.locator("[data-lane='0']").bounding_box()
    x = box["x"] + box["width"] / 2
    page.mouse.move(x, box["y"] + 2)
    page.mouse.down()
    page.mouse.move(x, box["y"] + box["height"] / 2, steps=4)
    page.mouse.up()
    kept = int(page.locator("[data-count]").inner_text().split()[0])
    assert 0.35 * POINTS < kept < 0.65 * POINTS, "the upper half of the widths"
    page.mouse.click(x, box["y"] + 5)
    assert page.locator("[data-count]").inner_text().startswith(f"{POINTS} of")


def test_picks_lead_to_their_point(opened: Any, record: dict[str, Any]) -> None:
    page = opened()
    for number, one in enumerate(record["picks"].values()):
        page.locator("[data-pick]").nth(number).click()
        assert page.locator("[data-detail] .title").inner_text().startswith(one)


@pytest.mark.parametrize(
    "window", [{}, {"color_scheme": "dark"}, {"viewport": {"width": 360, "height": 740}}]
)
def test_screens_and_paper(opened: Any, record: dict[str, Any], window: dict[str, Any]) -> None:
    page = opened(**window)
    width = page.viewport_size["width"]
    assert page.evaluate("document.documentElement.scrollWidth") <= width
    light = page.evaluate("getComputedStyle(document.body).backgroundColor") == "rgb(246, 247, 249)"
    assert light == (window.get("color_scheme") != "dark")
    page.evaluate("dispatchEvent(new Event('beforeprint'))")
    page.emulate_media(media="print")
    assert page.locator("#filters").is_hidden()
    shown = page.locator("[data-table] tbody tr:visible")
    assert shown.count() == 1 + len(record["front"]), "the original and the front"
