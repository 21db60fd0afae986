"""Least fatigue safety of a throw as a smooth quantity: a p-norm of the used strength, 1 / safety."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import partial

import numpy as np
from numpy.typing import NDArray

from cranktopo.base.arrays import Array, Index
from cranktopo.design.schema import Scene
from cranktopo.numerics.optimisers.gradient_search import central_difference
from cranktopo.numerics.tetrahedra.stress import SurfaceStress
from cranktopo.tasks.fatigue.criterion import LocalStress
from cranktopo.tasks.fatigue.hardened_layer import layers
from cranktopo.tasks.fatigue.hardening import Judge, TreatedFillet, harden, of_nodes, treated
from cranktopo.tasks.fatigue.lsa import LsaStrength, lsa, lsa_strength
from cranktopo.tasks.fatigue.superposition import signed_von_mises_range
from cranktopo.tasks.shape.smooth_stress import JudgedSurface, SmoothValue, power_norm

_STEP = 1e-6
"""Step of central differences of a node's used strength, of the largest stress."""


def least_safety(design: Scene, judged: JudgedSurface) -> SmoothValue:
    """Return the least safety by local stress analysis, of the strength that a design has.

    The smooth one is 1 over the p-norm of 1 / safety.
    """
    masks = judged.on_fillet
    hard = tuple(treated(judged.scene, name, layer, masks[name]) for name, layer in layers(design).items())
    here, judge = judged.at(judged.nodes), _judge(design, judged, hard, judged.nodes)
    ranges = [signed_von_mises_range(here, loads) for loads in judged.states]
    used = np.stack([1 / judge(found.local) for found in ranges])
    largest, norm, slopes, counted = power_norm(used)
    adjoint = np.zeros((2, *judged.stress.stress_MPa.shape))
    for loads, found, slope, many in zip(judged.states, ranges, slopes, counted, strict=True):
        if not many.any():  # one of several webs that are to be equal, loaded far less than another
            continue
        heavy = judged.nodes[many]
        decides = np.union1d(found.highest[many], found.lowest[many])  # few of the states of a cycle
        there = partial(_used, loads=loads[decides], judge=_judge(design, judged, hard, heavy))
        adjoint[:, :, heavy] -= _gradients_by_stress(there, judged.at(heavy)) * slope[many, None] / norm**2
    return SmoothValue(1 / largest, 1 / norm, (adjoint[0], adjoint[1]))


def _judge(design: Scene, judged: JudgedSurface, hard: tuple[TreatedFillet, ...], nodes: Index) -> Judge:
    """Return what tells the safety of nodes; on hardened fillets over all their depths."""
    here, core = of_nodes(hard, nodes), lsa_strength(design)
    strength = _strength(design, (judged.on_fillet["journal"] | judged.on_fillet["pin"])[nodes])

    def safety(local: LocalStress) -> Array:
        found = lsa(local, strength).safety
        return harden(found, lambda below: lsa(below, core).safety, here, local) if here else found

    return safety


def _strength(design: Scene, on_fillet: NDArray[np.bool_]) -> LsaStrength:
    """Return the strength at nodes; a treatment of the fillets raises it nowhere else."""
    strength = lsa_strength(design)
    factors = strength.treatment_factor, design.fatigue.factor_off_fillets
    return replace(strength, treatment_factor=np.where(on_fillet, *factors))


def _used(stress: SurfaceStress, loads: Array, judge: Judge) -> Array:
    return 1 / judge(signed_von_mises_range(stress, loads).local)


def _gradients_by_stress(used: Callable[[SurfaceStress], Array], stress: SurfaceStress) -> Array:
    """Return derivatives of each node's used strength by its own stresses and slopes, (2, fields, n, 6)."""
    both = np.stack([stress.stress_MPa, stress.depth_MPa_per_mm])
    result = np.zeros_like(both)
    for place in np.ndindex(2, both.shape[1]):

        def shifted(component: Array, place: tuple[int, ...] = place) -> Array:
            moved = both.copy()
            moved[place] += component
            return used(SurfaceStress(moved[0], moved[1], stress.jump_MPa))

        result[place] = central_difference(shifted, np.zeros(6), _STEP * np.abs(both[place]).max())
    return result
