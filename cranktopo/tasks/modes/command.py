"""`cranktopo modes`

Natural vibrations of the whole crankshaft: bending, torsion, axial; whirl over speed.
"""

from __future__ import annotations

from pathlib import Path
from typing import get_args

import click

from cranktopo.cli.options import CELL_MM, DEFAULT_DESIGN, SpeedRange, bearings_option, body_options, designs
from cranktopo.cli.output import tell
from cranktopo.cli.verbosity import verbosity_options


@click.command()
@click.argument("target", default=DEFAULT_DESIGN, shell_complete=designs)
@body_options
@bearings_option()
@click.option("--element-size-mm", type=CELL_MM, help="General element size.")
@click.option(
    "--speeds",
    "speeds_rpm",
    type=SpeedRange(),
    help="Speeds of the Campbell diagram; by default 21 over the design's range.",
)
@click.option(
    "--report",
    type=click.Path(dir_okay=False, path_type=Path),
    help="Write a page with Campbell diagram and shapes; HTML or Markdown.",
)
@click.option("--json", "as_json", is_flag=True, help="Print one JSON object.")
@verbosity_options
def command(
    target: str,
    design: str | None,
    align: bool,
    bearings: str,
    element_size_mm: float | None,
    speeds_rpm: list[float] | None,
    report: Path | None,
    as_json: bool,
) -> None:
    """Natural vibrations of TARGET's whole crankshaft on its bearings: frequencies, shapes, whirl over speed.

    The throws are elastic bodies with their mass; rods and pistons count with their mean mass, pulley,
    damper, flywheel and propeller of the design's [shaft] as rigid bodies.

    TARGET is a design, a run directory, or an STL or STEP file of the half throw (with --design).

    Example: cranktopo modes mikron-iiic --speeds 700:2800:31 --report modes.html
    """
    from cranktopo.base.notes import note
    from cranktopo.design.assumed import CARRIED
    from cranktopo.tasks.modes.stage import shaft_modes
    from cranktopo.tasks.modes.text import modes_text
    from cranktopo.tasks.shaft.assembly import Bearings
    from cranktopo.tasks.shaft.stage import shaft_tables
    from cranktopo.tasks.throw_fea.stage import print_assumed
    from cranktopo.tasks.throw_fea.targets import resolve_target

    resolved = resolve_target(target, design, align=align, whole=True, crank=True)
    support: Bearings = next(name for name in get_args(Bearings) if name == bearings)
    print_assumed([resolved], (*shaft_tables(resolved.scene, support), *CARRIED))
    note(f"{resolved.name}: condensing one throw")
    found = shaft_modes(resolved, support, element_size_mm, speeds_rpm=speeds_rpm or (), report=report)
    tell(found.as_json() if as_json else modes_text(found))
