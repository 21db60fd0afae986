"""`cranktopo export`: STEP and STL of a design's exact solid."""

from __future__ import annotations

from pathlib import Path

import click

from cranktopo.cli.completion import designs
from cranktopo.cli.parameters import Choice, Number
from cranktopo.formats import PARTS, SOLIDS, SolidPart


@click.command()
@click.argument("design", shell_complete=designs)
@click.argument("file", type=click.Path(path_type=Path, dir_okay=False))
@click.option("--part", type=Choice(PARTS), default="throw", show_default=True, help="What to write.")
@click.option("--facet-mm", type=Number(0.1, 100), default=1.0, show_default=True, help="STL facets.")
@click.option("--force", is_flag=True, help="Replace an existing file.")
def command(design: str, file: Path, part: SolidPart, facet_mm: float, force: bool) -> None:
    """Write the exact solid of DESIGN to FILE (.step or .stl), mm.

    The volume is checked against the closed form, and a STEP file is read back before it counts as written.

    Example: cranktopo export mikron-iiic throw.step
    """
    from cranktopo.cad.solid_files import export_solid
    from cranktopo.scene import load_scene
    from cranktopo.store import check_file

    check_file(file, "file", SOLIDS, replace=force)
    volume = export_solid(load_scene(design), part, file, facet_mm)
    click.echo(f"{file}: {part}, {volume:.1f} mm3")
