"""`cranktopo designs`

List the built-in designs, copy one to edit, or begin a new one with every key.
"""

from __future__ import annotations

import shlex
from pathlib import Path
from typing import TYPE_CHECKING

import click

from cranktopo.base.formats import PLOTS
from cranktopo.cli.group import SuggestingGroup
from cranktopo.cli.options import Choice, Number
from cranktopo.cli.options import designs as complete_designs
from cranktopo.cli.output import tell
from cranktopo.design.reference import SKETCHES

if TYPE_CHECKING:
    from cranktopo.design.starting_point import LayoutName

_FILE = click.argument("file", type=click.Path(path_type=Path, dir_okay=False))
_FORCE = click.option("--force", is_flag=True, help="Replace an existing file.")


@click.group("designs", cls=SuggestingGroup, invoke_without_command=True)
@click.pass_context
def command(context: click.Context) -> None:
    """List the built-in designs, which is the default, copy one to edit, or begin a new one.

    Example: cranktopo designs copy mikron-iiic my-engine.toml
    """
    if context.invoked_subcommand is None:
        context.invoke(list_command)


@command.command("list")
@click.option("--json", "as_json", is_flag=True, help="Print one JSON object.")
def list_command(as_json: bool) -> None:
    """List the built-in designs.

    Example: cranktopo designs list
    """
    from cranktopo.design.loading import builtin_designs, load_scene

    found = {name: load_scene(name).description for name in builtin_designs()}
    if as_json:
        from cranktopo.tasks.designs.result import DesignList, ListedDesign

        designs = tuple(ListedDesign(name=name, description=text) for name, text in found.items())
        tell(DesignList(designs=designs).as_json())
        return
    from cranktopo.report.result_table import labelled

    tell(labelled(list(found.items())))


@command.command("copy")
@click.argument("design", shell_complete=complete_designs)
@_FILE
@_FORCE
def copy_command(design: str, file: Path, force: bool) -> None:
    """Copy DESIGN to FILE (.toml), named after the file: edit it, then give it to any command.

    The copy finds the files that the design names. What was published about the original stays behind,
    because it does not hold for the copy.

    Example: cranktopo designs copy mikron-iiic my-engine.toml
    """
    from cranktopo.base.files import write_text
    from cranktopo.design.writing import copy_of
    from cranktopo.runs.destination import check_file

    check_file(file, "file", (".toml",), replace=force)
    write_text(file, copy_of(design, file))
    example = shlex.join(["cranktopo", "compare", str(file), "--baseline", design])
    tell(f"{file}: edit it, then for example: {example}")


@command.command("pair")
@click.argument("design", shell_complete=complete_designs)
@_FILE
@click.option("--first", metavar="TARGET", help="Design, or run, whose web becomes [web].")
@click.option("--second", metavar="TARGET", help="Design, or run, whose web becomes [second_web].")
@_FORCE
def pair_command(design: str, file: Path, first: str | None, second: str | None, force: bool) -> None:
    """Copy DESIGN to FILE (.toml) with two webs that were found one by one, by `--web` of the optimisers.

    A run gives its web: of shape its result, of iterate its best step, of optimise its re-model. Its journals
    must be those of DESIGN but for their lengths, which are taken over.

    Example: cranktopo designs pair two-webs.toml pair.toml --first runs/one --second runs/other
    """
    from cranktopo.base.files import write_text
    from cranktopo.design.writing import pair_text
    from cranktopo.runs.destination import check_file
    from cranktopo.tasks.designs.run_webs import parametric_scene, web_target

    if first is None and second is None:
        raise click.UsageError("give --first, --second or both: without them nothing changes")
    check_file(file, "file", (".toml",), replace=force)
    webs = [None if text is None else parametric_scene(text, web_target(text)) for text in (first, second)]
    write_text(file, pair_text(design, file, *webs))
    tell(f"{file}: {shlex.join(['cranktopo', 'evaluate', str(file)])}")


@command.command("sketch")
@click.argument("part", type=Choice(list(SKETCHES.values())))
@_FILE
@_FORCE
def sketch_command(part: str, file: Path, force: bool) -> None:
    """Draw the dimensions of a part of the throw under the names of their keys (.svg, .pdf or .png).

    PART is throw, web (all outlines), bevel, pocket, counterweight, drilling or crank (its ends).

    Example: cranktopo designs sketch counterweight counterweight.svg
    """
    from cranktopo.runs.destination import check_file
    from cranktopo.tasks.drawing.sketch import write_sketch

    check_file(file, "file", PLOTS, replace=force)
    write_sketch(part, file)
    tell(str(file))


@command.command("new")
@_FILE
@click.option("--name", help="Name of the design; the file's by default.")
@click.option(
    "--layout",
    type=Choice(["single", "in-line", "V", "W", "boxer", "radial"]),
    help="Begin with an engine of this layout: usual proportions, firing order and throw angles.",
)
@click.option("--cylinders", type=click.IntRange(1, 48), help="Its cylinders, in line without --layout.")
@click.option(
    "--bore-mm", type=Number(5, 1500), help="Its bore, which all proportions follow.  [default: 80]"
)
@click.option("--stroke-mm", type=Number(5, 5000), help="Its stroke; the bore by default.")
@click.option("--speed-rpm", type=Number(1, 30000), help="Its speed; by default for 10 m/s of the piston.")
@click.option(
    "--rod-length-mm", type=Number(5, 10000), help="Length of its rods; 3.5 throw radii by default."
)
@click.option(
    "--peak-pressure-MPa", "peak_pressure_MPa", type=Number(0.5, 40), help="Its peak pressure; 7 by default."
)
@click.option(
    "--power-kW",
    "power_kW",
    type=Number(0.01, 1e6),
    help="Its indicated power: gives the pressures, and compression and burning where they must be others.",
)
@click.option("--compression-ratio", type=Number(1.5, 40), help="Its compression ratio; 9 by default.")
@click.option(
    "--bank-angle-deg",
    type=Number(1, 180),
    help="Angle between the banks of a V, on the throws of its usual crank.  [default: usual]",
)
@click.option("--material", help="Name of a material of the library.")
@_FORCE
def new_command(
    file: Path,
    name: str | None,
    layout: LayoutName | None,
    cylinders: int | None,
    bore_mm: float | None,
    stroke_mm: float | None,
    force: bool,
    **known: float | str | None,
) -> None:
    """Write FILE (.toml), a design with every key: meaning, unit, range and default.

    It is valid as it stands: replace the values, switch on what the engine needs. With anything known of its
    engine it has one, whose other values are usual proportions, all assumed; their strength is not checked.

    Example: cranktopo designs new my-engine.toml --layout V --cylinders 8 --bore-mm 86
    """
    from cranktopo.base.files import write_text
    from cranktopo.design.loading import parse_scene
    from cranktopo.design.reference import template
    from cranktopo.design.starting_point import USUAL_CYLINDERS
    from cranktopo.design.strength import strength_remarks
    from cranktopo.design.writing import design_name
    from cranktopo.runs.destination import check_file
    from cranktopo.tasks.designs.beginning import begun

    check_file(file, "file", (".toml",), replace=force)
    title = name or design_name(file)
    remarks: tuple[str, ...] = ()
    if all(value is None for value in (layout, cylinders, bore_mm, stroke_mm, *known.values())):
        text = template(title)
        parse_scene(text, str(file))
    else:
        layout = layout or ("in-line" if (cylinders or 1) > 1 else "single")
        size = bore_mm or 80.0
        count = cylinders or USUAL_CYLINDERS[layout]
        beginning = begun(title, layout, count, size, stroke_mm or size, known)
        text, doubtful = beginning.text, map("warning: {}.".format, beginning.warnings)
        remarks = (
            *beginning.assumed,
            *doubtful,
            *map("material: {}.".format, strength_remarks(beginning.scene)),
        )
    write_text(file, text)
    for line in remarks:
        tell(line)
    tell(f"{file}: edit it, then for example: {shlex.join(['cranktopo', 'plan', str(file)])}")
