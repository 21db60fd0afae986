"""`cranktopo compare`: several targets beside a baseline."""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import TYPE_CHECKING, get_args

import click

from cranktopo.cli.completion import designs
from cranktopo.cli.evaluate import Meshing, evaluate_targets, warn_missed
from cranktopo.cli.options import FATIGUE_METHODS, mesh_options
from cranktopo.cli.parameters import Choice
from cranktopo.cli.verbosity import say, verbosity_options
from cranktopo.formats import PLOTS

if TYPE_CHECKING:
    from cranktopo.evaluate.evaluation import Evaluation
    from cranktopo.evaluate.targets import Target
    from cranktopo.report.comparison import Comparison
    from cranktopo.report.fatigue_tables import FatigueComparison


@click.command()
@click.argument("targets", metavar="TARGET...", nargs=-1, required=True, shell_complete=designs)
@click.option("--baseline", required=True, metavar="TARGET", help="The target that counts as 100 %.")
@click.option(
    "--format",
    "form",
    type=Choice(["table", "markdown", "csv", "json"]),
    default="table",
    show_default=True,
    help="Form of the result on stdout.",
)
@click.option("--json", "as_json", is_flag=True, help="Same as --format json.")
@click.option(
    "--plot", type=click.Path(path_type=Path), help="Also draw stiffness over mass (.png .svg .pdf)."
)
@click.option(
    "--report",
    "page",
    type=click.Path(path_type=Path, dir_okay=False),
    help="Also write a page with 3D view (.html), or Markdown with PNGs (.md).",
)
@click.option("--stress", is_flag=True, help="Also colour the 3D view of --report by stress: one more solve.")
@click.option(
    "--fatigue",
    "method",
    type=Choice(FATIGUE_METHODS),
    help="Also judge the fatigue safety by this method; see 'cranktopo fatigue --help'.",
)
@mesh_options
@verbosity_options
def command(
    targets: tuple[str, ...],
    baseline: str,
    form: str,
    as_json: bool,
    plot: Path | None,
    page: Path | None,
    stress: bool,
    method: str | None,
    element_size_mm: float | None,
    accuracy: float | None,
    budget: float | None,
    design: str | None,
) -> None:
    """Compare TARGETs with a baseline: mass, stiffness, stiffness per mass, inertia, unbalance, safety.

    The stiffnesses are those of the supports in the designs, each with its error estimate. A star marks the
    best of each column, unless another is within the estimate. The baseline is evaluated too when it is not
    among the targets.

    Example: cranktopo compare opposed-piston-variant-2 --baseline opposed-piston --report variants.html
    """
    if stress and page is None:
        raise click.UsageError("--stress colours the 3D view of --report: give --report FILE too")
    if plot is not None:
        from cranktopo.store import check_file

        check_file(plot, "--plot", PLOTS)
    if page is not None:
        from cranktopo.report.writing import check_report_path

        check_report_path(page)
    names = targets if baseline in targets else (baseline, *targets)
    from cranktopo.evaluate.targets import resolve_targets
    from cranktopo.report.comparison import check_supports

    resolved = resolve_targets(names, design)
    check_supports((target.scene.supports.torsion, target.scene.supports.bending) for target in resolved)
    index = names.index(baseline)
    judged = None if method is None else _fatigue(resolve_targets(names, design, fillets=True), method, index)
    evaluations, missed = evaluate_targets(resolved, Meshing(element_size_mm, accuracy, budget))
    comparison = _compared(resolved, evaluations, index, judged)
    click.echo(_text(comparison, "json" if as_json else form))
    if plot is not None:
        from cranktopo.report.scatter import plot_stiffness_over_mass

        plot_stiffness_over_mass(comparison, plot)
        say(f"plot: {plot}")
    if page is not None:
        from cranktopo.report.comparison_page import comparison_page
        from cranktopo.report.writing import write_report

        command_line = ["cranktopo", *sys.argv[1:]]
        write_report(comparison_page(comparison, resolved, command_line, say if stress else None), page)
        say(f"report: {page}")
    warn_missed(missed, accuracy)


def _fatigue(targets: list[Target], method: str, baseline: int) -> FatigueComparison:
    from cranktopo.evaluate.rule_check import check_rule
    from cranktopo.evaluate.safety_field import FieldMethod, assess, check_inputs
    from cranktopo.report.fatigue_tables import compare_fatigue

    for target in targets:
        check_inputs(target, method, "extremes")
    if method == "m53":
        return compare_fatigue([check_rule(target, progress=say) for target in targets], "extremes", baseline)
    chosen: FieldMethod = next(name for name in get_args(FieldMethod) if name == method)
    return compare_fatigue([assess(target, chosen, progress=say) for target in targets], "extremes", baseline)


def _compared(
    targets: list[Target], evaluations: list[Evaluation], baseline: int, judged: FatigueComparison | None
) -> Comparison:
    from cranktopo.report.comparison import Entry, compare

    published = [None if target.file else target.scene.published for target in targets]
    safeties = judged.safeties if judged else [None] * len(targets)
    entries = [Entry(*parts) for parts in zip(evaluations, published, safeties, strict=True)]
    return compare(entries, evaluations[baseline].target, judged)


def _text(comparison: Comparison, form: str) -> str:
    from cranktopo.report import comparison as report
    from cranktopo.report.tables import comma_separated, markdown, terminal

    if form == "json":
        return json.dumps(report.as_json(comparison), indent=2)
    if form == "csv":
        return comma_separated(report.flat_table(comparison))
    draw = markdown if form == "markdown" else terminal
    tables = [report.value_table(comparison), report.percent_table(comparison)]
    published = report.published_table(comparison)
    parts = [draw(table) for table in [*tables, *([published] if published else [])]]
    lives = [] if comparison.fatigue is None else ["\n".join(comparison.fatigue.verdicts)]
    return "\n\n".join([*parts, *lives])
