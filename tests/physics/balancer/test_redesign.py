"""The lightest balancer shaft within its ranges: against the root of one dimension, and what it refuses."""

import pytest
from scipy.optimize import brentq

from cranktopo.base.errors import CranktopoError
from cranktopo.design.loading import load_scene, scene_from_dict
from cranktopo.design.named import with_values
from cranktopo.tasks.balancer.redesign import redesign_balancer
from cranktopo.tasks.balancer.stage import check_balancer

SCENE = load_scene("balancer-shaft")


def shaft(**tables):
    """The built-in shaft without what its redesign may change, but with other tables."""
    data = SCENE.model_dump(mode="json", exclude_none=True)
    part = data["balancer"]
    del part["redesign"]
    for step in part["step"]:
        step.pop("free_bore_mm", None)
    for path, table in tables.items():
        name, _, number = path.partition("_")
        if number:
            part[name][int(number)] |= table
        else:
            part[name] = table
    return scene_from_dict(data, whole=True)


def test_one_diameter_ends_where_the_spline_bends_as_much_as_is_wanted():
    """The thinnest end of the shaft with 0.025 mm at the spline, found as a root without the search."""
    free = shaft(step_2={"free_diameter_mm": [25.0, 40.0]}, redesign={"deflection_mm": 0.025}, notch=[])

    def too_much(diameter):
        return (
            check_balancer(with_values(free, {"balancer.step[2].diameter_mm": diameter}))
            .probes[0]
            .deflection_mm
            - 0.025
        )

    scene, found = redesign_balancer(free)
    thinnest = brentq(too_much, 25.0, 40.0, xtol=1e-4)
    assert 25.5 < thinnest < 39.5
    assert scene.balancer.step[2].diameter_mm == pytest.approx(thinnest, abs=0.03)
    assert check_balancer(scene).probes[0].deflection_mm <= 0.025
    assert found.redesign.result_kg > found.redesign.start_kg


def test_nothing_that_is_limited_gets_worse():
    """Bores, and a bearing that moves toward the overhung mass; evaluated anew. A limit ends the gain."""
    free = shaft(
        step_0={"free_bore_mm": [0.0, 38.0]},
        step_1={"free_bore_mm": [0.0, 50.0]},
        bearing_1={"free_z_mm": [185.0, 208.0]},
        redesign={"deflection_mm": 0.043},
    )
    before, (scene, found) = check_balancer(free), redesign_balancer(free)
    after = check_balancer(scene)
    assert after.probes[0].deflection_mm <= 0.043
    assert min(b.life_h for b in after.bearings) >= 0.9999 * min(b.life_h for b in before.bearings)
    for kind in ("running_safety", "starting_safety", "reversed_safety"):
        least, own = (min(getattr(notch, kind) for notch in one.notches) for one in (after, before))
        assert least >= 0.9999 * own
    assert after.mass_kg == found.mass_kg == found.redesign.result_kg < 0.8 * before.mass_kg
    assert scene.balancer.bearing[1].z_mm > 193.0
    assert found.redesign.dimensions[2].start_mm == 193.0
    for number, step in enumerate(scene.balancer.step[:2]):
        if step.bore_mm < step.free_bore_mm[1]:
            wider = with_values(scene, {f"balancer.step[{number}].bore_mm": step.bore_mm + 0.5})
            assert check_balancer(wider).probes[0].deflection_mm > 0.043


def test_the_nearest_shaft_is_told_where_none_keeps_every_limit():
    free = shaft(step_2={"free_diameter_mm": [25.0, 26.0]}, redesign={"deflection_mm": 0.025})
    thickest = (
        check_balancer(with_values(free, {"balancer.step[2].diameter_mm": 26.0})).probes[0].deflection_mm
    )
    with pytest.raises(CranktopoError, match=rf"deflection of spline {thickest:.4g} mm, wanted <= 0\.025"):
        redesign_balancer(free)


def test_a_redesign_of_a_redesign_adds_nothing_again():
    scene, first = redesign_balancer(SCENE)
    _, second = redesign_balancer(scene)
    assert (first.redesign.added_bearings, second.redesign.added_bearings) == (1, 0)
    assert second.mass_kg == pytest.approx(first.mass_kg, rel=1e-3)


@pytest.mark.parametrize(
    ("tables", "words"),
    [
        ({}, "nothing is free for a redesign"),
        ({"step_0": {"free_bore_mm": [0.0, 40.0]}}, r"step\[0\].free_bore_mm.*wall of 3 mm"),
        ({"step_2": {"free_diameter_mm": [22.0, 30.0]}}, r"notch\[0\].diameter_mm"),
        ({"bearing_1": {"free_z_mm": [185.0, 290.0]}}, r"bearing\[1\].free_z_mm.*ends of the shaft"),
        ({"bearing_1": {"free_z_mm": [20.0, 200.0]}}, r"bearing\[1\].free_z_mm.*bearing at 32 mm"),
    ],
)
def test_ranges_that_make_no_shaft(tables, words):
    with pytest.raises(CranktopoError, match=words):
        redesign_balancer(shaft(**tables))
