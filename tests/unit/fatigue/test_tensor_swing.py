"""Cycles by tensors: closed forms, every pair of states, what stands still, and no jump of the mean."""

from __future__ import annotations

import numpy as np
import pytest

from cranktopo.numerics.tetrahedra.stress import SurfaceStress, von_mises
from cranktopo.tasks.fatigue.superposition import (
    signed_von_mises_ranges,
    tensor_ranges,
    tensor_stress,
)

ANGLE = np.linspace(0.0, 4 * np.pi, 240, endpoint=False)
CYCLE = np.stack(
    [np.exp(-20 * np.sin(ANGLE / 4) ** 2), np.cos(ANGLE), np.cos(2 * ANGLE), np.sin(ANGLE)], axis=1
)
"""A push that lasts a small part of a cycle, and inertia along and across."""


def surface(stress: np.ndarray, depth: np.ndarray | None = None) -> SurfaceStress:
    return SurfaceStress(
        stress, np.zeros_like(stress) if depth is None else depth, np.zeros(stress.shape[:2])
    )


def tensor(*components: float) -> np.ndarray:
    return np.array([components], dtype=float)


def test_uniaxial_stress_has_its_signed_range() -> None:
    stress = np.zeros((4, 3, 6))
    stress[:, :, 0] = np.random.default_rng(1).normal(0, 50, (4, 3))
    depth = 0.3 * np.random.default_rng(2).normal(0, 50, stress.shape)
    tensors, signed = (
        ranges(surface(stress, depth), (CYCLE,))[0] for ranges in (tensor_ranges, signed_von_mises_ranges)
    )
    assert tensors.local.amplitude_MPa == pytest.approx(signed.local.amplitude_MPa)
    assert tensors.local.mean_MPa == pytest.approx(signed.local.mean_MPa)
    assert (
        np.sort([tensors.highest, tensors.lowest], axis=0) == np.sort([signed.highest, signed.lowest], axis=0)
    ).all()


def test_a_tension_that_turns_swings() -> None:
    """From 100 MPa along x to as much along y: a shear of 50 MPa either way. Its signed stress stays."""
    turned = np.stack([tensor(100, 0, 0, 0, 0, 0), tensor(0, 100, 0, 0, 0, 0)])
    (found,), (signed,) = (
        ranges(surface(turned), (np.eye(2),)) for ranges in (tensor_ranges, signed_von_mises_ranges)
    )
    assert found.local.amplitude_MPa == pytest.approx(50 * np.sqrt(3))
    assert found.local.mean_MPa == pytest.approx(50)
    assert signed.local.amplitude_MPa == pytest.approx(0.0)


def test_a_static_stress_changes_the_mean_alone() -> None:
    """Also where it makes the first invariant nearly zero, as a preload beside a hole does."""
    random = np.random.default_rng(3)
    swinging, depth = random.normal(0, 20, (2, 4, 50, 6))
    static, below = random.normal(0, 300, (2, 1, 50, 6))
    static[..., 2] = -static[..., 0] - static[..., 1]
    both = np.concatenate([swinging, static]), np.concatenate([depth, below])
    (plain,), (held,) = (
        tensor_ranges(surface(*fields), (loads,))
        for fields, loads in (
            ((swinging, depth), CYCLE),
            (both, np.hstack([CYCLE, np.ones((len(CYCLE), 1))])),
        )
    )
    assert held.local.amplitude_MPa == pytest.approx(plain.local.amplitude_MPa, rel=1e-9)
    assert held.local.gradient_per_mm == pytest.approx(plain.local.gradient_per_mm, rel=1e-6, abs=1e-9)
    assert not np.allclose(held.local.mean_MPa, plain.local.mean_MPa, rtol=0.5)
    signed = signed_von_mises_ranges(surface(*both), (np.hstack([CYCLE, np.ones((len(CYCLE), 1))]),))[0]
    assert (signed.local.amplitude_MPa > 3 * held.local.amplitude_MPa).any(), "it jumps with the sign"


def test_no_pair_of_states_is_farther() -> None:
    """Or by less than a thousandth, at few points."""
    stress = (
        np.random.default_rng(4).normal(0, 1, (4, 40, 6)) * np.array([10.0, 2.0, 1.0, 2.0])[:, None, None]
    )
    found = tensor_ranges(surface(stress), (CYCLE,))[0].local.amplitude_MPa
    states = np.einsum("sf,fnc->nsc", CYCLE, stress)
    every = np.array([von_mises(one[:, None] - one).max() / 2 for one in states])
    assert found == pytest.approx(every, rel=1e-3)
    assert (found < every * (1 - 1e-9)).sum() <= 1


def test_the_mean_is_signed_and_does_not_jump() -> None:
    """Signed von Mises stress where principal stresses have one sign; shear has none, nor near it."""
    for principal in ((80, 0), (80, 30), (-80, -30), (-80, 0)):
        middle = tensor(*principal, 0, 0, 0, 0)
        found = tensor_stress(np.stack([middle, middle]), np.zeros((2, 1, 6))).mean_MPa
        assert found == pytest.approx(np.sign(sum(principal)) * von_mises(middle))
    for tension in (1e-3, 0.0, -1e-3):
        sheared = tensor(200 + tension, -200, 0, 0, 0, 0)
        found = tensor_stress(np.stack([sheared, sheared]), np.zeros((2, 1, 6))).mean_MPa
        assert found == pytest.approx(tension, abs=1e-9)
