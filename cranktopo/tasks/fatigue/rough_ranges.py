"""Cyclic stress of many nodes in single precision: enough to tell which of them cannot be the worst.

The gradient, too, is a form of the loads' products here, so that a node in a cycle costs no tensor.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from cranktopo.base.arrays import Array, Index, Single
from cranktopo.numerics.tetrahedra.stress import SurfaceStress
from cranktopo.tasks.fatigue.criterion import LocalStress
from cranktopo.tasks.fatigue.superposition import load_products, product_form, trace_form, von_mises_form

_VALUES = 2**16
"""Values of nodes in states at a time: two arrays of them stay in the cache of a core."""
_NODES = 2**12
"""Nodes whose forms are made at a time."""
_TINY = 1e-30


@dataclass(frozen=True)
class RoughStress:
    """Forms of the loads, or of their products, at the nodes of a surface.

    Attributes:
        squared: of the squared von Mises stress, (n, pairs).
        fall: of half its fall into the depth, (n, pairs).
        trace: of the first invariant, (n, fields).
    """

    squared: Single
    fall: Single
    trace: Single

    def at(self, nodes: Index) -> RoughStress:
        """Return that of some nodes."""
        return RoughStress(self.squared[nodes], self.fall[nodes], self.trace[nodes])

    def mirrored(self, signs: Array) -> RoughStress:
        """Return that of mirrored nodes, by the signs of the fields there, (n, fields)."""
        pairs = load_products(signs).T
        return RoughStress(*map(_single, (self.squared * pairs, self.fall * pairs, self.trace * signs)))

    def extremes(self, cycles: Sequence[Array]) -> Single:
        """Return the ends of the signed von Mises stress over some states, (3, cycles, n).

        They are the highest and the lowest one, squared with its sign, and the form `fall` at the larger one.

        Args:
            cycles: factor of each field in each state, (states, fields) each, as many states in all.
        """
        count = len(self.trace)
        factors = [(_single(load_products(loads).T), _single(loads)) for loads in cycles]
        found = np.empty((3, len(cycles), count), dtype=np.float32)
        step = max(_VALUES // len(cycles[0]), 1)
        for start in range(0, count, step):
            some = slice(start, start + step)
            own = self.squared[some], self.fall[some], self.trace[some]
            for cycle, (products, loads) in enumerate(factors):
                found[:, cycle, some] = _extremes(*own, products, loads)
        return found


def wider(one: Single, other: Single) -> Single:
    """Return the extremes (3, ...) over the states of both."""
    larger = np.abs(one[:2]).max(axis=0) >= np.abs(other[:2]).max(axis=0)
    fall = np.where(larger, one[2], other[2])
    return np.stack([np.maximum(one[0], other[0]), np.minimum(one[1], other[1]), fall])


def rough_local(extremes: Single) -> LocalStress:
    """Return the local stresses between extremes (3, n), in double precision as methods take them."""
    top, bottom, fall = extremes.astype(float)
    high, low = (np.copysign(np.sqrt(np.abs(end)), end) for end in (top, bottom))
    gradient = fall / np.maximum(np.maximum(np.abs(top), np.abs(bottom)), _TINY)
    return LocalStress((high - low) / 2, (high + low) / 2, np.maximum(gradient, 0.0))


def rough_stress(surface_stress: SurfaceStress) -> RoughStress:
    """Return the forms of a surface."""
    parts = []
    for start in range(0, surface_stress.stress_MPa.shape[1], _NODES):
        some = slice(start, start + _NODES)
        stress, depth = surface_stress.stress_MPa[:, some], surface_stress.depth_MPa_per_mm[:, some]
        forms = von_mises_form(stress), -product_form(stress, depth), trace_form(stress)
        parts.append([_single(form) for form in forms])
    return RoughStress(*map(np.concatenate, zip(*parts, strict=True)))


def _single(values: Array) -> Single:
    return np.ascontiguousarray(values, dtype=np.float32)


def _extremes(squared: Single, fall: Single, trace: Single, products: Single, loads: Single) -> Single:
    """Return the extremes of nodes in one cycle, (3, n).

    Args:
        products, loads: (states, pairs) and (states, fields).
    """
    signed = squared @ products.T
    np.copysign(signed, trace @ loads.T, out=signed)
    nodes = np.arange(len(signed))
    high, low = signed.argmax(axis=1), signed.argmin(axis=1)
    top, bottom = signed[nodes, high], signed[nodes, low]
    worst = np.where(np.abs(top) >= np.abs(bottom), high, low)
    return np.stack([top, bottom, np.einsum("np,np->n", fall, products[worst])])
