"""Every hard case: a number that agrees with a direct solve, or an error that says what is wrong."""

from __future__ import annotations

import re

import numpy as np
import pytest

from cranktopo.base.errors import CranktopoError, ExitCode
from cranktopo.numerics.grid.equilibrium import METHODS, Solution
from tests.hard.cases import cases
from tests.hard.fields import loose_parts
from tests.hard.outcome import attempt, compare

# Energy error that a residual of 1e-8 allows; loose parts shift in void that hardly resists.
TIGHT, LOOSE = 2e-7, 2e-5
CASES = cases()
VARIANTS = re.compile(
    r"Poisson 0\.[24]$|cells (4|1:4|1:1)|times|blobs 0\.[126]|void 1e-03"
    r"|blobs 0\.4, void 1e-0[69]|density 0\.0?[123]|cells 0\.[57]|sprung bearings|one-cell link"
    r"|cells 0\.3, void 1e-09|Poisson 0$|void 1e-12$|walls, void|hinge of one edge, void 1e-06"
)
"""Names of cases between others, or like them."""
LOOSE_CASES = re.compile(r"blobs 0\.4, void 1e-01|cells 0\.3, void 1e-06|as link, void 1e-09|journals apart")
"""Cases at a loose tolerance, where the same is asked of less: one that is easy and three that are hard."""
NUMBERS = [
    pytest.param(name, marks=pytest.mark.slow) if VARIANTS.search(name) else name
    for name, case in CASES.items()
    if not case.complaint
]
LOOSE_NUMBERS = [
    name if LOOSE_CASES.search(name) else pytest.param(name, marks=pytest.mark.slow)
    for name, case in CASES.items()
    if not case.complaint
]
ERRORS = [name for name, case in CASES.items() if case.complaint]
LEAST = ("void 0", "void 1e-12")
"""Voids with which a case without an answer is as it is with another one."""


@pytest.mark.parametrize("name", NUMBERS)
def test_number(float64: None, name: str) -> None:
    """The error of the work is second order in the residual: what is left is rounding, of both solvers."""
    tolerance = 1e-8
    solution = attempt(name, tolerance)
    assert isinstance(solution, Solution), solution
    assert np.isfinite(solution.displacements).all()
    assert np.max(solution.relative_residual) <= tolerance
    found = compare(name, solution)
    assert found.direct_residual < 1e-7, "the oracle itself is off"
    assert found.residual < 1.01 * tolerance + 10 * found.direct_residual
    assert found.compliance_error < 1e-10 + found.rounding < 1e-6
    assert found.energy_error < (LOOSE if loose_parts(CASES[name].moduli) else TIGHT)
    assert found.inadmissible < 1e-14
    assert bool(solution.notice) == (solution.method != METHODS[0].name)


@pytest.mark.parametrize("name", LOOSE_NUMBERS)
def test_number_at_a_loose_tolerance(float64: None, name: str) -> None:
    solution = attempt(name, 1e-5)
    assert isinstance(solution, Solution), solution
    assert np.max(solution.relative_residual) <= 1e-5
    found = compare(name, solution)
    assert found.compliance_error < 1e-6
    assert found.energy_error < 1e-3


@pytest.mark.parametrize(
    ("name", "tolerance"),
    [
        pytest.param(name, tolerance, marks=[pytest.mark.slow] * name.endswith(LEAST))
        for name in ERRORS
        for tolerance in (1e-8, 1e-5)
    ],
)
def test_error(float64: None, name: str, tolerance: float) -> None:
    error = attempt(name, tolerance)
    assert isinstance(error, CranktopoError), "a number that means nothing"
    assert error.code == ExitCode.SOLVER
    assert CASES[name].complaint in error.message
    assert error.hint
    assert "load case tip" in error.message


def test_fallbacks_are_used_and_announced(float64: None) -> None:
    name = "random 0/1 cells 0.3, void 1e-06"
    solution = attempt(name, 1e-8)
    assert isinstance(solution, Solution)
    assert solution.method == METHODS[1].name
    assert METHODS[0].name in solution.notice
    assert solution.iterations > METHODS[0].cap


@pytest.mark.parametrize(
    ("name", "cycles"),
    [("uniform density 1", 16), ("checkerboard, void 1e-09", 26), ("one-cell walls, void 1e-09", 35)],
)
def test_cycles(float64: None, name: str, cycles: int) -> None:
    """A wrong coarse operator or transfer would still converge, later."""
    solution = attempt(name, 1e-8)
    assert isinstance(solution, Solution)
    assert solution.iterations <= cycles


def test_contrast_hardly_matters(float64: None) -> None:
    solutions = [attempt(f"blobs 0.4, void {void}", 1e-8) for void in ("1e-03", "1e-12")]
    few, more = (s.iterations for s in solutions if isinstance(s, Solution))
    assert more <= 1.2 * few
