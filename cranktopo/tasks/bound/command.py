"""`cranktopo bound`

What no web of the envelope can beat, whatever its topology: proven, for a goal and limits.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import click

from cranktopo.base.errors import ExitCode
from cranktopo.cli.options import (
    CELL_MM,
    DEFAULT_DESIGN,
    designs,
    goal_options,
    throw_option,
    web_option,
    with_goal_options,
)
from cranktopo.cli.output import tell
from cranktopo.cli.verbosity import verbosity_options

if TYPE_CHECKING:
    from cranktopo.design.halves import WebName


@click.command("bound")
@click.argument("design", required=False, shell_complete=designs)
@web_option
@throw_option
@goal_options
@click.option("--resolution-mm", type=CELL_MM, help="Largest cell edge, mm; default: the design's.")
@click.option("--json", "as_json", is_flag=True, help="Print one JSON object.")
@verbosity_options
def command(
    design: str | None,
    web: WebName | None,
    throw: int | None,
    minimise: str | None,
    maximise: str | None,
    limits: tuple[str, ...],
    resolution_mm: float | None,
    as_json: bool,
) -> ExitCode:
    """Prove what no web of DESIGN's envelope can beat, whatever its topology, for a goal and limits.

    The proof is about the optimiser's cells: every density between 0 and 1 in each of them counts as a web.
    Limits that it cannot hold, such as fatigue safety, are left out; a line says so. This
    only makes the bound looser. Without a goal it is that of the smallest mass at both original stiffnesses.

    Example: cranktopo bound mikron-iiic --maximise torsion --limit "mass <= 95 %"
    """
    from cranktopo.design.loading import load_scene, one_web
    from cranktopo.engine.one_throw import one_throw
    from cranktopo.tasks.bound.stage import bound_of
    from cranktopo.tasks.bound.text import bound_summary

    scene = one_web(one_throw(load_scene(design or DEFAULT_DESIGN, whole=True), throw), web)
    if scene.goal is None and minimise is None and maximise is None:
        minimise = "mass"
    scene = with_goal_options(scene, minimise, maximise, limits)
    found = bound_of(scene, resolution_mm)
    tell(found.as_json() if as_json else bound_summary(found), indent=None)
    return ExitCode.DONE if found.bound.possible else ExitCode.CRITERION_NOT_MET
