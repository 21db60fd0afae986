"""`cranktopo vibration`

Torsional vibration of the whole shaft: critical speeds, torque and stress by order.
"""

from __future__ import annotations

from pathlib import Path
from typing import get_args

import click

from cranktopo.cli.options import (
    CELL_MM,
    DEFAULT_DESIGN,
    CylinderNumber,
    bearings_option,
    body_options,
    designs,
    seconds,
    typed,
)
from cranktopo.cli.output import tell
from cranktopo.cli.verbosity import verbosity_options


@click.command()
@click.argument("target", default=DEFAULT_DESIGN, shell_complete=designs)
@body_options
@bearings_option()
@click.option("--element-size-mm", type=CELL_MM, help="General element size.")
@click.option(
    "--report",
    type=click.Path(dir_okay=False, path_type=Path),
    help="Write a page with Campbell diagram and tables; HTML or Markdown.",
)
@click.option(
    "--csv",
    "csv_path",
    type=click.Path(dir_okay=False, path_type=Path),
    help="Write the torque of every section by speed and order.",
)
@click.option(
    "--run-up",
    "run_up_s",
    metavar="TIME",
    callback=seconds,
    help="Pass through the range of speeds in this time, such as 10s; by default steady vibration alone.",
)
@click.option(
    "--misfire",
    "misfires",
    type=CylinderNumber("worst"),
    multiple=True,
    help="A cylinder that does not fire, in place of the design's; repeatable. Or worst: what each one alone "
    "would do.",
)
@click.option("--json", "as_json", is_flag=True, help="Print one JSON object.")
@verbosity_options
def command(
    target: str,
    design: str | None,
    align: bool,
    bearings: str,
    element_size_mm: float | None,
    report: Path | None,
    csv_path: Path | None,
    run_up_s: float | None,
    misfires: tuple[int | str, ...],
    as_json: bool,
) -> None:
    """Torsional vibration of TARGET's shaft: natural frequencies, critical speeds, torque and stress.

    TARGET is a design, a run directory, or an STL or STEP file of the half throw (with --design). What is
    joined to the crankshaft, its damping and the range of speeds are the design's [shaft].

    Example: cranktopo vibration my-engine.toml --report vibration.html
    """
    from cranktopo.design.assumed import LOADS, SHAFT, VIBRATION, filter_by_table
    from cranktopo.tasks.shaft.assembly import Bearings
    from cranktopo.tasks.throw_fea.targets import resolve_target
    from cranktopo.tasks.vibration.result import vibration_result
    from cranktopo.tasks.vibration.stage import misfire_option, shaft_vibration
    from cranktopo.tasks.vibration.text import vibration_text

    resolved = resolve_target(target, design, align=align, whole=True, crank=True)
    chosen = bearings if "--bearings" in typed() else None
    support: Bearings | None = next((name for name in get_args(Bearings) if name == chosen), None)
    study = shaft_vibration(
        resolved,
        support,
        element_size_mm,
        report,
        csv_path,
        run_up_s=run_up_s,
        misfire=misfire_option(misfires),
    )
    assumed = filter_by_table(resolved.assumed, (*SHAFT, LOADS, VIBRATION))
    if as_json:
        tell(vibration_result(study, assumed).as_json())
    else:
        tell(vibration_text(study))
