"""Parts of the page of a bench that need no solve: names for screen readers, ghost, handles, drop, paste."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from cranktopo.design.edits import changed_text
from cranktopo.design.loading import design_text, scene_from_dict
from cranktopo.design.toml_text import parse_toml
from cranktopo.tasks.bench.access import Password
from cranktopo.tasks.bench.forms import new_design
from tests.browser.bench_page import gauge, quick_bench, reads, set_slider, shown, stays_shown
from tests.browser.conftest import QUICK_MS

pytest.importorskip("tornado")
PLAIN = "mikron-iiic-plain"
POINT = [0.0, 20.0, 30.0]
SETTLED = """async ([gauges, place, point]) => {
    const [{ state }, { showGauges }] = [await import("./state.js"), await import("./gauges.js")];
    Object.assign(state, { settled: gauges, fresh: true, dragging: false, place, point, errors: {} });
    showGauges();
}"""


def differing(one: np.ndarray, other: np.ndarray) -> float:
    """Share of pixels that differ clearly."""
    return float((np.abs(one - other).max(axis=2) > 30).mean())


@pytest.mark.slow
def test_a_screen_reader_hears_label_value_change_and_ring_of_every_gauge(quick: Any) -> None:
    seen = quick(PLAIN)
    page = seen.page
    shown(page)
    set_slider(page, "web.width_mm", 54, release=True)
    page.wait_for_selector("#history li.here:has-text('width: 54 mm')")
    page.wait_for_selector("[data-gauge=mass] .change:has-text('+')")
    dials = page.locator("#dials [data-gauge]")
    assert dials.count() > 15
    for dial in dials.all():
        label, value, *change = (text.strip() for text in dial.locator("> span").all_inner_texts()[:3])
        ring = dial.locator(".ring span").first.inner_text()
        name = dial.get_attribute("aria-label")
        assert dial.get_attribute("role") == "group"
        assert name.startswith(f"{label}: {value}")
        assert ring in name
        assert (change[0] or "no original yet") in name
    tree = page.locator("[role=group][aria-label^='Mass: ']")
    assert tree.count() == 1, "by its role and name, as a reader finds it"
    for control in page.locator("main input:visible, main select:visible, main button:visible").all():
        named = control.evaluate("(one) => one.ariaLabel || one.labels?.[0]?.textContent || one.textContent")
        assert named.strip(), control.evaluate("(one) => one.outerHTML")


@pytest.mark.slow
def test_the_ghost_of_the_original_is_seen_and_taken_away(quick: Any) -> None:
    seen = quick(PLAIN)
    page = seen.page
    shown(page)
    set_slider(page, "web.width_mm", 60, release=True)
    page.wait_for_selector("#history li.here:has-text('width: 60 mm')")
    page.get_by_role("button", name="Set as original").click()
    page.get_by_role("button", name="Undo").click()
    page.wait_for_selector("#front .ghost", state="attached")
    stays_shown(page)
    with_ghost = seen.picture()
    page.locator("#ghost").uncheck()
    without = seen.picture()
    assert differing(with_ghost, without) > 0.005
    added = (without[:, :, 3] == 0) & (with_ghost[:, :, 3] > 0)
    assert added.mean() > 0.002, "the wider original stands out beside the web"
    assert page.locator("#front .ghost").count() == 0
    assert seen.complaints == []


@pytest.mark.slow
def test_a_handle_of_the_front_view_is_dragged_with_the_pointer(quick: Any) -> None:
    """Half a width is moved: its dimension changes by twice the way, and stays under the pointer."""
    page = quick(PLAIN).page
    shown(page)
    mass, width = gauge(page, "mass"), float(page.locator("[id='f-web.width_mm']").input_value())
    dot = page.locator("[data-handle='web.width_mm'] circle")
    box, scale = dot.bounding_box(), float(page.locator("#front").get_attribute("data-scale"))
    x, y = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
    page.mouse.move(x, y)
    page.mouse.down()
    page.mouse.move(x + 10, y, steps=4)
    page.wait_for_function("() => Number(document.querySelector('#viewer').dataset.shown) > 0")
    stays_shown(page)
    moved = float(page.locator("[id='f-web.width_mm']").input_value())
    assert moved == pytest.approx(width + 2 * 10 * scale, abs=0.02)
    assert gauge(page, "mass") > mass
    box = dot.bounding_box()
    assert box["x"] + box["width"] / 2 == pytest.approx(x + 10, abs=1.5)
    page.mouse.up()
    page.wait_for_selector(f"#history li.here:has-text('web width: {moved:g} mm')")


@pytest.mark.slow
def test_the_section_is_dragged_its_dimension_typed_and_the_plots_follow(quick: Any) -> None:
    """A handle that is pressed twice opens its form; a press goes back to the first step."""
    seen = quick("car-diesel")
    page = seen.page
    shown(page)
    names = [one.get_attribute("data-plot") for one in page.locator("#plots figure").all()]
    assert names == ["Cylinder pressure", "Torque", "Free forces", "Free moments"]
    field = page.locator("[id='f-web.thickness_mm']")
    thickness, scale = float(field.input_value()), float(page.locator("#front").get_attribute("data-scale"))
    dot = page.locator("[data-handle='web.thickness_mm'] circle")
    box = dot.bounding_box()
    x, y = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
    page.mouse.move(x, y)
    page.mouse.down()
    page.mouse.move(x + 8, y, steps=2)
    stays_shown(page)
    assert float(field.input_value()) == pytest.approx(thickness + 8 * scale, abs=0.02)
    page.mouse.up()
    page.wait_for_selector("#history li.here:has-text('web thickness')")
    page.locator("#history li button").first.click()
    page.wait_for_selector("#history li.here:has-text('opened')")
    assert float(field.input_value()) == thickness
    page.evaluate("() => document.querySelectorAll('#tree details').forEach((one) => (one.open = false))")
    page.evaluate(
        """() => {
            const dot = document.querySelector("[data-handle='web.thickness_mm'] circle");
            for (let press = 0; press < 2; press++) dot.dispatchEvent(new PointerEvent("pointerup"));
        }"""
    )
    assert field.evaluate("(input) => input === document.activeElement"), "ready to be typed in"
    assert seen.complaints == []


@pytest.mark.slow
def test_two_pages_of_one_bench_see_each_other(quick: Any) -> None:
    page = quick(PLAIN).page
    shown(page)
    other = page.context.new_page()
    other.goto(page.url)
    shown(other)
    set_slider(page, "web.width_mm", 54, release=True)
    other.wait_for_selector("#history li.here:has-text('width: 54 mm')")
    for one in (page, other):
        one.wait_for_selector("[data-gauge=mass] .change:has-text('+')")
    assert gauge(other, "mass") == gauge(page, "mass")
    assert other.locator("[id='f-web.width_mm']").input_value() == "54"
    other.get_by_role("button", name="Undo").click()
    page.wait_for_selector("#history li.here:has-text('opened')")
    page.wait_for_function("() => document.getElementById('f-web.width_mm').value !== '54'")


@pytest.mark.slow
def test_the_place_of_the_least_safety_turns_the_view(quick: Any) -> None:
    seen = quick(PLAIN)
    page = seen.page
    shown(page)
    page.get_by_role("button", name="Side", exact=True).click()
    before = seen.picture()
    page.evaluate(SETTLED, [{"fatigue_safety": 1.2}, "pin fillet", POINT])
    assert differing(seen.picture(), before) == 0
    page.get_by_role("button", name="Least safety: pin fillet.").click()
    after = seen.picture()
    assert differing(after, before) > 0.05, "another view"
    red = (after[:, :, 0] > 150) & (after[:, :, 1] < 90) & (after[:, :, 2] < 90)
    assert 20 < red.sum() < 0.01 * red.size, "a mark at the place"
    rows, columns = np.nonzero(red)
    assert abs(columns.mean() / red.shape[1] - 0.5) < 0.2, "in the middle, seen from its side"
    assert rows.std() < 0.05 * red.shape[0]
    set_slider(page, "web.width_mm", 54, release=False)
    stays_shown(page)
    moved = seen.picture()
    red = (moved[:, :, 0] > 150) & (moved[:, :, 1] < 90) & (moved[:, :, 2] < 90)
    assert red.sum() == 0, "not of the web in hand"


@pytest.mark.slow
def test_the_section_is_moved_across_the_web(quick: Any) -> None:
    seen = quick(PLAIN)
    page = seen.page
    shown(page)
    slider = page.locator("#section-x")
    assert slider.is_hidden()
    page.locator("#section").check()
    half = float(page.locator("[id='f-web.width_mm']").input_value()) / 2
    assert float(slider.get_attribute("max")) == pytest.approx(half, abs=0.2)
    middle = seen.picture()
    slider.fill(str(round(half / 2, 1)))
    beside = seen.picture()
    assert differing(middle, beside) > 0.01
    shares = [(picture[:, :, 3] > 0).mean() for picture in (middle, beside)]
    assert shares[0] < shares[1], "less is taken away"


@pytest.mark.slow
def test_outlets_have_a_gauge_where_there_are_any(quick: Any, tmp_path: Path) -> None:
    page = quick(PLAIN).page
    shown(page)
    page.evaluate(SETTLED, [{"fatigue_safety": 1.2, "outlet_safety": 1.5}, "", None])
    assert page.locator("[data-gauge=outlet_safety] .value").inner_text() == "1.5"
    page.evaluate(SETTLED, [{"fatigue_safety": 1.2}, "", None])
    assert page.locator("[data-gauge=outlet_safety]").count() == 0


DROP = """([name, text, kind]) => {
    const data = new DataTransfer();
    if (name) data.items.add(new File([text], name));
    else data.setData("text/plain", text);
    const both = { bubbles: true, cancelable: true };
    const event = kind === "paste" ? new ClipboardEvent("paste", { clipboardData: data, ...both })
        : new DragEvent("drop", { dataTransfer: data, ...both });
    document.body.dispatchEvent(event);
    return event.defaultPrevented;
}"""


@pytest.mark.slow
def test_files_are_dropped_and_pasted(quick: Any, tmp_path: Path) -> None:
    """A design by a real drop event, a copied file, the text of a design, and a trace."""
    page = quick().page
    page.wait_for_selector("#begin:not([hidden])")
    text = design_text(PLAIN)
    assert page.evaluate(DROP, ["mine.toml", text, "drop"]), "the browser does not open the file itself"
    page.wait_for_selector("#name:has-text('mine')")
    assert (tmp_path / "mine.toml").read_text(encoding="utf-8") == text
    assert page.evaluate(DROP, ["other.toml", changed_text(text, {"web.width_mm": 52}, "own"), "paste"])
    page.wait_for_selector("#name:has-text('other')")
    assert page.evaluate(DROP, ["", changed_text(text, {"web.width_mm": 53}, "own"), "paste"])
    page.wait_for_selector(f"#name:has-text('{PLAIN}')")
    shown(page)
    assert page.locator("[id='f-web.width_mm']").input_value() == "53"
    trace = "\n".join(
        ["crank_angle_deg,pressure_bar", *(f"{a},{max(1, 60 - abs(a - 370)):g}" for a in range(0, 721, 5))]
    )
    assert page.evaluate(DROP, ["", trace, "paste"])
    page.wait_for_selector("#history li.here:has-text('pressure trace')")
    assert not page.evaluate(DROP, ["", "just some words", "paste"])


@pytest.mark.slow
def test_a_drag_beyond_a_rule_ends_at_the_rule(quick: Any) -> None:
    """A slider that was let go where a rule is broken fell back to where it began."""
    page = quick(PLAIN).page
    shown(page)
    set_slider(page, "web.width_mm", 40, release=True)
    page.wait_for_selector("#history li.here:has-text('web.width_mm: 4')")
    page.wait_for_selector("#message.calm:has-text('Taken is the nearest value')")
    assert "throw.main_journal.fillet_mm" in page.locator("#message").inner_text(), "the rule is told"
    taken = float(page.locator("[id='f-web.width_mm']").input_value())
    assert 42 < taken < 50
    assert page.locator("#tree .is-broken").count() == 0


@pytest.mark.slow
def test_variants_are_lines_across_their_gauges(quick: Any) -> None:
    """A heavier variant lies below at the mass; a bound is a line of the picture beside."""
    seen = quick(PLAIN)
    page = seen.page
    shown(page)
    known = [{"mass": 1.5, "torsion": 1.2e5, "torsion_per_mass": 8e4}, {"mass": 1.6, "torsion": 1.5e5}]
    known[1]["torsion_per_mass"] = known[1]["torsion"] / known[1]["mass"]
    page.evaluate(
        """async (known) => {
            const [{ state }, { showVariants }] = [await import("./state.js"), await import("./variants.js")];
            const none = { what: "", pinned: false, outlines: [] };
            const named = (i) => ({ id: `v${i}`, name: `variant ${i}`, ...none });
            state.project.variants = known.map((gauges, i) => ({ ...named(i), gauges }));
            const step = state.project.steps[state.project.at].file;
            state.jobs = [{ step, gauges: { bound_mass: 1.4 } }];
            showVariants();
        }""",
        known,
    )
    first, second = (
        [[float(part) for part in point.split(",")] for point in line.get_attribute("d")[1:].split("L")]
        for line in page.locator("#parallels path").all()
    )
    assert first[0][0] == second[0][0]
    assert first[0][1] < second[0][1], "lighter is better, above"
    assert first[1][1] > second[1][1], "stiffer is better, above"
    bound = page.locator("#scatter line.bound")
    lefts = [float(dot.get_attribute("cx")) for dot in page.locator("#scatter circle").all()]
    assert float(bound.get_attribute("x1")) < min(lefts), "no variant is lighter than the proof allows"
    assert seen.complaints == []


@pytest.mark.slow
def test_kept_variants_have_a_small_picture_to_one_scale(quick: Any) -> None:
    page = quick(PLAIN).page
    shown(page)
    for number, width in enumerate((50, 60), start=1):
        if width != 50:
            set_slider(page, "web.width_mm", width, release=True)
            page.wait_for_selector(f"#history li.here:has-text('width: {width} mm')")
        page.get_by_role("button", name="Keep variant").click()
        page.wait_for_selector(f"tr[data-variant=v{number}] svg.small path", state="attached")
    boxes = [one.evaluate("(path) => path.getBBox().width") for one in page.locator("svg.small path").all()]
    assert boxes == pytest.approx([50, 60], rel=0.02)


@pytest.mark.slow
def test_how_far_a_job_is_is_a_bar_with_the_time_left(quick: Any) -> None:
    page = quick(PLAIN).page
    shown(page)
    page.evaluate(
        """async () => {
            const [{ state }, { showJobs }] = [await import("./state.js"), await import("./work.js")];
            const job = { id: "001", kind: "shape", state: "running", seconds: 9, found: [], notes: [] };
            const pace = { share: 0.25, left: "about 40 s" };
            state.jobs = [{ ...job, gauges: {}, pace }, { ...job, id: "002", gauges: {}, pace: null }];
            showJobs();
        }"""
    )
    silent, told = page.locator("#jobs progress").all()
    assert told.evaluate("(bar) => bar.value") == 0.25
    assert page.locator("#jobs .left").last.inner_text() == "25 %, about 40 s left"
    assert silent.evaluate("(bar) => bar.position") == -1, "one that tells nothing has no end"


GROUPS = {
    "Bearings": "bearings",
    "Connecting rod": "rod",
    "Bolted joints": "bolted_joint",
    "Balancer shaft": "balancer",
    "Forging": "forging",
    "Drawing": "drawing",
    "Crank and ends": "crank",
}


@pytest.mark.slow
def test_bearings_crank_forging_and_drawing_have_forms(quick: Any) -> None:
    page = quick("car-diesel").page
    shown(page)
    data = page.evaluate("async () => (await import('./state.js')).state.project.data")
    for title, table in GROUPS.items():
        group = page.locator(f"#tree [data-path='group:{title}']")
        assert group.count() == 1
        group.locator("summary").first.click()
        if group.locator(f"[data-row^='{table}.']").count():
            continue
        assert table not in data
        name = table.replace("_", " ")
        group.get_by_role("button", name=f"Add {name}", exact=True).click()
        page.wait_for_selector(f"#history li.here:has-text('added {name}')")
        assert page.locator(f"#tree [data-row^='{table}']").count() > 0
    assert page.locator("#tree [data-path='group:Second web'] button").count() > 0
    assert page.locator("#write [data-kind=step-rod]").is_visible(), "a file of the part that was added"
    page.get_by_role("button", name="Remove forging", exact=True).click()
    page.wait_for_selector("#history li.here:has-text('removed forging')")
    assert page.get_by_role("button", name="Add forging", exact=True).count() == 1


@pytest.mark.slow
def test_a_task_by_keyboard_alone(quick: Any, tmp_path: Path) -> None:
    """From the first page to the STEP file: a design is begun, made wider, kept, and written."""
    page = quick().page
    page.wait_for_selector("#begin:not([hidden])")
    keys = page.keyboard

    def reach(selector: str) -> None:
        for _ in range(400):
            if page.evaluate("(wanted) => Boolean(document.activeElement?.matches(wanted))", selector):
                return
            keys.press("Tab")
        raise AssertionError(f"{selector}: is not reached")

    for name, text in {"bore_mm": "80", "stroke_mm": "90", "name": "keys"}.items():
        reach(f"#questions [name={name}]")
        keys.insert_text(text)
    keys.press("Enter")
    shown(page)
    reach("input[type=range][data-key='web.width_mm']")
    before = float(page.locator("[id='f-web.width_mm']").input_value())
    for _ in range(3):
        keys.press("ArrowRight")
    page.wait_for_selector("#history li.here:has-text('width: ')")
    assert float(page.locator("[id='f-web.width_mm']").input_value()) > before
    reach("[data-handle-key='throw.crankpin.outer_diameter_mm']")
    keys.press("ArrowUp")
    page.wait_for_selector("#history li.here:has-text('crankpin outer diameter')")
    keys.press("Control+k")
    page.wait_for_selector("tr[data-variant=v1]")
    reach("#write [data-kind=step-throw]")
    keys.press("Enter")
    page.wait_for_selector("#made a:has-text('keys.step')")
    assert (tmp_path / "keys.step").read_text(encoding="ascii").startswith("ISO-10303-21")


@pytest.mark.slow
def test_a_bench_of_others_asks_for_its_password_once(browser: Any, tmp_path: Path) -> None:
    password = Password("a long password")
    with quick_bench(tmp_path, PLAIN, host="127.0.0.2", password=password) as address:
        page = browser.new_context().new_page()
        page.set_default_timeout(QUICK_MS)
        page.goto(address)
        for word in ("a wrong password", "a long password"):
            page.get_by_label("Password").fill(word)
            page.get_by_role("button", name="Open").click()
            page.wait_for_selector("#told:has-text('not the password')" if "wrong" in word else "#dials li")
        page.reload()
        page.wait_for_selector("#dials li")
        page.context.close()


@pytest.mark.slow
def test_a_use_fills_in_a_sound_beginning(quick: Any) -> None:
    page = quick().page
    page.wait_for_selector("#begin:not([hidden])")
    tiles = page.locator("#uses button")
    assert tiles.all_inner_texts() == ["car", "motorcycle", "aircraft", "medium speed"]
    for tile in tiles.all():
        tile.click()
        answers = page.evaluate(
            """() => Object.fromEntries([...new FormData(document.getElementById("questions"))]
                .filter(([, text]) => text).map(([name, text]) => [name, Number(text) || text]))"""
        )
        scene = scene_from_dict(parse_toml(new_design(answers).text, "begun"), "begun", whole=True)
        assert scene.engine is not None
        assert scene.engine.bore_mm == answers["bore_mm"]
    assert not page.locator("[name=bank_angle_deg]").is_visible(), "of a V alone"
    page.get_by_role("button", name="Begin").click()
    shown(page)
    assert page.locator("#name").inner_text() == "my-engine"


@pytest.mark.slow
def test_a_lock_keeps_a_dimension_or_gives_shape_a_range_of_it(quick: Any) -> None:
    seen = quick(PLAIN)
    page = seen.page
    shown(page)
    lock = page.get_by_role("button", name="thickness: keep as it is")
    assert lock.get_attribute("aria-pressed") == "true", "shape keeps what has no range"
    assert page.get_by_role("button", name="width: keep as it is").count() == 0, "always free"
    lock.click()
    page.wait_for_selector("#history li.here:has-text('free for shape from 13.3 to 24.7')")
    assert lock.get_attribute("aria-pressed") == "false"
    assert "web_thickness_mm = [13.3, 24.7]" in page.locator("#diff").text_content()
    lock.click()
    page.wait_for_selector("#history li.here:has-text('thickness: stays as it is')")
    assert lock.get_attribute("aria-pressed") == "true"
    assert seen.complaints == []


@pytest.mark.slow
def test_the_drawing_has_the_locks_and_shows_how_far_shape_may_go(quick: Any) -> None:
    """By pointer and by keyboard, whose focus stays where the drawing is made anew."""
    seen = quick(PLAIN)
    page = seen.page
    shown(page)
    assert page.locator("#front path.free").count() == 0
    assert page.locator("[data-handle='web.width_mm'] .lock").count() == 0, "always free"
    lock = page.locator("[data-handle='web.thickness_mm'] .lock")
    assert lock.get_attribute("aria-pressed") == "true", "shape keeps what has no range"
    lock.locator(".hit").click()
    page.wait_for_selector("#history li.here:has-text('free for shape from 13.3 to 24.7')")
    page.wait_for_selector("[data-handle='web.thickness_mm'] .lock[aria-pressed=false]")
    way = page.locator("#front path.free").evaluate("(path) => path.getBBox().width")
    assert way == pytest.approx(24.7 - 13.3, abs=0.01)
    in_form = page.get_by_role("button", name="thickness: keep as it is")
    assert in_form.get_attribute("aria-pressed") == "false"
    lock.focus()
    page.keyboard.press("Enter")
    page.wait_for_selector("[data-handle='web.thickness_mm'] .lock[aria-pressed=true]")
    assert page.locator("#front path.free").count() == 0
    assert lock.evaluate("(lock) => lock === document.activeElement")
    assert seen.complaints == []


@pytest.mark.slow
def test_a_slider_that_is_held_stays_whatever_else_is_told(quick: Any) -> None:
    """A proof that a drag ends is told a second later: the forms were made anew under the pointer."""
    page = quick(PLAIN).page
    shown(page)
    slider = page.locator("input[type=range][data-key='web.width_mm']").element_handle()
    set_slider(page, "web.width_mm", 54, release=False)
    page.evaluate("async () => (await import('./talk.js')).say({ do: 'keep' })")
    page.wait_for_selector("tr[data-variant=v1]")
    assert slider.evaluate("(slider) => slider.isConnected")
    assert page.locator("[id='f-web.width_mm']").input_value() == "54"
    set_slider(page, "web.width_mm", 55, release=True)
    page.wait_for_selector("#history li.here:has-text('width: 55 mm')")


@pytest.mark.slow
def test_arrow_keys_move_a_handle_again_and_again(quick: Any) -> None:
    page = quick(PLAIN).page
    shown(page)
    field = page.locator("[id='f-web.width_mm']")
    width = float(field.input_value())
    page.locator("[data-handle='web.width_mm'] circle").focus()
    for step in (1, 2):
        page.keyboard.press("ArrowRight")
        page.wait_for_selector(f"#history li.here:has-text('web width: {width + 0.5 * step:g} mm')")
        stays_shown(page)


@pytest.mark.slow
def test_a_cylinder_misfires_and_the_torque_follows(quick: Any) -> None:
    """Of four equal cylinders the work of one is lost, and its compression is given back."""
    seen = quick("car-diesel")
    page = seen.page
    shown(page)
    firing = gauge(page, "mean_torque")
    boxes = page.get_by_role("group", name="Cylinders that misfire").get_by_role("checkbox")
    assert boxes.count() == 4
    boxes.nth(1).check()
    page.wait_for_selector("#history li.here:has-text('misfire: cylinder 2')")
    assert "misfire = [2]" in page.locator("#diff").text_content()
    reads(page, "mean_torque", 0.75 * firing, 0.02)
    boxes.nth(1).uncheck()
    page.wait_for_selector("#history li.here:has-text('all cylinders fire')")
    reads(page, "mean_torque", firing, 1e-3)
    assert seen.complaints == []
