"""`cranktopo doctor`

Check this machine: Python, JAX, gmsh, memory, extras, optional tools, and how to install them.
"""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

import click

from cranktopo.base.errors import CranktopoError, ExitCode, lacks_memory
from cranktopo.cli.output import coloured, tell

if TYPE_CHECKING:
    from cranktopo.tasks.doctor.stage import Check

_COLOURS = {"ok": "green", "missing": "red", "short": "red", "absent": "yellow"}
_STATE = re.compile(rf"(?m)^(\S.*?  +)({'|'.join(_COLOURS)})\b")


@click.command("doctor")
@click.option("--json", "as_json", is_flag=True, help="Print one JSON object.")
def command(as_json: bool) -> int:
    """Check Python, JAX, gmsh, cores, memory, extras and optional tools.

    For each missing one it prints the consequence and the line that installs it. Exit code 7 when something
    needed is missing, 3 when this process may not have the memory for it ("short"); without an extra or an
    optional tool ("absent") everything else works.

    Example: cranktopo doctor
    """
    try:
        return _report(as_json)
    except Exception as error:
        if not lacks_memory(error):
            raise
        raise CranktopoError(
            "memory: too little to check this machine.", hint="Allow more (ulimit -v)."
        ) from None


def _report(as_json: bool) -> int:
    from cranktopo.tasks.doctor.stage import check_machine

    checks = check_machine()
    missing, short = (
        [check.name for check in checks if check.state == state] for state in ("missing", "short")
    )
    if as_json:
        from cranktopo.tasks.doctor.result import MachineChecks

        found = MachineChecks(ready=not missing and not short, checks=tuple(checks))
        tell(found.as_json())
    else:
        tell(_text(checks))
        tell(_verdict(missing, short))
    if missing:
        return ExitCode.MISSING_TOOL
    return ExitCode.INVALID_INPUT if short else ExitCode.DONE


def _verdict(missing: list[str], short: list[str]) -> str:
    said = [f"needed and missing: {', '.join(missing)}"] * bool(missing)
    said += [f"needed, and too little memory for it: {', '.join(short)}"] * bool(short)
    return "\n" + "\n".join(said or ["ready"])


def _text(checks: list[Check]) -> str:
    from cranktopo.report.result_table import text_table

    rows: list[tuple[str, str, str]] = []
    for check in checks:
        rows.append((check.name, check.state, check.value))
        rows += [("", "", f"without it: {check.cost}")] * bool(check.state != "ok" and check.cost)
    table = re.sub(_STATE, _in_its_colour, text_table("lll", ("", "", ""), rows))
    remedies = [f"{check.name}: {check.remedy}" for check in checks if check.state != "ok" and check.remedy]
    return "\n".join([table, *["", "remedies, to be copied:"] * bool(remedies), *remedies])


def _in_its_colour(found: re.Match[str]) -> str:
    return f"{found[1]}{coloured(found[2], _COLOURS[found[2]])}"
