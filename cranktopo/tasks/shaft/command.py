"""`cranktopo shaft`

Assemble the throws of a crankshaft: torsional stiffness, natural frequencies, openTorsion.
"""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, get_args

import click

from cranktopo.base.notes import note
from cranktopo.cli.options import CELL_MM, DEFAULT_DESIGN, bearings_option, body_options, designs
from cranktopo.cli.verbosity import verbosity_options

if TYPE_CHECKING:
    from cranktopo.tasks.shaft.assembly import Bearings
    from cranktopo.tasks.shaft.stage import ShaftEvaluation


@click.command()
@click.argument("target", default=DEFAULT_DESIGN, shell_complete=designs)
@body_options
@bearings_option
@click.option("--element-size-mm", type=CELL_MM, help="General element size.")
@click.option("--json", "as_json", is_flag=True, help="Print one JSON object, openTorsion's arguments in it.")
@verbosity_options
def command(
    target: str,
    design: str | None,
    align: bool,
    bearings: str,
    element_size_mm: float | None,
    as_json: bool,
) -> None:
    """Assemble the throws of TARGET to a shaft by firing order: torsional stiffness, natural frequencies.

    TARGET is a design, a run directory, or an STL or STEP file of the half throw (with --design).

    The error estimate comes from the mesh itself; it does not cover the disk model.

    Example: cranktopo shaft mikron-iiic --bearings free
    """
    from cranktopo.tasks.fea.stage import print_assumed
    from cranktopo.tasks.fea.targets import resolve_target
    from cranktopo.tasks.shaft.assembly import Bearings
    from cranktopo.tasks.shaft.stage import evaluate_shaft, shaft_tables

    resolved = resolve_target(target, design, align=align, whole=True, crank=True)
    support: Bearings = next(name for name in get_args(Bearings) if name == bearings)
    print_assumed([resolved], shaft_tables(resolved.scene, support))
    note(f"{resolved.name}: condensing one throw")
    shaft = evaluate_shaft(resolved, support, element_size_mm)
    click.echo(json.dumps(shaft.as_json(), indent=2) if as_json else _text(shaft))


def _text(shaft: ShaftEvaluation) -> str:
    from cranktopo.report.result_table import ResultTable, labelled, terminal

    throws = terminal(
        ResultTable(
            {"throw": 0, "angle_deg": 0, "torsion_kNm_per_rad": 2},
            tuple(
                {"throw": str(number), "angle_deg": angle, "torsion_kNm_per_rad": stiffness / 1000}
                for number, (angle, stiffness) in enumerate(
                    zip(shaft.throw_angles_deg, shaft.stiffness.throws_Nm_per_rad, strict=True), start=1
                )
            ),
        )
    )
    frequencies = ", ".join(f"{f:.0f}" for f in shaft.natural_frequencies_Hz)
    error = shaft.error_percent
    end = shaft.stiffness.end_to_end_Nm_per_rad / 1000
    rows = (
        (shaft.weighed, f"{shaft.mass_kg:.3f} kg"),
        (f"end to end, {shaft.bearings} bearings", f"{end:.2f} kN m/rad"),
        ("natural frequencies", f"{frequencies} Hz (shaft and moving masses alone, free ends)"),
    )
    return (
        f"{throws}\n\n{labelled(rows)}\n\n"
        f"stiffnesses +-{error:.2g} %, frequencies +-{error / 2:.2g} % at most"
    )
