"""Equilibrium to a checked residual: fast multigrid first, then announced fallbacks, else an error.

Nothing leaves this module whose true float64 residual misses its tolerance.
"""

from __future__ import annotations

import ctypes
import sys
from collections.abc import Hashable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, replace
from functools import lru_cache
from math import isfinite
from typing import NamedTuple

import jax
import jax.numpy as jnp
import numpy as np

from cranktopo.base.errors import CranktopoError, solver_error
from cranktopo.numerics.device_arrays import zeros_like
from cranktopo.numerics.grid.conjugate_gradients import (
    CgResult,
    SharedSolve,
    System,
    devices_for,
    jacobi_cg,
    multigrid_cg,
)
from cranktopo.numerics.grid.diagnosis import (
    VOID_STIFFNESS_RATIO,
    unsupported_load,
    void_energy_and_work,
    void_energy_share,
)
from cranktopo.numerics.grid.multigrid import GridTables, build_hierarchy
from cranktopo.numerics.grid.true_residual import measured_again, rounding
from cranktopo.numerics.precision import Precision

# An answer of which void decides more than this share is refused.
_VOID_SHARE = 0.5
# A failure is explained by rounding where it leaves more than this share of the tolerance.
_ROUNDED = 0.5
# Only cells stiffer than this share of the stiffest count as joined when a failure is explained.
_JOINED_STIFFNESS_RATIO = 1e-3


class Solution(NamedTuple):
    """Displacements, true residuals over the loads (cases,), iterations of all methods, the one that did it.

    The notice is one sentence where the first method was not enough, else empty.
    """

    displacements: jax.Array
    relative_residual: jax.Array
    iterations: int
    method: str = ""
    notice: str = ""


@dataclass(frozen=True)
class Method:
    """A way to solve; `degree` 0 is Jacobi without a hierarchy."""

    name: str
    precision: Precision
    degree: int
    cap: int


# A field that defeats two smoothing steps in float32 is either ill-conditioned or an island in void:
# float64 helps with the second, deeper smoothing with the first.
METHODS = (
    Method("multigrid CG", "float32", 2, 200),
    Method("multigrid CG in float64 with deeper smoothing", "float64", 6, 600),
    Method("Jacobi CG", "float64", 0, 5000),
)


@dataclass(frozen=True)
class Advice:
    """Hints for a user whose system no method solves; a caller who knows the part says it in its words."""

    rounded: str = "Stiff parts move far on soft ones: take stiffer supports or stiffer parts between them."
    unsolved: str = "Check that a load path joins loads and supports, or use a smaller stiffness contrast."


ADVICE = Advice()


def solve_system(
    tables: GridTables,
    system: System,
    guess: jax.Array,
    tolerance: float,
    names: tuple[str, ...],
    precision: Precision = "float32",
    advice: Advice = ADVICE,
) -> Solution:
    """Return the displacements of every case, their true residual at most the tolerance.

    The guess (cases, 3, nodes...) is admissible, e.g. the last solution or zeros, and gone afterwards. Raises
    CranktopoError where field or load make no sense, or no method reaches the tolerance (exit code 4).
    """
    _check_numbers(system, names)
    iterations, tried, aim = 0, "", tolerance
    for method in (replace(METHODS[0], precision=precision), *METHODS[1:]):
        found = run_method(method, tables, system, guess, aim)
        result = measured_again(system, found)
        used, residual = int(result.iterations), float(np.asarray(result.relative_residual).max())
        iterations += used
        _check_meaning(system, result, residual <= tolerance, names)
        if residual <= tolerance:
            notice = f"{tried}: {method.name} took over and reached {tolerance:.0e}" if tried else ""
            return Solution(result.displacements, result.relative_residual, iterations, method.name, notice)
        if not tried:
            _check_load_path(system, names)
        tried = f"{method.name} stopped at relative residual {residual:.1e} after {used} iterations"
        if np.asarray(found.relative_residual).max() <= aim:  # it stopped too early, deceived by rounding
            aim /= 2
        guess = result.displacements if isfinite(residual) else zeros_like(guess)
    raise _failure(system, result, tolerance, iterations, names, advice)


def run_method(
    method: Method, tables: GridTables, system: System, guess: jax.Array, tolerance: float
) -> CgResult:
    """Return what one method arrives at; the others have not been tried."""
    limits = tolerance, method.cap
    if method.degree == 0:
        return jacobi_cg(system, guess, *limits)
    parts = devices_for(system.moduli.shape)
    if parts > 1:
        of_all = jnp.asarray(tolerance), jnp.asarray(method.cap)
        return SharedSolve(tables, system, method.degree, guess, of_all, method.precision, parts).result()
    compile_multigrid(tables, system, method.precision)
    hierarchy = build_hierarchy(tables, system.supports, system.moduli, precision=method.precision)
    return multigrid_cg(system, hierarchy, method.degree, guess, *limits)


def _check_numbers(system: System, names: tuple[str, ...]) -> None:
    smallest, most, numbers, finite = map(np.asarray, _extreme_values(system.moduli, system.forces))
    least, largest = float(smallest), float(most)
    if not (numbers and least >= 0 and largest > 0):
        raise solver_error(
            f"solver: relative moduli from {least:.3g} to {largest:.3g}{'' if numbers else ' or no number'}; "
            "all must be finite, none negative and one positive.",
            "Check the densities and the material.",
        )
    if not finite.all():
        raise solver_error(
            f"solver: load case {names[int(finite.argmin())]} has forces that are not finite numbers.",
            "Check the loads.",
        )


@jax.jit
def _extreme_values(moduli: jax.Array, forces: jax.Array) -> tuple[jax.Array, ...]:
    """Return moduli and what is finite: a compiled minimum may pass over NaN, a sum does not."""
    finite = jnp.isfinite(jnp.sum(moduli)), jnp.isfinite(jnp.sum(forces, axis=(1, 2, 3, 4)))
    return jnp.min(moduli), jnp.max(moduli), *finite


def _check_meaning(system: System, result: CgResult, solved: bool, names: tuple[str, ...]) -> None:
    """Refuse an answer that void decides; while it is not reached, only where material has a gap."""
    shares = void_energy_share(system, result.displacements)
    if not shares.max() > _VOID_SHARE:
        return
    found = unsupported_load(system, VOID_STIFFNESS_RATIO)
    if found is None and not solved:
        return
    case, reason = (
        found
        or _hinge(system, VOID_STIFFNESS_RATIO)
        or (int(shares.argmax()), "a part of the structure is loose")
    )
    raise solver_error(
        f"solver: load case {names[case]} has no answer that means anything: {reason}; {shares.max():.0%} of "
        f"its work is done on void, cells softer than {VOID_STIFFNESS_RATIO:.0e} of the stiffest.",
        "Join the load to the supports with material: move the load or raise the volume fraction.",
    )


def _hinge(system: System, threshold: float) -> tuple[int, str] | None:
    found = unsupported_load(system, threshold, "faces")
    return found and (
        found[0],
        "its load reaches a support only across edges or corners of cells, which are hinges",
    )


def _check_load_path(system: System, names: tuple[str, ...]) -> None:
    """Refuse a singular system before slower methods are tried."""
    found = unsupported_load(system, 0.0)
    if found is not None:
        case, reason = found
        raise solver_error(
            f"solver: load case {names[case]} has no answer: {reason}.",
            "Join the load to the supports with material, or give void cells a small modulus.",
        )


def _failure(
    system: System,
    result: CgResult,
    tolerance: float,
    iterations: int,
    names: tuple[str, ...],
    advice: Advice,
) -> CranktopoError:
    residual = np.asarray(result.relative_residual).tolist()
    worst = residual.index(max(residual))
    reason, hint = _reason(system, result, worst, tolerance, names, advice)
    return solver_error(
        f"solver: load case {names[worst]} stopped at relative residual {residual[worst]:.1e} after "
        f"{iterations} iterations of {len(METHODS)} methods; {tolerance:.0e} is required.{reason}",
        hint,
    )


def _reason(
    system: System, result: CgResult, worst: int, tolerance: float, names: tuple[str, ...], advice: Advice
) -> tuple[str, str]:
    """Return why the worst case has no solution, empty where nobody knows, and what to do."""
    found = unsupported_load(system, _JOINED_STIFFNESS_RATIO) or _hinge(system, _JOINED_STIFFNESS_RATIO)
    limit = float(np.asarray(rounding(system, result.displacements))[worst])
    if limit > _ROUNDED * tolerance and (found is None or found[0] != worst):
        return (
            f" Float64 ends there: rounding of displacements alone may leave {limit:.0e}.",
            advice.rounded,
        )
    return (
        f" In load case {names[found[0]]} {found[1]}." if found else "",
        advice.unsolved,
    )


def compile_multigrid(tables: GridTables, system: System, precision: Precision) -> None:
    """Compile the programs of a solve at once; calls on arrays of these shapes find them.

    Half of a compilation is serial: one after the other they take a third longer on two cores.
    """
    leaves, structure = jax.tree.flatten((tables, system))
    _compile(structure, tuple(jax.ShapeDtypeStruct(leaf.shape, leaf.dtype) for leaf in leaves), precision)


@lru_cache(maxsize=64)
def _compile(structure: Hashable, shapes: tuple[jax.ShapeDtypeStruct, ...], precision: Precision) -> None:
    tables, system = jax.tree.unflatten(structure, shapes)
    limits = 2, system.forces, 1e-2, 1
    with ThreadPoolExecutor(2) as pool:
        building = build_hierarchy.begin(tables, system.supports, system.moduli, precision=precision)
        jobs = [pool.submit(building.compile)]
        iterating = multigrid_cg.begin(system, building.out_info, *limits)
        jobs.append(pool.submit(iterating.compile))
        jobs += [
            pool.submit(program.begin(system, system.forces).compile)
            for program in (void_energy_and_work, rounding)
        ]
        for job in jobs:
            job.result()
    _give_back_memory()


def _give_back_memory() -> None:
    """Hand what compilers freed to the system: the allocator would keep some 300 MiB (glibc)."""
    if sys.platform == "linux":
        trim = getattr(ctypes.CDLL(None), "malloc_trim", None)
        if trim is not None:
            trim(0)
