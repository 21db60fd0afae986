"""The page of a sweep with 500 points, as a reader has it: opened from disk in a browser."""

from __future__ import annotations

import itertools
import json
import random
import re
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import trimesh

from cranktopo.design.loading import load_scene, scene_from_dict, with_value
from cranktopo.design.schema import Scene
from cranktopo.numerics.surfaces.mesh import SurfaceMesh
from cranktopo.report.viewer.scene3d import ShownBody
from cranktopo.report.viewer.small_web import packed_web
from cranktopo.tasks.sweep.front import front_of, picks_of
from cranktopo.tasks.sweep.page import sweep_html
from cranktopo.tasks.sweep.result import PointResult, SweepFiles, SweepResult, SweepSeconds
from cranktopo.tasks.sweep.stages import web_view
from cranktopo.tasks.throw_fea.targets import Target, simulated
from tests.browser.bench_page import START_MS
from tests.browser.conftest import READS
from tests.page_text import typed
from tests.sweep_cases import point_result

POINTS, MOST_BYTES, MOST_MS = 500, 10_000_000, 100.0
NARROW_MM, WIDE_MM = 48.0, 60.0
TORSION = "torsion_Nm_per_rad"
# From the pointer's move to the picture of that point's web, ms.
SEEN = """([x, y, i]) => new Promise((done) => {
    const viewer = document.getElementById("viewer"), began = performance.now();
    new MutationObserver((_, observer) => {
        if (viewer.dataset.web !== String(i)) return;
        observer.disconnect();
        done(performance.now() - began);
    }).observe(viewer, { attributes: true });
    const moved = new PointerEvent("pointermove", { clientX: x, clientY: y, bubbles: true });
    document.querySelector("[data-scatter] svg").dispatchEvent(moved);
})"""
# Columns of the canvas in which the web's blue is seen.
BLUE = """() => {
    const canvas = document.querySelector("canvas"), gl = canvas.getContext("webgl2");
    const [w, h] = [canvas.width, canvas.height], pixels = new Uint8Array(4 * w * h), seen = new Set();
    gl.readPixels(0, 0, w, h, gl.RGBA, gl.UNSIGNED_BYTE, pixels);
    for (let n = 0; n < w * h; n++) if (pixels[4 * n + 2] > 1.5 * pixels[4 * n]) seen.add(n % w);
    return seen.size;
}"""
# A step of the user, and the layout that the browser makes of it.
TIMED = """() => {{
    const began = performance.now();
    ({act})();
    document.body.offsetHeight;
    return performance.now() - began;
}}"""


def points() -> list[PointResult]:
    draw, rows = random.Random(5), list[dict[str, Any]]()
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
                "design": "mikron-iiic-plain",
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
    return [point_result(str(row.pop("id")), **row) for row in rows]


@pytest.fixture(scope="module")
def record() -> SweepResult:
    rows = points()
    finished = [row for row in rows if row.status == "done"]
    other = {"id": "original", "mass_kg": 1.6, TORSION: 130_000.0, "bending_N_per_mm": 100_000.0}
    original = PointResult(**{**rows[0].as_json(), **other})
    front, objectives = front_of(finished)
    return SweepResult(
        run="a-sweep",
        design="mikron-iiic-plain",
        varied=("web.width_mm", "web.thickness_mm"),
        sampling="grid",
        points=tuple(rows),
        ends={"done": POINTS - 1, "impossible": 1},
        original=original,
        objectives=dict.fromkeys(objectives, "more"),
        front=tuple(front),
        picks=picks_of(finished, original),
        files=SweepFiles(table="table.csv", parquet="table.parquet", page="report.html"),
        seconds=SweepSeconds(total=1.0),
    )


@pytest.fixture(scope="module")
def webs(record: SweepResult) -> dict[str, str]:
    """A web for every point that has one: by turns a narrow one, a wide one, and one with bumps."""
    exact = [web_view(Target("web", scene)) for scene in map(with_width, (NARROW_MM, WIDE_MM))]
    kinds = [*exact, packed_web(rough_web())]
    done = [row.id for row in record.points if row.status == "done"]
    return {"original": exact[0], **dict(zip(done, itertools.cycle(kinds), strict=False))}


def with_width(width_mm: float) -> Scene:
    tables = with_value(load_scene("mikron-iiic-plain").model_dump(mode="json"), "web.width_mm", width_mm)
    return simulated(scene_from_dict(tables, "test"))


def rough_web() -> ShownBody:
    """A body with bumps all over, as heavy to pack as any that an optimisation leaves."""
    body = trimesh.creation.icosphere(subdivisions=5, radius=40.0)
    bumps = 1 + 0.02 * np.sin(0.3 * body.vertices).prod(axis=1, keepdims=True)
    mesh = SurfaceMesh(np.asarray(body.vertices * bumps), np.asarray(body.faces, np.int64))
    return ShownBody("rough", mesh, (-10.0, 10.0), 40.0)


@pytest.fixture(scope="module")
def page_file(record: SweepResult, webs: dict[str, str], tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("sweep") / "report.html"
    path.write_text(sweep_html(record, webs), encoding="utf-8")
    assert path.stat().st_size < MOST_BYTES
    return path


@contextmanager
def windows(browser: Any, page_file: Path) -> Iterator[Any]:
    """Open the page in windows; whatever it asks for or complains about fails the block."""
    contexts, said = [], list[str]()

    def visit(**window: Any) -> Any:
        contexts.append(browser.new_context(**{"viewport": {"width": 1200, "height": 800}, **window}))
        page = contexts[-1].new_page()
        page.on("console", lambda message: said.append(message.text) if READS not in message.text else None)
        page.on("pageerror", lambda error: said.append(str(error)))
        page.on("request", lambda request: said.append(request.url))
        page.set_default_timeout(START_MS)
        page.goto(page_file.as_uri(), timeout=START_MS)
        page.wait_for_selector("html[data-ready] #viewer[data-pictures]")
        return page

    yield visit
    for context in contexts:
        context.close()
    assert set(said) == {page_file.as_uri()}


@pytest.fixture
def opened(browser: Any, page_file: Path) -> Iterator[Any]:
    with windows(browser, page_file) as visit:
        yield visit


@pytest.fixture(scope="module")
def read(browser: Any, page_file: Path) -> Iterator[Any]:
    """The page in one window, for what only reads it."""
    with windows(browser, page_file) as visit:
        yield visit()


def timed(page: Any, act: str) -> float:
    """Least time of three of a step, ms: others use the machine too."""
    return min(float(page.evaluate(TIMED.format(act=act))) for _ in range(3))


def table_ids(page: Any) -> list[str]:
    found: list[str] = page.locator("[data-table] tbody tr:not(.base) th").all_inner_texts()
    return found


def test_plots_and_table_show_the_points(read: Any, record: SweepResult) -> None:
    page = read
    assert page.locator("[data-scatter] circle:not(.ring)").count() == POINTS - 1
    assert page.locator("[data-scatter] circle.front").count() == len(record.front)
    assert page.locator("[data-scatter] .error").count() == len(record.front), "of the torsion"
    assert page.locator("[data-scatter] .original").count() == 1
    assert page.locator("[data-scatter] .bound").count() == 1, "of the mass, which is across"
    assert page.locator("[data-parallel] path.row").count() == POINTS
    assert table_ids(page)[0] == record.points[0].id
    reason = page.locator("[data-table] td.reason").nth(7).inner_text()
    assert reason == "impossible: web.width_mm = 3: </script> <b>too thin</b> & more."
    line = page.locator("[data-front]").get_attribute("d")
    reached = [float(y) for y in re.findall(r"L[\d.]+ ([\d.]+)", line)]
    assert reached == sorted(reached, reverse=True), "the front goes up with the mass"


@pytest.mark.slow
def test_filter_sort_and_hover_are_linked_and_quick(opened: Any, record: SweepResult) -> None:
    page = opened()
    names = page.evaluate(
        'JSON.parse(document.getElementById("sweep-data").textContent).columns.map((c) => c.name)'
    )
    mass, torsion = names.index("mass_kg"), names.index(TORSION)
    sort = f"() => document.querySelector('[data-sort=\"{torsion}\"]').click()"
    assert timed(page, sort) < MOST_MS
    rows = [row for row in record.points if row.number(TORSION) is not None]
    highest = sorted(rows, key=lambda row: -float(f"{row.number(TORSION):.6g}"))
    assert table_ids(page)[:3] == [row.id for row in highest[:3]]
    field = f'document.querySelector(\'[data-filter="{mass}"][data-end="1"]\')'
    told = "dispatchEvent(new Event('input', {bubbles: true}))"
    put = f"() => {{ const field = {field}; field.value = 1.4; field.{told}; }}"
    assert timed(page, put) < MOST_MS
    light = [row for row in rows if row.number("mass_kg") <= 1.4]
    assert page.locator("[data-count]").inner_text() == f"{len(light)} of {POINTS} points"
    assert page.locator("[data-scatter] circle:not(.out):not(.ring)").count() == len(light)
    assert page.locator("[data-parallel] path.row:not(.out)").count() == len(light)
    dot = page.locator("[data-scatter] circle:not(.out)").first
    dot.scroll_into_view_if_needed()
    box = dot.bounding_box()
    page.mouse.move(box["x"] + box["width"] / 2, box["y"] + box["height"] / 2)
    shown = page.locator("[data-detail] .title").inner_text().split(",")[0]
    assert shown in {row.id for row in light}
    assert page.locator("[data-mark] .error").count() == 1, "the error of the torsion"
    spot = f"clientX: {box['x']} + 9 * Math.random(), clientY: {box['y']}, bubbles: true"
    moved = f"new PointerEvent('pointermove', {{{spot}}})"
    hover = f"() => document.querySelector('[data-scatter] svg').dispatchEvent({moved})"
    assert timed(page, hover) < MOST_MS
    page.get_by_role("button", name="Clear").click()
    assert page.locator("[data-count]").inner_text() == f"{POINTS} of {POINTS} points"


def centre(place: Any) -> tuple[float, float]:
    box = place.bounding_box()
    return box["x"] + box["width"] / 2, box["y"] + box["height"] / 2


@pytest.mark.slow
def test_the_web_under_the_cursor_is_drawn_at_once(opened: Any) -> None:
    """As wide as it is, in the original's scale; within the limit for most of a dozen points."""
    page = opened()
    page.get_by_role("button", name="Front").click()
    page.locator("[data-scatter]").scroll_into_view_if_needed()
    times, widths = list[float](), dict[int, float]()
    for number in range(8, 20):
        dot = page.locator(f"[data-scatter] circle[data-i='{number}']")
        page.locator("[data-axis='x']").select_option(label="web.width, mm")
        times.append(page.evaluate(SEEN, [*centre(dot), number]))
        # The seventh has no web, so that those behind it come one earlier.
        widths[(number - 1) % 3] = page.evaluate(BLUE)
    assert sorted(times)[len(times) // 2] < MOST_MS, times
    assert widths[1] / widths[0] == pytest.approx(WIDE_MM / NARROW_MM, rel=0.03)


@pytest.mark.slow
def test_keys_and_rows_lead_to_the_web(opened: Any, record: SweepResult) -> None:
    page, rows = opened(), record.points
    page.locator("[data-scatter]").focus()
    for _ in range(2):
        page.keyboard.press("ArrowRight")
    by_mass = sorted((i for i in range(POINTS) if i != 7), key=lambda i: rows[i].number("mass_kg"))
    page.wait_for_selector(f"#viewer[data-web='{by_mass[1]}']")
    page.keyboard.press("Enter")
    page.locator("[data-table] tr[data-i='7']").focus()
    page.wait_for_selector("#viewer.missing")
    assert page.locator("[data-web-of]").inner_text() == "no web: impossible"
    page.locator("[data-scatter]").focus()
    page.wait_for_selector(f"#viewer[data-web='{by_mass[1]}']:not(.missing)")
    page.keyboard.press("Escape")
    page.wait_for_selector("#viewer[data-web='']")
    assert page.locator("[data-web-of]").inner_text() == "original web"


@pytest.mark.slow
def test_a_touch_shows_the_web(opened: Any) -> None:
    page = opened(viewport={"width": 390, "height": 780}, has_touch=True)
    dot = page.locator("[data-scatter] circle[data-i='12']")
    dot.scroll_into_view_if_needed()
    page.touchscreen.tap(*centre(dot))
    page.wait_for_function("document.getElementById('viewer').dataset.web > ''")
    shown = page.locator("[data-detail] .title").inner_text().split(",")[0]
    assert page.locator("[data-web-of]").inner_text() == f"web of {shown}"


def test_a_page_without_room_keeps_the_webs_of_picks_and_front(record: SweepResult) -> None:
    large = {row.id: "x" * 300_000 for row in [*record.points, record.original]}
    text = sweep_html(record, large)
    assert len(text) < MOST_BYTES
    kept = json.loads(text.split('id="sweep-webs" type="application/json">')[1].split("</script>")[0])
    first = list(dict.fromkeys([*record.picks.values(), *record.front]))[:20]
    assert all(kept[int(one, 16)] for one in first)
    assert kept.count(None) > 400
    assert 'id="viewer"' not in sweep_html(record, {})


@pytest.mark.slow
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


@pytest.mark.slow
def test_picks_lead_to_their_point(opened: Any, record: SweepResult) -> None:
    page = opened()
    for number, one in enumerate(record.picks.values()):
        page.locator("[data-pick]").nth(number).click()
        assert page.locator("[data-detail] .title").inner_text().startswith(one)


def test_a_pick_says_first_what_got_worse_and_its_mass(read: Any, record: SweepResult) -> None:
    page = read
    for number, one in enumerate(record.picks.values()):
        point = next(row for row in record.points if row.id == one)
        pick = page.locator("[data-pick]").nth(number)
        words = [part.strip() for part in typed(pick.locator("small").inner_text()).split(";")]
        change = 100 * (point.number("mass_kg") / record.original.number("mass_kg") - 1)
        assert f"mass {point.number('mass_kg'):.4g} kg, {change:+.1f} %" in words
        worse = [typed(part) for part in pick.locator("small .worse").all_inner_texts()]
        assert words[: len(worse)] == worse
        assert pick.locator("strong").inner_text().startswith("web width ")


@pytest.mark.slow
def test_numbers_have_the_digits_of_their_error(opened: Any, record: SweepResult) -> None:
    page = opened()
    cells = page.locator("[data-table] tbody tr:not(.base)").first.locator("td").all_inner_texts()
    assert f"{record.points[0].number(TORSION) / 1000:.4g}" in cells
    assert "kN m/rad" in page.locator("[data-table] thead").inner_text()
    ticks = page.locator("[data-scatter] .tick").all_text_contents()
    assert max(float(tick.replace(",", "")) for tick in ticks) < 1000
    assert page.locator("[data-table] td.reason").nth(7).bounding_box()["height"] < 60


@pytest.mark.slow
@pytest.mark.parametrize(
    "window",
    [
        {},
        {"color_scheme": "dark"},
        {"viewport": {"width": 360, "height": 740}},
    ],
)
def test_screens_and_paper(opened: Any, record: SweepResult, window: dict[str, Any]) -> None:
    page = opened(**window)
    width = page.viewport_size["width"]
    assert page.evaluate("document.documentElement.scrollWidth") <= width
    light = page.evaluate("getComputedStyle(document.body).backgroundColor") == "rgb(246, 247, 249)"
    assert light == (window.get("color_scheme") != "dark")
    page.evaluate("dispatchEvent(new Event('beforeprint'))")
    page.emulate_media(media="print")
    assert page.locator("#filters").is_hidden()
    shown = page.locator("[data-table] tbody tr:visible")
    assert shown.count() == 1 + len(record.front), "the original and the front"
    assert page.locator("[data-detail] .title").is_hidden(), "nobody points at paper"
    mark = page.locator(".mark.point").evaluate("m => getComputedStyle(m).printColorAdjust")
    canvas = page.locator("#viewer canvas").evaluate("c => getComputedStyle(c).objectFit")
    assert canvas == "contain", "the web keeps its proportions"
    assert mark == "exact", "or the names of the plot's signs are without them"
    page.evaluate("document.documentElement.classList.remove('has-3d')")
    assert not page.locator("#point").is_visible(), "no heading over nothing where there is no 3D"
