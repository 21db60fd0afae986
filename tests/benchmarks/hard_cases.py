"""What the solver makes of the hard cases, as a table: `python -m tests.benchmarks.hard_cases`."""

from __future__ import annotations

import numpy as np

from cranktopo.base.errors import CranktopoError
from cranktopo.numerics.grid.equilibrium import Solution
from cranktopo.numerics.precision import double_precision
from tests.hard.cases import cases
from tests.hard.outcome import attempt, compare

TOLERANCE = 1e-8


def main() -> None:
    """Print the table as Markdown."""
    print("| case | cells | contrast | CG | method | residual | energy error | compliance error |")
    print("|---|---|---|---|---|---|---|---|")
    with double_precision():
        for name, case in cases().items():
            moduli = np.asarray(case.moduli)
            contrast = f"{moduli.max() / moduli.min():.0e}" if moduli.min() > 0 else "inf"
            cells = " x ".join(str(n) for n in moduli.shape)
            print(f"| {name} | {cells} | {contrast} | {_answer(name)} |", flush=True)


def _answer(name: str) -> str:
    answer = attempt(name, TOLERANCE)
    if isinstance(answer, CranktopoError):
        return f"- | error {int(answer.code)}: {_gist(answer.message, cases()[name].complaint)} | - | - | -"
    return _number(name, answer)


def _gist(message: str, complaint: str) -> str:
    """What an error says about the reason, without the numbers around it."""
    parts = [part for sentence in message.split(". ") for part in sentence.split("; ") if complaint in part]
    return parts[-1].split(": ")[-1].removeprefix("In load case tip ").rstrip(".") if parts else message


def _number(name: str, solution: Solution) -> str:
    found = compare(name, solution)
    residual = float(np.max(np.asarray(solution.relative_residual)))
    errors = f"{found.energy_error:.0e} | {found.compliance_error:.0e}"
    return f"{solution.iterations} | {solution.method} | {residual:.1e} | {errors}"


if __name__ == "__main__":
    main()
