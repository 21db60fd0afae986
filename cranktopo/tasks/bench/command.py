"""`cranktopo bench`

Open the bench: a local page on which a web is dragged, watched, compared and exported.
"""

from __future__ import annotations

from pathlib import Path

import click

from cranktopo.base.errors import ExitCode
from cranktopo.cli.options import designs_and_runs


@click.command("bench")
@click.argument("target", required=False, metavar="[DESIGN|RUN|BODY]", shell_complete=designs_and_runs)
@click.option("--port", type=click.IntRange(1024, 65535), help="Port on 127.0.0.1; default: a free one.")
@click.option("--no-browser", is_flag=True, help="Print the address alone.")
def command(target: str | None, port: int | None, no_browser: bool) -> ExitCode:
    """Open a page on this machine: drag a dimension, see what it does, keep variants, export.

    A DESIGN, the web of a RUN, or a crank from CAD (BODY, .step) is put on the bench; without one the page
    asks six questions. All that is done is kept in the folder `bench` and shown as commands. The page is for
    this machine alone: nothing is loaded from elsewhere, and the address holds a secret. Ctrl-C ends the
    bench; jobs go on.

    Example: cranktopo bench mikron-iiic --no-browser
    """
    from cranktopo.base.errors import packages_of

    with packages_of("bench"):
        import tornado.web  # noqa: F401
    from cranktopo.tasks.bench.stage import run_bench

    run_bench(Path.cwd(), target, port or 0, lambda address: _told(address, no_browser))
    return ExitCode.DONE


def _told(address: str, no_browser: bool) -> None:
    click.echo(address)
    click.echo("Ctrl-C ends the bench; what was done is kept.", err=True)
    if not no_browser:
        import webbrowser

        webbrowser.open(address)
