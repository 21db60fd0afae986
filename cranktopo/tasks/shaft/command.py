"""`cranktopo shaft`

Assemble the throws of a crankshaft: torsional stiffness, natural frequencies, openTorsion.
"""

from __future__ import annotations

import json
import math
from typing import TYPE_CHECKING, Any, get_args

import click

from cranktopo.base.errors import CranktopoError, ExitCode, decimal_comma, quoted
from cranktopo.base.notes import note
from cranktopo.cli.options import CELL_MM, DEFAULT_DESIGN, bearings_option, body_options, designs
from cranktopo.cli.verbosity import verbosity_options

if TYPE_CHECKING:
    from cranktopo.tasks.shaft.assembly import Bearings


class SpeedRange(click.ParamType[list[float]]):
    """Speeds (rpm) at even steps: both ends and how many."""

    name = "FROM:TO:NUMBER"
    most = 1000

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> list[float]:
        """Return the speeds; fails with the allowed form."""
        low, high, number = [*str(value).split(":"), "", ""][:3]
        try:
            start, stop, count = float(low), float(high), int(number)
            if 0 < start < stop < math.inf and 2 <= count <= self.most and str(value).count(":") == 2:
                return [start + index * (stop - start) / (count - 1) for index in range(count)]
        except ValueError:
            pass
        form = f"must be FROM:TO:NUMBER with 0 < FROM < TO in rpm and 2 to {self.most} speeds"
        self.fail(f"{quoted(str(value))}: {form}. {decimal_comma(str(value))}".rstrip(), param, ctx)


@click.command()
@click.argument("target", default=DEFAULT_DESIGN, shell_complete=designs)
@body_options
@bearings_option
@click.option("--element-size-mm", type=CELL_MM, help="General element size.")
@click.option(
    "--speeds",
    "speeds_rpm",
    type=SpeedRange(),
    help="Speeds of the cycle on all bearings instead of the engine's own.",
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
    as_json: bool,
) -> None:
    """The whole shaft of TARGET: torsional stiffness, frequencies, and what webs and main bearings carry.

    Its throws are assembled by firing order. With pressures, and bearings that are not free, the shaft
    stands on all its main bearings over the working cycle.

    TARGET is a design, a run directory, or an STL or STEP file of the half throw (with --design).

    The error estimate comes from the mesh itself; it does not cover the disk model.

    Example: cranktopo shaft mikron-iiic --bearings free
    """
    from cranktopo.tasks.fea.stage import print_assumed
    from cranktopo.tasks.fea.targets import resolve_target
    from cranktopo.tasks.shaft.assembly import Bearings
    from cranktopo.tasks.shaft.stage import evaluate_shaft, shaft_tables, stands_on_bearings
    from cranktopo.tasks.shaft.text import shaft_text

    resolved = resolve_target(target, design, align=align, whole=True, crank=True)
    support: Bearings = next(name for name in get_args(Bearings) if name == bearings)
    loaded = stands_on_bearings(resolved.scene, support)
    if speeds_rpm and not loaded:
        raise CranktopoError(
            "--speeds: the forces on all bearings need [engine.gas], and bearings that are not free.",
            hint="Leave it out, or choose --bearings rigid or spring.",
            code=ExitCode.USAGE,
        )
    print_assumed([resolved], shaft_tables(resolved.scene, support, loaded=loaded))
    note(f"{resolved.name}: condensing one throw")
    shaft = evaluate_shaft(resolved, support, element_size_mm, speeds_rpm=speeds_rpm or ())
    click.echo(json.dumps(shaft.as_json(), indent=2) if as_json else shaft_text(shaft))
