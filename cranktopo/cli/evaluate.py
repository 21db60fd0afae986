"""`cranktopo evaluate`: mass, inertia, unbalance and stiffness on a body-fitted tet10 mesh."""

from __future__ import annotations

import json
from dataclasses import dataclass
from typing import TYPE_CHECKING

import click

from cranktopo.cli.completion import designs
from cranktopo.cli.options import DEFAULT_DESIGN, mesh_options
from cranktopo.cli.verbosity import detail, say, verbosity_options
from cranktopo.errors import CranktopoError, ExitCode

if TYPE_CHECKING:
    from cranktopo.evaluate.evaluation import Evaluation
    from cranktopo.evaluate.targets import Target


@click.command()
@click.argument("targets", metavar="TARGET...", nargs=-1, shell_complete=designs)
@mesh_options
@click.option("--json", "as_json", is_flag=True, help="Print one JSON object.")
@verbosity_options
def command(
    targets: tuple[str, ...],
    element_size_mm: float | None,
    accuracy: float | None,
    budget: float | None,
    design: str | None,
    as_json: bool,
) -> None:
    """Judge each TARGET with quadratic finite elements on its exact solid.

    A TARGET is a design, a run directory, or an STL or STEP file of the half throw (with --design). Both
    stiffnesses are those of the full throw; each comes with an error estimate from a second, coarser mesh.

    Example: cranktopo evaluate mikron-iiic --accuracy 1%
    """
    from cranktopo.evaluate.targets import resolve_targets

    wanted = Meshing(element_size_mm, accuracy, budget)
    evaluations, missed = evaluate_targets(resolve_targets(targets or (DEFAULT_DESIGN,), design), wanted)
    if as_json:
        from cranktopo.evaluate.evaluation import SCHEMA_VERSION

        entries = [e.as_json() for e in evaluations]
        click.echo(json.dumps({"schema_version": SCHEMA_VERSION, "evaluations": entries}, indent=2))
    else:
        from cranktopo.report.evaluations import evaluation_table, result_line
        from cranktopo.report.tables import terminal

        click.echo(terminal(evaluation_table(evaluations)) + "\n")
        for evaluation in evaluations:
            click.echo(result_line(evaluation))
    warn_missed(missed, accuracy)


@dataclass(frozen=True)
class Meshing:
    """How exactly targets are to be evaluated: by size, or by accuracy and time.

    Attributes:
        element_size_mm: general element size, or None.
        accuracy: wanted error in percent, or None.
        budget_s: time per target, or None.
    """

    element_size_mm: float | None = None
    accuracy: float | None = None
    budget_s: float | None = None


def evaluate_targets(targets: list[Target], wanted: Meshing) -> tuple[list[Evaluation], list[str]]:
    """Evaluate targets one after the other, progress on stderr.

    Args:
        targets: what to evaluate.
        wanted: how exactly.

    Returns:
        Evaluations in order, and the names of those that miss the accuracy.

    Raises:
        CranktopoError: both size and accuracy or time given, or a failed solve.
    """
    if wanted.element_size_mm and (wanted.accuracy or wanted.budget_s):
        raise CranktopoError(
            "--element-size-mm excludes --accuracy and --budget.",
            hint="Give the size, or what it should do.",
            code=ExitCode.USAGE,
        )
    evaluations, missed = [], []
    for target in targets:
        evaluation, reached = _evaluate(target, wanted)
        evaluations.append(evaluation)
        _detail(evaluation)
        missed += [] if reached else [f"{target.name} ({evaluation.error_percent:.2f} %)"]
    return evaluations, missed


def _evaluate(target: Target, wanted: Meshing) -> tuple[Evaluation, bool]:
    if wanted.accuracy is None and wanted.budget_s is None:
        from cranktopo.evaluate.evaluation import evaluate

        return evaluate(target, wanted.element_size_mm, say), True
    from cranktopo.accuracy.error_target import ErrorTarget, evaluate_to
    from cranktopo.accuracy.level import EVALUATION
    from cranktopo.accuracy.stored_studies import key_of, load_study

    measured = load_study(key_of(target), EVALUATION)
    found, reached = evaluate_to(target, ErrorTarget(wanted.accuracy, wanted.budget_s), measured, say)
    if wanted.budget_s is not None and found.total_seconds > wanted.budget_s:
        say(f"note: {target.name}: took {found.total_seconds:.1f} s, --budget was {wanted.budget_s:g} s.")
    return found, reached


def warn_missed(missed: list[str], accuracy: float | None) -> None:
    """End with exit code 6, after the results, when the wanted accuracy was not reached.

    Args:
        missed: targets that missed it, with the error reached.
        accuracy: the wanted accuracy, %; None only when nothing was missed.

    Raises:
        click.exceptions.Exit: something was missed.
    """
    if missed:
        click.echo(f"error: accuracy {accuracy:g}% not reached by {', '.join(missed)}.", err=True)
        raise click.exceptions.Exit(ExitCode.CRITERION_NOT_MET)


def _detail(evaluation: Evaluation) -> None:
    fine = evaluation.fine
    detail(
        f"{evaluation.target}: {fine.nodes} nodes, {fine.mesh_seconds:.1f} s to mesh, "
        f"{fine.solve_seconds:.1f} s to solve, error estimate {evaluation.error_percent:.2f} %"
    )
