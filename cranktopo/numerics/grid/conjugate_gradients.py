"""Conjugate gradients in float64, all cases at once, preconditioned by the multigrid cycle or by Jacobi.

Fields have shape (cases, 3, nodes...). The relative residual that all cases must reach is `tolerance`. Only
the preconditioner may be in float32: directions that are rounded find the same few soft motions of a body
again and again, which takes many more cycles on fine grids.

On several devices each has the cells of one part of the grid and its nodes. Fields travel to and from the
devices with every interface twice, once per neighbour, so that all parts are equal. Between solves they are
whole, on the first device.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache, partial
from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from jax.sharding import Mesh, NamedSharding
from jax.sharding import PartitionSpec as Spec

from cranktopo.numerics.grid.boundary_conditions import (
    BoundaryConditions,
    add_section,
    coordinates_of_ends,
    interior_factors,
    section_coordinates,
)
from cranktopo.numerics.grid.galerkin import CoarseMap
from cranktopo.numerics.grid.multigrid import GridTables, Hierarchy, apply_cycle, build_hierarchy, project
from cranktopo.numerics.grid.operator import apply_stiffness, stiffness_diagonal
from cranktopo.numerics.grid.partition import AXIS, Partition
from cranktopo.numerics.kept_programs import kept_program
from cranktopo.numerics.kernels.registry import apply_operator, kernel_or_jax
from cranktopo.numerics.precision import Precision

_Preconditioner = Callable[[jax.Array, jax.Array], tuple[jax.Array, jax.Array]]
"""From a residual and its norms to a field and scales per case: the correction is their projected product."""

# Aim a little lower: the recursive residual that is watched drifts from the true one by rounding.
_AIM = 0.9
# No regular system lets the residual grow so far on its way down: this one is singular.
_DIVERGED = 1e10


class System(NamedTuple):
    """Equilibrium K(moduli) u = f of every case: blocks (8, 3, 3, nz), forces (cases, 3, nodes...)."""

    blocks: jax.Array
    supports: BoundaryConditions
    moduli: jax.Array
    forces: jax.Array


class CgResult(NamedTuple):
    """Displacements (cases, 3, nodes...), true residuals over the loads (cases,), common iterations."""

    displacements: jax.Array
    relative_residual: jax.Array
    iterations: jax.Array


class _CgState(NamedTuple):
    u: jax.Array
    r: jax.Array
    p: jax.Array
    rz: jax.Array
    error: jax.Array
    true_error: jax.Array
    done: jax.Array
    measure: jax.Array
    stop: jax.Array


def stiffness_product(system: System, u: jax.Array) -> jax.Array:
    """Return K u with the springs of the rigid sections, as far as admissible displacements feel it.

    The reactions are projected out: far larger than a residual, they would drown it in float32.
    """
    supports = system.supports
    springs = jnp.einsum("bmn,bn->bm", supports.springs, section_coordinates(supports, u))
    forces = supports.partition.add_interfaces(apply_stiffness(system.blocks, system.moduli, u))
    return project(supports, add_section(supports, forces, springs))


def product_and_work(system: System, u: jax.Array) -> tuple[jax.Array, jax.Array]:
    """Return the product with the stiffness, and its work (cases,) on its admissible displacements."""
    if system.supports.partition.parts > 1:
        return _by_product(system, u)
    return kernel_or_jax(_by_kernel, _by_product, system, u)


def _by_product(system: System, u: jax.Array) -> tuple[jax.Array, jax.Array]:
    image = stiffness_product(system, u)
    return image, system.supports.partition.dot(u, image)


def _by_kernel(system: System, u: jax.Array) -> tuple[jax.Array, jax.Array]:
    supports, nodes = system.supports, (u.shape[2], u.shape[3], u.shape[4])
    factors = interior_factors(supports, nodes)
    free, ends, works = apply_operator(
        "stiffness", "free_forces", [system.blocks, system.moduli, u, *factors]
    )
    moved = section_coordinates(supports, u)
    pushed = coordinates_of_ends(supports, ends) + jnp.einsum("bmn,bn->bm", supports.springs, moved)
    return add_section(supports, free, pushed), jnp.sum(works, axis=1) + jnp.sum(moved * pushed, axis=1)


@kept_program(donated=("guess",))
def multigrid_cg(
    system: System,
    hierarchy: Hierarchy,
    degree: jax.Array,
    guess: jax.Array,
    tolerance: jax.Array,
    max_iterations: jax.Array,
) -> CgResult:
    """Solve by conjugate gradients with the multigrid cycle; the memory of the guess is taken for the result.

    The tolerance is missed where the cap is reached, where the preconditioner or the matrix is not positive
    definite in floating point, and where rounding stops all progress. `degree` is that of `apply_cycle`.
    """
    precondition = partial(apply_cycle, hierarchy, system.supports, degree)
    return _iterate(system, precondition, guess, tolerance, max_iterations)


@jax.jit
def jacobi_cg(system: System, guess: jax.Array, tolerance: jax.Array, max_iterations: jax.Array) -> CgResult:
    """Solve by conjugate gradients with the inverse diagonal; result as of `multigrid_cg`."""
    diagonal = stiffness_diagonal(system.blocks, system.moduli)
    inverse = jnp.where(diagonal > 0, 1 / jnp.where(diagonal > 0, diagonal, 1.0), 0.0)

    def precondition(residual: jax.Array, norm: jax.Array) -> tuple[jax.Array, jax.Array]:
        return inverse * residual, jnp.ones_like(norm)

    return _iterate(system, precondition, guess, tolerance, max_iterations)


@dataclass(frozen=True)
class _Iteration:
    """One loop of two kinds of steps, so that the product is compiled only once."""

    system: System
    precondition: _Preconditioner
    load: jax.Array
    tolerance: jax.Array
    max_iterations: jax.Array

    def step(self, s: _CgState) -> _CgState:
        """Move along the next direction, as far as the energy falls."""
        direction, r, slope = jax.lax.cond(s.measure, self._measured, self._conjugate, s)
        # Not a result of the branches: it would be copied.
        u = jnp.where(s.measure, 0.0, s.u)
        image, curvature = product_and_work(self.system, direction)
        alpha = _ratio(slope, curvature)
        u, r = u + _wide(alpha) * direction, r - _wide(alpha) * image
        error = jnp.sqrt(self._dot(r, r)) / self.load
        sound = jnp.all((slope > 0) & (curvature > 0) & (error < _DIVERGED) | (error == 0))
        done = s.done + jnp.where(s.measure, 0, 1)
        spent = done >= self.max_iterations
        checked = s.measure & (s.done > 0)
        stuck = checked & ~(jnp.max(error) <= 0.5 * jnp.max(s.true_error))  # also when not a number
        return _CgState(
            u=u,
            r=r,
            p=direction,
            rz=jnp.where(s.measure, 0.0, slope),
            error=error,
            true_error=jnp.where(s.measure, error, s.true_error),
            done=done,
            measure=~s.measure & (jnp.all(error <= _AIM * self.tolerance) | ~sound | spent),
            stop=s.measure & (jnp.all(error <= self.tolerance) | stuck | spent),
        )

    def _measured(self, s: _CgState) -> tuple[jax.Array, jax.Array, jax.Array]:
        """Measure the true residual, and scale u per case to the minimum energy of its error.

        It makes the most of the guess at the start and checks the result at the end. Where the recursive
        residual has drifted from the true one, the iteration goes on from there, as long as that still helps.
        """
        # Projected here, not kept: the forces would be one more field.
        forces = project(self.system.supports, self.system.forces)
        return s.u, forces, self._dot(forces, s.u)

    def _conjugate(self, s: _CgState) -> tuple[jax.Array, jax.Array, jax.Array]:
        z, scale = self.precondition(s.r, s.error * self.load)
        # What z has outside the space of admissible displacements the residual does not feel.
        rz = scale * self._dot(s.r, z.astype(s.r.dtype))
        kept = _wide(_ratio(rz, s.rz)) * s.p
        return project(self.system.supports, z.astype(s.r.dtype), scale, kept), s.r, rz

    def _dot(self, a: jax.Array, b: jax.Array) -> jax.Array:
        return self.system.supports.partition.dot(a, b)


def _iterate(
    system: System,
    precondition: _Preconditioner,
    guess: jax.Array,
    tolerance: jax.Array,
    max_iterations: jax.Array,
) -> CgResult:
    free = project(system.supports, system.forces)
    load = jnp.sqrt(system.supports.partition.dot(free, free))
    load = jnp.where(load > 0, load, 1.0)
    iteration = _Iteration(system, precondition, load, tolerance, max_iterations)
    u = project(system.supports, guess)
    none, zero = jnp.zeros(u.shape[0], u.dtype), jnp.zeros_like(u)
    counters = jnp.zeros((), jnp.int32), jnp.asarray(True), jnp.asarray(False)
    first = _CgState(u, zero, zero, none, none, none, *counters)
    final = jax.lax.while_loop(lambda s: ~s.stop, iteration.step, first)
    return CgResult(final.u, final.true_error, final.done)


def _wide(scalars: jax.Array) -> jax.Array:
    return scalars[:, None, None, None, None]


def _ratio(a: jax.Array, b: jax.Array) -> jax.Array:
    """Return a / b, and 0 where there is nothing to divide by: a zero guess, a case already solved."""
    return jnp.where(b > 0, a / jnp.where(b > 0, b, 1.0), 0.0)


# With fewer cells the messages between devices take longer than what they save (tests/benchmarks/devices.py).
_LEAST_CELLS = 2_000_000

_SAME: Any = Spec()
_CELLS: Any = Spec(None, None, AXIS)
_LAYERS: Any = Spec(None, None, None, AXIS)
_NODES: Any = Spec(None, None, None, None, AXIS)


def devices_for(cells: tuple[int, ...]) -> int:
    """Return the number of devices that a grid is worth: parts are equal, and none too small."""
    most = min(jax.device_count(), math.prod(cells) // _LEAST_CELLS)
    return max((count for count in range(1, most + 1) if cells[2] % count == 0), default=1)


def partition_of(tables: GridTables, parts: int) -> Partition:
    """Return the partition: levels are cut while the parts have equal layers, the coarsest is whole."""
    levels = 1
    for coarse in tables.coarse[:-1]:
        if coarse.matrices.shape[2] % parts:
            break
        levels += 1
    return Partition(parts, levels)


@dataclass(frozen=True)
class SharedSolve:
    """A solve on the first devices that JAX finds; the number of parts divides that of layers."""

    tables: GridTables
    system: System
    degree: int
    guess: jax.Array
    limits: tuple[jax.Array, jax.Array]
    precision: Precision
    parts: int

    def result(self) -> CgResult:
        """Return what `multigrid_cg` arrives at, on the first device."""
        found: CgResult = jax.device_put(self.program()(*self.arguments()), jax.devices()[0])
        return found._replace(displacements=_joined(found.displacements, self.parts))

    def program(self) -> Any:
        """Return the compiled function of all devices."""
        return _program(self._partition, len(self.tables.coarse), self.precision)

    def arguments(self) -> tuple[object, ...]:
        """Return what the program is called with, each on its device."""
        system, partition = self.system, self._partition
        supports = system.supports._replace(partition=partition)
        there = system._replace(supports=supports, forces=_cut(system.forces, self.parts))
        arrays = self.tables, there, self.degree, _cut(self.guess, self.parts), *self.limits
        specs = _specs(partition, len(self.tables.coarse))
        places = jax.tree.map(partial(NamedSharding, _mesh(self.parts)), specs)
        placed: tuple[object, ...] = jax.device_put(arrays, places)
        return placed

    @property
    def _partition(self) -> Partition:
        return partition_of(self.tables, self.parts)


@lru_cache(maxsize=8)
def _program(partition: Partition, coarse: int, precision: Precision) -> Any:
    def solve(
        tables: GridTables, system: System, degree: jax.Array, guess: jax.Array, *limits: jax.Array
    ) -> CgResult:
        hierarchy = build_hierarchy(tables, system.supports, system.moduli, precision=precision)
        return multigrid_cg(system, hierarchy, degree, guess, *limits)

    specs = _specs(partition, coarse)
    results = CgResult(_NODES, _SAME, _SAME)
    on_parts = jax.shard_map(
        solve, mesh=_mesh(partition.parts), in_specs=specs, out_specs=results, check_vma=False
    )
    return jax.jit(on_parts, donate_argnums=3)


def _specs(partition: Partition, coarse: int) -> tuple[object, ...]:
    maps = tuple(
        CoarseMap(_SAME, _SAME, _CELLS if level < partition.levels else _SAME, _SAME)
        for level in range(1, coarse + 1)
    )
    supports = BoundaryConditions(_SAME, _SAME, _SAME, _SAME, _SAME, partition)
    system = System(_LAYERS, supports, _CELLS, _NODES)
    return GridTables(_LAYERS, _SAME, maps), system, _SAME, _NODES, _SAME, _SAME


@lru_cache(maxsize=8)
def _mesh(parts: int) -> Mesh:
    return Mesh(np.array(jax.devices()[:parts]), (AXIS,))


@partial(jax.jit, static_argnums=1)
def _cut(field: jax.Array, parts: int) -> jax.Array:
    layers = (field.shape[-1] - 1) // parts
    return jnp.concatenate([field[..., k * layers : (k + 1) * layers + 1] for k in range(parts)], axis=-1)


@partial(jax.jit, static_argnums=1)
def _joined(field: jax.Array, parts: int) -> jax.Array:
    planes = field.shape[-1] // parts
    pieces = [field[..., k * planes : (k + 1) * planes - 1] for k in range(parts)]
    return jnp.concatenate([*pieces, field[..., -1:]], axis=-1)
