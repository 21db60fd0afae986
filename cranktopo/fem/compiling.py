"""Compiling the programs of a solve side by side, before the first one runs."""

from __future__ import annotations

from collections.abc import Hashable
from concurrent.futures import ThreadPoolExecutor
from functools import lru_cache

import jax
import jax.numpy as jnp

from cranktopo.fem.conjugate_gradients import System, multigrid_cg
from cranktopo.fem.multigrid import GridTables, build_hierarchy
from cranktopo.fem.precision import Precision


def compile_multigrid(tables: GridTables, system: System, precision: Precision) -> None:
    """Compile hierarchy and iteration at once; calls on arrays of these shapes find the programs.

    Half of a compilation is serial: one after the other they take a third longer on two cores.
    """
    leaves, structure = jax.tree.flatten((tables, system))
    _compile(structure, tuple(jax.ShapeDtypeStruct(leaf.shape, leaf.dtype) for leaf in leaves), precision)


@lru_cache(maxsize=64)
def _compile(structure: Hashable, shapes: tuple[jax.ShapeDtypeStruct, ...], precision: Precision) -> None:
    tables, system = jax.tree.unflatten(structure, shapes)
    building = build_hierarchy.lower(tables, system.supports, system.moduli, precision)
    limits = jnp.asarray(2), system.forces, jnp.asarray(1e-2), jnp.asarray(1)
    iterating = multigrid_cg.lower(system, building.out_info, *limits)
    with ThreadPoolExecutor(2) as pool:
        for job in [pool.submit(program.compile) for program in (iterating, building)]:
            job.result()
