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
@click.option("--json", "as_json", is_flag=True, help="Print metrics.json and manifest.json as one object.")
def show_command(run: str, root: Path, as_json: bool) -> None:
    """Show one RUN: how it ended, its results, its files.

    Example: cranktopo runs show 20250101-120000_mikron-iiic_0123abcd
    """
    from cranktopo.cli.optimise import summary
    from cranktopo.store import open_run

    found = open_run(run, root)
    manifest, metrics = found.manifest(), _metrics(found)
    if as_json:
        click.echo(json.dumps({"schema_version": 1, "manifest": manifest, "metrics": metrics}, indent=2))
        return
    click.echo(f"{found.path}: {manifest['status']}, started {manifest['started']}")
    click.echo(f"{' '.join(manifest['command'])}\n")
    if metrics is None:
        click.echo(f"not finished; continue with: cranktopo optimise --resume {found.path}")
    else:
        click.echo(summary(metrics, found.path))


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


def _metrics(run: RunStore) -> dict[str, Any] | None:
    return run.read_metrics() if (run.path / "metrics.json").is_file() else None


def _entry(run: RunStore) -> dict[str, Any]:
    entry: dict[str, Any] = {"run": run.name, "path": str(run.path), "status": _status(run)}
    if entry["status"] == "unreadable":
        return entry
    entry |= {"design": run.manifest()["design"], "started": run.manifest()["started"]}
    metrics = _metrics(run)
    if metrics is not None:
        entry["result"] = metrics["status"]
        entry["mass_of_throw_kg"] = metrics["mass_kg"]["throw"]
        gains = metrics["original_web"]["gain_of_stiffness_per_mass_percent"]
        entry["gain_of_stiffness_per_mass_percent"] = gains
    return entry


def _table(entries: list[dict[str, Any]]) -> str:
    from cranktopo.report.text_table import text_table

    header = ("run", "status", "result", "throw kg", "torsion per kg", "bending per kg")
    rows = []
    for entry in entries:
        gains = entry.get("gain_of_stiffness_per_mass_percent", {})
        mass = entry.get("mass_of_throw_kg")
        row = [
            entry["run"],
            entry["status"],
            entry.get("result", "-"),
            "-" if mass is None else f"{mass:.3f}",
        ]
        row += [f"{gains[kind]:+.1f} %" if kind in gains else "-" for kind in ("torsion", "bending")]
        rows.append(row)
    return text_table("lllrrr", header, rows)
