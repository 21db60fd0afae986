"""A press on the 3D view: the form of what is there is opened, and a web face takes a new pocket."""

from __future__ import annotations

from typing import Any

import pytest

from tests.browser.bench_page import shown, stays_shown

pytest.importorskip("tornado")
PLACE = """(point) => {
    const { left, top } = document.querySelector("canvas").getBoundingClientRect();
    const at = (x, y) => document.querySelector("#viewer").sight(x, y).start;
    const less = (a, b) => a.map((x, i) => x - b[i]), dot = (a, b) => a.reduce((s, x, i) => s + x * b[i], 0);
    const o = at(left, top), right = less(at(left + 1, top), o), down = less(at(left, top + 1), o);
    const share = (way) => dot(less(point, o), way) / dot(way, way);
    return [left + share(right), top + share(down)];
}"""
"""Place of the window at which a point of the throw is drawn."""


def press(page: Any, *point_mm: float) -> None:
    """Press the canvas where a point of the throw is drawn."""
    x, y = page.evaluate(PLACE, list(point_mm))
    page.mouse.click(x, y)


@pytest.mark.slow
def test_a_press_opens_the_form_of_what_is_there_and_a_face_takes_a_hole(quick: Any) -> None:
    seen = quick("mikron-iiic")
    page = seen.page
    shown(page)
    page.evaluate("() => document.querySelectorAll('#tree details').forEach((one) => (one.open = false))")
    before = seen.picture()
    page.get_by_role("button", name="Front", exact=True).click()
    press(page, 0, -16, 39)
    page.wait_for_selector("#picked:has-text('Bevel 2')")
    bevel = page.locator("#tree details[data-path='web.bevel[1]']")
    assert bevel.get_attribute("open") is not None
    assert bevel.locator("summary").first.evaluate("(one) => one === document.activeElement")
    page.get_by_role("button", name="Side", exact=True).click()
    press(page, 0, 10, 10)
    page.wait_for_selector("#picked:has-text('Main journal: outer diameter')")
    field = page.locator("[id='f-throw.main_journal.outer_diameter_mm']")
    assert field.is_visible()
    assert field.evaluate("(one) => one === document.activeElement")
    page.get_by_role("button", name="Front", exact=True).click()
    press(page, 22, 24, 39)
    page.wait_for_selector("#picked:has-text('Pin face, x = 22.0, y = 24.0 mm')")
    page.get_by_role("button", name="Add hole here").click()
    page.wait_for_selector("#history li.here:has-text('added hole')")
    page.wait_for_selector("#picked:has-text('Pocket 1')")
    assert page.locator("[id='f-web.pocket[0].y_mm']").input_value() == "24"
    stays_shown(page)
    page.keyboard.press("Escape")
    assert page.locator("#picked").is_hidden()
    page.get_by_role("button", name="Crankpin side").click()
    assert (seen.picture() != before).any()
    assert seen.complaints == []


@pytest.mark.slow
def test_a_line_of_sight_goes_through_what_is_drawn_and_a_turn_is_no_press(quick: Any) -> None:
    """The edge of the web is drawn where its place says, by pixels; the view was turned before."""
    seen = quick("mikron-iiic-plain")
    page = seen.page
    shown(page)
    page.get_by_role("button", name="Front", exact=True).click()
    page.locator("#ghost").uncheck()
    picture = seen.picture()
    box = page.locator("canvas").bounding_box()
    for inside, beyond in ((24.0, 26.0), (-24.0, -26.0)):
        for x, drawn in ((inside, True), (beyond, False)):
            left, top = page.evaluate(PLACE, [x, 24, 39])
            column, row = ((at - box[name]) for at, name in ((left, "x"), (top, "y")))
            scale = picture.shape[1] / box["width"]
            assert (picture[int(row * scale), int(column * scale), 3] > 0) == drawn
    x, y = page.evaluate(PLACE, [0, 24, 39])
    page.mouse.move(x, y)
    page.mouse.down()
    page.mouse.move(x + 30, y, steps=3)
    page.mouse.up()
    page.wait_for_timeout(500)
    assert page.locator("#picked").is_hidden()
