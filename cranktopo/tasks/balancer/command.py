"""`cranktopo balancer`

A balancer shaft as a part: bearing loads and life, deflection, tilt, fatigue of its notches.
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING

import click

from cranktopo.base.notes import note
from cranktopo.cli.options import designs
from cranktopo.cli.verbosity import verbosity_options

if TYPE_CHECKING:
    from cranktopo.tasks.balancer.result import BalancerStrength

_DESIGN = "balancer-shaft"


@click.command(name="balancer")
@click.argument("design", default=_DESIGN, shell_complete=designs)
@click.option(
    "--redesign",
    type=click.Path(dir_okay=False, path_type=Path),
    metavar="FILE",
    help="Search the lightest shaft within the ranges of the design and write the design with it (.toml).",
)
@click.option("--json", "as_json", is_flag=True, help="Print one JSON object.")
@verbosity_options
def command(design: str, redesign: Path | None, as_json: bool) -> None:
    """Balancer shaft of DESIGN on its bearings: forces, life, deflection, tilt, fatigue of grooves and holes.

    The shaft is [balancer]: its steps, the masses on it, its bearings, the gear that drives it. What an
    engine needs of balancer shafts is told by 'cranktopo balance'.

    --redesign changes what has a range (free_diameter_mm, free_bore_mm, free_z_mm) and adds the bearings of
    [balancer.redesign]: least mass with the deflection that is wanted, no shorter life, no less safe notches.

    Example: cranktopo balancer balancer-shaft --redesign new-shaft.toml
    """
    from cranktopo.design.loading import load_scene
    from cranktopo.runs.destination import check_file
    from cranktopo.tasks.balancer.stage import check_balancer
    from cranktopo.tasks.balancer.text import balancer_text

    if redesign is None:
        found = check_balancer(load_scene(design, whole=True))
    else:
        check_file(redesign, "--redesign", (".toml",))
        found = _redesigned(design, redesign)
    click.echo(json.dumps(found.as_json(), indent=2) if as_json else balancer_text(found))


def _redesigned(design: str, file: Path) -> BalancerStrength:
    """Write a redesign into the text of its design, with the comments of it; return its strength."""
    from cranktopo.base.files import write_text
    from cranktopo.design.edits import changed_text
    from cranktopo.design.loading import load_scene
    from cranktopo.design.writing import copy_of
    from cranktopo.tasks.balancer.redesign import changes_of, redesign_balancer

    scene, found = redesign_balancer(load_scene(design, whole=True))
    write_text(file, changed_text(copy_of(design, file), changes_of(scene, found), str(file)))
    note(str(file))
    return found
