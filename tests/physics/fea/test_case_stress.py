"""Stresses of load cases against the closed form of a twisted tube, and where they are read."""

from __future__ import annotations

import math

import numpy as np
import pytest

from cranktopo.engine.load_case import LoadCase
from cranktopo.tasks.throw_fea.targets import Target
from cranktopo.tasks.throw_fea.unit_fields import CaseStress, case_stress
from tests.physics.fea.evaluation_cases import LOPSIDED, mikron_with

SIZE_MM = 14.0
TORSION = LoadCase(name="torsion", kind="torsion", torque_Nm=700.0)
BENDING = LoadCase(name="bending", kind="bending", radial_N=30000.0)


@pytest.fixture(scope="module")
def found() -> CaseStress:
    """One lopsided throw: nothing is mirrored."""
    target = Target("lopsided", mikron_with(pocket=[LOPSIDED]))
    return case_stress(
        target, (TORSION, BENDING, BENDING.model_copy(update={"name": "twice", "radial_N": 60000.0})), SIZE_MM
    )


def ring(radius_mm: float, z_mm: float) -> np.ndarray:
    angle = np.linspace(0, 2 * math.pi, 48, endpoint=False)
    return np.stack([radius_mm * np.cos(angle), radius_mm * np.sin(angle), np.full(48, z_mm)], axis=1)


@pytest.mark.parametrize("radius_mm", [21.0, 12.0], ids=["outside", "bore"])
def test_journal_is_a_twisted_tube(found: CaseStress, radius_mm: float) -> None:
    """Shear T r / J on the journal away from the web, von Mises stress sqrt(3) times that."""
    polar_mm4 = math.pi / 32 * (42.0**4 - 24.0**4)
    expected = math.sqrt(3) * 700e3 * radius_mm / polar_mm4
    assert found.at(ring(radius_mm, 4.0))[0].mean() == pytest.approx(expected, rel=0.05)


def test_stress_is_linear_in_the_load(found: CaseStress) -> None:
    np.testing.assert_allclose(found.von_mises_MPa[2], 2 * found.von_mises_MPa[1], rtol=1e-10)


def test_lopsided_web_is_stressed_on_one_side(found: CaseStress) -> None:
    """The hole at x = +15 mm weakens the side it is on."""
    beside = np.array([[24.5, 20.0, 30.0], [-24.5, 20.0, 30.0]])
    weak, strong = found.at(beside)[0]
    assert not found.mirrored
    assert weak > 1.2 * strong


def test_read_at_a_node_is_the_value_of_the_node(found: CaseStress) -> None:
    some = slice(0, None, 97)
    np.testing.assert_allclose(found.at(found.points_mm[some]), found.von_mises_MPa[:, some], rtol=1e-3)


def test_half_model_answers_on_both_sides() -> None:
    half = case_stress(Target("whole", mikron_with()), (TORSION,), SIZE_MM)
    assert half.mirrored
    left, right = (half.at(ring(21.0, 4.0) * [side, 1.0, 1.0])[0] for side in (-1, 1))
    np.testing.assert_allclose(left, right)
