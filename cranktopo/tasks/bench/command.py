"""`cranktopo bench`

Open the bench: a local page on which a web is dragged, watched, compared and exported.
"""

from __future__ import annotations

from functools import partial
from pathlib import Path

import click

from cranktopo.base.errors import ExitCode
from cranktopo.cli.options import designs_and_runs
from cranktopo.cli.output import tell


@click.command("bench")
@click.argument("target", required=False, metavar="[DESIGN|RUN|BODY]", shell_complete=designs_and_runs)
@click.option("--port", type=click.IntRange(1024, 65535), help="Port on 127.0.0.1; default: a free one.")
@click.option(
    "--host",
    metavar="ADDRESS",
    help="Address of this machine where others reach it; asks for a password.",
)
@click.option(
    "--i-know",
    is_flag=True,
    help="Confirm with --host: others reach the bench, and the connection is not encrypted.",
)
@click.option("--no-browser", is_flag=True, help="Print the address alone.")
def command(
    target: str | None, port: int | None, host: str | None, i_know: bool, no_browser: bool
) -> ExitCode:
    """Open a page on this machine: drag a dimension, see what it does, keep variants, export.

    A DESIGN, the web of a RUN, or a crank from CAD (BODY, .step) is put on the bench; without one the page
    asks six questions. Every step is kept in the folder `bench` and shown as a command. The page is for
    this machine alone, unless --host names an address that others reach: nothing is loaded from elsewhere,
    and the address holds a secret. Ctrl-C ends the bench; jobs go on.

    Example: cranktopo bench mikron-iiic --no-browser
    """
    from cranktopo.base.errors import packages_of

    with packages_of("bench"):
        import tornado.web  # noqa: F401
    from cranktopo.tasks.bench.access import Password, check_host
    from cranktopo.tasks.bench.stage import run_bench

    if i_know and host is None:
        raise click.UsageError("--i-know is about --host")
    opened = partial(_announce, no_browser=no_browser)
    if host is None:
        run_bench(Path.cwd(), target, port or 0, opened)
        return ExitCode.DONE
    check_host(host, i_know)
    password = Password(click.prompt("Password for this bench", hide_input=True, err=True))
    run_bench(Path.cwd(), target, port or 0, opened, host, password)
    return ExitCode.DONE


def _announce(address: str, no_browser: bool) -> None:
    tell(address)
    tell("Ctrl-C ends the bench; what was done is kept.", err=True)
    if not no_browser:
        import webbrowser

        webbrowser.open(address)
