"""The stepped beam against closed forms of beams: Euler, Timoshenko, three moments, springs."""

import math

import numpy as np
import pytest

from cranktopo.numerics.stepped_beam import bend, round_beam

E, NU = 210e3, 0.3


def beam(z, outer, inner=0.0):
    steps = np.ones(len(z) - 1)
    return round_beam(np.array(z, dtype=float), outer * steps, inner * steps, E, NU)


def load(count, **at):
    found = np.zeros(count, dtype=complex)
    for node, value in at.items():
        found[int(node[1:])] = value
    return found


def test_simple_beam_with_shear():
    """F l^3 / 48 E I + F l / 4 k G A, moment F l / 4, slope F l^2 / 16 E I."""
    bar = beam([0, 100, 200], 30.0, 10.0)
    bent = bend(bar, {0: None, 2: None}, load(3, n1=1000.0), load(3))
    stiff, shear = bar.bending_Nmm2[0], bar.shear_N[0]
    assert bent.deflection_mm[1] == pytest.approx(1000 * 200**3 / 48 / stiff + 1000 * 200 / 4 / shear)
    assert abs(bent.before_Nmm[1]) == pytest.approx(50_000.0)
    assert abs(bent.after_Nmm[1]) == pytest.approx(50_000.0)
    assert abs(bent.slope_rad[0]) == pytest.approx(1000 * 200**2 / 16 / stiff)
    assert bent.reaction_N[0] == pytest.approx(-500.0)


def test_overhang_and_a_step():
    """Deflection at the end of an overhang by Castigliano, the overhang thinner than the span."""
    bar = round_beam(np.array([0.0, 161.0, 237.0]), np.array([60.0, 45.0]), np.zeros(2), E, NU)
    bent = bend(bar, {0: None, 1: None}, load(3, n2=3000.0), load(3))
    thick, thin = bar.bending_Nmm2
    shear = bar.shear_N
    a, span = 76.0, 161.0
    bending = 3000 * a**2 * span / (3 * thick) + 3000 * a**3 / (3 * thin)
    shearing = 3000 * a / shear[1] + 3000 * (a / span) ** 2 * span / shear[0]
    assert bent.deflection_mm[2].real == pytest.approx(bending + shearing, rel=1e-10)


def test_three_supports_by_three_moments():
    """Two equal spans, a force in the middle of one: the moment over the middle support is 3 F l / 32."""
    bar = beam(np.arange(0, 2001, 500), 20.0)
    bent = bend(bar, {0: None, 2: None, 4: None}, load(5, n1=100.0), load(5))
    assert abs(bent.after_Nmm[2]) == pytest.approx(3 * 100 * 1000 / 32, rel=1e-3)
    assert sum(bent.reaction_N.values()) == pytest.approx(-100.0)


def test_springs_and_planes():
    """A stiff beam sinks by force over spring; a force across bends it across alike."""
    bar = beam([0, 50, 100], 400.0)
    bent = bend(bar, {0: 1e4, 2: 1e4}, load(3, n1=1000.0 + 500.0j), load(3))
    assert bent.deflection_mm[1] == pytest.approx(0.05 + 0.025j, rel=1e-3)
    turned = bend(bar, {0: 1e4, 2: 1e4}, load(3, n1=(1000.0 + 500.0j) * 1j), load(3))
    assert turned.deflection_mm == pytest.approx(bent.deflection_mm * 1j)


def test_couple_at_an_end():
    """M l / 3 E I is the slope below a couple, M l / 6 E I at the other support."""
    bar = beam([0, 300], 20.0)
    bent = bend(bar, {0: None, 1: None}, load(2), load(2, n0=1e4))
    assert bent.slope_rad[0].real == pytest.approx(1e4 * 300 / (3 * bar.bending_Nmm2[0]), rel=2e-2)
    assert bent.slope_rad[1].real == pytest.approx(-1e4 * 300 / (6 * bar.bending_Nmm2[0]), rel=2e-2)
    assert abs(bent.after_Nmm[0]) == pytest.approx(1e4)


def test_cutting_a_step_in_pieces_changes_nothing():
    whole = bend(beam([0, 100, 200], 30.0), {0: None, 2: 5e5}, load(3, n1=1e3), load(3))
    cut = bend(beam(np.linspace(0, 200, 9), 30.0), {0: None, 8: 5e5}, load(9, n4=1e3), load(9))
    assert cut.deflection_mm[4] == pytest.approx(whole.deflection_mm[1], rel=1e-9)
    assert math.isclose(abs(cut.moment_Nmm[4]), abs(whole.moment_Nmm[1]), rel_tol=1e-9)
