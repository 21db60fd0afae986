"""The bench in windows of every size: nothing sticks out of the page or is cut, light and dark."""

from __future__ import annotations

from typing import Any

import pytest

from tests.browser.bench_page import set_slider, shown
from tests.studies.bench_pictures import CUT, SIZES

pytest.importorskip("tornado")
SLOW = pytest.mark.slow
OVERLAPS = """() => {
    const names = [...document.querySelectorAll("#front [data-handle]:not(.quiet) text")], found = [];
    const boxes = names.map((name) => name.getBBox());
    for (const [i, one] of boxes.entries())
        for (const [j, two] of boxes.entries())
            if (i < j && one.x < two.x + two.width && two.x < one.x + one.width
                && Math.abs(one.y - two.y) < 0.7 * one.height)
                found.push(`${names[i].textContent} on ${names[j].textContent}`);
    return found;
}"""


@SLOW
@pytest.mark.parametrize("size", SIZES)
def test_nothing_is_cut(quick: Any, size: str) -> None:
    """The choice of a file stuck out of the first page on a tablet, names of handles stood on each other."""
    page = quick(**SIZES[size]).page
    page.wait_for_selector("#begin:not([hidden])")
    assert page.evaluate(CUT) == []
    page.get_by_role("button", name="mikron-iiic", exact=True).click()
    shown(page)
    set_slider(page, "web.width_mm", 54, release=True)
    page.wait_for_selector("#history li.here:has-text('width: 54 mm')")
    page.evaluate("() => document.querySelectorAll('#tree details').forEach((one) => (one.open = true))")
    assert page.evaluate(CUT) == []
    assert page.evaluate(OVERLAPS) == []


@SLOW
def test_light_and_dark_can_be_read(quick: Any) -> None:
    """Text against its ground has a contrast of at least 4.5, as WCAG 2.1 asks for; what is stale, 3."""
    page = quick("mikron-iiic-plain").page
    shown(page)
    for scheme in ("light", "dark"):
        page.emulate_media(color_scheme=scheme)
        colours = page.evaluate(
            """() => Object.fromEntries(
                ["page", "panel", "ink", "muted", "accent", "good", "bad", "wait"].map((name) =>
                [name, getComputedStyle(document.documentElement).getPropertyValue(`--${name}`).trim()]))"""
        )
        for ground in ("page", "panel"):
            for name in ("ink", "muted", "accent", "good", "bad", "wait"):
                assert contrast(colours[name], colours[ground]) >= 4.5, (scheme, name, ground)


def contrast(one: str, other: str) -> float:
    """Contrast of two colours, `#rrggbb`, by WCAG 2.1."""
    light, dark = sorted((luminance(one), luminance(other)), reverse=True)
    return (light + 0.05) / (dark + 0.05)


def luminance(colour: str) -> float:
    """Relative luminance of a colour in sRGB."""
    shares = [int(colour[i : i + 2], 16) / 255 for i in (1, 3, 5)]
    linear = [s / 12.92 if s <= 0.04045 else ((s + 0.055) / 1.055) ** 2.4 for s in shares]
    return sum(weight * share for weight, share in zip((0.2126, 0.7152, 0.0722), linear, strict=True))
