"""Largest stress and least safety as smooth quantities: closed forms, and derivatives against differences."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from cranktopo.numerics.tetrahedra.stress import SurfaceStress, von_mises
from cranktopo.tasks.fatigue.criterion import LocalStress
from cranktopo.tasks.fatigue.smooth_extremes import JudgedSurface, SmoothValue, largest_stress, least_safety
from cranktopo.tasks.fatigue.superposition import SIGNED, TENSOR, Measure


def judged(stress: np.ndarray, states: tuple[np.ndarray, ...], nodes: list[int]) -> JudgedSurface:
    found = SurfaceStress(stress, np.zeros_like(stress), np.zeros(stress.shape[:2]))
    return JudgedSurface(found, states, np.array(nodes))


def test_tension_and_shear_of_two_loads_in_closed_form() -> None:
    """Von Mises of a tension s and a shear t is sqrt(s2 + 3 t2); a node that is not judged has more."""
    stress = np.zeros((2, 2, 6))
    stress[0, 0, 0], stress[1, 0, 3], stress[0, 1, 0] = 2.0, 1.0, 500.0
    states = np.array([[30.0, 0.0], [30.0, -50.0]])
    found = largest_stress(judged(stress, (states,), [0]))
    most, other = math.sqrt(60.0**2 + 3 * 50.0**2), 60.0
    assert found.extreme == pytest.approx(most, rel=1e-12)
    assert found.value == pytest.approx((most**40 + other**40) ** (1 / 40), rel=1e-12)
    by_tension = found.value ** (1 - 40) * (most**39 * 60.0 / most * 30.0 + other**39 * 30.0)
    assert found.adjoint[0][0, 0, 0] == pytest.approx(by_tension, rel=1e-9)
    assert not found.adjoint[0][:, 1].any()
    assert not found.adjoint[1].any(), "no depth has a part in it"


def test_derivatives_by_every_stress_are_those_of_differences() -> None:
    random = np.random.default_rng(8)
    stress = random.normal(0, 1, (3, 12, 6))
    states = tuple(random.normal(0, 100, (4, 3)) for _ in range(2))
    before = judged(stress, states, [1, 2, 5, 7, 11])
    adjoint, step = largest_stress(before).adjoint[0], 1e-6
    way = random.normal(0, 1, stress.shape)
    ahead, back = (
        largest_stress(replace(before, stress=replace(before.stress, stress_MPa=stress + s * step * way)))
        for s in (1, -1)
    )
    assert (adjoint * way).sum() == pytest.approx((ahead.value - back.value) / (2 * step), rel=1e-7)


@pytest.mark.parametrize("turns", [1, 2])
def test_a_cycle_counts_in_all_nodes_and_in_a_state_without_load(turns: int) -> None:
    """Nodes far below the largest are left out: they add nothing that six digits show."""
    random, angle = np.random.default_rng(11), np.linspace(0.0, 2 * np.pi * turns, 360)
    stress = random.normal(0, 1, (3, 40, 6)) * np.geomspace(0.01, 1.0, 40)[:, None]
    cycle = np.stack([1 - np.cos(angle), np.sin(angle), np.sin(angle / 2)], axis=1)
    states = cycle, cycle * np.array([1.0, -1.0, 1.0])
    assert not cycle[0].any()
    found = largest_stress(judged(stress, states, list(range(40))))
    size = von_mises(np.stack([np.einsum("fnc,sf->snc", stress, loads) for loads in states]))
    assert found.extreme == pytest.approx(size.max(), rel=1e-12)
    assert found.value == pytest.approx((size**40).sum() ** (1 / 40), rel=1e-7)
    way, step = random.normal(0, 1, stress.shape), 1e-6
    ahead, back = (
        largest_stress(judged(stress + s * step * way, states, list(range(40)))).value for s in (1, -1)
    )
    assert (found.adjoint[0] * way).sum() == pytest.approx((ahead - back) / (2 * step), rel=1e-6)


def used(local: LocalStress) -> np.ndarray:
    """Of a strength that rises with the gradient."""
    return (local.amplitude_MPa + 0.3 * np.maximum(local.mean_MPa, 0.0)) / (
        1 + 0.2 * np.sqrt(local.gradient_per_mm)
    )


@pytest.mark.parametrize("measure", [SIGNED, TENSOR], ids=["signed", "tensor"])
def test_slopes_of_the_least_safety_by_stresses_depths_and_loads_are_those_of_differences(
    measure: Measure,
) -> None:
    """All of them move at once; each of two images has loads that three parameters change."""
    random = np.random.default_rng(5)
    stress, depth = random.normal(0, 1, (2, 3, 12, 6))
    states = tuple(random.normal(0, 100, (7, 3)) for _ in range(2))
    slopes = tuple(random.normal(0, 20, (3, 7, 3)) for _ in range(2))
    ways, by = random.normal(0, 1, (2, *stress.shape)), random.normal(0, 1, 3)

    def least(step: float) -> SmoothValue:
        found = SurfaceStress(stress + step * ways[0], depth + step * ways[1], np.zeros(stress.shape[:2]))
        loads = tuple(s + step * np.einsum("p,psf->sf", by, d) for s, d in zip(states, slopes, strict=True))
        surface = JudgedSurface(found, loads, np.array([0, 1, 4, 7, 9]), slopes, measure)
        return least_safety(surface, lambda _: lambda local: 1 / used(local))

    own, step = least(0.0), 1e-6
    exact = sum((a * w).sum() for a, w in zip(own.adjoint, ways, strict=True)) + own.by_loads @ by
    assert exact == pytest.approx((least(step).value - least(-step).value) / (2 * step), rel=1e-6)
    assert own.by_loads.any()
    assert own.adjoint[1].any()
