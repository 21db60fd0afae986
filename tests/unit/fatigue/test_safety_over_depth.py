"""The depth that decides, against closed forms; limits; treatments of one fillet alone."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from cranktopo import load_scene
from cranktopo.base.arrays import Array
from cranktopo.tasks.fatigue.criterion import LocalStress
from cranktopo.tasks.fatigue.lsa import LsaStrength, lsa
from cranktopo.tasks.throw_fatigue.hardened_layer import HardenedLayer
from cranktopo.tasks.throw_fatigue.hardening import (
    TreatedFillet,
    at_nodes,
    fillet_result,
    harden,
    least_safety,
    of_nodes,
    over_depth,
    safety_at,
)
from cranktopo.tasks.throw_fatigue.m53 import concentration_factors, dimensions
from cranktopo.tasks.throw_fatigue.stress_below import NotchShape, notch_shape, stress_share, web_middle_mm
from tests.unit.fatigue.hardened_layers import INDUCTION, NITRIDED

STRENGTH = LsaStrength(495, 525, 900, 1100)
SHAPE = NotchShape(3.0, 10.0)
NO_RESIDUAL = ((0.0, 0.0),)


def judge(local: LocalStress) -> Array:
    return lsa(local, STRENGTH).safety


def by_amplitude(local: LocalStress) -> Array:
    """A criterion without support or mean stress."""
    return 400.0 / local.amplitude_MPa


def points(gradient: float, amplitude: float = 300.0, mean: float = 100.0, count: int = 1) -> LocalStress:
    one = np.ones(count)
    return LocalStress(amplitude * one, mean * one, gradient * one)


def fillet(layer: HardenedLayer, shape: NotchShape = SHAPE, count: int = 1) -> TreatedFillet:
    return TreatedFillet("pin", layer, shape, np.ones(count, dtype=bool))


def test_a_core_of_one_hardness_is_as_safe_as_untreated() -> None:
    plain = HardenedLayer("induction", 2.0, 340.0, 340.0, 340.0, NO_RESIDUAL)
    for gradient in (0.0, 0.02, 0.2, 0.9, 3.0):
        local = points(gradient)
        assert least_safety(judge, fillet(plain), local)[0] == pytest.approx(judge(local)[0], rel=1e-12)


def test_a_straight_fall_of_the_stress_decides_just_below_the_layer() -> None:
    """Stress 1 - chi t, strength of the case above d and of the core below: d decides where (1 - chi d) times
    the gain of the case exceeds 1."""
    gradient, depth = 0.02, 2.0
    layer = HardenedLayer("induction", depth, 500.0, 340.0, 340.0, NO_RESIDUAL)
    local, one = points(gradient), fillet(layer)
    below = 400.0 / 300.0 / (1 - gradient * depth)
    harder = 733.0 / (1.42 * 340 + 23)
    support = (1 + math.sqrt(1600 * gradient) / 500) / (1 + math.sqrt(1600 * gradient) / 340)
    assert harder * support * (1 - gradient * depth) > 1
    found = over_depth(by_amplitude, one, local)
    assert found.depth_mm[found.deciding] == depth
    assert found.safety[found.deciding] == pytest.approx(below, rel=1e-12)
    assert found.safety[0] == pytest.approx(400 / 300 * harder * support, rel=1e-12)
    told = fillet_result(by_amplitude, one, local)
    assert (told.depth_mm, told.safety, told.safety_below) == (depth, told.safety_below, told.safety)
    assert told.gain == pytest.approx(1 / (1 - gradient * depth))


def test_amplitude_and_mean_stress_both_fall() -> None:
    """Local stress analysis by hand at 2 mm of a straight fall: 1 / k = share (a / strength + m / Rm)."""
    gradient, depth, core = 0.02, 2.0, HardenedLayer("induction", 9.0, 340.0, 340.0, 340.0, NO_RESIDUAL)
    share = 1 - gradient * depth
    there = gradient / share
    support = 1 + (525 / 495 - 1) / (2 / 7.5) * there
    notch = 1 + math.sqrt(there) * 10 ** -(0.35 + 900 / 810)
    used = share * (300 / (495 * 0.89 * 0.75 * support / notch) + 100 / 1100)
    assert safety_at(judge, fillet(core), points(gradient), depth)[0] == pytest.approx(1 / used, rel=1e-12)


def test_both_ends_of_the_scatter_are_told() -> None:
    """At the surface of an even stress the compression of a layer counts by 1 - M s / S."""
    layer = HardenedLayer(
        "induction", 9.0, 600.0, 340.0, 340.0, ((0.0, -200.0), (9.0, -200.0), (20.0, -200.0))
    )
    told = [
        fillet_result(by_amplitude, fillet(replace(layer, scatter_MPa=s), NotchShape(3.0, 1e9)), points(0.5))
        for s in (0.0, 60.0)
    ]
    assert told[0].safety_high is None
    harder = 733 / (1.42 * 340 + 23)
    support = (1 + math.sqrt(800) / 600) / (1 + math.sqrt(800) / 340)
    ends = [400 / 300 * harder * support * (1 + 0.4 * kept / 733) for kept in (140, 260)]
    assert told[1].safety_surface == pytest.approx(ends[0], rel=1e-12)
    assert told[1].safety <= told[0].safety <= (told[1].safety_high or 0.0) <= ends[1] * (1 + 1e-12)


def test_a_steep_fall_decides_at_the_surface_and_tells_the_transition_beside_it() -> None:
    found = fillet_result(judge, fillet(INDUCTION), points(1.2))
    assert found.depth_mm == 0.0
    assert found.safety == found.safety_surface < found.safety_below
    transition = over_depth(judge, fillet(INDUCTION), points(1.2))
    assert found.safety_below == transition.safety[transition.depth_mm >= 2.0].min()


def test_the_depth_of_least_safety_of_a_smooth_profile() -> None:
    """Rolled: strength 1 + g (1 - t / d), stress 1 - chi t: the least of their ratio lies at an end, at the
    depth d where (1 - chi d)(1 + g) > 1, else at the surface."""
    layer = HardenedLayer("rolled", 1.5, 374.0, 340.0, 340.0, NO_RESIDUAL)
    for gradient in (0.01, 0.03):
        found = over_depth(by_amplitude, fillet(layer), points(gradient))
        support = (1 + math.sqrt(1600 * gradient) / 374) / (1 + math.sqrt(1600 * gradient) / 340)
        buried = (1 - gradient * 1.5) * 1.1 * support > 1
        assert found.depth_mm[found.deciding] == (1.5 if buried else 0.0)


def test_a_thin_layer_gains_nothing_and_a_deep_one_what_its_surface_gains() -> None:
    local = points(0.9)
    untreated = judge(local)[0]
    thin = replace(NITRIDED, depth_mm=1e-6, residual=NO_RESIDUAL)
    deep = replace(NITRIDED, depth_mm=9.0, residual=NO_RESIDUAL)
    assert least_safety(judge, fillet(thin), local)[0] == pytest.approx(untreated, rel=1e-3)
    surface = over_depth(judge, fillet(deep), local).safety[0]
    assert least_safety(judge, fillet(deep), local)[0] == surface > 1.3 * untreated


@pytest.mark.parametrize("gradient", [0.1, 0.4, 0.9])
def test_deeper_is_never_less_safe_without_residual_stress(gradient: float) -> None:
    for layer in (NITRIDED, replace(INDUCTION, transition_HV=340.0)):
        found = [
            float(
                least_safety(
                    judge, fillet(replace(layer, depth_mm=d, residual=NO_RESIDUAL)), points(gradient)
                )[0]
            )
            for d in (0.1, 0.2, 0.4, 0.8, 1.6, 3.2)
        ]
        assert (np.diff(found) > -1e-3 * found[0]).all()


def test_lengths_scale() -> None:
    """Twice the size, half the gradient: twice the depth, the same safety but for the support."""
    small = fillet_result(
        by_amplitude, fillet(replace(INDUCTION, depth_mm=1.0), NotchShape(3.0, 5.0)), points(0.4)
    )
    large = fillet_result(by_amplitude, fillet(INDUCTION), points(0.2))
    assert (small.depth_mm, large.depth_mm) == (1.0, 2.0)
    assert small.stress_share == pytest.approx(large.stress_share, rel=1e-12)
    assert small.safety == pytest.approx(large.safety, rel=0.02)


def test_one_treated_fillet_leaves_other_nodes_as_they_are() -> None:
    local = points(0.5, count=4)
    masks = np.array([True, False, True, False])
    one = TreatedFillet("journal", NITRIDED, SHAPE, masks)
    plain = judge(local)
    found = harden(plain, judge, (one,), local)
    assert (found[~masks] == plain[~masks]).all()
    assert (found[masks] > plain[masks]).all()
    (cut,) = of_nodes((one,), np.array([1, 2]))
    assert cut.nodes.tolist() == [False, True]
    assert at_nodes(local, masks).amplitude_MPa.shape == (2,)


def test_the_stress_falls_by_its_own_gradient() -> None:
    gradient = np.array([0.0, 0.01, 0.05, 0.4, 1.5])
    step = 1e-6
    for depth in (0.0, 0.3, 2.0):
        share, told = stress_share(SHAPE, gradient, depth)
        after = stress_share(SHAPE, gradient, depth + step)[0]
        assert told == pytest.approx(-(after - share) / step / share, rel=1e-4, abs=1e-7)
    share, told = stress_share(SHAPE, gradient, 0.0)
    assert share == pytest.approx(np.ones(5), rel=1e-14)
    assert told == pytest.approx(gradient, rel=1e-14)
    assert stress_share(SHAPE, np.array([0.01]), 5.0)[0][0] == pytest.approx(1 - 0.01 * 5.0)


def test_the_stress_beside_a_hole_falls_about_as_kirsch_has_it() -> None:
    """Stress concentration 3, gradient 7 / (3 r): within 13 % as far as a radius below the edge."""
    radius = 2.5
    for depth in np.linspace(0.0, radius, 9):
        ratio = radius / (radius + depth)
        exact = (2 + ratio**2 + 3 * ratio**4) / 6
        share = stress_share(NotchShape(3.0, 1e6), np.array([7 / (3 * radius)]), float(depth))[0][0]
        assert share == pytest.approx(exact, rel=0.14)


def test_the_shape_of_a_fillet_is_that_of_the_rule() -> None:
    scene = load_scene("mikron-iiic")
    size = dimensions(scene)
    factors = concentration_factors(size)
    assert notch_shape(scene, "pin").concentration == factors.alpha_bending
    assert notch_shape(scene, "journal").concentration == factors.beta_bending
    assert web_middle_mm(size) == pytest.approx(math.hypot(19, 6) / 2)


def test_both_webs_of_a_shaft_of_unlike_halves_are_told_apart() -> None:
    local = points(0.5, count=2)
    near = TreatedFillet("pin", NITRIDED, NotchShape(3.0, 9.0), np.array([True, False]))
    far = TreatedFillet("pin", NITRIDED, NotchShape(2.0, 12.0), np.array([False, True]))
    found = harden(judge(local), judge, (near, far), local)
    assert found[0] != found[1]
