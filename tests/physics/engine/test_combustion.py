"""The combustion model against an independent integration of its energy balance and against the gas laws."""

import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from cranktopo.base.errors import CranktopoError
from cranktopo.design.engine import Gas
from cranktopo.engine.chamber import Piston, chamber
from cranktopo.engine.combustion import combustion_pressure_MPa, fit_combustion

R, L = 48.0, 166.0
ROOM = chamber(Piston(R, L))
GAS = Gas(
    peak_pressure_MPa=5.16,
    peak_angle_deg=11.0,
    ambient_pressure_MPa=0.10133,
    intake_pressure_MPa=0.09,
    exhaust_pressure_MPa=0.11,
    compression_ratio=8.0,
)


def volume(a_deg, ratio):
    """Volume over clearance volume, from the triangle of throw and rod (law of cosines)."""
    a = math.radians(a_deg)
    piston = R * math.cos(a) + math.sqrt(L**2 - (R * math.sin(a)) ** 2)
    return 1 + (ratio - 1) * (R + L - piston) / (2 * R)


@pytest.mark.parametrize(
    ("peak", "angle", "ratio", "duration", "shape"),
    [(5.16, 11.0, 8.0, 60.0, 2.0), (15.0, 8.0, 16.0, 45.0, 1.2)],
)
def test_peak_is_where_and_as_high_as_asked(peak, angle, ratio, duration, shape):
    update = {"peak_pressure_MPa": peak, "peak_angle_deg": angle, "compression_ratio": ratio}
    gas = GAS.model_copy(update={**update, "burn_duration_deg": duration, "wiebe_shape": shape})
    fine = np.arange(0.0, 90.0, 0.01)
    pressure = combustion_pressure_MPa(fit_combustion(gas, ROOM, 720.0), fine)
    assert pressure.max() == pytest.approx(peak, rel=1e-7)
    assert fine[pressure.argmax()] == pytest.approx(angle, abs=0.011)


def test_pressure_follows_the_energy_balance():
    """dp/da = ((n - 1) q dx/da - n p dv/da) / v by an adaptive Runge-Kutta method."""
    model = fit_combustion(GAS, ROOM, 720.0)
    n, m = GAS.polytropic_expansion, GAS.wiebe_shape

    def slope(a, p):
        h = 1e-4
        dv = (volume(a + h, 8.0) - volume(a - h, 8.0)) / (2 * h)
        phi = max(a - model.start_deg, 0.0) / GAS.burn_duration_deg
        dx = 6.908 * (m + 1) * phi**m * math.exp(-6.908 * phi ** (m + 1)) / GAS.burn_duration_deg
        return ((n - 1) * model.heat_MPa * dx - n * p * dv) / volume(a, 8.0)

    start = GAS.intake_MPa * (8.0 / volume(model.start_deg, 8.0)) ** GAS.polytropic_compression
    angles = np.array([0.0, 11.0, 30.0, 60.0, 100.0, 125.0])
    truth = solve_ivp(slope, (model.start_deg, 130.0), [start], t_eval=angles, rtol=1e-10, atol=1e-12)
    assert combustion_pressure_MPa(model, angles) == pytest.approx(truth.y[0], rel=1e-6)


def test_compression_and_gas_exchange():
    model = fit_combustion(GAS, ROOM, 720.0)
    p = combustion_pressure_MPa(model, np.array([185.0, 300.0, 359.0, 370.0, 385.0, 500.0, 620.0]))
    assert p[:3] == pytest.approx(0.11)
    assert p[3] == pytest.approx(0.10)  # half-way through the overlap
    assert p[4:6] == pytest.approx(0.09)
    assert p[6] == pytest.approx(0.09 * (8.0 / volume(-100.0, 8.0)) ** 1.32, rel=1e-12)


def test_curve_is_continuous_over_the_cycle():
    for cycle in (720.0, 360.0):
        gas = GAS.model_copy(update={"exhaust_pressure_MPa": None if cycle == 360.0 else 0.11})
        angle = np.arange(0.0, cycle, 0.25)
        p = combustion_pressure_MPa(fit_combustion(gas, ROOM, cycle), angle)
        assert np.abs(np.diff(p, append=p[0])).max() < 0.06 * 5.16 * 0.25
        assert p.min() == pytest.approx(0.09)


def test_two_stroke_scavenges_between_the_ports():
    gas = GAS.model_copy(update={"exhaust_opening_deg": 110.0, "exhaust_pressure_MPa": None})
    p = combustion_pressure_MPa(fit_combustion(gas, ROOM, 360.0), np.array([180.0, 200.0, 249.0, 300.0]))
    assert p[:3] == pytest.approx(0.09)
    assert p[3] == pytest.approx(0.09 * (volume(-110.0, 8.0) / volume(-60.0, 8.0)) ** 1.32, rel=1e-12)


def test_peak_below_compression_is_refused():
    gas = GAS.model_copy(update={"peak_pressure_MPa": 1.2})
    with pytest.raises(CranktopoError, match=r"peak_pressure_MPa = 1\.2: must be above the compression"):
        fit_combustion(gas, ROOM, 720.0)


def test_peak_that_no_burning_reaches_is_refused():
    gas = GAS.model_copy(update={"peak_angle_deg": 59.0, "burn_duration_deg": 2.0, "wiebe_shape": 9.0})
    with pytest.raises(CranktopoError, match=r"engine\.gas\.peak_angle_deg"):
        fit_combustion(gas.model_copy(update={"peak_pressure_MPa": 1.45}), ROOM, 720.0)
