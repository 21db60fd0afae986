"""`cranktopo remodel`

Fit a parametric web that can be made to a run: scene, STEP, STL, drawing, shape error.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import click

from cranktopo.cli.options import limit_options, runs
from cranktopo.cli.output import tell
from cranktopo.cli.verbosity import verbosity_options


@click.command()
@click.argument("run", shell_complete=runs)
@click.option("--out", type=click.Path(path_type=Path), help="Folder to write to; RUN/remodel by default.")
@limit_options
@click.option("--no-evaluation", is_flag=True, help="Leave out the stiffness comparison.")
@click.option("--no-judge", "no_evaluation", is_flag=True, hidden=True)
@click.option("--json", "as_json", is_flag=True, help="Print remodel.json.")
@verbosity_options
def command(run: str, out: Path | None, no_evaluation: bool, as_json: bool, **limits: Any) -> None:
    """Fit a web that a die or a mill can make to the extracted body of RUN.

    Spline outline, end bevels, side pocket and pockets, each kept only for the overlap it gains. Writes a
    scene that every command accepts, the exact solid as STEP and STL, a drawing, remodel.json and a page;
    'cranktopo report RUN' shows its numbers as well.

    Example: cranktopo remodel 20250101-120000_mikron-iiic_0123abcd --min-wall-mm 4
    """
    from cranktopo.tasks.refit.page import refit_text
    from cranktopo.tasks.refit.stage import remodel_run

    data = remodel_run(run, out, limits, not no_evaluation)
    tell(data.as_json() if as_json else refit_text(data), indent=None)
