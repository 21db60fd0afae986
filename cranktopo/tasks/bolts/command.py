"""`cranktopo bolts`

Bolted joints by VDI 2230 and by Shigley: preload, torque, separation, fatigue.
"""

from __future__ import annotations

import click

from cranktopo.base.notes import note
from cranktopo.cli.options import designs
from cranktopo.cli.output import tell
from cranktopo.cli.verbosity import verbosity_options

_DESIGN = "mikron-iiic-rod"


@click.command(name="bolts")
@click.argument("design", default=_DESIGN, shell_complete=designs)
@click.option("--json", "as_json", is_flag=True, help="Print one JSON object.")
@verbosity_options
def command(design: str, as_json: bool) -> None:
    """Bolted joints of DESIGN: preload, tightening torque, stiffness, separation, fatigue, pressures.

    The joints are [[bolted_joint]], the bolts of [rod.bolt], which the engine's inertia loads, and those of
    [balancer.weight.bolt], which the mass that they hold loads.

    Example: cranktopo bolts mikron-iiic-rod
    """
    from cranktopo.design.assumed import assumed_text
    from cranktopo.design.loading import load_scene
    from cranktopo.tasks.bolts.stage import check_bolts
    from cranktopo.tasks.bolts.text import bolts_text

    checks = check_bolts(load_scene(design, whole=True))
    if checks.assumed:
        note(assumed_text(checks.assumed))
    tell(checks.as_json() if as_json else bolts_text(checks))
