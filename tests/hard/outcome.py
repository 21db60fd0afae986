"""What the solver makes of a hard case, beside the direct solve."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import jax.numpy as jnp
import numpy as np

from cranktopo.base.errors import CranktopoError
from cranktopo.numerics.grid.equilibrium import Solution
from cranktopo.tasks.density.response import solve
from tests.hard.cases import cases
from tests.hard.oracle import Direct


@dataclass(frozen=True)
class Comparison:
    """A solution against the direct one, the worst of all load cases.

    Attributes:
        residual: relative residual by the assembled matrix.
        energy_error: relative.
        compliance_error: relative.
        inadmissible: displacement that the supports forbid, relative.
        rounding: what rounding alone may change of the compliance, relative.
        direct_residual: of the direct solve.
    """

    residual: float
    energy_error: float
    compliance_error: float
    inadmissible: float
    rounding: float
    direct_residual: float


def attempt(name: str, tolerance: float) -> Solution | CranktopoError:
    """The solver's answer to a case, or its complaint; call inside `double_precision()`."""
    case = cases()[name]
    try:
        return solve(case.model(), jnp.asarray(case.moduli), tolerance=tolerance)
    except CranktopoError as error:
        return error


@cache
def direct(name: str) -> list[Direct]:
    """Direct solutions of a case."""
    return cases()[name].direct()


def compare(name: str, solution: Solution) -> Comparison:
    """A solution against the direct one."""
    rows = [_compare(d, np.asarray(u)) for d, u in zip(direct(name), solution.displacements, strict=True)]
    return Comparison(*(max(values) for values in zip(*rows, strict=True)))


def _compare(direct: Direct, u: np.ndarray) -> tuple[float, ...]:
    work = direct.work(u)
    return (
        direct.relative_residual(u),
        direct.energy_error(u),
        abs(work / direct.compliance - 1),
        direct.inadmissible(u),
        direct.rounding,
        direct.residual,
    )
