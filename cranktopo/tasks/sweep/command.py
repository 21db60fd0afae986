"""`cranktopo sweep`

Many points of a design space on all cores or a cluster: table, Pareto front and page.
"""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from cranktopo.base.errors import ExitCode
from cranktopo.cli.options import (
    CELL_MM,
    DEFAULT_DESIGN,
    Choice,
    designs,
    goal_options,
    percent,
    refuse_beside_resume,
    run_options,
    seconds,
    typed,
)
from cranktopo.cli.output import tell, tell_error
from cranktopo.cli.verbosity import verbosity_options

if TYPE_CHECKING:
    from cranktopo.tasks.sweep.plan import SweepPlan

_BESIDE_FILE = ("target", "workers", "scheduler", "out", "as_json")
"""Parameters that may stand beside a file, which says all of the points."""


@click.command("sweep")
@click.argument("target", required=False, metavar="[DESIGN|FILE]", shell_complete=designs)
@click.option(
    "--vary",
    multiple=True,
    metavar="KEY=VALUES",
    help="A key of the scene and its values: A:B:N, or A:B with --sampling, or a,b,c; repeatable.",
)
@click.option(
    "--stage",
    type=Choice(["evaluate", "fatigue", "optimise", "remodel", "shape"]),
    help="How far each point goes.  [default: evaluate]",
)
@goal_options
@click.option(
    "--sampling",
    type=Choice(["grid", "latin", "sobol"]),
    help="All combinations, a Latin hypercube or a Sobol sequence.  [default: grid]",
)
@click.option(
    "--samples",
    type=click.IntRange(1, 100_000),
    help="Number of points of a Latin hypercube or a Sobol sequence.",
)
@click.option(
    "--element-size-mm", type=CELL_MM, help="Element size of evaluations; by default that of `evaluate`."
)
@click.option(
    "--accuracy",
    "accuracy_percent",
    metavar="PERCENT",
    callback=percent,
    help="Largest permitted error of evaluations, such as 1%.",
)
@click.option(
    "--refine",
    type=Choice(["all", "front"]),
    help="front: coarse first, full accuracy for what may be on the front alone.  [default: all]",
)
@click.option(
    "--budget",
    "budget_s",
    metavar="TIME",
    callback=seconds,
    help="Time for points at full accuracy with --refine front, such as 10min; the picks come first.",
)
@click.option(
    "--keep",
    type=Choice(["journals", "pitch"]),
    help="What stays where webs or pins get longer: main journals, or the pitch.  [default: journals]",
)
@click.option(
    "--workers", type=click.IntRange(1, 1024), help="Processes here; default: as cores and memory allow."
)
@click.option(
    "--scheduler", metavar="ADDRESS", help="A Dask scheduler to use instead, such as tcp://10.0.0.5:8786."
)
@run_options("Continue a sweep; finished points are kept.")
@click.option("--json", "as_json", is_flag=True, help="Print sweep.json.")
@verbosity_options
def command(
    target: str | None,
    workers: int | None,
    scheduler: str | None,
    out: Path | None,
    resume: str | None,
    as_json: bool,
    **options: Any,
) -> ExitCode:
    """Compute many variants of DESIGN, or those that a TOML FILE describes.

    Points are computed side by side on this machine, or on a Dask cluster. An impossible web is a row with
    its reason. Writes table.csv, table.parquet, sweep.json, a page that opens from disk, and a directory for
    each point. After Ctrl-C or a crash --resume goes on; no finished point is computed twice.

    Example: cranktopo sweep mikron-iiic --vary "web.width_mm=46:56:6" --vary "throw.crankpin.fillet_mm=2,2.5"

    Goals: cranktopo sweep --stage shape --minimise mass --limit "torsion >= 90:130:5 %"
    """
    if workers is not None and scheduler is not None:
        raise click.UsageError("--scheduler excludes --workers: the cluster has its own")
    if resume:
        refuse_beside_resume("workers", "scheduler")
    from cranktopo.tasks.sweep.computed import Workplace
    from cranktopo.tasks.sweep.run import resume_sweep, run_sweep
    from cranktopo.tasks.sweep.text import sweep_summary

    place = Workplace(workers, scheduler)
    if resume:
        done = resume_sweep(resume, place)
    else:
        plan = _plan(target or DEFAULT_DESIGN, **options)
        done = run_sweep(plan, place, out, ["cranktopo", *sys.argv[1:]])
    tell(done.result.as_json() if as_json else sweep_summary(done.result, done.folder), indent=None)
    if done.failed:
        return ExitCode.SOLVER
    if done.impossible:
        tell_error(f"no point of the sweep is possible; the first: {done.impossible}")
        return ExitCode.INVALID_INPUT
    return ExitCode.DONE


def _plan(target: str, vary: tuple[str, ...], **options: Any) -> SweepPlan:
    from cranktopo.tasks.sweep.plan import is_plan, read_plan, sweep_plan
    from cranktopo.tasks.sweep.variation import read_option

    used = {name: value for name, value in options.items() if value not in (None, ())}
    if is_plan(target):
        if vary or used:
            raise click.UsageError(f"{target} says all of it: leave out {typed(*_BESIDE_FILE)[0]}")
        return read_plan(Path(target))
    if not vary and not used.get("limits"):
        raise click.UsageError('nothing varies: give --vary "web.width_mm=46:56:6" or the like, or a FILE')
    return sweep_plan([target], [read_option(text) for text in vary], **used)
