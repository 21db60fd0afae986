"""`cranktopo doctor`

Check this machine: Python, JAX, gmsh, memory, extras, optional tools, and how to install them.
"""

from __future__ import annotations

import json
from dataclasses import asdict
from typing import TYPE_CHECKING

import click

from cranktopo.base.errors import ExitCode
from cranktopo.cli.verbosity import coloured

if TYPE_CHECKING:
    from cranktopo.tasks.doctor.stage import Check

_COLOURS = {"ok": "green", "missing": "red", "absent": "yellow"}


@click.command("doctor")
@click.option("--json", "as_json", is_flag=True, help="Print one JSON object.")
def command(as_json: bool) -> int:
    """Check Python, JAX, gmsh, cores, memory, extras and optional tools.

    Says for whatever is missing what that costs and which line installs it. Exit code 7 when something
    needed is missing; without an extra or an optional tool ("absent") everything else works.

    Example: cranktopo doctor
    """
    from cranktopo.tasks.doctor.stage import check_machine

    checks = check_machine()
    missing = [check.name for check in checks if check.state == "missing"]
    if as_json:
        entries = [asdict(check) for check in checks]
        click.echo(json.dumps({"schema_version": 1, "ready": not missing, "checks": entries}, indent=2))
    else:
        click.echo(_text(checks))
        click.echo(f"\nneeded and missing: {', '.join(missing)}" if missing else "\nready")
    return ExitCode.MISSING_TOOL if missing else ExitCode.DONE


def _text(checks: list[Check]) -> str:
    width = max(len(check.name) for check in checks)
    lines = []
    for check in checks:
        state = coloured(f"{check.state:8}", _COLOURS[check.state])
        lines.append(f"{check.name:{width}}  {state}{check.value}".rstrip())
        if check.state != "ok":
            lines += [f"{'':{width}}          without it: {check.cost}"] if check.cost else []
            lines += [f"{'':{width}}          remedy:     {check.remedy}"] if check.remedy else []
    return "\n".join(lines)
