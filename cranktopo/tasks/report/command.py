"""`cranktopo report`

Write the page of a run: verdict, 3D view, curves, tables; HTML or Markdown with PNGs.
"""

from __future__ import annotations

from pathlib import Path

import click

from cranktopo.cli.options import runs
from cranktopo.cli.output import tell
from cranktopo.cli.verbosity import verbosity_options


@click.command(name="report")
@click.argument("run", shell_complete=runs)
@click.option(
    "--out",
    type=click.Path(path_type=Path, dir_okay=False),
    help="File, .html or .md; default: report.html in the run.",
)
@click.option(
    "--stress",
    is_flag=True,
    help="Solve the surface for its load cases on body-fitted elements and show the stresses.",
)
@click.option("--markdown", "as_markdown", is_flag=True, help="Markdown with PNGs beside it.")
@verbosity_options
def command(run: str, out: Path | None, stress: bool, as_markdown: bool) -> None:
    """Write the report of RUN: one HTML file that opens from disk, or Markdown with pictures.

    RUN is the directory of an optimise, shape or iterate run, its name under runs/, or the beginning of that
    name. Those commands write the page by themselves; write it again in another form, or to include what was
    added to an optimisation since. Stresses are kept in the run.

    Example: cranktopo report runs/20250101-120000_mikron-iiic_0123abcd --stress
    """
    from cranktopo.report.report_file import check_report_path
    from cranktopo.runs.directories import open_run
    from cranktopo.tasks.report.stage import report_run

    if as_markdown and out is not None and out.suffix.lower() != ".md":
        raise click.UsageError(f"--markdown writes .md, but --out is '{out}'")
    if out is not None:
        check_report_path(out)
    store = open_run(run)
    target = out or (store.path / "report.md" if as_markdown else None)
    tell(str(report_run(store, target, stress)))
