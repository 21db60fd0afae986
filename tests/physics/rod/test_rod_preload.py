"""Preload of the cap's bolts on elements: statics, slopes of its forces, stiffness of the parts, split."""

from dataclasses import replace

import numpy as np
import pytest

from cranktopo.design.loading import load_scene
from cranktopo.design.named import with_values
from cranktopo.tasks.bolts.joint import part_compliance_mm_per_N
from cranktopo.tasks.rod.bolt_load import near_bolts, preload_tractions
from cranktopo.tasks.rod.element_stage import rod_on_elements
from cranktopo.tasks.rod.element_stress import cycle_states
from cranktopo.tasks.rod.unit_fields import rod_model, solve_rod
from cranktopo.tasks.rod.unit_loads import ACROSS, ALONG

SQUARE = load_scene("mikron-iiic-rod-h")
SQUARE = SQUARE.model_copy(update={"material": SQUARE.rod.material})
OBLIQUE = with_values(SQUARE, {"rod.split_angle_deg": 30.0})
THROUGH = with_values(SQUARE, {"rod.bolt.held_in": "nut", "rod.bolt.grip_mm": 30.34})
PRELOAD = (*ALONG, *ACROSS).index("preload")


@pytest.fixture(scope="module", params=["square", "oblique", "through"])
def case(request):
    scene = {"square": SQUARE, "oblique": OBLIQUE, "through": THROUGH}[request.param]
    return scene, rod_model(scene, 12.0)


def along(scene, points):
    angle = np.radians(scene.rod.split_angle_deg)
    return points[0] * np.sin(angle) + points[1] * np.cos(angle)


def forces_of(scene, model):
    return sum(size * one.forces() for size, one in preload_tractions(scene.rod, model)).reshape(-1, 3)


def test_it_is_in_equilibrium_over_its_grip(case):
    """First moment of the forces along the bolt, and so the mean stress: head to middle of the thread."""
    scene, model = case
    rod, force = scene.rod, forces_of(scene, model)
    bolts = 1 if scene.rod.split_angle_deg == 0 else 2
    assert np.abs(force.sum(axis=0)).max() < 1e-12
    moment = (along(scene, force.T) * along(scene, model.nodes_mm)).sum()
    held = rod.boss_above_mm if rod.bolt.held_in == "nut" else rod.bolt.grip_mm - rod.boss_below_mm
    middle = held if rod.bolt.held_in == "nut" else held + rod.bolt.engaged_mm / 2
    assert -moment / (0.5 * bolts) == pytest.approx(middle + rod.boss_below_mm, rel=0.02)


def test_slopes_of_the_forces_are_those_of_moved_nodes(case):
    scene, model = case
    rng = np.random.default_rng(3)
    at, weights = rng.standard_normal(model.nodes_mm.shape), rng.standard_normal(model.nodes_mm.size)
    step = 1e-5
    for _, traction in preload_tractions(scene.rod, model):
        ahead, back = (
            traction_on(traction, model.nodes_mm + sign * step * at).forces() @ weights for sign in (1, -1)
        )
        found = (traction.slopes(weights) * at).sum()
        assert found == pytest.approx((ahead - back) / (2 * step), rel=1e-6, abs=1e-9)


def traction_on(traction, nodes_mm):
    return replace(traction, model=replace(traction.model, nodes_mm=nodes_mm))


@pytest.mark.slow
def test_the_parts_yield_by_what_vdi_2230_has():
    """Work of 1 N over both seats of a through bolt in wide bosses, beside the rule's cones of pressure."""
    wide = {"rod.boss_width_mm": 78.0, "rod.big_end_width_mm": 24.0, "rod.bolt_distance_mm": 60.0}
    scene = with_values(THROUGH, {**wide, "rod.bolt.member_diameter_mm": 18.0})
    model = rod_model(scene, 5.0)
    work = forces_of(scene, model).ravel() @ solve_rod(scene, model, {}).displacement_mm[PRELOAD] / 0.5
    rule = part_compliance_mm_per_N(scene.rod.clamping_bolt, scene.material.E_GPa * 1e3)
    assert work == pytest.approx(rule, rel=0.1)


@pytest.mark.slow
def test_states_have_the_mean_preload_and_the_split_the_least():
    found = rod_on_elements(SQUARE, "lsa", 6.0, contact=False)
    preload, joint = found.strength.elements.preload, found.strength.bolt.vdi_2230
    factor = SQUARE.rod.bolt.tightening_factor
    assert preload.mean_N == pytest.approx((joint.preload_N + joint.preload_N / factor) / 2)
    assert (preload.least_N, preload.largest_N) == pytest.approx((joint.least_preload_N, joint.preload_N))
    states = cycle_states(found.stress.fields, found.motions)
    assert states[:, PRELOAD] == pytest.approx(np.full(len(states), preload.mean_N))
    stronger = with_values(SQUARE, {"rod.bolt.preload_N": 1.2 * joint.preload_N})
    more = rod_on_elements(stronger, "lsa", 6.0, contact=False).strength.elements
    assert more.preload.least_pressure_MPa > preload.least_pressure_MPa + 5
    without = with_values(SQUARE, {"rod.bolt": None})
    assert rod_on_elements(without, "lsa", 6.0, contact=False).strength.elements.preload is None


def test_nothing_is_judged_at_heads_and_threads():
    rod = SQUARE.rod
    axis = rod.bolt_distance_mm / 2
    points = np.array(
        [(axis + 6, -16, 0), (axis + 4.2, 5, 0), (axis + 4.2, -5, 0), (0, -16, 0), (axis + 6, -10, 0)],
        dtype=float,
    )
    assert near_bolts(rod, points.T, 1.0).tolist() == [True, True, False, False, False]
    assert not near_bolts(rod.model_copy(update={"bolt": None}), points.T, 1.0).any()
