"""`cranktopo extract`

Surface of a run, or of any iteration of it, as STL, 3MF or GLB.
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING

import click

from cranktopo.base.formats import SURFACES, SurfaceFormat
from cranktopo.cli.completion import runs
from cranktopo.cli.parameters import Choice
from cranktopo.cli.verbosity import detail, verbosity_options

if TYPE_CHECKING:
    from cranktopo.tasks.extraction.run import Extraction


@click.command("extract")
@click.argument("run", shell_complete=runs)
@click.option("--iteration", type=click.IntRange(min=1), help="Design of an earlier iteration.")
@click.option("--format", "form", type=Choice(SURFACES), help="Default: by the suffix of --out, or stl.")
@click.option("--out", type=click.Path(path_type=Path), help="File; default: RUN/surface/iteration-N.stl.")
@click.option("--force", is_flag=True, help="Replace an existing --out.")
@click.option("--json", "as_json", is_flag=True, help="Print one JSON object.")
@verbosity_options
def command(
    run: str, iteration: int | None, form: SurfaceFormat | None, out: Path | None, force: bool, as_json: bool
) -> None:
    """Extract the watertight surface of a design of RUN: binary STL or 3MF in mm, or GLB in metres.

    STL and 3MF are for CAD, printing and meshing. GLB is for showing it: browsers, phones and PowerPoint open
    it without any CAD program.

    Journals, pins and bores are exact cylinders, the volume is that of the density. Nothing is written
    unless the surface is closed, oriented, one body and within 0.5 % of its volume.

    Example: cranktopo extract 20250101-120000_mikron-iiic_0123abcd --iteration 12 --format 3mf
    """
    chosen = _format(form, out, force)
    from cranktopo.tasks.extraction.run import extract_surface

    detail(f"{run}: extracting the surface")
    found, path = extract_surface(run, iteration, out, chosen)
    if as_json:
        click.echo(json.dumps({"schema_version": 1, **found.as_json(), "files": {chosen: str(path)}}))
    else:
        click.echo(_text(found, path))


def _format(form: SurfaceFormat | None, out: Path | None, force: bool) -> SurfaceFormat:
    """The format that is asked for, by option or by the name of a file that can be written."""
    if out is None:
        return form or "stl"
    from cranktopo.runs.destination import check_file

    check_file(out, "--out", [f".{name}" for name in ((form,) if form else SURFACES)], replace=force)
    return next(name for name in SURFACES if out.suffix.lower() == f".{name}")


def _text(found: Extraction, path: Path) -> str:
    from cranktopo.tasks.extraction.run import LEAST_MEMBER_CELLS
    from cranktopo.tasks.extraction.undercut_table import undercut_text

    surface, report = found.surface, found.report
    lengths = {"thinnest member": found.minimum_member_mm, "narrowest gap": found.minimum_gap_mm}
    lines = [
        f"{found.run}, iteration {found.iteration}",
        f"web volume       {surface.volume_mm3:.0f} mm3, "
        f"{report.web_volume_error_percent:+.3f} % from the density's",
        f"mass             throw {found.throw_kg:.3f} kg, web {found.web_kg:.3f} kg",
        f"iso-value        {surface.iso_value:.4f}; distance of its surface {found.mean_distance_mm:.3f} mm "
        f"in the mean, {found.max_distance_mm:.3f} mm at most",
        *(
            f"{name:<17}{'none' if mm is None else f'{mm:.1f} mm, {found.in_cells(mm):.1f} cells'}"
            for name, mm in lengths.items()
        ),
        f"undercuts        {undercut_text(found.undercuts)}",
        f"surface          {report.faces} faces, closed, 1 body, {report.cavities} closed hollows, "
        f"{surface.dropped_islands} islands left out ({surface.dropped_volume_mm3:.0f} mm3)",
    ]
    if surface.fallback:
        lines.append(f"fallback         the usual surface was not sound: {surface.fallback}")
    cells = found.in_cells(found.minimum_member_mm)
    if cells is not None and cells < LEAST_MEMBER_CELLS:
        lines.append(f"warning: members thinner than {LEAST_MEMBER_CELLS:g} cells are not resolved")
    return "\n".join([*lines, str(path)])
