"""The report of a run as a reader has it: opened from disk in a browser."""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from tests.browser.conftest import Visit, windows
from tests.page_text import typed

MOST_BYTES = 8_000_000


def is_grey(picture: np.ndarray) -> np.ndarray:
    """Pixels of journals: opaque and without a hue."""
    return (picture[:, :, 3] == 255) & (np.ptp(picture[:, :, :3], axis=2) < 12)


def is_blue(picture: np.ndarray) -> np.ndarray:
    """Pixels of the web."""
    return (picture[:, :, 3] == 255) & (picture[:, :, 2] - picture[:, :, 0] > 30)


@pytest.fixture(scope="module")
def read(browser: Any, run: Path) -> Iterator[Visit]:
    """The report in one window, for what only reads it."""
    with windows(browser) as visit:
        yield visit(run / "report.html")


def test_one_small_file_that_asks_for_nothing(read: Visit, run: Path) -> None:
    report, seen = run / "report.html", read
    assert 100_000 < report.stat().st_size < MOST_BYTES
    assert seen.complaints == []
    assert seen.requests == [report.resolve().as_uri()]
    text = report.read_text(encoding="utf-8")
    assert not re.search(r"""(src|href)\s*=\s*["'](https?:)?//""", text)
    assert not re.search(r"\bimport\s*\(|@import|fetch\(|XMLHttpRequest", text)


def test_tables_hold_the_metrics(read: Visit, metrics: dict[str, Any]) -> None:
    page = read.page
    rows = page.locator("#variants table").first.locator("tbody tr")
    cells = [
        [float(v) for v in rows.nth(i).locator("td").evaluate_all("c => c.map(x => x.dataset.value)")]
        for i in range(2)
    ]
    for found, part in zip(cells, (metrics["original_web"], metrics), strict=True):
        torsion = part["load_cases"]["torsion"]["stiffness_Nm_per_rad"]
        bending = part["load_cases"]["bending"]["stiffness_N_per_mm"]
        expected = [part["mass_kg"]["throw"], part["mass_kg"]["web"], torsion / 1e3, bending / 1e3]
        ratios = part["stiffness_per_mass"]
        expected += [ratios["torsion_Nm_per_rad_kg"] / 1e3, ratios["bending_N_per_mm_kg"] / 1e3]
        np.testing.assert_allclose(found, expected, rtol=1e-12)
    shown = rows.nth(1).locator("td").all_inner_texts()
    assert shown[0] == f"{metrics['mass_kg']['throw']:.3f}"
    effects = page.locator("#effects tbody tr")
    assert effects.count() == len(metrics["effects"])
    for row, effect in enumerate(metrics["effects"]):
        assert effect["reason"] in typed(effects.nth(row).inner_text())


def test_verdict_comes_first(read: Visit, metrics: dict[str, Any]) -> None:
    page = read.page
    first = page.locator("main > section").first
    assert first.get_attribute("id") == "verdict"
    gain = metrics["original_web"]["gain_of_stiffness_per_mass_percent"]
    text = typed(first.inner_text())
    for value in (f"{gain['torsion']:+.1f} %", f"{gain['bending']:+.1f} %", "Fatigue", "Released by a die"):
        assert value in text
    assert f"{metrics['mass_kg']['throw']:.3f} kg" in text


@pytest.mark.slow
def test_the_throw_is_drawn_the_right_way_round(visit: Any, run: Path) -> None:
    """From the crankpin side the pin is in front: a grey ring above the middle, the web around and below."""
    seen = visit(run / "report.html")
    seen.page.get_by_role("button", name="Front").click()
    picture = seen.picture()
    grey, blue = is_grey(picture), is_blue(picture)
    assert blue.sum() > 0.03 * grey.size
    assert grey.sum() > 0.01 * grey.size
    middle = picture.shape[0] / 2
    assert np.nonzero(grey)[0].mean() < middle - 20 < middle < np.nonzero(blue)[0].mean()
    ring = np.nonzero(grey)
    centre = picture[int(ring[0].mean()), int(ring[1].mean())]
    assert centre[3] == 0, "one looks through the bore"
    seen.page.get_by_role("button", name="Journal side").click()
    assert np.nonzero(is_grey(seen.picture()))[0].mean() > middle, "the journal is below"


@pytest.mark.slow
def test_the_front_view_is_that_of_a_drawing(visit: Any, run: Path) -> None:
    """Parallel, so that the outline from behind is its mirror image, and with edges."""
    seen = visit(run / "report.html")
    front = seen.page.get_by_role("button", name="Front")
    front.click()
    before = seen.picture()
    front.evaluate("button => button.dataset.view = '3.14159265,0'")
    front.click()
    behind = seen.picture()[:, ::-1]
    solid = before[:, :, 3] == 255
    assert (solid != (behind[:, :, 3] == 255)).sum() < 0.01 * solid.sum()
    edge = solid & (before[:, :, :3].max(axis=2) < 40)
    assert 0.002 < edge.sum() / solid.sum() < 0.05


@pytest.mark.slow
def test_keys_turn_zoom_and_reset(visit: Any, run: Path) -> None:
    seen = visit(run / "report.html")
    start = seen.picture()
    canvas = seen.page.locator("canvas")
    canvas.focus()
    for key in ("ArrowLeft", "ArrowUp", "+"):
        canvas.press(key)
        assert (seen.picture() != start).any(axis=2).mean() > 0.01, key
        canvas.press("Home")
        np.testing.assert_array_equal(seen.picture(), start)


@pytest.mark.slow
def test_pointer_turns(visit: Any, run: Path) -> None:
    seen = visit(run / "report.html")
    start = seen.picture()
    canvas = seen.page.locator("canvas")
    canvas.scroll_into_view_if_needed()
    box = canvas.bounding_box()
    x, y = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
    seen.page.mouse.move(x, y)
    seen.page.mouse.down()
    seen.page.mouse.move(x + 80, y, steps=4)
    seen.page.mouse.up()
    assert (seen.picture() != start).any(axis=2).mean() > 0.02


@pytest.mark.slow
def test_whole_throw_is_longer(visit: Any, run: Path) -> None:
    seen = visit(run / "report.html")
    seen.page.get_by_role("button", name="Side", exact=True).click()
    assert is_grey(seen.picture()).any(axis=0).any()
    half = np.ptp(np.nonzero(seen.picture()[:, :, 3])[1]) / np.ptp(np.nonzero(seen.picture()[:, :, 3])[0])
    seen.page.get_by_label("Whole throw").check()
    whole = np.ptp(np.nonzero(seen.picture()[:, :, 3])[1]) / np.ptp(np.nonzero(seen.picture()[:, :, 3])[0])
    assert whole > 1.5 * half


@pytest.mark.slow
def test_slider_shows_every_iteration_by_keyboard(visit: Any, run: Path, metrics: dict[str, Any]) -> None:
    seen = visit(run / "report.html")
    slider, text = seen.page.locator("[data-step]"), seen.page.locator("[data-step-text]")
    final = seen.picture()
    assert text.inner_text() == "Final surface"
    slider.focus()
    slider.press("Home")
    assert text.inner_text().startswith("Iteration 1: ")
    slider.press("ArrowRight")
    assert text.inner_text().startswith("Iteration 2: ")
    assert slider.get_attribute("aria-valuetext") == text.inner_text()
    second = seen.picture()
    assert (second != final).any(axis=2).mean() > 0.02
    for _ in range(metrics["iterations"] - 2):
        slider.press("ArrowRight")
    last = text.inner_text()
    assert last.startswith(f"Iteration {metrics['iterations']}: ")
    assert f"greyness {metrics['greyness']:.3f}" in last
    assert (seen.picture() != second).any(axis=2).mean() > 0.02
    slider.press("End")
    np.testing.assert_array_equal(seen.picture(), final)


@pytest.mark.slow
def test_play_runs_to_the_final_surface(visit: Any, run: Path) -> None:
    seen = visit(run / "report.html")
    # All texts, because on a busy machine the first is gone before it can be asked for.
    seen.page.evaluate(
        """() => {
            const text = document.querySelector("[data-step-text]");
            window.shown = [];
            new MutationObserver(() => shown.push(text.textContent)).observe(
                text, { childList: true, characterData: true, subtree: true });
        }"""
    )
    seen.page.get_by_role("button", name="Play").click()
    seen.page.wait_for_function("shown.length > 0")
    assert seen.page.evaluate("shown[0]").startswith("Iteration 1: ")
    seen.page.wait_for_function("document.querySelector('[data-step-text]').textContent === 'Final surface'")
    assert seen.page.get_by_role("button", name="Play").is_visible()


def test_all_controls_are_reached_by_tab(read: Visit) -> None:
    page = read.page
    reached = set()
    for _ in range(40):
        page.keyboard.press("Tab")
        reached.add(page.evaluate("document.activeElement.outerHTML.slice(0, 60)"))
    wanted = page.locator("#view canvas, #view input:visible, #view button").evaluate_all(
        "c => c.map(x => x.outerHTML.slice(0, 60))"
    )
    assert len(wanted) >= 7
    assert set(wanted) <= reached


def test_pictures_have_words(read: Visit) -> None:
    page = read.page
    words = page.locator("img").evaluate_all("c => c.map(x => x.alt)")
    words += page.locator("svg").evaluate_all("c => c.map(x => x.getAttribute('aria-label'))")
    words += page.locator("canvas").evaluate_all("c => c.map(x => x.getAttribute('aria-label'))")
    assert len(words) >= 9
    assert all(len(text) > 20 for text in words)


@pytest.mark.slow
@pytest.mark.parametrize("width", [360, 820])
def test_narrow_screens_need_no_sideways_scrolling(visit: Any, run: Path, width: int) -> None:
    page = visit(run / "report.html", viewport={"width": width, "height": 780}, is_mobile=True).page
    assert page.evaluate("document.documentElement.scrollWidth") <= width


@pytest.mark.slow
def test_dark_and_paper(visit: Any, run: Path) -> None:
    seen = visit(run / "report.html", color_scheme="dark")
    background = "getComputedStyle(document.body).backgroundColor"
    dark = [int(n) for n in re.findall(r"\d+", seen.page.evaluate(background))[:3]]
    ink = seen.page.locator("figure svg").first.evaluate("s => getComputedStyle(s).color")
    assert max(dark) < 60 < 180 < min(int(n) for n in re.findall(r"\d+", ink)[:3])
    seen.page.emulate_media(media="print")
    assert not seen.page.locator("canvas").is_visible()
    still = seen.page.locator(".still img")
    assert still.is_visible()
    assert still.evaluate("i => i.naturalWidth") > 1000
    assert seen.page.evaluate(background) == "rgb(255, 255, 255)"
