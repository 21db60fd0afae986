"""Arrangement of cylinders and throws: what follows from it, and what is refused."""

import re

import pytest

from cranktopo.base.errors import CranktopoError
from cranktopo.design.assumed import LOADS, assumptions
from cranktopo.design.loading import parse_scene
from cranktopo.engine.analysis import analyse
from cranktopo.engine.balance.throw import throw_balance
from tests.engine_arrangements import MIKRON, VEE
from tests.engine_arrangements import arranged as scene

SHAFT = "[[engine.arrangement.balancer_shaft]]\norder = 1\nturns = 'against'\n"
GEAR = f"{SHAFT}[engine.arrangement.balancer_shaft.gear]\npitch_radius_mm = 30.0\n"
TWIN = {"cylinders": 2, "order": (1, 2)}


def test_an_empty_arrangement_changes_nothing():
    plain, arranged = parse_scene(MIKRON).engine, scene("").engine
    assert arranged.throw_angles_deg == plain.throw_angles_deg == (0.0, 180.0, 180.0, 0.0)
    assert arranged.firing_angles_deg == plain.firing_angles_deg == (0.0, 540.0, 180.0, 360.0)
    assert (plain.throws, plain.rods_per_pin, plain.bank_angle_deg) == (4, 1, 0.0)


@pytest.mark.parametrize(
    ("arrangement", "cylinders", "order", "throws", "fires"),
    [
        ("", 2, (1, 2), (0, 0), (0, 360)),
        ("throw_angles_deg = [0.0, 180.0]", 2, (1, 2), (0, 180), (0, 180)),
        ("layout = 'V'\nbank_angle_deg = 90.0\nthrow_angles_deg = [0.0]", 2, (1, 2), (0,), (0, 450)),
        ("layout = 'V'\nbank_angle_deg = 45.0\nthrow_angles_deg = [0.0]", 2, (2, 1), (0,), (315, 0)),
        (
            "layout = 'V'\nbank_angle_deg = 90.0",
            8,
            (1, 5, 4, 2, 6, 3, 7, 8),
            (0, 90, 270, 180),
            (0, 270, 450, 180, 90, 360, 540, 630),
        ),
        ("layout = 'boxer'", 4, (1, 3, 2, 4), (0, 180, 180, 0), (0, 360, 180, 540)),
        (
            "throw_angles_deg = [0.0, 90.0, 270.0, 180.0]",
            4,
            (1, 3, 2, 4),
            (0, 90, 270, 180),
            (0, 270, 90, 540),
        ),
    ],
    ids=["twin 360", "twin 180", "V2 at 90", "V2 at 45", "V8 cross-plane", "boxer 4", "uneven four"],
)
def test_throws_and_firing(arrangement, cylinders, order, throws, fires):
    engine = scene(arrangement, cylinders, order).engine
    assert engine.throw_angles_deg == pytest.approx(throws)
    assert engine.firing_angles_deg == pytest.approx(fires)


def test_a_two_stroke_engine_fires_at_every_dead_centre():
    engine = scene("throw_angles_deg = [0.0, 100.0]", 2, (1, 2), 2).engine
    assert engine.firing_angles_deg == pytest.approx((0, 260))


def test_uneven_firing_reaches_the_torque_behind_a_throw():
    """A twin of 180 deg: the second throw adds the torque of the first, 180 deg later."""
    torque = analyse(scene("throw_angles_deg = [0.0, 180.0]", 2, (1, 2))).cycle.torque
    first, both = torque.passed_on_Nm
    steps = round(180 / (torque.angle_deg[1] - torque.angle_deg[0]))
    later = [first[i - steps] for i in range(len(first))]
    assert both - first == pytest.approx(later, abs=1e-9)


def test_both_rods_of_a_pin_turn_with_it():
    vee = scene("layout = 'V'\nbank_angle_deg = 90.0\nthrow_angles_deg = [0.0]", 2, (1, 2))
    line, two = throw_balance(parse_scene(MIKRON)), throw_balance(vee)
    found = {str(item) for item in assumptions(vee, (LOADS,))}
    assert "engine.arrangement.rod_offset_mm = 18 (half the pin's length)" in found
    assert two.rotating_unbalance_kg_mm - line.rotating_unbalance_kg_mm == pytest.approx(0.3254 * 48)


REFUSED = [
    ("layout = 'X'", {}, r"engine\.arrangement\.layout = 'X': must be"),
    ("layot = 'V'", {}, r"unknown key engine\.arrangement\.layot"),
    ("layout = 'V'", {}, r"bank_angle_deg = None: must be given for a V"),
    ("layout = 'V'\nbank_angle_deg = 190.0", {}, r"bank_angle_deg = 190\.0: must be"),
    ("bank_angle_deg = 90.0", {}, r"bank_angle_deg = 90\.0: an in-line engine has one bank"),
    ("layout = 'boxer'\nbank_angle_deg = 90.0", {}, r"bank_angle_deg = 90\.0: must be 180 deg for a boxer"),
    ("layout = 'boxer'", {"cylinders": 3, "order": (1, 2, 3)}, r"engine\.cylinders = 3: must be even"),
    (VEE, TWIN, r"order.*cannot be even.*split pins"),
    (VEE + "rod_offset_mm = 40.0", {}, r"rod_offset_mm = 40\.0: must be smaller"),
    ("rod_offset_mm = 10.0", {}, r"rod_offset_mm = 10\.0: only a V or a W has rods side by side"),
    ("cylinder_pitch_mm = 30.0", {}, r"cylinder_pitch_mm = 30\.0: must be larger than throw\.crankpin"),
    ("cylinder_pitch_mm = 0.0", {}, r"cylinder_pitch_mm = 0\.0: must be"),
    ("throw_angles_deg = [0.0, 180.0]", {}, r"must have one angle per throw \(4\)"),
    ("throw_angles_deg = [90.0, 0.0, 180.0, 270.0]", {}, r"must begin with 0"),
    ("throw_angles_deg = [0.0, 400.0, 180.0, 270.0]", {}, r"throw_angles_deg\[1\] = 400\.0: must be"),
    ("throw_angles_deg = [0.0, 90.0, 180.0, 270.0]", {"strokes": 2}, r"which is not one after the other"),
    ("balanced_oscillating_share = 1.5", {}, r"balanced_oscillating_share = 1\.5: must be"),
    (SHAFT.replace("1", "3"), {}, r"balancer_shaft\[0\]\.order = 3: must be"),
    (SHAFT.replace("against", "along"), {}, r"balancer_shaft\[0\]\.turns = 'along': must be"),
    (SHAFT + "balances = 'moment'", {}, r"balancer_shaft\[0\]\.distance_mm = None: must be given"),
    (SHAFT + "distance_mm = 100.0", {}, r"\[0\]\.distance_mm = 100\.0: a shaft that balances a force"),
    (SHAFT + "balances = 'moment'\ndistance_mm = 100.0\nz_mm = 1.0", {}, r"z_mm = 1\.0: two opposite masses"),
    (SHAFT + "balances = 'torque'", {}, r"balancer_shaft\[0\]\.balances = 'torque': must be"),
    (SHAFT + "unbalance_kg_mm = -1.0", {}, r"balancer_shaft\[0\]\.unbalance_kg_mm = -1\.0: must be"),
    (SHAFT + "phase_deg = 400.0", {}, r"balancer_shaft\[0\]\.phase_deg = 400\.0: must be"),
    (SHAFT + "z_mm = 1e9", {}, r"balancer_shaft\[0\]\.z_mm = 1000000000\.0: must be"),
    (GEAR + "power_kW = 0.0", {}, r"balancer_shaft\[0\]\.gear\.power_kW = 0\.0: must be"),
    (GEAR + "power_kW = 1.0\nhelix_deg = 90.0", {}, r"gear\.helix_deg = 90\.0: must be"),
    (GEAR + "power_kW = 1.0\npressure_deg = 0.0", {}, r"gear\.pressure_deg = 0\.0: must be"),
    (GEAR.replace("30", "-30") + "power_kW = 1.0", {}, r"gear\.pitch_radius_mm = -30\.0: must be"),
    (SHAFT + SHAFT, {}, r"balancer_shaft\[1\] = .*is there twice"),
]  # fmt: skip


@pytest.mark.parametrize(("arrangement", "engine", "message"), REFUSED)
def test_refused(arrangement, engine, message):
    with pytest.raises(CranktopoError) as error:
        scene(arrangement, **engine)
    assert re.search(message, str(error.value)), error.value
    assert len(str(error.value).splitlines()) == 1
