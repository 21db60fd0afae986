"""Largest stress and least safety of a surface as smooth quantities, with their derivatives by the stresses.

The largest of many jumps from node to node, so it is summed up by a p-norm: a safety as 1 over that of the
used strength, 1 / safety. No part is known here: who calls says which nodes count, and what judges them.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from cranktopo.base.arrays import Array, Index
from cranktopo.numerics.optimisers.gradient_search import central_difference
from cranktopo.numerics.tetrahedra.stress import DEVIATOR, SurfaceStress, von_mises
from cranktopo.tasks.fatigue.criterion import Judge, larger_end_MPa
from cranktopo.tasks.fatigue.superposition import SIGNED, Measure, StressRange, extreme_stresses

_POWER = 40.0
_NEGLIGIBLE = 1e-8
"""Weight of a value in the p-norm below which its derivative is left out."""
_STEP = 1e-6
"""Step of central differences of a node's used strength, of the largest stress."""
JudgeOf = Callable[[Index], Judge]
"""The judge of some nodes of a surface."""


@dataclass(frozen=True)
class JudgedSurface:
    """Surface nodes of a mesh whose stress is no matter of the mesh, and the load states that they are under.

    Attributes:
        stress: of each unit field at all nodes of the surface.
        states: factor of each field in each load state, (states, fields), for every image of the body.
        nodes: those that are judged.
        load_slopes: derivatives of the states by parameters, (parameters, states, fields), for every image;
            none where no parameter changes the loads.
        measure: what of a cycle is judged.
    """

    stress: SurfaceStress
    states: tuple[Array, ...]
    nodes: Index
    load_slopes: tuple[Array, ...] = ()
    measure: Measure = SIGNED

    @cached_property
    def ranges(self) -> list[StressRange]:
        """Range of every image over its states at the judged nodes."""
        return self.measure.ranges(self.at(self.nodes), self.states)

    def at(self, nodes: Index) -> SurfaceStress:
        """Return the stress at some nodes of the surface."""
        return self.stress.at(nodes)


@dataclass(frozen=True)
class SmoothValue:
    """A quantity of a judged surface.

    Attributes:
        extreme: its true value, of one node in one state.
        value: a smooth one beside it.
        adjoint: derivatives of the smooth one by the stresses and by their derivatives into the depth, each
            (fields, surface nodes, 6).
        by_loads: its derivatives by the parameters of the loads, (parameters,), the stresses held.
    """

    extreme: float
    value: float
    adjoint: tuple[Array, Array]
    by_loads: Array


def power_norm(values: Array) -> tuple[float, float, Array, NDArray[np.bool_]]:
    """Return the largest of positive values, their p-norm, its derivatives, and which values count in it."""
    largest = values.max()
    powers = (values / largest) ** _POWER
    norm = largest * powers.sum() ** (1 / _POWER)
    slopes = powers / powers.sum() * norm / np.maximum(values, np.finfo(float).tiny)
    return float(largest), float(norm), slopes, powers > _NEGLIGIBLE


def largest_stress(judged: JudgedSurface) -> SmoothValue:
    """Return the largest von Mises stress over all nodes, states and images, MPa, by stresses alone."""
    nodes = judged.nodes[_near_largest(judged)]
    stress = judged.stress.stress_MPa[:, nodes]
    acting = np.stack([np.einsum("fnc,sf->snc", stress, loads) for loads in judged.states])
    size = von_mises(acting)  # (images, states, n)
    largest, norm, slopes, counted = power_norm(size)
    adjoint = np.zeros((2, *judged.stress.stress_MPa.shape))
    for loads, own, by_size, many, here in zip(judged.states, acting, slopes, counted, size, strict=True):
        heavy = np.flatnonzero(many.any(axis=0))
        by_square = by_size / np.maximum(here, np.finfo(float).tiny)  # a state may be without load
        share = by_square[:, heavy, None] * (own[:, heavy] @ DEVIATOR)
        adjoint[0][:, nodes[heavy]] += np.einsum("snc,sf->fnc", share, loads)
    return SmoothValue(largest, norm, (adjoint[0], adjoint[1]), np.zeros(0))


def _near_largest(judged: JudgedSurface) -> NDArray[np.bool_]:
    """Return which judged nodes count in the norm: all nodes in all states of a cycle would fill memory."""
    top = np.max(
        [larger_end_MPa(one.local.amplitude_MPa, one.local.mean_MPa) for one in judged.ranges], axis=0
    )
    return np.asarray(top > top.max() * _NEGLIGIBLE ** (1 / _POWER))


def least_safety(judged: JudgedSurface, judge_of: JudgeOf) -> SmoothValue:
    """Return the least safety over all nodes and images, the smooth one as 1 over the p-norm."""
    judge = judge_of(judged.nodes)
    used = np.stack([1 / judge(found.local) for found in judged.ranges])
    largest, norm, slopes, counted = power_norm(used)
    adjoint = np.zeros((2, *judged.stress.stress_MPa.shape))
    moves = judged.load_slopes or [np.zeros((0, *loads.shape)) for loads in judged.states]
    by_loads = np.zeros(len(moves[0]))
    images = zip(judged.states, judged.ranges, slopes, counted, moves, strict=True)
    for loads, found, slope, many, move in images:
        if not many.any():  # one of several bodies that are to be equal, loaded far less than another
            continue
        heavy, states = judged.nodes[many], np.stack([found.highest[many], found.lowest[many]])
        stress = judged.at(heavy)
        by_extremes = (
            -slope[many, None]
            / norm**2
            * _slopes_of_used(judge_of(heavy), judged.measure, stress, loads[states])
        )
        adjoint[:, :, heavy] += np.einsum("ksnc,snf->kfnc", by_extremes, loads[states])
        fields = np.stack([stress.stress_MPa, stress.depth_MPa_per_mm])
        by_loads += np.einsum("ksnc,psnf,kfnc->p", by_extremes, move[:, states], fields, optimize=True)
    return SmoothValue(1 / largest, 1 / norm, (adjoint[0], adjoint[1]), by_loads)


def _slopes_of_used(judge: Judge, measure: Measure, stress: SurfaceStress, loads: Array) -> Array:
    """Return derivatives of nodes' used strength by stress and depth slope in both states, (2, 2, n, 6).

    The states of a node stay: another one takes over where both are equal.
    """
    both = np.stack(extreme_stresses(stress, *loads))
    result = np.zeros_like(both)
    for place in np.ndindex(2, 2):

        def used(component: Array, place: tuple[int, ...] = place) -> Array:
            moved = both.copy()
            moved[place] += component
            return 1 / judge(measure.local(*moved))

        size = max(np.abs(both[place[0]]).max(), np.finfo(float).tiny)
        result[place] = central_difference(used, np.zeros(6), _STEP * size)
    return result
