"""`cranktopo evaluate`

Evaluate designs, runs or STL files: mass, torsional and bending stiffness on tet10 solids.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import zip_longest
from typing import TYPE_CHECKING

import click

from cranktopo.base.errors import ExitCode
from cranktopo.base.notes import detail, note
from cranktopo.cli.options import DEFAULT_DESIGN, designs, mesh_options, throw_option, web_option
from cranktopo.cli.output import tell, tell_error
from cranktopo.cli.verbosity import verbosity_options

if TYPE_CHECKING:
    from cranktopo.design.halves import WebName


@click.command()
@click.argument("targets", metavar="TARGET...", nargs=-1, shell_complete=designs)
@mesh_options
@click.option(
    "--sensitivities",
    is_flag=True,
    help="Also print what a millimetre of each dimension of a parametric web is worth, and what holds it.",
)
@web_option
@throw_option
@click.option("--json", "as_json", is_flag=True, help="Print one JSON object.")
@verbosity_options
def command(
    targets: tuple[str, ...],
    element_size_mm: float | None,
    accuracy: float | None,
    budget: float | None,
    design: str | None,
    align: bool,
    sensitivities: bool,
    web: WebName | None,
    throw: int | None,
    as_json: bool,
) -> None:
    """Evaluate each TARGET with quadratic finite elements on its exact solid.

    A TARGET is a design, a run directory, or an STL or STEP file of the half throw (with --design). Both
    stiffnesses are those of the full throw; each comes with a bound of its error.
    With --sensitivities a TARGET is a design with a parametric web, or a run that has one; of a design with
    two different webs --web names the one whose dimensions are meant.

    Example: cranktopo evaluate mikron-iiic --accuracy 1%
    """
    from cranktopo.tasks.throw_fea.stage import MeshRequest, evaluate_targets
    from cranktopo.tasks.throw_fea.targets import resolve_targets, unlike_fillet_line

    request, texts = MeshRequest(element_size_mm, accuracy, budget), targets or (DEFAULT_DESIGN,)
    if web and not sensitivities:
        raise click.UsageError("--web names the web of --sensitivities; both webs are evaluated without it")
    worth = []
    if sensitivities:  # only these need the search of dimensions
        from cranktopo.tasks.evaluate.sensitivities import evaluate_sensitivities

        worth = [evaluate_sensitivities(text, element_size_mm, web, throw) for text in texts]
    resolved = resolve_targets(
        [w.file for w in worth] or texts, design, align=align, whole=True, throw=None if worth else throw
    )
    if line := unlike_fillet_line(resolved):
        note(line)
    found = evaluate_targets(resolved, request)
    for evaluation in found.evaluations:
        fine = evaluation.fine
        detail(
            f"{evaluation.target}: {fine.nodes} nodes, {fine.mesh_seconds:.1f} s to mesh, "
            f"{fine.solve_seconds:.1f} s to solve, error estimate {evaluation.error_percent:.2f} %"
        )
    if as_json:
        from cranktopo.tasks.evaluate.result import EvaluationList, TargetEvaluation

        tables = [one.table for one in worth]
        entries = (
            TargetEvaluation(**dict(one.result), sensitivities=table)
            for one, table in zip_longest(found.evaluations, tables)
        )
        tell(EvaluationList(evaluations=tuple(entries)).as_json())
    else:
        from cranktopo.report.result_table import terminal
        from cranktopo.tasks.throw_fea.flying_web import flying_line
        from cranktopo.tasks.throw_fea.quantities import evaluation_table, result_line

        tell(terminal(evaluation_table(found.evaluations)) + "\n")
        for evaluation in found.evaluations:
            tell(result_line(evaluation))
            for flying in evaluation.flying_webs:
                tell(flying_line(flying))
        for one in worth:
            from cranktopo.tasks.web_shape.text import sensitivity_text

            tell("\n" + "\n".join(sensitivity_text(one.table, one.scene.name)))
    warn_missed(found.missed, accuracy)


def warn_missed(missed: Sequence[str], accuracy: float | None) -> None:
    """End with exit code 6, after the results, when targets missed the accuracy (%) asked for."""
    if missed:
        tell_error(f"accuracy {accuracy:g}% not reached by {', '.join(missed)}.")
        raise click.exceptions.Exit(ExitCode.CRITERION_NOT_MET)
