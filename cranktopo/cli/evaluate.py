"""`cranktopo evaluate`: mass, inertia, unbalance and stiffness on a body-fitted tet10 mesh."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING

import click

from cranktopo.cli.completion import designs
from cranktopo.cli.options import mesh_options
from cranktopo.cli.talk import detail, say, talkative
from cranktopo.errors import CranktopoError, ExitCode

if TYPE_CHECKING:
    from cranktopo.evaluate.evaluation import Evaluation


@click.command()
@click.argument("targets", metavar="TARGET...", nargs=-1, shell_complete=designs)
@mesh_options
@click.option("--json", "as_json", is_flag=True, help="Print one JSON object.")
@talkative
def command(
    targets: tuple[str, ...],
    element_size_mm: float | None,
    accuracy: float | None,
    design: str | None,
    as_json: bool,
) -> None:
    """Judge each TARGET with quadratic finite elements on its exact solid.

    A TARGET is a design, a run directory, or an STL or STEP file of the half throw (with --design). Both
    stiffnesses are those of the full throw; each comes with an error estimate from a second, coarser mesh.

    Example: cranktopo evaluate mikron-iiic --accuracy 1%
    """
    evaluations, missed = evaluate_targets(targets or ("mikron-iiic",), element_size_mm, accuracy, design)
    if as_json:
        from cranktopo.evaluate.evaluation import SCHEMA_VERSION

        entries = [e.as_json() for e in evaluations]
        click.echo(json.dumps({"schema_version": SCHEMA_VERSION, "evaluations": entries}, indent=2))
    else:
        from cranktopo.report.evaluations import evaluation_table
        from cranktopo.report.tables import terminal

        click.echo(terminal(evaluation_table(evaluations)))
    warn_missed(missed, accuracy)


def evaluate_targets(
    targets: tuple[str, ...], element_size_mm: float | None, accuracy: float | None, design: str | None
) -> tuple[list[Evaluation], list[str]]:
    """Evaluate targets one after the other, progress on stderr.

    Args:
        targets: as typed.
        element_size_mm: general element size, or None.
        accuracy: wanted error in percent, or None.
        design: design for geometry files.

    Returns:
        Evaluations in order, and the names of those that miss the accuracy.

    Raises:
        CranktopoError: a bad target, both size and accuracy given, or a failed solve.
    """
    from cranktopo.evaluate.evaluation import evaluate, evaluate_to_accuracy
    from cranktopo.evaluate.targets import resolve_target

    if element_size_mm and accuracy:
        raise CranktopoError(
            "--element-size-mm and --accuracy exclude each other.", hint="Give one.", code=ExitCode.USAGE
        )
    resolved = [resolve_target(text, design) for text in targets]
    evaluations, missed = [], []
    for target in resolved:
        if accuracy is None:
            evaluations.append(evaluate(target, element_size_mm, say))
            _detail(evaluations[-1])
            continue
        evaluation, reached = evaluate_to_accuracy(target, accuracy, say)
        evaluations.append(evaluation)
        _detail(evaluation)
        missed += [] if reached else [f"{target.name} ({evaluation.error_percent:.2f} %)"]
    return evaluations, missed


def warn_missed(missed: list[str], accuracy: float | None) -> None:
    """End with exit code 6, after the results, when the wanted accuracy was not reached."""
    if missed:
        click.echo(f"error: accuracy {accuracy:g}% not reached by {', '.join(missed)}.", err=True)
        raise click.exceptions.Exit(ExitCode.CRITERION_NOT_MET)


def _detail(evaluation: Evaluation) -> None:
    fine = evaluation.fine
    detail(
        f"{evaluation.target}: {fine.nodes} nodes, {fine.mesh_seconds:.1f} s to mesh, "
        f"{fine.solve_seconds:.1f} s to solve, error estimate {evaluation.error_percent:.2f} %"
    )
