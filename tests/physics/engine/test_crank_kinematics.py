"""Crank kinematics against a table computed apart from the code, the power balance and differentiation."""

import numpy as np
import pytest

from cranktopo.base.errors import CranktopoError
from cranktopo.engine.kinematics import exact_motion, force_ratios, phase_shift, series_motion

R, L = 45.0, 156.6
# a deg, x mm, v/(r w), acc/(r w^2), N/F
TABLE = [
    (0, 0, 0, 1.28736, 1),
    (30, 7.6537, 0.62573, 1.01580, 0.79343),
    (60, 27.4266, 0.99450, 0.35655, 0.27748),
    (90, 51.6048, 1, -0.30001, -0.30001),
    (120, 72.4266, 0.73755, -0.64345, -0.72252),
    (180, 90, 0, -0.71264, -1),
]


@pytest.mark.parametrize("row", TABLE)
def test_table(row):
    a = np.radians([row[0]])
    motion, ratios = exact_motion(a, R, L), force_ratios(a, R, L)
    assert motion.displacement_mm == pytest.approx(row[1], abs=5.1e-5)
    got = [motion.velocity_ratio, motion.acceleration_ratio, ratios.radial]
    assert np.concatenate(got) == pytest.approx(row[2:], abs=5.1e-6)


def test_largest_velocity():
    a = np.radians(np.arange(70, 80, 0.01))
    v = exact_motion(a, R, L).velocity_ratio
    assert v.max() == pytest.approx(1.04070, abs=5e-6)
    assert np.degrees(a[v.argmax()]) == pytest.approx(75.07, abs=0.01)


@pytest.mark.parametrize(("r", "rod"), [(45.0, 156.6), (48.0, 166.0), (50.0, 50.5)])
def test_power_balance(r, rod):
    """Tangential force times pin speed equals piston force times piston speed, at every angle."""
    a = np.radians(np.linspace(0, 720, 1441))
    assert force_ratios(a, r, rod).tangential == pytest.approx(
        exact_motion(a, r, rod).velocity_ratio, abs=1e-12
    )


def test_derivatives_of_displacement():
    """Velocity and acceleration by central differences of the displacement (step 1e-4 rad)."""
    a, h = np.radians(np.arange(1.0, 720.0, 7.0)), 1e-4
    x = [exact_motion(a + k * h, R, L).displacement_mm / R for k in (-1, 0, 1)]
    motion = exact_motion(a, R, L)
    assert (x[2] - x[0]) / (2 * h) == pytest.approx(motion.velocity_ratio, abs=1e-8)
    assert (x[2] - 2 * x[1] + x[0]) / h**2 == pytest.approx(motion.acceleration_ratio, abs=1e-6)


def test_force_triangle():
    """Rod force from its axial and lateral parts, and again from its radial and tangential parts."""
    ratios = force_ratios(np.radians(np.arange(0.0, 360.0, 5.0)), R, L)
    assert ratios.rod**2 == pytest.approx(1 + ratios.side**2, rel=1e-13)
    assert ratios.rod**2 == pytest.approx(ratios.radial**2 + ratios.tangential**2, rel=1e-13)


def test_series_error_shrinks_with_the_cube_of_the_crank_ratio():
    """What the first-order series leaves out of the displacement is r lam^3 sin^4 a / 8."""
    a = np.radians(np.arange(0.0, 360.0, 1.0))
    errors = [
        np.abs(series_motion(a, R, rod).displacement_mm - exact_motion(a, R, rod).displacement_mm).max()
        for rod in (10 * R, 20 * R)
    ]
    assert errors[0] == pytest.approx(R * 0.1**3 / 8, rel=0.01)
    assert errors[0] / errors[1] == pytest.approx(8, rel=0.01)


def test_rod_not_longer_than_throw_is_refused():
    with pytest.raises(CranktopoError, match=r"engine\.rod_length_mm = 45\.0: must be longer"):
        exact_motion(np.zeros(1), 45.0, 45.0)


@pytest.mark.parametrize("points", [720, 1440, 7200])
@pytest.mark.parametrize("cycle_deg", [360.0, 720.0])
def test_a_curve_that_is_later_is_that_between_its_points(points: int, cycle_deg: float) -> None:
    """From point to point it is turned: the bits are those of the interpolation, also for complex curves."""
    angle = cycle_deg * np.arange(points) / points
    curve = np.random.default_rng(points).standard_normal((2, points))
    for own in (curve[0], curve[0] + 1j * curve[1]):
        for by in (0.0, 90.0, 120.0, 240.0, 540.0, -60.0, 17.3, cycle_deg / points / 3):
            wanted = np.interp(angle - by, angle, own, period=cycle_deg)
            assert phase_shift(own, angle, by, cycle_deg).tobytes() == wanted.tobytes()


def test_a_motion_is_computed_once_and_nobody_changes_it() -> None:
    angle = np.radians(np.arange(720.0))
    motion, ratios = exact_motion(angle, R, L), force_ratios(angle, R, L)
    assert exact_motion(angle.copy(), R, L) is motion
    assert exact_motion(angle, R, L + 1e-9) is not motion
    assert exact_motion(angle.reshape(2, 360), R, L).velocity_ratio.shape == (2, 360)
    for shared in (motion.acceleration_ratio, motion.displacement_mm, ratios.radial):
        with pytest.raises(ValueError, match="read-only"):
            shared[0] = 0.0
