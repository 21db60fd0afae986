"""`cranktopo rod`

Strength of the connecting rod: masses, stresses, buckling, fatigue, piston pin, bolts.
"""

from __future__ import annotations

from pathlib import Path

import click

from cranktopo.base.errors import CranktopoError, ExitCode
from cranktopo.base.formats import DRAWINGS
from cranktopo.base.notes import note
from cranktopo.cli.options import CELL_MM, Choice, designs
from cranktopo.cli.output import tell
from cranktopo.cli.verbosity import verbosity_options
from cranktopo.tasks.fatigue.criteria import LOCAL_METHODS

_DESIGN = "mikron-iiic-rod"


@click.command(name="rod")
@click.argument("design", default=_DESIGN, shell_complete=designs)
@click.option(
    "--method",
    type=Choice(tuple(LOCAL_METHODS)),
    default="lsa",
    show_default=True,
    help="Fatigue by local stress analysis or by the FKM guideline.",
)
@click.option(
    "--lighter",
    type=click.Path(dir_okay=False, path_type=Path),
    metavar="FILE",
    help="Search a lighter rod at no less safety and write the design with it (.toml).",
)
@click.option(
    "--drawing",
    type=click.Path(dir_okay=False, path_type=Path),
    metavar="FILE",
    help="Write the workshop drawing, of the lighter rod with --lighter (.pdf, .svg, .png or .dxf).",
)
@click.option(
    "--fea", is_flag=True, help="Also compute stresses, safeties and ovalisation by finite elements."
)
@click.option("--element-size-mm", type=CELL_MM, help="With --fea: element size; by default by the volume.")
@click.option(
    "--contact", is_flag=True, help="With --fea: rigid pins touch the bores; else pressure is by the cosine."
)
@click.option(
    "--out",
    type=click.Path(path_type=Path),
    help="With --fea: folder for rod.json, picture and VTU file of the surface.",
)
@click.option("--json", "as_json", is_flag=True, help="Print one JSON object.")
@verbosity_options
def command(
    design: str,
    method: str,
    lighter: Path | None,
    drawing: Path | None,
    fea: bool,
    element_size_mm: float | None,
    contact: bool,
    out: Path | None,
    as_json: bool,
) -> None:
    """Connecting rod of DESIGN: masses from its geometry, stresses over the cycle, buckling, pin and bolts.

    The rod is [rod]; its masses replace those of [engine.masses] in every command. `export --part rod` writes
    its solid.

    With --fea a quarter of the rod, or a half where the split is oblique, is solved on curved tet10 elements,
    with pressure by the cosine in both eyes, or with --contact where rigid pins touch. A rod of --lighter is
    then no less safe by elements, too.

    Permitted ovalisation of both bores is [rod] small_end_ovalisation_um and big_end_ovalisation_um: a rod of
    --lighter keeps it. A drawing as DXF needs the extra `dxf`.

    Example: cranktopo rod mikron-iiic-rod-h --lighter lighter.toml
    """
    from cranktopo.design.assumed import assumed_text
    from cranktopo.design.loading import load_scene
    from cranktopo.design.writing import design_name, save_scene
    from cranktopo.report.dxf import check_dxf
    from cranktopo.runs.destination import check_file
    from cranktopo.tasks.fatigue.taken_keys import note_unused
    from cranktopo.tasks.rod.drawing import draw_rod
    from cranktopo.tasks.rod.lighter import lighten_rod
    from cranktopo.tasks.rod.stage import check_rod_strength
    from cranktopo.tasks.rod.text import rod_text

    fea_options = {"--element-size-mm": element_size_mm, "--contact": contact, "--out": out}
    for option in (name for name, value in fea_options.items() if value and not fea):
        raise CranktopoError(f"{option}: only with --fea.", hint="Add --fea.", code=ExitCode.USAGE)
    scene = load_scene(design, whole=True)
    if lighter is not None:
        check_file(lighter, "--lighter", (".toml",))
    if drawing is not None:
        check_file(drawing, "--drawing", DRAWINGS)
        check_dxf(drawing)
    if fea and lighter:
        from cranktopo.tasks.rod.element_search import lighten_rod_by_elements  # loads the solvers

        scene, found = lighten_rod_by_elements(scene, method, element_size_mm, contact, out)
    elif fea:
        from cranktopo.tasks.rod.element_stage import check_rod_elements  # loads the solvers

        found = check_rod_elements(scene, method, element_size_mm, contact, out)
    elif lighter:
        scene, searched = lighten_rod(scene, method)
        found = check_rod_strength(scene, method).model_copy(update={"lighter": searched})
    else:
        found = check_rod_strength(scene, method)
    note_unused(scene.name, scene.fatigue, (method,))
    for remark in found.strength_remarks or ():
        note(f"{scene.name}: rod: material: {remark}")
    if found.assumed:
        note(assumed_text(found.assumed))
    if lighter:
        scene = scene.model_copy(update={"name": design_name(lighter)})
        save_scene(scene, lighter)
        note(str(lighter))
    if drawing is not None:
        draw_rod(scene, drawing)
        note(str(drawing))
    tell(found.as_json() if as_json else rod_text(found))
