"""Forces and torque of throw and engine: energy, equilibrium, firing order, speed."""

import math
from itertools import pairwise

import numpy as np
import pytest
from scipy.integrate import quad

from cranktopo.design.loading import load_scene
from cranktopo.engine.analysis import analyse, at_speed
from cranktopo.engine.chamber import Piston, chamber
from cranktopo.engine.combustion import combustion_pressure_MPa, fit_combustion
from cranktopo.engine.forces import by_cylinder, shaft_torque
from cranktopo.engine.kinematics import exact_motion

MIKRON = load_scene("mikron-iiic-plain")


def with_engine(**update):
    return MIKRON.model_copy(update={"engine": MIKRON.engine.model_copy(update=update)})


@pytest.mark.parametrize("speed", [0.0, 2100.0, 2800.0])
def test_torque_does_the_indicated_work(speed):
    """Mean engine torque x angle = cylinders x work of one cylinder; inertia takes and gives back."""
    cycle = analyse(at_speed(MIKRON, speed)).cycle
    work = cycle.engine_torque()[0] * 4 * math.pi
    assert work == pytest.approx(4 * cycle.indicated_work_J, rel=1e-6)


def test_indicated_work_by_adaptive_quadrature():
    """The closed integral of p dV of the combustion model, with breaks where its phases meet."""
    gas = MIKRON.engine.gas
    model = fit_combustion(gas, chamber(Piston(48.0, 166.0)), 720.0)
    area = math.pi / 4 * 95**2

    def power(a):
        velocity = exact_motion(np.radians([a]), 48.0, 166.0).velocity_ratio[0]
        return combustion_pressure_MPa(model, np.array([a]))[0] * area * velocity * 48.0 * math.pi / 180

    breaks = [0, 130, 180, 360, 380, 540, 720 + model.start_deg, 720]
    parts = [quad(power, a, b, epsrel=1e-9)[0] for a, b in pairwise(breaks)]
    assert sum(parts) / 1000 == pytest.approx(analyse(MIKRON).cycle.indicated_work_J, rel=1e-6)


def test_inertia_alone_does_no_work_and_scales_with_speed_squared():
    slow, fast = (analyse(at_speed(MIKRON, n)).cycle.forces for n in (1000.0, 3000.0))
    still = analyse(at_speed(MIKRON, 0.0)).cycle.forces
    assert np.allclose(
        fast.tangential_force_N - still.tangential_force_N,
        9 * (slow.tangential_force_N - still.tangential_force_N),
        atol=1e-6,
    )
    assert (fast.tangential_force_N - still.tangential_force_N).mean() == pytest.approx(0, abs=1e-6)


def test_rod_pushes_pin_and_wall_in_equilibrium():
    """Force on the pin, in cylinder axes, equals the axial force; its lateral part is the side force."""
    f = analyse(MIKRON).cycle.forces
    a = np.radians(f.angle_deg)
    # Radial points to the crank axis, (-sin a, -cos a) in (lateral, axial); tangential is (cos a, -sin a).
    axial = f.radial_force_N * np.cos(a) + f.tangential_force_N * np.sin(a)
    lateral = -f.radial_force_N * np.sin(a) + f.tangential_force_N * np.cos(a)
    rod = f.rod_force_N
    assert np.hypot(axial, lateral) == pytest.approx(np.abs(rod), abs=1e-8)
    assert np.abs(lateral) == pytest.approx(np.abs(f.side_force_N), abs=1e-8)
    masses = MIKRON.engine.masses
    lifted = f.inertia_force_N * (1 + masses.rod_reciprocating_kg / masses.piston_group_kg)
    assert axial == pytest.approx(f.gas_force_N + lifted, abs=1e-8)


def test_main_journals_carry_pin_load_and_unbalance():
    analysis = analyse(MIKRON)
    f, w2 = analysis.cycle.forces, (2100 * math.pi / 30) ** 2
    y = -f.radial_force_N + (analysis.balance.rotating_unbalance_kg_mm / 1000) * w2  # outward along the throw
    assert f.main_journal_force_N == pytest.approx(np.hypot(y, f.tangential_force_N) / 2, rel=1e-12)


def test_engine_torque_sums_the_cylinders_at_their_firing_angles():
    """A spike at 30 deg of one throw, firing order 1-3-4-2: what each throw passes on."""
    angle = np.arange(0.0, 720.0, 1.0)
    spike = np.where(angle == 30, 100.0, 0.0)
    every = by_cylinder(spike, angle, MIKRON.engine.firing_angles_deg, 720.0)
    shaft = shaft_torque(angle, every, 4).passed_on_Nm
    fires = {1: 30, 3: 210, 4: 390, 2: 570}
    for behind in range(1, 5):
        expected = sorted(fires[k] for k in range(1, behind + 1))
        assert np.flatnonzero(shaft[behind - 1]).tolist() == expected
    assert shaft[3].sum() == pytest.approx(400.0)


def test_two_stroke_fires_every_turn():
    gas = MIKRON.engine.gas.model_copy(update={"exhaust_opening_deg": 110.0})
    analysis = analyse(with_engine(strokes=2, gas=gas))
    cycle = analysis.cycle
    assert cycle.forces.angle_deg[-1] == 359.75
    mean, high, _ = cycle.engine_torque()
    assert mean * 2 * math.pi == pytest.approx(4 * cycle.indicated_work_J, rel=1e-6)
    again = cycle.torque.engine_Nm[int((high.deg + 90) % 360 * 4)]  # four cylinders: every 90 deg
    assert again == pytest.approx(high.value)


def test_odd_number_of_cylinders():
    cycle = analyse(with_engine(cylinders=7, firing_order=(1, 3, 5, 7, 2, 4, 6))).cycle
    assert cycle.engine_torque()[0] * 4 * math.pi == pytest.approx(7 * cycle.indicated_work_J, rel=1e-5)
