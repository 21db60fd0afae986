"""`cranktopo compare`

Compare targets against a baseline: table, Markdown, LaTeX, CSV, JSON or a scatter plot.
"""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING

import click

from cranktopo.base.formats import PLOTS
from cranktopo.base.notes import note
from cranktopo.cli.options import (
    Choice,
    Number,
    bound_option,
    designs,
    loads_option,
    mesh_options,
    throw_option,
    typed,
)
from cranktopo.cli.output import pass_on, tell
from cranktopo.cli.verbosity import verbosity_options
from cranktopo.tasks.evaluate.command import warn_missed
from cranktopo.tasks.fatigue.criteria import METHODS

if TYPE_CHECKING:
    from cranktopo.engine.histories import HistoryKind
    from cranktopo.tasks.throw_fatigue.assessment import FatigueMethod


@click.command()
@click.argument("targets", metavar="TARGET...", nargs=-1, required=True, shell_complete=designs)
@click.option("--baseline", required=True, metavar="TARGET", help="The target that counts as 100 %.")
@click.option(
    "--format",
    "form",
    type=Choice(["table", "markdown", "latex", "csv", "json"]),
    default="table",
    show_default=True,
    help="Form of the result on stdout; latex needs the package booktabs.",
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
    "methods",
    type=Choice(tuple(METHODS)),
    multiple=True,
    help="Also assess the fatigue safety by this method (repeatable); see 'cranktopo fatigue --help'.",
)
@click.option(
    "--fillet-fraction",
    type=Number(0.01, 0.5),
    help="Of the fatigue: element size in a fillet over its radius; by default 0.17.",
)
@loads_option
@bound_option
@throw_option
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
    methods: tuple[FatigueMethod, ...],
    fillet_fraction: float | None,
    loads: HistoryKind,
    no_bound: bool,
    throw: int | None,
    element_size_mm: float | None,
    accuracy: float | None,
    budget: float | None,
    design: str | None,
    align: bool,
) -> None:
    """Compare TARGETs with a baseline: mass, stiffness, stiffness per mass, inertia, unbalance, safety.

    Stiffnesses are those of the supports in the designs, each with a bound of its error. Bounds of changes
    are smaller, since errors of like meshes cancel. A star marks the best of each column, unless another is
    within that bound. The baseline is evaluated too when it is not among the targets. For a design with a
    [goal] the result says which limits hold; --fatigue adds the safety. A sweep counts by its picks. Values
    of [published] stand beside the computed percentages.

    Example: cranktopo compare opposed-piston-variant-2 --baseline opposed-piston --report variants.html
    """
    if as_json and form != "json" and "--format" in typed():
        raise click.UsageError(f"--json excludes --format {form}: give one of them")
    if no_bound and plot is None and page is None:
        note("--no-bound: changes nothing without --plot or --report, which alone show the bound")
    if stress and page is None:
        raise click.UsageError("--stress colours the 3D view of --report: give --report FILE too")
    if "--loads" in typed() and not methods:
        raise click.UsageError("--loads is of the fatigue safety: give --fatigue METHOD too")
    if fillet_fraction is not None and not methods:
        raise click.UsageError("--fillet-fraction is of the fatigue safety: give --fatigue METHOD too")
    if page is not None and page.suffix.lower() == ".tex":
        raise click.UsageError(
            f"--report {page}: writes pages, .html or .md; tables for LaTeX come from --format latex > {page}"
        )
    if plot is not None:
        from cranktopo.runs.destination import check_file

        check_file(plot, "--plot", PLOTS)
    if page is not None:
        from cranktopo.report.report_file import check_report_path

        check_report_path(page)
    from cranktopo.tasks.compare.printed import comparison_text
    from cranktopo.tasks.compare.stage import compare_targets, comparison_bound, report_comparison
    from cranktopo.tasks.throw_fea.stage import MeshRequest

    request = MeshRequest(element_size_mm, accuracy, budget)
    found = compare_targets(targets, baseline, request, methods, design, align, loads, throw, fillet_fraction)
    form = "json" if as_json else form
    (tell if form == "table" else pass_on)(comparison_text(found.comparison, form))
    bound = None if no_bound or (plot or page) is None else comparison_bound(found)
    if plot is not None:
        from cranktopo.tasks.compare.page import plot_stiffness_over_mass

        plot_stiffness_over_mass(found.comparison, plot, bound)
        note(f"plot: {plot}")
    if page is not None:
        report_comparison(found, page, ["cranktopo", *sys.argv[1:]], stress, bound)
        note(f"report: {page}")
    warn_missed(found.missed, accuracy)
