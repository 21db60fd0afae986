"""Conjugate gradients in float64 with the multigrid cycle as preconditioner, all cases at once."""

from __future__ import annotations

from functools import partial
from typing import NamedTuple

import jax
import jax.numpy as jnp

from cranktopo.fem.lattice import Lattice
from cranktopo.fem.multigrid import Hierarchy, apply_cycle, project
from cranktopo.fem.operator import apply_stiffness
from cranktopo.fem.supports import Supports, add_section, section_coordinates


class Solution(NamedTuple):
    """Displacements and how well they satisfy equilibrium.

    Attributes:
        displacements: (cases, 3, nodes...).
        relative_residual: (cases,) norm of the true residual over that of the load.
        iterations: number of iterations, shared by all cases.
    """

    displacements: jax.Array
    relative_residual: jax.Array
    iterations: jax.Array


class _State(NamedTuple):
    u: jax.Array
    r: jax.Array
    p: jax.Array
    rz: jax.Array
    error: jax.Array
    count: jax.Array


def stiffness_product(lattice: Lattice, supports: Supports, moduli: jax.Array, u: jax.Array) -> jax.Array:
    """K u with the springs of the rigid sections."""
    springs = jnp.einsum("bmn,bn->bm", supports.springs, section_coordinates(supports, u))
    return add_section(supports, apply_stiffness(lattice, moduli, u), springs)


@partial(jax.jit, static_argnames=("lattice",))
def conjugate_gradients(
    lattice: Lattice,
    hierarchy: Hierarchy,
    supports: Supports,
    moduli: jax.Array,
    forces: jax.Array,
    guess: jax.Array,
    tolerance: jax.Array,
    max_iterations: jax.Array,
) -> Solution:
    """Solve K(moduli) u = f for every case.

    Args:
        lattice: the grid.
        hierarchy: preconditioner, built from these moduli or from similar ones.
        supports: supports of all cases.
        moduli: modulus per cell, float64.
        forces: (cases, 3, nodes...), float64.
        guess: start values in the admissible space, e.g. the last solution or zeros.
        tolerance: relative residual at which all cases must arrive.
        max_iterations: cap.

    Returns:
        Solution with the true residual, computed afresh at the end.
    """
    precondition = partial(apply_cycle, lattice, hierarchy, supports)
    forces = project(supports, forces)
    load = _norm(forces)
    load = jnp.where(load > 0, load, 1.0)

    # Section reactions are far larger than the residual: taken along, they would drown it in float32.
    def product(u: jax.Array) -> jax.Array:
        return project(supports, stiffness_product(lattice, supports, moduli, u))

    def begin(u: jax.Array) -> _State:
        r = forces - product(u)
        z = precondition(r)
        return _State(u, r, z, _dot(r, z), _norm(r) / load, jnp.zeros((), jnp.int32))

    def step(s: _State) -> _State:
        image = product(s.p)
        alpha = _ratio(s.rz, _dot(s.p, image))
        u, r = s.u + _wide(alpha) * s.p, s.r - _wide(alpha) * image
        z = precondition(r)
        rz = _dot(r, z)
        p = z + _wide(_ratio(rz, s.rz)) * s.p
        return _State(u, r, p, rz, _norm(r) / load, s.count + 1)

    def unfinished(s: _State) -> jax.Array:
        return jnp.any(s.error > tolerance) & (s.count < max_iterations) & jnp.all(jnp.isfinite(s.error))

    final = jax.lax.while_loop(unfinished, step, begin(guess))
    return Solution(final.u, _norm(forces - product(final.u)) / load, final.count)


def _dot(a: jax.Array, b: jax.Array) -> jax.Array:
    return jnp.sum(a * b, axis=(1, 2, 3, 4))


def _norm(a: jax.Array) -> jax.Array:
    return jnp.sqrt(_dot(a, a))


def _wide(scalars: jax.Array) -> jax.Array:
    return scalars[:, None, None, None, None]


def _ratio(a: jax.Array, b: jax.Array) -> jax.Array:
    """a / b, and 0 where a case is already solved exactly."""
    return jnp.where(b != 0, a / jnp.where(b != 0, b, 1.0), 0.0)
