"""`cranktopo import`

Turn a crank from CAD (STEP, STL) into a design: axes, throws, journals, webs.
"""

from __future__ import annotations

from pathlib import Path

import click

from cranktopo.cli.options import Choice
from cranktopo.cli.output import tell
from cranktopo.cli.verbosity import verbosity_options
from cranktopo.tasks.crank_import.choices import DEFAULT_MATERIAL, END_JOURNALS, UNITS, EndJournals, Unit


@click.command(name="import")
@click.argument("body", type=click.Path(path_type=Path, dir_okay=False))
@click.option(
    "--solid", metavar="NAME", help="Solid of an assembly; by default the one that looks like a crank."
)
@click.option("--name", metavar="N", help="Name of the design; by default that of the file.")
@click.option("--out", type=click.Path(path_type=Path, file_okay=False), help="New folder for all files.")
@click.option(
    "--end-journals",
    type=Choice(END_JOURNALS),
    default="auto",
    show_default=True,
    help="The outermost main journals: whole, or cut in their middle where a throw repeats.",
)
@click.option(
    "--material",
    metavar="NAME",
    default=DEFAULT_MATERIAL,
    show_default=True,
    help="Material, which a CAD file does not contain.",
)
@click.option(
    "--unit", type=Choice(UNITS), help="Unit of the numbers where the file has none, or a wrong one."
)
@click.option("--json", "as_json", is_flag=True, help="Print one JSON object.")
@verbosity_options
def command(
    body: Path,
    solid: str | None,
    name: str | None,
    out: Path | None,
    end_journals: EndJournals,
    material: str,
    unit: Unit | None,
    as_json: bool,
) -> None:
    """Recognise the crank in BODY in any attitude, and write a design of every distinct web.

    STEP (.step, .stp) and BREP have exact faces; to the triangles of STL, 3MF and OBJ, faces are fitted.

    Exact faces tell crank axis, main journals, crankpins, throws and angles, webs, fillets, bores and oil
    drillings. Each distinct half throw is cut and moved to the frame of a throw, unchanged: the
    original of its design. The page shows body and design over each other. Material and engine are lines to
    fill in.

    Example: cranktopo import crankshaft.step --name my-crank
    """
    from cranktopo.tasks.crank_import.stage import import_crank
    from cranktopo.tasks.crank_import.text import import_text

    found = import_crank(body, name, out, solid, end_journals, material, unit)
    tell(found.as_json() if as_json else import_text(found))
