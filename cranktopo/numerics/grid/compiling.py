"""Compiling the programs of a solve side by side, before the first one runs."""

from __future__ import annotations

import ctypes
import sys
from collections.abc import Hashable
from concurrent.futures import ThreadPoolExecutor
from functools import lru_cache

import jax
import jax.numpy as jnp

from cranktopo.numerics.grid.conjugate_gradients import System, multigrid_cg
from cranktopo.numerics.grid.diagnosis import void_energy_and_work
from cranktopo.numerics.grid.multigrid import GridTables, build_hierarchy
from cranktopo.numerics.precision import Precision


def compile_multigrid(tables: GridTables, system: System, precision: Precision) -> None:
    """Compile the programs of a solve at once; calls on arrays of these shapes find them.

    Half of a compilation is serial: one after the other they take a third longer on two cores.
    """
    leaves, structure = jax.tree.flatten((tables, system))
    _compile(structure, tuple(jax.ShapeDtypeStruct(leaf.shape, leaf.dtype) for leaf in leaves), precision)


@lru_cache(maxsize=64)
def _compile(structure: Hashable, shapes: tuple[jax.ShapeDtypeStruct, ...], precision: Precision) -> None:
    tables, system = jax.tree.unflatten(structure, shapes)
    limits = jnp.asarray(2), system.forces, jnp.asarray(1e-2), jnp.asarray(1)
    with ThreadPoolExecutor(2) as pool:
        building = build_hierarchy.lower(tables, system.supports, system.moduli, precision)
        jobs = [pool.submit(building.compile)]
        iterating = multigrid_cg.lower(system, building.out_info, *limits)
        jobs.append(pool.submit(iterating.compile))
        jobs.append(pool.submit(void_energy_and_work.lower(system, system.forces).compile))
        for job in jobs:
            job.result()
    _give_back_memory()


def _give_back_memory() -> None:
    """Hand what compilers freed to the system: the allocator would keep some 300 MiB (glibc)."""
    if sys.platform == "linux":
        trim = getattr(ctypes.CDLL(None), "malloc_trim", None)
        if trim is not None:
            trim(0)
