"""The inequality that every web of an envelope obeys, and the weights that make it say most.

For a web with the stiffness K the compliance is the largest value of 2 l(v) - v' K v over all admissible
displacements v, so any v gives a lower bound, whether it solves anything or not. K is linear in the
densities.

For any displacements the quantities of a web are not below q(rho) = base + rows . rho, and equal to it for
sums over cells. With a weight y >= 0 for each constraint s (q - limit) <= 0, the goal of every web that keeps
them is not below

    D(y) = least over rho of  n . q(rho) - y . (s limit),      n = goal + sum of y s,

whatever y is. D is concave in y, its gradient s (q - limit) at the best densities. All quantities are over
those of the original web.

Stiffness per mass: with displacements v and a slope t, every web obeys compliance + t * mass >= D(t). Some
such lines enclose all pairs of mass and compliance in a convex polygon. The product is concave along each
line, so that its least value in the polygon is at a corner.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import jax
import jax.numpy as jnp
import numpy as np

from cranktopo.base.arrays import Array
from cranktopo.design.goal.constraint import Constraint
from cranktopo.numerics.grid.boundary_conditions import section_coordinates
from cranktopo.numerics.grid.lattice import layer_blocks
from cranktopo.numerics.grid.operator import strain_energy_densities
from cranktopo.tasks.bound.webs import AdmissibleDensities
from cranktopo.tasks.density.material import CONTRAST
from cranktopo.tasks.density.model import ThrowModel

_at_sections = jax.jit(section_coordinates)
_ROUND_OFF = 128 * float(np.finfo(np.float64).eps)
"""Above the rounding, over the sum of the terms' sizes, of an energy from the displacements of eight corners,
of a pairwise sum of up to 1e9 terms, and of displacements on a rigid section."""


def energies(model: ThrowModel, webs: AdmissibleDensities, u: jax.Array) -> tuple[Array, Array]:
    """Return what displacements (cases, 3, nodes...), mm, within the supports prove; rounded to be safe.

    Of every web with densities rho: compliances >= constant - sum of gains * rho.

    Returns:
        Constant (cases,) and gains, the energies of full cells (cases, nx, ny, nw), not negative; N mm.
    """
    blocks = layer_blocks(model.lattice)
    factor = model.modulus_MPa / model.share
    cells = factor * (
        np.asarray(strain_energy_densities(blocks, u))
        + _ROUND_OFF * np.asarray(_sizes(np.abs(blocks).sum(axis=0), u))
    )
    web = cells[..., webs.layers] * webs.design
    soft = webs.fixed * cells
    works = factor * np.asarray(model.forces) * np.asarray(u)
    at = np.asarray(_at_sections(model.supports, u))
    springs = factor * np.asarray(np.einsum("bm,bmn,bn->b", at, np.asarray(model.supports.springs), at))
    sides = (1, 2, 3)
    parts = np.stack([soft.sum(axis=sides), CONTRAST * web.sum(axis=sides), springs])
    sizes = 2 * np.abs(works).sum(axis=(1, 2, 3, 4)) + np.abs(parts).sum(axis=0)
    constant = 2 * works.sum(axis=(1, 2, 3, 4)) - parts.sum(axis=0) - _ROUND_OFF * sizes
    return constant, (1 - CONTRAST) * web


@jax.jit
def _sizes(blocks: jax.Array, u: jax.Array) -> jax.Array:
    """Return the sum of the sizes of all terms in the energy of each cell (cases, nx, ny, nz)."""

    def of_case(v: jax.Array) -> jax.Array:
        corners = jnp.abs(v)
        for axis in range(1, 4):
            size = corners.shape[axis]
            near = jax.lax.slice_in_dim(corners, 0, size - 1, axis=axis)
            corners = near + jax.lax.slice_in_dim(corners, 1, size, axis=axis)
        return jnp.einsum("cxyz,cdz,dxyz->xyz", corners, blocks, corners)

    sizes: jax.Array = jax.lax.map(of_case, u)
    return sizes


_CUTS = 60
_ENOUGH = 1e-4
"""Share of the bound by which better weights could still raise it when their search ends."""
_LARGEST_WEIGHT = 1e4


@dataclass(frozen=True)
class LinearUnderestimator:
    """Lower bounds of the quantities, linear in the densities.

    Attributes:
        names: load cases, then sums over cells.
        base: (quantities,).
        rows: (quantities, nx, ny, nw).
        sizes: (quantities,) largest sizes of the terms, for the rounding.
    """

    names: tuple[str, ...]
    base: Array
    rows: Array
    sizes: Array
    webs: AdmissibleDensities

    def weights_of(self, quantity: str) -> Array:
        """Return the weights that pick one of the quantities."""
        return np.array([float(name == quantity) for name in self.names])

    def minimum(self, weights: Array) -> tuple[float, Array]:
        """Return a lower bound of a weighted sum of the quantities over all webs, and these there."""
        gains = -np.tensordot(weights, self.rows, 1)
        most, density = self.webs.best(gains)
        value = float(weights @ self.base) - most - _ROUND_OFF * float(np.abs(weights) @ self.sizes)
        return value, self.base + np.tensordot(self.rows, density, 3)


def underestimator_of(
    webs: AdmissibleDensities,
    cases: Sequence[str],
    proven: tuple[Array, Array],
    original: Mapping[str, float],
    reference_compliances: Mapping[str, float],
) -> LinearUnderestimator:
    """Return what displacements prove, every quantity over that of the original web; compliances in N mm."""
    cells = np.array([reference_compliances[case] for case in cases])
    sums = tuple(webs.amounts)
    scale = np.concatenate([cells, [original[name] or 1.0 for name in sums]])
    constant, gains = proven
    base = np.concatenate([constant, [webs.fixed_amounts[name] for name in sums]])
    rows = np.concatenate([-gains, np.stack([webs.amounts[name] for name in sums])])
    rows = rows / scale[:, None, None, None]
    sizes = np.abs(base / scale) + np.abs(rows).sum(axis=(1, 2, 3))
    return LinearUnderestimator((*cases, *sums), base / scale, rows, sizes, webs)


@dataclass(frozen=True)
class Certificate:
    """A value that no web with these constraints can go below.

    Attributes:
        value: of the goal, over the original's; infinite where no web keeps all constraints.
        weights: of the constraints, (constraints,): by how much the goal's bound falls with each.
    """

    value: float
    weights: Array


def _certificate_at(
    underestimator: LinearUnderestimator, goal: Array, constraints: Sequence[Constraint], weights: Array
) -> tuple[Certificate, Array]:
    """Return what the inequality says with given weights, and its slope by them."""
    signs = np.array([c.sign for c in constraints])
    limits = np.array([c.bound for c in constraints])
    at = np.array([underestimator.names.index(c.quantity) for c in constraints], int)
    normal = goal.copy()
    np.add.at(normal, at, weights * signs)
    value, quantities = underestimator.minimum(normal)
    price = weights * signs * limits
    found = value - float(price.sum()) - _ROUND_OFF * float(np.abs(price).sum())
    return Certificate(found, weights), signs * (quantities[at] - limits)


def best_certificate(
    underestimator: LinearUnderestimator, goal: Array, constraints: Sequence[Constraint], first: Array
) -> Certificate:
    """Return the largest lower bound of the goal over the weights, by cutting planes (Kelley, 1960)."""
    from scipy.optimize import linprog

    certificate, slope = _certificate_at(underestimator, goal, constraints, first)
    if not constraints:
        return certificate
    count, values, slopes, points = len(constraints), [certificate.value], [slope], [first]
    box = np.maximum(10 * first, 10.0)
    for _ in range(_CUTS):
        cuts = np.array(slopes)
        offsets = np.array(values) - np.einsum("kc,kc->k", cuts, np.array(points))
        found = linprog(
            np.append(np.zeros(count), -1.0),
            A_ub=np.hstack([-cuts, np.ones((len(cuts), 1))]),
            b_ub=offsets,
            bounds=[*((0.0, high) for high in box), (None, None)],
        )
        if not found.success or -found.fun - certificate.value <= _ENOUGH * max(1.0, abs(certificate.value)):
            if not found.success or not _widened(box, found.x[:-1], certificate.weights):
                return certificate
            continue
        weights = np.maximum(found.x[:-1], 0.0)
        tried, slope = _certificate_at(underestimator, goal, constraints, weights)
        values, slopes, points = [*values, tried.value], [*slopes, slope], [*points, weights]
        if tried.value > certificate.value:
            certificate = tried
            if excluded(underestimator, constraints, weights):
                return Certificate(np.inf, weights)
        _widened(box, weights, certificate.weights)
    return certificate


def excluded(underestimator: LinearUnderestimator, constraints: Sequence[Constraint], weights: Array) -> bool:
    """Tell whether the constraints alone, with these weights, exclude every web."""
    total, nothing = weights.sum(), np.zeros(len(underestimator.names))
    if total <= 0:
        return False
    return _certificate_at(underestimator, nothing, constraints, weights / total)[0].value > 0


def _widened(box: Array, *points: Array) -> bool:
    """Tell whether the box of weights was too narrow for the best ones and has been widened."""
    hit = (np.max(points, axis=0) >= 0.999 * box) & (box < _LARGEST_WEIGHT)
    box[hit] *= 10
    return bool(hit.any())


_LINES = 13
_SPAN = 3.0
_PRODUCT_ROUND_OFF = 1e-12


@dataclass(frozen=True)
class _SupportingLine:
    """Every web has compliance + slope * mass >= offset, proven by the weights of the constraints."""

    slope: float
    offset: float
    weights: Array


def supporting_lines(
    underestimator: LinearUnderestimator,
    goal: Array,
    mass: Array,
    constraints: Sequence[Constraint],
    first: Array,
    slope: float,
) -> list[_SupportingLine]:
    """Return lines below the pairs of mass and compliance of every web that keeps the constraints.

    Args:
        goal, mass: weights of the quantities that make the compliance and the mass.
        constraints: without those of the mass, which `minimum_product` takes.
        slope: of the compliance over the mass where the least product is expected, made positive.
    """
    lines, weights = [], first
    for t in (0.0, *(slope * np.geomspace(1 / _SPAN, _SPAN, _LINES))):
        certificate = best_certificate(underestimator, goal + t * mass, constraints, weights)
        weights = weights if np.isinf(certificate.value) else certificate.weights
        lines.append(_SupportingLine(float(t), certificate.value, weights))
    return lines


def minimum_product(lines: Sequence[_SupportingLine], low: float, high: float) -> tuple[Certificate, float]:
    """Return a lower bound of compliance times mass between two masses, and the slope that suits its corner.

    A convex curve through the corner on which no other product is smaller has that slope.
    """
    slopes, offsets = np.array([line.slope for line in lines]), np.array([line.offset for line in lines])
    if low > high or np.isinf(offsets).any():
        return Certificate(np.inf, lines[0].weights), 0.0
    first, second = np.triu_indices(len(slopes), 1)
    apart = slopes[first] != slopes[second]
    first, second = first[apart], second[apart]
    corners = (offsets[first] - offsets[second]) / (slopes[first] - slopes[second])
    masses = np.array([low, high, *corners[(corners > low) & (corners < high)]])
    above = offsets[:, None] - slopes[:, None] * masses
    products = masses * np.max(above, axis=0)
    worst = int(np.argmin(products))
    slope = float(above[:, worst].max() / masses[worst])
    line = lines[int(np.argmax(above[:, worst]))]
    return Certificate(float(products[worst]) * (1 - _PRODUCT_ROUND_OFF), line.weights), slope


def mass_range(
    underestimator: LinearUnderestimator, mass: Array, constraints: Sequence[Constraint]
) -> tuple[float, float]:
    """Return the least and greatest mass of the webs, within the constraints of the mass."""
    low, high = underestimator.minimum(mass)[0], -underestimator.minimum(-mass)[0]
    limits = [c for c in constraints if c.quantity == "mass"]
    return (
        max([low, *(c.bound for c in limits if c.sign < 0)]),
        min([high, *(c.bound for c in limits if c.sign > 0)]),
    )
