"""`cranktopo shaft`

The whole crankshaft: torsional stiffness, frequencies, all its bearings, safety of every fillet.
"""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, get_args

import click

from cranktopo.base.errors import CranktopoError, ExitCode
from cranktopo.base.notes import note
from cranktopo.cli.options import (
    CELL_MM,
    DEFAULT_DESIGN,
    Choice,
    CylinderNumber,
    Number,
    SpeedRange,
    bearings_option,
    body_options,
    designs,
)
from cranktopo.cli.output import tell
from cranktopo.cli.verbosity import verbosity_options
from cranktopo.tasks.fatigue.criteria import LOCAL_METHODS

if TYPE_CHECKING:
    from cranktopo.tasks.shaft.assembly import ShaftBearings


@click.command()
@click.argument("target", default=DEFAULT_DESIGN, shell_complete=designs)
@body_options
@bearings_option("clearance", "film")
@click.option("--element-size-mm", type=CELL_MM, help="General element size.")
@click.option(
    "--speeds",
    "speeds_rpm",
    type=SpeedRange(),
    help="Speeds of the cycle on all bearings instead of the engine's own; of a vibrating shaft, that of its "
    "largest torque between them is added.",
)
@click.option(
    "--method",
    type=Choice(tuple(LOCAL_METHODS)),
    help="Judge every fillet and outlet of every web over the cycle: local stress analysis or FKM.",
)
@click.option(
    "--fillet-fraction",
    type=Number(0.01, 0.5),
    help="With --method: element size in a fillet over its radius; by default 0.17.",
)
@click.option(
    "--report",
    type=click.Path(dir_okay=False, path_type=Path),
    help="Write a page with the safety of the webs, by lsa if no method is given; HTML or Markdown.",
)
@click.option(
    "--csv",
    "csv_path",
    type=click.Path(dir_okay=False, path_type=Path),
    help="Write bending, torque and forces in every web at every angle and speed.",
)
@click.option(
    "--misfire",
    "misfires",
    type=CylinderNumber(),
    multiple=True,
    help="A cylinder that does not fire over the cycle, in place of the design's; repeatable.",
)
@click.option(
    "--dynamic",
    is_flag=True,
    help="Also solve the vibration of the shaft with its mass: bending, torsion and axial motion together.",
)
@click.option("--json", "as_json", is_flag=True, help="Print one JSON object, openTorsion's arguments in it.")
@verbosity_options
def command(
    target: str,
    design: str | None,
    align: bool,
    bearings: str,
    element_size_mm: float | None,
    speeds_rpm: list[float] | None,
    method: str | None,
    fillet_fraction: float | None,
    report: Path | None,
    csv_path: Path | None,
    misfires: tuple[int, ...],
    dynamic: bool,
    as_json: bool,
) -> None:
    """The whole shaft of TARGET: torsional stiffness, frequencies, and what webs and main bearings carry.

    Its throws are assembled by firing order. With pressures, and bearings that are not free, the shaft
    stands on all its main bearings over the working cycle: with --bearings clearance with the play of
    [bearings], with --bearings film in its oil. With --method its mesh follows the fillets, and
    the safety of each part of each web is that of the worst point, crank angle and speed.
    With --dynamic all of it is told a second time, of the shaft that vibrates with its mass in rigid
    bearings, on springs or in oil films.

    TARGET is a design, a run directory, or an STL or STEP file of the half throw (with --design).

    The error estimate comes from the mesh itself; it does not cover the disk model.

    Example: cranktopo shaft mikron-iiic --bearings free
    """
    from cranktopo.design.assumed import FATIGUE
    from cranktopo.tasks.fatigue.taken_keys import assumed_by, note_unused
    from cranktopo.tasks.shaft.assembly import ShaftBearings
    from cranktopo.tasks.shaft.stage import shaft_tables, stands_on_bearings
    from cranktopo.tasks.shaft_safety.stage import assess_shaft
    from cranktopo.tasks.shaft_safety.text import shaft_text
    from cranktopo.tasks.throw_fatigue.stress_mesh import RULE_FRACTION
    from cranktopo.tasks.throw_fea.stage import print_assumed
    from cranktopo.tasks.throw_fea.targets import resolve_target

    method = method or ("lsa" if report is not None else None)
    resolved = resolve_target(target, design, fillets=method is not None, align=align, whole=True, crank=True)
    support: ShaftBearings = next(name for name in get_args(ShaftBearings) if name == bearings)
    loaded = stands_on_bearings(resolved.scene, support)
    needing = {
        "--speeds": speeds_rpm,
        "--method": method,
        "--misfire": misfires,
        "--csv": csv_path,
        "--dynamic": dynamic,
    }
    _check_loaded(loaded, [option for option, used in needing.items() if used])
    _check_options(method, element_size_mm, fillet_fraction)
    tables = shaft_tables(resolved.scene, support, loaded=loaded)
    if method:
        note_unused(resolved.name, resolved.scene.fatigue, (method,))
    taken = assumed_by(resolved.assumed, (method,) if method else ())
    print_assumed([replace(resolved, assumed=taken)], (*tables, FATIGUE))
    note(f"{resolved.name}: condensing one throw")
    shaft = assess_shaft(
        resolved,
        support,
        element_size_mm,
        speeds_rpm=speeds_rpm or (),
        method=method,
        fillet_fraction=fillet_fraction or RULE_FRACTION,
        misfire=misfires,
        report=report,
        csv=csv_path,
        dynamic=dynamic,
    )
    tell(shaft.as_json() if as_json else shaft_text(shaft))


def _check_loaded(loaded: bool, options: list[str]) -> None:
    """Refuse options that need forces on all bearings, where there are none."""
    from cranktopo.tasks.shaft.stage import not_on_bearings

    if options and not loaded:
        raise not_on_bearings(f"{options[0]}: the forces on all bearings need")


def _check_options(method: str | None, element_size_mm: float | None, fillet_fraction: float | None) -> None:
    """Refuse options that say nothing here."""
    if method and element_size_mm is not None:
        raise CranktopoError(
            "--element-size-mm: with --method the mesh follows the fillets.",
            hint="Give --fillet-fraction instead.",
            code=ExitCode.USAGE,
        )
    if fillet_fraction is not None and not method:
        raise CranktopoError(
            "--fillet-fraction: without --method no stress is asked for.",
            hint="Give --method too.",
            code=ExitCode.USAGE,
        )
