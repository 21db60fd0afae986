"""`cranktopo compare`: several targets beside a baseline."""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING

import click

from cranktopo.cli.evaluate import evaluate_targets, warn_missed
from cranktopo.cli.options import mesh_options
from cranktopo.errors import CranktopoError, ExitCode

if TYPE_CHECKING:
    from cranktopo.report.comparison import Comparison


@click.command()
@click.argument("targets", metavar="TARGET...", nargs=-1, required=True)
@click.option("--baseline", required=True, metavar="TARGET", help="The target that counts as 100 %.")
@click.option(
    "--format",
    "form",
    type=click.Choice(["table", "markdown", "csv", "json"]),
    default="table",
    show_default=True,
    help="Form of the result on stdout.",
)
@click.option("--json", "as_json", is_flag=True, help="Same as --format json.")
@click.option(
    "--plot", type=click.Path(path_type=Path), help="Also draw stiffness over mass (.png .svg .pdf)."
)
@mesh_options
def command(
    targets: tuple[str, ...],
    baseline: str,
    form: str,
    as_json: bool,
    plot: Path | None,
    element_size_mm: float | None,
    accuracy: float | None,
    design: str | None,
) -> None:
    """Compare TARGETs with a baseline: mass, stiffness, stiffness per mass, inertia, unbalance.

    The stiffnesses are those of the supports in the designs. A star marks the best of each column. The
    baseline is evaluated too when it is not among the targets.
    """
    if plot is not None and not plot.parent.is_dir():
        raise CranktopoError(f"--plot '{plot}': its folder does not exist.", code=ExitCode.USAGE)
    names = targets if baseline in targets else (baseline, *targets)
    comparison, missed = _compare(names, names.index(baseline), element_size_mm, accuracy, design)
    click.echo(_text(comparison, "json" if as_json else form))
    if plot is not None:
        from cranktopo.report.scatter import plot_stiffness_over_mass

        plot_stiffness_over_mass(comparison, plot)
        click.echo(f"plot: {plot}", err=True)
    warn_missed(missed, accuracy)


def _compare(
    names: tuple[str, ...], baseline: int, size: float | None, accuracy: float | None, design: str | None
) -> tuple[Comparison, list[str]]:
    from cranktopo.evaluate.targets import resolve_target
    from cranktopo.report.comparison import Entry, compare

    published = [
        None if target.file else target.scene.published
        for target in (resolve_target(name, design) for name in names)
    ]
    evaluations, missed = evaluate_targets(names, size, accuracy, design)
    entries = [Entry(e, p) for e, p in zip(evaluations, published, strict=True)]
    return compare(entries, evaluations[baseline].target), missed


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
    return "\n\n".join(draw(table) for table in [*tables, *([published] if published else [])])
