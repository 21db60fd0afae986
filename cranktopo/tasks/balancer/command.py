"""`cranktopo balancer`

A balancer shaft as a part: bearing loads and life, deflection, tilt, fatigue of its notches.
"""

from __future__ import annotations

import json

import click

from cranktopo.cli.options import designs
from cranktopo.cli.verbosity import verbosity_options

_DESIGN = "balancer-shaft"


@click.command(name="balancer")
@click.argument("design", default=_DESIGN, shell_complete=designs)
@click.option("--json", "as_json", is_flag=True, help="Print one JSON object.")
@verbosity_options
def command(design: str, as_json: bool) -> None:
    """Balancer shaft of DESIGN on its bearings: forces, life, deflection, tilt, fatigue of grooves and holes.

    The shaft is [balancer]: its steps, the masses on it, its bearings, the gear that drives it. What an
    engine needs of balancer shafts is told by 'cranktopo balance'.

    Example: cranktopo balancer balancer-shaft
    """
    from cranktopo.design.loading import load_scene
    from cranktopo.tasks.balancer.stage import check_balancer
    from cranktopo.tasks.balancer.text import balancer_text

    found = check_balancer(load_scene(design, whole=True))
    click.echo(json.dumps(found.as_json(), indent=2) if as_json else balancer_text(found))
