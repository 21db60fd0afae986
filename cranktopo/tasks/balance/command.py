"""`cranktopo balance`

Balance of the whole engine: free forces and moments, counterweights, balancer shafts.
"""

from __future__ import annotations

from pathlib import Path

import click

from cranktopo.base.notes import note
from cranktopo.cli.options import DEFAULT_DESIGN, designs, share_of
from cranktopo.cli.output import tell
from cranktopo.cli.verbosity import verbosity_options


@click.command(name="balance")
@click.argument("design", default=DEFAULT_DESIGN, shell_complete=designs)
@click.option("--json", "as_json", is_flag=True, help="Print one JSON object.")
@click.option(
    "--report",
    "page",
    type=click.Path(path_type=Path, dir_okay=False),
    help="Also write a page with polar plots (.html), or Markdown with PNGs (.md).",
)
@click.option(
    "--propose",
    "share",
    metavar="SHARE",
    callback=share_of,
    help="Propose the counterweight of each web that balances this share of the oscillating mass, such as "
    "50%, in place of engine.arrangement.balanced_oscillating_share; 0%: the rotating masses alone. "
    "The halves of the throw must be alike.",
)
@verbosity_options
def command(design: str, as_json: bool, page: Path | None, share: float | None) -> None:
    """Balance of DESIGN's whole engine at its speed: free forces and moments by order, and their balancing.

    In line, V, W, boxer or radial, as [engine.arrangement] says. Counterweights of every web, for its throw
    and for the shaft; balance factor; bending moment inside the shaft; balancer shafts of the scene, or those
    that would be needed; loads of the main bearings over the cycle with and without counterweights.

    Example: cranktopo balance car-diesel --propose 50% --report balance.html
    """
    from cranktopo.design.assumed import assumed_text
    from cranktopo.design.loading import load_scene
    from cranktopo.engine.balance.whole_engine import engine_balance
    from cranktopo.report.report_file import check_report_path
    from cranktopo.tasks.balance.proposal import propose_counterweight, with_share
    from cranktopo.tasks.balance.result import balance_result
    from cranktopo.tasks.balance.stage import report_balance
    from cranktopo.tasks.balance.text import balance_text

    if page is not None:
        check_report_path(page)
    scene = load_scene(design, whole=True)
    proposal = None if share is None else propose_counterweight(scene, share)
    balance = engine_balance(scene if share is None else with_share(scene, share))
    if page is not None:
        report_balance(balance, page, proposal)
        note(f"report: {page}")
    data = balance_result(balance, proposal)
    tell(data.as_json() if as_json else balance_text(data))
    if data.assumed and not as_json:
        note(assumed_text(data.assumed))
