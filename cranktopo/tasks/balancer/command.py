"""`cranktopo balancer`

A balancer shaft as a part: bearing loads and life, deflection, tilt, fatigue of its notches.
"""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

from cranktopo.base.formats import PLOTS
from cranktopo.base.notes import note
from cranktopo.cli.options import designs
from cranktopo.cli.output import tell
from cranktopo.cli.verbosity import verbosity_options

if TYPE_CHECKING:
    from cranktopo.design.schema import Scene
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
@click.option(
    "--drawing",
    type=click.Path(dir_okay=False, path_type=Path),
    metavar="FILE",
    help="Write the workshop drawing of the shaft, of its redesign with --redesign (.pdf, .svg or .png).",
)
@click.option("--json", "as_json", is_flag=True, help="Print one JSON object.")
@verbosity_options
def command(design: str, redesign: Path | None, drawing: Path | None, as_json: bool) -> None:
    """Balancer shaft of DESIGN on its bearings: forces, life, deflection, tilt, fatigue of grooves and holes.

    The shaft is [balancer]: its steps, the masses on it, its bearings, the gear that drives it. 'cranktopo
    balance' finds the balancer shafts that an engine needs.

    --redesign changes what has a range (free_diameter_mm, free_bore_mm, free_z_mm) and adds the bearings of
    [balancer.redesign]: least mass within the permitted deflection, no shorter life, no less safe notches.

    Example: cranktopo balancer balancer-shaft --redesign new-shaft.toml
    """
    from cranktopo.design.loading import load_scene
    from cranktopo.runs.destination import check_file
    from cranktopo.tasks.balancer.drawing import draw_balancer
    from cranktopo.tasks.balancer.stage import check_balancer
    from cranktopo.tasks.balancer.text import balancer_text

    if redesign is not None:
        check_file(redesign, "--redesign", (".toml",))
    if drawing is not None:
        check_file(drawing, "--drawing", PLOTS)
    scene = load_scene(design, whole=True)
    if redesign is None:
        found = check_balancer(scene)
    else:
        scene, found = _redesigned(design, scene, redesign)
    for remark in found.strength_remarks or ():
        note(f"{scene.name}: balancer shaft: material: {remark}")
    if drawing is not None:
        draw_balancer(scene, drawing)
        note(str(drawing))
    tell(found.as_json() if as_json else balancer_text(found))


def _redesigned(design: str, scene: Scene, file: Path) -> tuple[Scene, BalancerStrength]:
    """Write a redesign into the text of its design, with the comments of it; return it and its strength."""
    from cranktopo.base.files import write_text
    from cranktopo.design.edits import changed_text
    from cranktopo.design.writing import copy_of, design_name
    from cranktopo.tasks.balancer.redesign import changes_of, redesign_balancer

    scene, found = redesign_balancer(scene)
    write_text(file, changed_text(copy_of(design, file), changes_of(scene, found), str(file)))
    note(str(file))
    return scene.model_copy(update={"name": design_name(file)}), found
