"""`cranktopo drawing`

Draw the whole crank for the workshop: PDF, SVG or DXF.
"""

from __future__ import annotations

from pathlib import Path

import click

from cranktopo.base.formats import DRAWINGS
from cranktopo.base.notes import note
from cranktopo.cli.options import designs
from cranktopo.cli.output import tell
from cranktopo.cli.verbosity import verbosity_options


@click.command()
@click.argument("design", shell_complete=designs)
@click.argument("file", type=click.Path(path_type=Path, dir_okay=False))
@click.option("--force", is_flag=True, help="Replace an existing file.")
@verbosity_options
def command(design: str, file: Path, force: bool) -> None:
    """Write the workshop drawing of the whole crank of DESIGN to FILE (.pdf, .svg, .png or .dxf).

    One sheet, A3 to A0: the crank half in section, from its free end, every distinct web with its sections,
    fillets magnified, fits and tolerances from [drawing]. With [forging] a PDF has a second page, the raw
    crank. DXF needs the extra `dxf`.

    Example: cranktopo drawing mikron-iiic crank.pdf
    """
    from cranktopo.design.assumed import THROW, assumed_text, assumptions
    from cranktopo.design.loading import load_scene
    from cranktopo.report.dxf import check_dxf
    from cranktopo.runs.destination import check_file
    from cranktopo.tasks.crank_drawing.sheet import draw_crank
    from cranktopo.tasks.drawing.sheet import scale_text

    check_file(file, "file", DRAWINGS, replace=force)
    check_dxf(file)
    scene = load_scene(design, whole=True)
    assumed = assumptions(scene, (THROW,))
    if assumed:
        note(assumed_text(assumed))
    sheet, scale = draw_crank(scene, file)
    tell(f"{file}: workshop drawing of the crank, {sheet}, {scale_text(scale)}")
