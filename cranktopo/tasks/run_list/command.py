"""`cranktopo runs`

List, show or clean up runs.
"""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from cranktopo.cli.group import SuggestingGroup
from cranktopo.cli.options import Choice
from cranktopo.cli.options import runs as complete_runs
from cranktopo.cli.output import tell

if TYPE_CHECKING:
    from cranktopo.runs.kind import RunKind
    from cranktopo.tasks.run_list.stage import RunEntry

_STATES = ("done", "interrupted", "failed", "running")
_ROOT = click.option(
    "--root", type=click.Path(path_type=Path), default=Path("runs"), show_default=True, help="Folder of runs."
)


@click.group("runs", cls=SuggestingGroup)
def command() -> None:
    """List, show or clean up runs.

    Example: cranktopo runs list
    """


@command.command("list")
@_ROOT
@click.option("--json", "as_json", is_flag=True, help="Print one JSON object.")
def list_command(root: Path, as_json: bool) -> None:
    """List the runs, oldest first: status, mass, gains per mass against the original web.

    Example: cranktopo runs list --json
    """
    from cranktopo.tasks.run_list.stage import RunList, summarise_runs

    entries = summarise_runs(root)
    if as_json:
        tell(RunList(runs=tuple(entries)).as_json())
    elif entries:
        tell(_table(entries))
    else:
        tell(f"no runs under '{root}'; make one with: cranktopo optimise")


@command.command("show")
@click.argument("run", shell_complete=complete_runs)
@_ROOT
@click.option("--json", "as_json", is_flag=True, help="Print manifest and results as one object.")
def show_command(run: str, root: Path, as_json: bool) -> None:
    """Show one RUN: how it ended, its results, its files.

    Example: cranktopo runs show 20250101-120000_mikron-iiic_0123abcd
    """
    from cranktopo.runs.directories import open_run
    from cranktopo.runs.kind import (
        EACH_WEB,
        LOOP,
        SHAPE,
        SWEEP,
        kind_of,
        read_result,
        reading_results,
        resume_command,
    )
    from cranktopo.tasks.run_list.stage import run_result

    found = open_run(run, root)
    manifest, kind = found.manifest(), kind_of(found)
    if as_json:
        keys = {LOOP: "loop", SHAPE: "shape", SWEEP: "sweep", EACH_WEB: "each_web"}
        key = keys.get(kind, "metrics")
        whole = {"schema_version": 1, "manifest": manifest.as_json(), key: read_result(found)}
        tell(whole)
        return
    tell(f"{found.path}: {manifest.status}, started {manifest.started}")
    tell(f"{' '.join(manifest.command)}\n")
    result = run_result(found)
    if result is None:
        tell(f"not finished; continue with: {resume_command(found)}")
        return
    with reading_results(found):
        summary = _summary(kind, result, found.path)
    tell(summary)


def _summary(kind: RunKind, result: Any, folder: Path) -> str:
    from cranktopo.runs.kind import EACH_WEB, LOOP, SHAPE, SWEEP
    from cranktopo.tasks.iterate.text import loop_summary
    from cranktopo.tasks.optimise.text import run_summary
    from cranktopo.tasks.sweep.text import sweep_summary
    from cranktopo.tasks.web_shape.each_web.text import each_web_summary
    from cranktopo.tasks.web_shape.text import shape_summary

    summaries: dict[RunKind, Any] = {
        LOOP: loop_summary,
        SHAPE: shape_summary,
        SWEEP: sweep_summary,
        EACH_WEB: each_web_summary,
    }
    return str(summaries.get(kind, run_summary)(result, folder))


@command.command("clean")
@_ROOT
@click.option(
    "--status",
    "states",
    type=Choice(_STATES),
    multiple=True,
    default=("failed",),
    show_default=True,
    help="Which runs; may be repeated.",
)
@click.option("--yes", is_flag=True, help="Delete; without it, only list what would be deleted.")
def clean_command(root: Path, states: tuple[str, ...], yes: bool) -> None:
    """Delete runs by their status; a run that a process works in is never deleted.

    Example: cranktopo runs clean --status failed --status interrupted --yes
    """
    from cranktopo.tasks.run_list.stage import clean_runs

    chosen = clean_runs(states, yes, root)
    for path in chosen:
        tell(f"{'deleted' if yes else 'would delete'} {path}")
    if not chosen:
        tell(f"no run under '{root}' is {' or '.join(states)}")
    elif not yes:
        tell("Add --yes to delete.")


def _table(entries: list[RunEntry]) -> str:
    from cranktopo.report.result_table import text_table

    header = ("run", "command", "status", "result", "throw\nkg", "torsion per kg", "bending per kg")
    rows = []
    for entry in entries:
        gains, mass = entry.gain_of_stiffness_per_mass_percent or {}, entry.mass_of_throw_kg
        row = [entry.run, entry.command or "-", entry.status, entry.result or "-"]
        row += ["-" if mass is None else f"{mass:.3f}"]
        row += [f"{gains[kind]:+z.1f} %" if kind in gains else "-" for kind in ("torsion", "bending")]
        rows.append(row)
    return text_table("llllrrr", header, rows)
