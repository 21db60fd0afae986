"""`cranktopo fatigue`

Fatigue safety of designs with true fillets: local stress analysis, FKM, IACS UR M53, critical planes.
"""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING

import click

from cranktopo.base.errors import ExitCode
from cranktopo.base.notes import note
from cranktopo.cli.options import (
    DEFAULT_DESIGN,
    Choice,
    Number,
    body_options,
    designs,
    loads_option,
    throw_option,
)
from cranktopo.cli.output import tell
from cranktopo.cli.verbosity import verbosity_options
from cranktopo.tasks.fatigue.criteria import METHODS

if TYPE_CHECKING:
    from cranktopo.engine.histories import HistoryKind
    from cranktopo.tasks.throw_fatigue.assessment import FatigueAssessment, FatigueMethod


def _one_method(_context: click.Context, _option: click.Parameter, given: tuple[str, ...]) -> str:
    """Return the method; of several the last would be taken without a word."""
    if len(set(given)) > 1:
        raise click.UsageError("--method: takes one method; `cranktopo compare` takes several")
    return given[0]


@click.command()
@click.argument("targets", metavar="TARGET...", nargs=-1, shell_complete=designs)
@click.option(
    "--method",
    type=Choice(tuple(METHODS)),
    multiple=True,
    default=("lsa",),
    show_default=True,
    callback=_one_method,
    help="Local stress analysis, FKM guideline, the rule IACS UR M53, or the critical planes of Findley or "
    "Dang Van.",
)
@loads_option
@click.option("--baseline", metavar="TARGET", help="The target that the others are compared with.")
@click.option(
    "--fillet-fraction",
    type=Number(0.01, 0.5),
    help="Element size in a fillet over its radius; by default 0.17, by m53 less where an edge is above a "
    "quarter or a check of the mesh leaves a place open.",
)
@body_options
@throw_option
@click.option(
    "--out",
    type=click.Path(path_type=Path),
    help="Folder for fatigue.json, and VTU and picture of each target; a run shows it.",
)
@click.option(
    "--report",
    type=click.Path(dir_okay=False, path_type=Path),
    help="With --method m53 and one TARGET: the dossier for a classification society (.html, .md, .pdf).",
)
@click.option("--json", "as_json", is_flag=True, help="Print one JSON object.")
@verbosity_options
def command(
    targets: tuple[str, ...],
    method: FatigueMethod,
    loads: HistoryKind,
    baseline: str | None,
    fillet_fraction: float | None,
    design: str | None,
    align: bool,
    throw: int | None,
    out: Path | None,
    report: Path | None,
    as_json: bool,
) -> ExitCode:
    """Fatigue safety of each TARGET on curved tet10 elements.

    A TARGET is a design whose fillets have a radius, or a STEP file of the half throw (with --design), whose
    fillets are found on the body.

    The unit loads are solved once; every load state is a sum of them. The safety is that of the worst point
    of fillets, oil outlets, rounded edges and faces; sharp inner edges, where the mesh decides, are named.

    With --method m53 --report FILE the check is written as a dossier for a classification society (.html,
    .md or .pdf), with its assumptions to be signed. Exit code 6: the rule does not accept every TARGET
    (not accepted, not judged, or its material not covered).

    Example: cranktopo fatigue mikron-iiic-hollow --baseline mikron-iiic --out fatigue
    """
    from cranktopo.tasks.throw_fatigue.stage import assess_fatigue
    from cranktopo.tasks.throw_fatigue.stress_mesh import RULE_FRACTION

    names = targets or (baseline or DEFAULT_DESIGN,)
    if baseline is not None and baseline not in names:
        names = (baseline, *names)
    index = None if baseline is None else names.index(baseline)
    if report is not None:
        from cranktopo.tasks.throw_fatigue.dossier import (  # loads pages and drawings
            check_dossier,
            write_dossier,
        )

        check_dossier(method, len(names), report)
    fraction = RULE_FRACTION if fillet_fraction is None else fillet_fraction
    found = assess_fatigue(names, method, loads, index, fraction, out, design, align, throw)
    if report is not None:
        write_dossier(found, report, ["cranktopo", *sys.argv[1:]])
        note(str(report))
    tell(found.as_json() if as_json else _text(found))
    accepted = all(check.verdict == "accepted" for check in found.checks)
    return ExitCode.DONE if accepted else ExitCode.CRITERION_NOT_MET


def _text(assessment: FatigueAssessment) -> str:
    from cranktopo.report.result_table import terminal
    from cranktopo.tasks.throw_fatigue import rule_text
    from cranktopo.tasks.throw_fatigue import text as tables
    from cranktopo.tasks.throw_fatigue.verdicts import verdicts

    baseline = assessment.baseline
    if assessment.fields:
        parts = [terminal(tables.field_table(assessment.fields, baseline))]
        fields = assessment.fields
        beside = tables.field_remarks, tables.inclusions, tables.not_judged
        parts += ["\n".join(line for of_kind in beside for line in of_kind(fields))]
    else:
        outside = "".join(
            f"\n{check.name}: outside the rule's polynomials: {'; '.join(check.outside)}."
            for check in assessment.checks
            if check.outside
        )
        remarks = rule_text.rule_remarks(assessment.checks)
        parts = [
            *(["\n".join(remarks)] if remarks else []),
            terminal(rule_text.rule_table(assessment.checks, baseline)),
            terminal(rule_text.factor_table(assessment.checks)) + outside,
        ]
        if any(check.outlets for check in assessment.checks):
            parts.append(terminal(rule_text.outlet_table(assessment.checks)))
    sentences = [] if baseline is None else verdicts(assessment.results, baseline)
    blocks = [assessment.mirrored, *parts, "\n".join(sentences)]
    return "\n\n".join(filter(None, blocks))
