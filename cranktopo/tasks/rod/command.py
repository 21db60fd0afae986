"""`cranktopo rod`

Strength of the connecting rod: masses, stresses, buckling, fatigue, piston pin, bolts.
"""

from __future__ import annotations

import json

import click

from cranktopo.cli.options import Choice, designs
from cranktopo.cli.verbosity import verbosity_options

_DESIGN = "mikron-iiic-rod"


@click.command(name="rod")
@click.argument("design", default=_DESIGN, shell_complete=designs)
@click.option(
    "--method",
    type=Choice(["lsa", "fkm"]),
    default="lsa",
    show_default=True,
    help="Fatigue by local stress analysis or by the FKM guideline.",
)
@click.option("--json", "as_json", is_flag=True, help="Print one JSON object.")
@verbosity_options
def command(design: str, method: str, as_json: bool) -> None:
    """Connecting rod of DESIGN: masses from its geometry, stresses over the cycle, buckling, pin and bolts.

    The rod is [rod]; its masses replace those of [engine.masses] in every command. `export --part rod` writes
    its solid.

    Example: cranktopo rod mikron-iiic-rod
    """
    from cranktopo.design.loading import load_scene
    from cranktopo.tasks.rod.stage import check_rod_strength
    from cranktopo.tasks.rod.text import rod_text

    found = check_rod_strength(load_scene(design, whole=True), method)
    click.echo(json.dumps(found.as_json(), indent=2) if as_json else rod_text(found))
