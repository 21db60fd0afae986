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
_NODES = 2**10
"""Nodes whose forms are made at a time."""
_UNMOVED = 1e-7
"""Share of the largest sum of fields below which a sum is left out."""
_TINY = 1e-30


@dataclass(frozen=True)
class RoughStress:
    """Forms of the factors of fields, or of their products, at the nodes of a surface.

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


def fewer_fields(loads: Array, size: Array) -> tuple[Array, Array]:
    """Return sums of fields of which every state is made, (sums, fields), and their factors, (..., sums).

    A throw takes part in the forces of all cylinders alone, nine or thirteen of a four or a six, so that its
    fields do not move each by itself; products of them are a third or less.

    Args:
        loads: factor of each field in each state, (..., fields).
        size: largest stress of each field, (fields,).
    """
    sized = loads * size
    flat = sized.reshape(-1, len(size))
    squares, axes = np.linalg.eigh(flat.T @ flat)
    axes = axes[:, squares > _UNMOVED**2 * squares[-1]]
    return axes.T / size, sized @ axes


def rough_stress(surface_stress: SurfaceStress, sums: Array) -> RoughStress:
    """Return the forms of a surface in one image after the other, (images nodes, ...).

    Args:
        sums: of the fields of the surface, in each image, (images, sums, fields).
    """
    parts = []
    for start in range(0, surface_stress.stress_MPa.shape[1], _NODES):
        some = slice(start, start + _NODES)
        both = surface_stress.stress_MPa[:, some], surface_stress.depth_MPa_per_mm[:, some]
        parts.append([_forms(*(np.tensordot(image, one, axes=1) for one in both)) for image in sums])
    of_images = [part for image in zip(*parts, strict=True) for part in image]
    return RoughStress(*map(np.concatenate, zip(*of_images, strict=True)))


def _forms(stress: Array, depth: Array) -> tuple[Single, Single, Single]:
    """Return the forms of nodes as of `RoughStress`."""
    fall = -product_form(stress, depth)
    return _single(von_mises_form(stress)), _single(fall), _single(trace_form(stress))


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
