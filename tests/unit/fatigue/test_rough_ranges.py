"""Cyclic stress in single precision: that of double precision, in one piece and joined of parts."""

from __future__ import annotations

import numpy as np
import pytest

from cranktopo.numerics.tetrahedra.stress import SurfaceStress
from cranktopo.tasks.fatigue.rough_ranges import fewer_fields, rough_local, rough_stress, wider
from cranktopo.tasks.fatigue.superposition import signed_von_mises_ranges

Array = np.ndarray
NODES, STATES, FIELDS = 4 * (2**16 // 48), 48, 5
"""More nodes than forms are made of at a time, and as many as extremes are found of in four times: the last
digit of a product of matrices depends on how many rows it has, on some processors."""
EACH = np.eye(FIELDS)[None]
"""Every field by itself, in one image."""


def of_fields() -> SurfaceStress:
    """Five fields of which the second is nearly the first one's opposite, as motions of two sections are."""
    random = np.random.default_rng(3)
    stress, depth = random.normal(0, 40, (2, 5, NODES, 6))
    stress[1] = 0.02 * stress[1] - stress[0]
    depth[1] = 0.02 * depth[1] - depth[0]
    return SurfaceStress(stress, depth, np.zeros(stress.shape[:2]))


def cycles() -> list[Array]:
    """Three cycles; in the second all nodes are pulled and pushed, in the third half of them never pushed."""
    found = np.random.default_rng(4).normal(0, 1, (3, STATES, 5))
    found[2, :, 4] += 3
    return list(found)


def test_it_is_what_double_precision_finds() -> None:
    stress = of_fields()
    found = rough_stress(stress, EACH).extremes(cycles())
    for own, exact in zip(found.swapaxes(0, 1), signed_von_mises_ranges(stress, cycles()), strict=True):
        rough, local = rough_local(own), exact.local
        assert own.dtype == np.float32
        scale = np.abs(local.mean_MPa) + local.amplitude_MPa
        assert np.abs(rough.amplitude_MPa - local.amplitude_MPa).max() < 1e-5 * scale.max()
        assert np.abs(rough.mean_MPa - local.mean_MPa).max() < 1e-5 * scale.max()
        assert rough.gradient_per_mm == pytest.approx(local.gradient_per_mm, rel=1e-3, abs=1e-5)
        assert (local.gradient_per_mm > 0).mean() > 0.3


def test_extremes_of_parts_of_a_cycle_join_to_those_of_all() -> None:
    rough = rough_stress(of_fields(), EACH).at(np.arange(0, NODES, 7))
    every = rough.extremes(cycles())
    parts = [rough.extremes([cycle[start::3] for cycle in cycles()]) for start in range(3)]
    joined = wider(wider(parts[0], parts[1]), parts[2])
    assert joined[:2] == pytest.approx(every[:2], rel=1e-4, abs=1e-2)
    assert joined[2] == pytest.approx(every[2], rel=1e-4, abs=1e-2)


def test_mirrored_nodes_have_fields_of_other_signs() -> None:
    stress, signs = of_fields(), np.array([1.0, -1.0, 1.0, -1.0, 1.0])
    mirrored = SurfaceStress(
        stress.stress_MPa * signs[:, None, None],
        stress.depth_MPa_per_mm * signs[:, None, None],
        stress.jump_MPa,
    )
    found = rough_stress(stress, EACH * np.stack([np.ones(FIELDS), signs])[:, None]).extremes(cycles())
    assert np.array_equal(found[:, :, :NODES], rough_stress(stress, EACH).extremes(cycles()))
    assert np.array_equal(found[:, :, NODES:], rough_stress(mirrored, EACH).extremes(cycles()))


def test_fields_that_move_together_are_summed() -> None:
    """Of two forces: their states have two sums of five fields, whose stress is that of all."""
    stress, random = of_fields(), np.random.default_rng(5)
    loads = random.normal(0, 1, (3, STATES, 2)) @ random.normal(0, 1, (2, FIELDS))
    sums, factors = fewer_fields(loads, np.abs(stress.stress_MPa).max(axis=(1, 2)))
    assert sums.shape == (2, FIELDS)
    assert np.abs(factors @ sums - loads).max() < 1e-9
    found = rough_stress(stress, sums[None]).extremes(list(factors))
    expected = rough_stress(stress, EACH).extremes(list(loads))
    assert np.abs(found - expected).max() < 1e-5 * np.abs(expected).max()


def test_fields_that_move_by_themselves_are_all_kept() -> None:
    loads = np.stack(cycles())
    sums, factors = fewer_fields(loads, np.full(FIELDS, 7.0))
    assert sums.shape == (FIELDS, FIELDS)
    assert np.abs(factors @ sums - loads).max() < 1e-9
