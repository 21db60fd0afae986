"""The multigrid solve on several devices: each has the cells of one part of the grid and its nodes.

Fields travel to and from the devices with every interface twice, once per neighbour, so that all parts are
equal. Between solves they are whole, on the first device.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache, partial
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
from jax.sharding import Mesh, NamedSharding
from jax.sharding import PartitionSpec as Spec

from cranktopo.numerics.grid.boundary_conditions import BoundaryConditions
from cranktopo.numerics.grid.conjugate_gradients import CgResult, System, multigrid_cg
from cranktopo.numerics.grid.galerkin import CoarseMap
from cranktopo.numerics.grid.lattice import AXIS, Partition
from cranktopo.numerics.grid.multigrid import GridTables, build_hierarchy
from cranktopo.numerics.precision import Precision

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
        given = self.tables, there, self.degree, _cut(self.guess, self.parts), *self.limits
        specs = _specs(partition, len(self.tables.coarse))
        places = jax.tree.map(partial(NamedSharding, _mesh(self.parts)), specs)
        placed: tuple[object, ...] = jax.device_put(given, places)
        return placed

    @property
    def _partition(self) -> Partition:
        return partition_of(self.tables, self.parts)


@lru_cache(maxsize=8)
def _program(partition: Partition, coarse: int, precision: Precision) -> Any:
    def solve(
        tables: GridTables, system: System, degree: jax.Array, guess: jax.Array, *limits: jax.Array
    ) -> CgResult:
        hierarchy = build_hierarchy(tables, system.supports, system.moduli, precision)
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
    return (
        GridTables(_LAYERS, _SAME, maps),
        System(_LAYERS, supports, _CELLS, _NODES),
        _SAME,
        _NODES,
        _SAME,
        _SAME,
    )


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
