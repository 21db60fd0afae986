"""`cranktopo runs`: list, show and clean up run directories."""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from cranktopo.cli.completion import runs as complete_runs
from cranktopo.cli.group import SuggestingGroup
from cranktopo.cli.parameters import Choice
from cranktopo.errors import CranktopoError

if TYPE_CHECKING:
    from cranktopo.store import RunStore

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
    from cranktopo.store import list_runs

    entries = [_entry(run) for run in list_runs(root)]
    if as_json:
        click.echo(json.dumps({"schema_version": 1, "runs": entries}, indent=2))
    elif entries:
        click.echo(_table(entries))
    else:
        click.echo(f"no runs under '{root}'; make one with: cranktopo optimise")


@command.command("show")
@click.argument("run", shell_complete=complete_runs)
@_ROOT
@click.option("--json", "as_json", is_flag=True, help="Print manifest and results as one object.")
def show_command(run: str, root: Path, as_json: bool) -> None:
    """Show one RUN: how it ended, its results, its files.

    Example: cranktopo runs show 20250101-120000_mikron-iiic_0123abcd
    """
    from cranktopo.cli import iterate, optimise
    from cranktopo.store import LOOP, kind_of, open_run, read_result, resume_command

    found = open_run(run, root)
    manifest, kind, result = found.manifest(), kind_of(found), read_result(found)
    if as_json:
        key = "loop" if kind == LOOP else "metrics"
        click.echo(json.dumps({"schema_version": 1, "manifest": manifest, key: result}, indent=2))
        return
    click.echo(f"{found.path}: {manifest['status']}, started {manifest['started']}")
    click.echo(f"{' '.join(manifest['command'])}\n")
    if result is None:
        click.echo(f"not finished; continue with: {resume_command(found)}")
    else:
        click.echo((iterate if kind == LOOP else optimise).summary(result, found.path))


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
@click.option("--yes", is_flag=True, help="Delete; without it, only say what would be deleted.")
def clean_command(root: Path, states: tuple[str, ...], yes: bool) -> None:
    """Delete runs by their status; a run that a process works in is never deleted.

    Example: cranktopo runs clean --status failed --status interrupted --yes
    """
    from cranktopo.store import list_runs, remove_run

    chosen = [run for run in list_runs(root) if _status(run) in states]
    for run in chosen:
        if yes:
            remove_run(run)
        click.echo(f"{'deleted' if yes else 'would delete'} {run.path}")
    if not chosen:
        click.echo(f"no run under '{root}' is {' or '.join(states)}")
    elif not yes:
        click.echo("Add --yes to delete.")


def _status(run: RunStore) -> str:
    """Status of a run, or `unreadable`, which no option chooses."""
    try:
        return str(run.manifest()["status"])
    except CranktopoError:
        return "unreadable"


def _entry(run: RunStore) -> dict[str, Any]:
    from cranktopo.store import LOOP, kind_of, read_result

    entry: dict[str, Any] = {"run": run.name, "path": str(run.path), "status": _status(run)}
    if entry["status"] == "unreadable":
        return entry
    kind, result = kind_of(run), read_result(run)
    entry |= {"command": kind, "design": run.manifest()["design"], "started": run.manifest()["started"]}
    if result is None:
        return entry
    return entry | (_loop_result(result) if kind == LOOP else _run_result(result))


def _run_result(metrics: dict[str, Any]) -> dict[str, Any]:
    return {
        "result": metrics["status"],
        "mass_of_throw_kg": metrics["mass_kg"]["throw"],
        "gain_of_stiffness_per_mass_percent": metrics["original_web"]["gain_of_stiffness_per_mass_percent"],
    }


def _loop_result(loop: dict[str, Any]) -> dict[str, Any]:
    """The best step of a loop, if it has one."""
    if loop["best_step"] is None:
        return {"result": "no better web"}
    best = loop["steps"][loop["best_step"]]
    share = best["percent_of_original"]
    return {
        "result": f"best: step {best['number']}",
        "mass_of_throw_kg": best["throw_kg"],
        "gain_of_stiffness_per_mass_percent": {
            case: share[f"{case}_per_mass"] - 100 for case in ("torsion", "bending")
        },
    }


def _table(entries: list[dict[str, Any]]) -> str:
    from cranktopo.report.text_table import text_table

    header = ("run", "command", "status", "result", "throw kg", "torsion per kg", "bending per kg")
    rows = []
    for entry in entries:
        gains = entry.get("gain_of_stiffness_per_mass_percent", {})
        mass = entry.get("mass_of_throw_kg")
        row = [
            entry["run"],
            entry.get("command", "-"),
            entry["status"],
            entry.get("result", "-"),
            "-" if mass is None else f"{mass:.3f}",
        ]
        row += [f"{gains[kind]:+.1f} %" if kind in gains else "-" for kind in ("torsion", "bending")]
        rows.append(row)
    return text_table("llllrrr", header, rows)
