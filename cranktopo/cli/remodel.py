"""`cranktopo remodel`: a parametric web that can be drawn and made, fitted to a run."""

from __future__ import annotations

import json
from pathlib import Path

import click

from cranktopo.cli.completion import runs
from cranktopo.cli.talk import say, talkative


@click.command()
@click.argument("run", shell_complete=runs)
@click.option("--out", type=click.Path(path_type=Path), help="Folder to write to; RUN/remodel by default.")
@click.option(
    "--min-wall-mm", type=click.FloatRange(min=0.5), default=3.0, show_default=True, help="Least wall."
)
@click.option(
    "--min-radius-mm",
    type=click.FloatRange(min=0.5),
    default=6.0,
    show_default=True,
    help="Least radius of curvature of the outline.",
)
@click.option(
    "--draft-deg",
    type=click.FloatRange(min=0, max=30),
    default=3.0,
    show_default=True,
    help="Least draft of a side pocket's walls.",
)
@click.option(
    "--cell-mm",
    type=click.FloatRange(min=0.25, max=4),
    default=1.0,
    show_default=True,
    help="Cells of the final fit: half the size is nearer to the body and eight times dearer.",
)
@click.option("--no-judge", is_flag=True, help="Leave out the stiffness comparison.")
@click.option("--json", "as_json", is_flag=True, help="Print remodel.json.")
@talkative
def command(
    run: str,
    out: Path | None,
    min_wall_mm: float,
    min_radius_mm: float,
    draft_deg: float,
    cell_mm: float,
    no_judge: bool,
    as_json: bool,
) -> None:
    """Fit a web that a die or a mill can make to the extracted body of RUN.

    Spline outline, end bevels, side pocket and pockets, each kept only for the overlap it gains. Writes a
    scene that every command accepts, the exact solid as STEP and STL, a drawing and remodel.json.

    Example: cranktopo remodel 20250101-120000_mikron-iiic_0123abcd --min-wall-mm 4
    """
    from cranktopo.pipeline_remodel import remodel
    from cranktopo.remodel.rules import Rules
    from cranktopo.report.remodel_text import remodel_text

    rules = Rules(
        min_wall_mm=min_wall_mm, min_radius_mm=min_radius_mm, min_draft_deg=draft_deg, cell_mm=cell_mm
    )
    data = remodel(run, out, rules, not no_judge, say)
    click.echo(json.dumps(data) if as_json else remodel_text(data))
