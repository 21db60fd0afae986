"""Largest stress of a throw as a smooth quantity: the surface that is judged, its nodes and load states.

The largest of many jumps from node to node, so it is summed up by a p-norm.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cranktopo.base.arrays import Array, Index
from cranktopo.design.schema import Scene
from cranktopo.numerics.tetrahedra.sharp_edges import near_sharp_edges
from cranktopo.numerics.tetrahedra.stress import DEVIATOR, Surface, SurfaceStress, von_mises
from cranktopo.tasks.fatigue.criterion import larger_end_MPa
from cranktopo.tasks.fatigue.fillets import cut_outlet_nodes, fillet_nodes
from cranktopo.tasks.fatigue.superposition import signed_von_mises_ranges

_POWER = 40.0
_NEGLIGIBLE = 1e-8
"""Weight of a value in the p-norm below which its derivative is left out."""


@dataclass(frozen=True)
class JudgedSurface:
    """Surface nodes of a mesh whose stress is no matter of the mesh: none at sharp edges or cut outlets.

    Attributes:
        stress: of each unit field at all nodes of the surface.
        states: factor of each field in each load state, (states, fields), for every image of the throw.
        nodes: those that are judged.
        on_fillet: masks of all nodes, by fillet.
    """

    scene: Scene
    stress: SurfaceStress
    states: tuple[Array, ...]
    nodes: Index
    on_fillet: dict[str, NDArray[np.bool_]]

    def at(self, nodes: Index) -> SurfaceStress:
        """Return the stress at some nodes of the surface."""
        found = self.stress
        return SurfaceStress(
            found.stress_MPa[:, nodes], found.depth_MPa_per_mm[:, nodes], found.jump_MPa[:, nodes]
        )


@dataclass(frozen=True)
class SmoothValue:
    """A quantity of a judged surface.

    Attributes:
        extreme: its true value, of one node in one state.
        value: a smooth one beside it.
        adjoint: derivatives of the smooth one by the stresses and by their derivatives into the depth, each
            (fields, surface nodes, 6).
    """

    extreme: float
    value: float
    adjoint: tuple[Array, Array]


def judged_surface(
    scene: Scene, surface: Surface, stress: SurfaceStress, states: list[Array]
) -> JudgedSurface:
    """Return what is judged of the surface of a half throw."""
    on = {name: fillet_nodes(scene, name, surface.points_mm) for name in ("journal", "pin")}
    mesh_decides = near_sharp_edges(surface) | cut_outlet_nodes(scene, surface.points_mm)
    nodes = np.flatnonzero(on["journal"] | on["pin"] | ~mesh_decides)
    return JudgedSurface(scene, stress, tuple(states), nodes, on)


def power_norm(values: Array) -> tuple[float, float, Array, NDArray[np.bool_]]:
    """Return the largest of positive values, their p-norm, its derivatives, and which values count in it."""
    largest = values.max()
    powers = (values / largest) ** _POWER
    norm = largest * powers.sum() ** (1 / _POWER)
    slopes = powers / powers.sum() * norm / np.maximum(values, np.finfo(float).tiny)
    return float(largest), float(norm), slopes, powers > _NEGLIGIBLE


def largest_stress(_: Scene, judged: JudgedSurface) -> SmoothValue:
    """Return the largest von Mises stress over all nodes, states and images, MPa."""
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
    return SmoothValue(largest, norm, (adjoint[0], adjoint[1]))


def _near_largest(judged: JudgedSurface) -> NDArray[np.bool_]:
    """Return which judged nodes count in the norm: all nodes in all states of a cycle would fill memory."""
    ranges = signed_von_mises_ranges(judged.at(judged.nodes), judged.states)
    top = np.max([larger_end_MPa(one.local.amplitude_MPa, one.local.mean_MPa) for one in ranges], axis=0)
    return np.asarray(top > top.max() * _NEGLIGIBLE ** (1 / _POWER))
