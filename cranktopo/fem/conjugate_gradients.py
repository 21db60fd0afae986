"""Conjugate gradients, all cases at once, preconditioned by the multigrid cycle or by Jacobi.

Fields have shape (cases, 3, nodes...). The relative residual that all cases must reach is `tolerance`, in
float64; the iteration itself runs in the precision of its preconditioner on corrections that are added up
in float64, where the residual is computed afresh each time it has fallen by `_FALL` (reliable updates).

Source: M. A. Clark et al., Solving lattice QCD systems of equations using mixed precision solvers on GPUs,
Comput. Phys. Commun. 181, 2010, section 3.3.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Any, NamedTuple

import jax
import jax.numpy as jnp

from cranktopo.fem.boundary_conditions import BoundaryConditions, add_section, section_coordinates
from cranktopo.fem.multigrid import Hierarchy, apply_cycle, project
from cranktopo.fem.operator import apply_stiffness, apply_stiffness_in_slabs, stiffness_diagonal

_Product = Callable[[jax.Array, jax.Array, jax.Array], jax.Array]

# Aim a little lower: the recursive residual that is watched drifts from the true one by rounding.
_AIM = 0.9
# No regular system lets the residual grow so far on its way down: this one is singular.
_DIVERGED = 1e10
# What float32 adds drifts from its residual: at a contrast of 1e12, 1e-2 takes a third more cycles.
_FALL = 1e-1


class System(NamedTuple):
    """Equilibrium K(moduli) u = f of every case.

    Attributes:
        blocks: reflection blocks (8, 3, 3, nz) of the layers.
        moduli: modulus per cell, float64.
        forces: (cases, 3, nodes...), float64.
    """

    blocks: jax.Array
    supports: BoundaryConditions
    moduli: jax.Array
    forces: jax.Array


class CgResult(NamedTuple):
    """What an iteration arrived at.

    Attributes:
        displacements: (cases, 3, nodes...).
        relative_residual: (cases,) norm of the true residual, computed afresh, over that of the load.
        iterations: number of iterations, shared by all cases.
    """

    displacements: jax.Array
    relative_residual: jax.Array
    iterations: jax.Array


class _CgState(NamedTuple):
    """Between two steps; `x`, `r` and `p` in the precision of the iteration, in units of the load.

    Attributes:
        u: displacements at the last measurement, float64.
        x: what the iteration has added since.
        true_error: relative residual at the last measurement; `error` is that of `r`.
        worse: whether that measurement was no better than the one before.
    """

    u: jax.Array
    x: jax.Array
    r: jax.Array
    p: jax.Array
    rz: jax.Array
    error: jax.Array
    true_error: jax.Array
    done: jax.Array
    measure: jax.Array
    worse: jax.Array
    stop: jax.Array


def stiffness_product(system: System, u: jax.Array, product: _Product = apply_stiffness) -> jax.Array:
    """K u with the springs of the rigid sections, as far as admissible displacements feel it.

    The reactions are projected out: far larger than a residual, they would drown it in float32.
    """
    supports = system.supports
    springs = jnp.einsum("bmn,bn->bm", supports.springs, section_coordinates(supports, u))
    forces = product(system.blocks, system.moduli, u)
    return project(supports, add_section(supports, forces, springs.astype(u.dtype)))


@jax.jit
def multigrid_cg(
    system: System,
    hierarchy: Hierarchy,
    degree: jax.Array,
    guess: jax.Array,
    tolerance: jax.Array,
    max_iterations: jax.Array,
) -> CgResult:
    """Conjugate gradients with the multigrid cycle.

    Args:
        hierarchy: built from the system's moduli or from similar ones.
        degree: smoothing steps before and after each coarse correction.

    Returns:
        CgResult; the tolerance is missed where the cap is reached, where the preconditioner or the matrix is
        not positive definite in floating point, and where rounding stops all progress.
    """
    precondition = partial(apply_cycle, hierarchy, system.supports, degree)
    return _iterate(system, precondition, guess, tolerance, max_iterations, hierarchy.moduli.dtype)


@jax.jit
def jacobi_cg(system: System, guess: jax.Array, tolerance: jax.Array, max_iterations: jax.Array) -> CgResult:
    """Conjugate gradients with the inverse diagonal; result as of `multigrid_cg`."""
    diagonal = stiffness_diagonal(system.blocks, system.moduli)
    inverse = jnp.where(diagonal > 0, 1 / jnp.where(diagonal > 0, diagonal, 1.0), 0.0)

    def precondition(residual: jax.Array) -> jax.Array:
        return project(system.supports, inverse * residual)

    return _iterate(system, precondition, guess, tolerance, max_iterations, guess.dtype)


@dataclass(frozen=True)
class _Iteration:
    """What all steps of an iteration share.

    Attributes:
        load: (cases,) norms of the projected forces, the unit of the corrections, 1 where 0.
        narrow: the system in the precision of the iteration.
    """

    system: System
    narrow: System
    precondition: Callable[[jax.Array], jax.Array]
    load: jax.Array
    tolerance: jax.Array
    max_iterations: jax.Array

    def step(self, s: _CgState) -> _CgState:
        """One loop has both kinds of steps."""
        return jax.lax.cond(s.measure, self._measured, self._conjugate, s)

    def _measured(self, s: _CgState) -> _CgState:
        """The true residual, in float64.

        At the start and at the end u is scaled per case to the least energy of its error: that makes the most
        of the guess, and gives the work of the loads an error of second order. Where the recursive residual
        has drifted from the true one, the iteration goes on from there, as long as that still helps; its
        direction is kept. On slender or fine grids float32 rounds smooth displacements by more than the load:
        the first true residual is then larger than before, but rough, so that little displacement takes it
        away. Worse twice in a row, it is stuck.
        """
        u = s.u + _wide(self.load) * project(self.system.supports, s.x.astype(s.u.dtype))
        image = stiffness_product(self.system, u, apply_stiffness_in_slabs)
        supports, forces = self.system.supports, self.system.forces
        near = _norm(project(supports, forces - image)) <= self.tolerance * self.load
        least_energy = _ratio(dot(forces, u), dot(u, image))
        scale = _wide(jnp.where((s.done == 0) | near, least_energy, 1.0))
        # Projected here, not kept: the forces would be one more field in float64.
        r = project(supports, forces - scale * image) / _wide(self.load)
        error = _norm(r)
        worse = (s.done > 0) & ~(jnp.max(error) <= 0.5 * jnp.max(s.true_error))  # also when not a number
        stuck = worse & (s.worse | ~jnp.all(jnp.isfinite(error)))
        return s._replace(
            u=scale * u,
            x=jnp.zeros_like(s.x),
            r=r.astype(s.r.dtype),
            error=error,
            true_error=error,
            rz=jnp.where(worse, 0.0, s.rz),
            worse=worse,
            measure=jnp.asarray(False),
            stop=jnp.all(error <= self.tolerance) | stuck | (s.done >= self.max_iterations),
        )

    def _conjugate(self, s: _CgState) -> _CgState:
        """One step along the next conjugate direction."""
        inner = s.r.dtype
        z = self.precondition(s.r)
        rz = dot(s.r, z)
        p = z + _wide(_ratio(rz, s.rz)).astype(inner) * s.p
        image = stiffness_product(self.narrow, p)
        curvature = dot(p, image)
        alpha = _wide(_ratio(rz, curvature)).astype(inner)
        r = s.r - alpha * image
        error = _norm(r)
        sound = jnp.all((rz > 0) & (curvature > 0) & (error < _DIVERGED) | (error == 0))
        near = jnp.all((error <= _AIM * self.tolerance) | (error <= _FALL * s.true_error))
        done = s.done + 1
        return s._replace(
            x=s.x + alpha * p,
            r=r,
            p=p,
            rz=rz,
            error=error,
            done=done,
            measure=near | ~sound | (done >= self.max_iterations),
        )


def _iterate(
    system: System,
    precondition: Callable[[jax.Array], jax.Array],
    guess: jax.Array,
    tolerance: jax.Array,
    max_iterations: jax.Array,
    inner: jnp.dtype[Any],
) -> CgResult:
    """From the guess until a measurement tells to stop, in the precision `inner` between measurements."""
    load = _norm(project(system.supports, system.forces))
    load = jnp.where(load > 0, load, 1.0)
    narrow = system._replace(moduli=system.moduli.astype(inner))
    iteration = _Iteration(system, narrow, precondition, load, tolerance, max_iterations)
    first = _before_measuring(project(system.supports, guess), inner)
    final = jax.lax.while_loop(lambda s: ~s.stop, iteration.step, first)
    return CgResult(final.u, final.true_error, final.done)


def _before_measuring(u: jax.Array, inner: jnp.dtype[Any]) -> _CgState:
    none, zero = jnp.zeros(u.shape[0], u.dtype), jnp.zeros(u.shape, inner)
    return _CgState(
        u=u,
        x=zero,
        r=zero,
        p=zero,
        rz=none,
        error=none,
        true_error=none,
        done=jnp.zeros((), jnp.int32),
        measure=jnp.asarray(True),
        worse=jnp.asarray(False),
        stop=jnp.asarray(False),
    )


def dot(a: jax.Array, b: jax.Array) -> jax.Array:
    """Scalar product of two fields, per case, summed in float64."""
    return jnp.sum(a.astype(jnp.float64) * b.astype(jnp.float64), axis=(1, 2, 3, 4))


def _norm(a: jax.Array) -> jax.Array:
    return jnp.sqrt(dot(a, a))


def _wide(scalars: jax.Array) -> jax.Array:
    return scalars[:, None, None, None, None]


def _ratio(a: jax.Array, b: jax.Array) -> jax.Array:
    """a / b, and 0 where there is nothing to divide by: a zero guess, a case that is already solved."""
    return jnp.where(b > 0, a / jnp.where(b > 0, b, 1.0), 0.0)
