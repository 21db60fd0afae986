"""The bench as a user has it: opened in a browser, a dimension dragged, numbers and picture follow."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from tests.browser.bench_page import Actions, gauge, set_slider, settled, shown

pytest.importorskip("tornado")


def test_a_drag_moves_numbers_and_picture(bench: Any, tmp_path: Path) -> None:
    seen = bench("mikron-iiic-plain")
    page = seen.page
    shown(page)
    before, mass = seen.picture(), gauge(page, "mass")
    assert (before[:, :, 3] == 255).mean() > 0.03, "the canvas is not blank"
    set_slider(page, "web.width_mm", 64, release=False)
    page.wait_for_function(
        f"() => !document.querySelector('[data-gauge=mass] .value').textContent.startsWith('{mass:g}')"
    )
    page.wait_for_function("() => Number(document.querySelector('#viewer').dataset.shown) > 0")
    assert gauge(page, "mass") > mass * 1.05
    assert (np.abs(seen.picture() - before).max(axis=2) > 30).mean() > 0.005, "the picture follows"
    assert page.locator("[data-gauge=torsion].stale").count() == 1, "what was not solved looks stale"
    assert "mass +" in page.locator("#worse").inner_text(), "what is worse is said"
    set_slider(page, "web.width_mm", 64, release=True)
    page.wait_for_selector("#history li.here:has-text('width: 64 mm')")
    number = page.locator("[data-row='web.thickness_mm'] input").first
    number.fill("20,5")
    number.press("Enter")
    page.wait_for_selector("#history li.here:has-text('thickness: 20.5 mm')")
    number.fill("0,01")
    page.wait_for_selector("[data-row='web.thickness_mm'].is-broken")
    assert "web.thickness_mm" in page.locator("[data-row='web.thickness_mm'] .broken").inner_text()
    page.get_by_role("button", name="Undo").click()
    page.wait_for_selector("#history li.here:has-text('width: 64 mm')")
    assert page.locator("#history li").count() == 3, "what breaks a rule is no step"
    assert [line for line in seen.complaints if "favicon" not in line] == []
    assert all(url.startswith(("http://127.0.0.1:", "blob:")) for url in seen.requests)
    assert len(list((tmp_path / "bench").glob("*/0002.toml"))) == 1, "each step is a file"


@pytest.mark.slow
def test_a_limit_is_dragged_and_the_section_is_seen(bench: Any) -> None:
    seen = bench("mikron-iiic-plain")
    page = seen.page
    shown(page)
    whole = seen.picture()
    page.locator("#section").check()
    assert (np.abs(seen.picture() - whole).max(axis=2) > 30).mean() > 0.01, "the section is drawn"
    page.wait_for_selector("[data-gauge=inertia] .track u")
    mark = page.locator("[data-gauge=inertia] .track u")
    mark.scroll_into_view_if_needed()
    box, track = mark.bounding_box(), page.locator("[data-gauge=inertia] .track").bounding_box()
    page.mouse.move(box["x"] + 1, box["y"] + box["height"] / 2)
    page.mouse.down()
    page.mouse.move(track["x"] + track["width"] / 3, box["y"] + 5, steps=4)
    page.mouse.up()
    page.wait_for_selector("#history li.here:has-text('limit: inertia about the crank axis <= 90 %')")
    page.wait_for_selector("[data-gauge=inertia] .limit:has-text('not kept')")
    assert "Limit not kept" in page.locator("#worse").inner_text()
    page.get_by_role("button", name="Undo").click()
    page.wait_for_selector("[data-gauge=inertia] .limit", state="detached")
    assert seen.complaints == []


@pytest.mark.slow
def test_colours_of_a_settled_web(bench: Any) -> None:
    """Each of them is another picture with its meaning below; a drag goes back to the parts."""
    seen = bench("mikron-iiic-plain")
    page = seen.page
    shown(page)
    page.locator("#colours").select_option("stress")
    assert page.locator("#legend").inner_text().startswith("The colours come when")
    settled(page)
    told = {
        "safety": "the last is the least safety",
        "stress": "MPa",
        "torsion": "stiffness in torsion",
        "bending": "stiffness in bending",
    }
    pictures = []
    for name, meaning in told.items():
        page.locator("#colours").select_option(name)
        page.wait_for_function(
            "(text) => document.querySelector('#legend').textContent.includes(text)", arg=meaning
        )
        page.wait_for_timeout(500)
        pictures.append(seen.picture())
    _, stress, torsion, bending = pictures  # the stress of this web goes with the strength that is used
    for one, other in ((stress, torsion), (torsion, bending)):
        assert (np.abs(one - other).max(axis=2) > 30).mean() > 0.01
    set_slider(page, "web.width_mm", 56, release=False)
    page.wait_for_function(
        "() => document.querySelector('#legend').textContent.startsWith('The colours come')"
    )
    assert seen.complaints == []


@pytest.mark.slow
def test_what_is_not_of_the_design_in_hand_is_hidden_and_warnings_come_first(bench: Any) -> None:
    """The place of the least safety went on to stand beside safeties that wait for the next web."""
    seen = bench("mikron-iiic-plain")
    page = seen.page
    shown(page)
    settled(page)
    assert page.locator("#place").inner_text().startswith("Least safety: ")
    assert "left out although above the threshold" in page.locator("#warnings").inner_text()
    page.get_by_role("button", name="Keep variant").click()
    page.wait_for_selector("tr[data-variant=v1]")
    set_slider(page, "web.width_mm", 56, release=True)
    page.wait_for_selector("#history li.here:has-text('width: 56 mm')")
    assert page.locator("#place").inner_text() == ""
    assert page.locator("[data-gauge=fatigue_safety].stale").count() == 1
    page.get_by_role("button", name="Keep variant").click()
    page.wait_for_selector("tr[data-variant=v2]:has-text('variant 2'):has-text('web.width_mm: 50 to 56')")
    table = page.locator("#variants .scroll")
    assert table.evaluate("(box) => box.scrollWidth <= box.clientWidth"), "nothing is cut"
    do = Actions(page)
    do.open("Engine", "gas")
    do.enter("engine.gas.peak_pressure_MPa", "20")
    page.wait_for_selector("#warnings li:has-text('give engine.gas.intake_pressure_MPa')")
    commands = page.locator("#commands").text_content().splitlines()
    assert commands == [
        "cranktopo designs copy bench/mikron-iiic-plain/0002.toml mikron-iiic-plain-0002.toml"
    ]
    assert seen.complaints == []
