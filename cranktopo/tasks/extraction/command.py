"""`cranktopo extract`

Surface of a run, or of any iteration of it, as STL, 3MF or GLB.
"""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

from cranktopo.base.formats import SURFACES, SurfaceFormat
from cranktopo.base.notes import detail
from cranktopo.cli.options import Choice, runs
from cranktopo.cli.output import tell
from cranktopo.cli.verbosity import verbosity_options

if TYPE_CHECKING:
    from cranktopo.tasks.extraction.result import Extraction


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
    from cranktopo.tasks.extraction.stage import extract_surface

    detail(f"{run}: extracting the surface")
    found, path = extract_surface(run, iteration, out, chosen)
    tell(found.as_json() if as_json else _text(found, path), indent=None)


def _format(form: SurfaceFormat | None, out: Path | None, force: bool) -> SurfaceFormat:
    """Return the format that is asked for, by option or by the name of a file that can be written."""
    if out is None:
        if force:
            raise click.UsageError("--force is about --out: without it the run's own surface is written")
        return form or "stl"
    from cranktopo.runs.destination import check_file

    check_file(out, "--out", [f".{name}" for name in ((form,) if form else SURFACES)], replace=force)
    return next(name for name in SURFACES if out.suffix.lower() == f".{name}")


def _text(extraction: Extraction, path: Path) -> str:
    from cranktopo.report.result_table import labelled
    from cranktopo.tasks.extraction.result import LEAST_MEMBER_CELLS
    from cranktopo.tasks.extraction.text import undercut_text

    surface, masses, distance = (
        extraction.surface,
        extraction.mass_kg,
        extraction.surface.distance_to_iso_surface_mm,
    )
    lengths = (
        ("thinnest member", surface.minimum_member_mm, surface.minimum_member_cells),
        ("narrowest gap", surface.minimum_gap_mm, surface.minimum_gap_cells),
    )
    rows = [
        (
            "web volume",
            f"{surface.web_volume_mm3:.0f} mm3, {surface.web_volume_error_percent:+z.3f} % from the "
            "density's",
        ),
        ("mass", f"throw {masses.throw:.3f} kg, web {masses.web:.3f} kg"),
        (
            "iso-value",
            f"{surface.iso_value:.4f}; distance of its surface {distance.mean:.3f} mm in the mean, "
            f"{distance.max:.3f} mm at most",
        ),
        *((name, "none" if mm is None else f"{mm:.1f} mm, {cells:.1f} cells") for name, mm, cells in lengths),
        ("undercuts", undercut_text(surface.undercuts)),
        (
            "surface",
            f"{surface.faces} faces, closed, 1 body, {surface.cavities} closed hollows, "
            f"{surface.dropped_islands} islands left out ({surface.dropped_volume_mm3:.0f} mm3)",
        ),
    ]
    if surface.fallback:
        rows.append(("fallback", f"the usual surface was not sound: {surface.fallback}"))
    lines = [f"{extraction.run}, iteration {extraction.iteration}", labelled(rows)]
    cells = surface.minimum_member_cells
    if cells is not None and cells < LEAST_MEMBER_CELLS:
        lines.append(f"warning: members thinner than {LEAST_MEMBER_CELLS:g} cells are not resolved")
    return "\n".join([*lines, str(path)])
