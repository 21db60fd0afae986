"""Starting points by layout, number of cylinders and bore."""

from __future__ import annotations

import re
from functools import partial
from itertools import pairwise

import pytest

from cranktopo.base.errors import CranktopoError
from cranktopo.design.loading import load_scene, parse_scene, value_at
from cranktopo.design.reference import template
from cranktopo.design.schema import Scene
from cranktopo.design.starting_point import (
    FIRING,
    LayoutName,
    arrangement_line,
    sized_example,
    starting_values,
)
from cranktopo.engine.analysis import analyse
from cranktopo.engine.balance.whole_engine import engine_balance
from cranktopo.tasks.bench.live import exact_values


def started(layout: LayoutName, cylinders: int, bore_mm: float = 80.0, stroke_mm: float = 80.0) -> Scene:
    return parse_scene(template("mine", starting_values(layout, cylinders, bore_mm, stroke_mm)))


def gaps_deg(scene: Scene) -> list[float]:
    assert scene.engine is not None
    fires = sorted(scene.engine.firing_angles_deg)
    return [round(b - a, 6) for a, b in pairwise([*fires, fires[0] + scene.engine.cycle_deg])]


@pytest.mark.parametrize(("layout", "cylinders"), FIRING, ids=str)
def test_every_layout_is_a_valid_design_with_loads(layout: LayoutName, cylinders: int) -> None:
    """It fires evenly but for V engines whose pins cannot."""
    scene = started(layout, cylinders)
    uneven = {("V", 2): [450, 270], ("V", 4): [180, 270, 180, 90], ("V", 6): [90, 150] * 3}
    assert gaps_deg(scene) == uneven.get((layout, cylinders), [round(720 / cylinders, 6)] * cylinders)
    cycle = analyse(scene).cycle
    assert cycle is not None
    assert cycle.engine_torque()[0] > 0


@pytest.mark.parametrize("bore_mm", [40.0, 130.0, 400.0])
@pytest.mark.parametrize("layout", ["in-line", "V"])
def test_any_size(layout: LayoutName, bore_mm: float) -> None:
    assert started(layout, 6, bore_mm, 1.2 * bore_mm).throw.radius_mm == 0.6 * bore_mm


def test_a_four_in_line_is_near_the_built_in_one() -> None:
    """Lengths within a quarter of those of `car-diesel` at its bore and stroke."""
    known = load_scene("car-diesel").model_dump(mode="json")
    for key, value in starting_values("in-line", 4, 80.0, 88.0).items():
        if key.startswith(("throw.", "web.")):
            assert value == pytest.approx(value_at(known, key), rel=0.25), key


@pytest.mark.parametrize(("layout", "cylinders"), [("in-line", 6), ("V", 12), ("boxer", 6)])
def test_usual_throws_leave_nothing_free(layout: LayoutName, cylinders: int) -> None:
    """Forces, N, and moments, N m, of rotating masses and of the oscillating ones up to the fourth order."""
    parts = [part for part in engine_balance(started(layout, cylinders)).parts if part.order < 6]
    assert max(part.force.largest for part in parts) < 1e-3
    assert max(part.moment.largest for part in parts) < 1e-3


def test_line_that_tells_the_proposal() -> None:
    told = arrangement_line(started("V", 8))
    assert told.startswith(
        "assumed: firing order 1-3-7-2-6-5-4-8, every 90 deg; throws at 0, 90, 270, 180 deg,"
    )
    assert "deg, banks 90 deg apart;" in told
    assert "banks" not in arrangement_line(started("in-line", 4))


def test_examples_that_are_off_are_those_of_an_engine_of_that_size() -> None:
    """A design space of 48 mm beside a web of 420 mm helps nobody; angles and standard parts stay."""
    values = starting_values("in-line", 6, 320.0, 480.0)
    text = template("six", values, sized=partial(sized_example, values))
    shown = {line for line in text.splitlines() if re.match("#*[a-z_]+_(mm|deg|kg_m2|rpm) = ", line)}
    for line in ("#diameter_mm = 16.8", "#half_angle_deg = 60.0", "##shank_diameter_mm = 8.0"):
        assert line in shown
    assert parse_scene(text).envelope is not None
    width = values["web.width_mm"]
    assert f"half_width_mm = {0.8 * width:.1f}" in text
    weight = re.search(r"(?m)^#outer_radius_mm = ([\d.]+)$", text)
    assert weight is not None
    assert float(weight[1]) > width / 2, "beyond the web"
    small = template("mine", starting_values("single", 1, 95.0, 96.0))
    assert template("mine", starting_values("single", 1, 95.0, 96.0), sized=lambda p, n, e: e) == small


@pytest.mark.parametrize(
    "table",
    ["second_web", "web.counterweight(.plug)?", "web.pocket", "web.bevel", "throw.drilling", "shaft"],
)
def test_a_block_of_that_size_works_when_it_is_switched_on(table: str) -> None:
    values = starting_values("in-line", 6, 320.0, 480.0)
    text = template("six", values, sized=partial(sized_example, values))
    for block in text.split("\n\n"):
        if re.search(rf"(?m)^#\[+{table}(\.from|\.to)?\]", block):
            text = text.replace(block, re.sub(r"(?m)^#(?! )", "", block), 1)
    scene = parse_scene(text, whole=True)
    assert scene != parse_scene(template("six", values))


def test_a_large_engine_is_near_the_rule_at_a_usual_pressure() -> None:
    """IACS UR M53 asks for 1.15; the proportions of a car gave 0.63 at 18 MPa."""
    values = starting_values("in-line", 6, 320.0, 480.0) | {
        "engine.gas.peak_pressure_MPa": 18.0,
        "engine.gas.compression_ratio": 15.0,
        "engine.gas.intake_pressure_MPa": 0.35,
        "engine.gas.exhaust_pressure_MPa": 0.28,
    }
    found = exact_values(parse_scene(template("six", values)))
    assert 1.15 < found["m53_journal"] < found["m53_pin"] < 2.0


def test_an_unknown_number_of_cylinders_is_refused() -> None:
    with pytest.raises(CranktopoError, match="known: 2, 4, 6, 8, 10, 12"):
        starting_values("V", 14, 80.0, 80.0)
