"""`cranktopo export`: STEP and STL of a design's exact solid, and its workshop drawing."""

from __future__ import annotations

from pathlib import Path

import click

from cranktopo.cli.completion import designs
from cranktopo.cli.parameters import Choice, Number
from cranktopo.formats import PARTS, PLOTS, SOLIDS, SolidPart


@click.command()
@click.argument("design", shell_complete=designs)
@click.argument("file", type=click.Path(path_type=Path, dir_okay=False))
@click.option("--part", type=Choice(PARTS), default="throw", show_default=True, help="What to write.")
@click.option(
    "--facet-mm",
    type=Number(0.01, 100),
    help="STL facets; by default 1 mm for journals of 42 to 84 mm, others in proportion.",
)
@click.option("--force", is_flag=True, help="Replace an existing file.")
def command(design: str, file: Path, part: SolidPart, facet_mm: float | None, force: bool) -> None:
    """Write the exact solid of DESIGN to FILE (.step or .stl), or its workshop drawing (.pdf, .svg or .png).

    The volume is checked against the closed form, and a STEP file is read back before it counts as written.
    The drawing is an A3 sheet at a true scale, dimensions in mm; of halves that differ, one each.

    Example: cranktopo export mikron-iiic throw.step
    """
    from cranktopo.scene import load_scene
    from cranktopo.scene.assumed import THROW, assumed_text, assumptions
    from cranktopo.store import check_file

    check_file(file, "file", (*SOLIDS, *PLOTS), replace=force)
    scene = load_scene(design, whole=True)
    assumed = assumptions(scene, (THROW,))
    if assumed:
        click.echo(assumed_text(assumed), err=True)
    if file.suffix.lower() in PLOTS:
        from cranktopo.pipeline.drawing_file import export_drawing

        sheets = export_drawing(scene, file)
        click.echo(f"{file}: workshop drawing, {'A3' if sheets == 1 else 'A2: two sheets A3, one half each'}")
        return
    from cranktopo.cad.solid_files import export_solid

    volume = export_solid(scene, part, file, facet_mm)
    click.echo(f"{file}: {part}, {volume:.1f} mm3")
