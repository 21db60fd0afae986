"""`cranktopo export`

Write the exact solid of a design as STEP or STL, its drawing, or the reduced model of its shaft.
"""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

from cranktopo.base.formats import ARRAYS, EXPORTS, PLOTS, SOLIDS, Exported, SolidPart
from cranktopo.base.notes import note
from cranktopo.cli.options import Choice, Number, designs, throw_option
from cranktopo.cli.output import tell
from cranktopo.cli.verbosity import verbosity_options

if TYPE_CHECKING:
    from cranktopo.design.schema import Scene


_DRAWN = ("throw", "raw")
"""Parts with a sheet of their own."""
_WHOLE = "cranktopo drawing DESIGN FILE draws the whole crank"
_ITS_SHEET = {
    "crankshaft": _WHOLE,
    "raw_crankshaft": f"{_WHOLE}, the raw one on page 2 of a PDF",
    "rod": "cranktopo rod DESIGN --drawing FILE draws it",
    "balancer": "cranktopo balancer DESIGN --drawing FILE draws it",
}
_ALL_THROWS = ("crankshaft", "raw_crankshaft", "reduced")
_NO_SHEET = "it has no workshop drawing of its own, only .step and .stl"


@click.command()
@click.argument("design", shell_complete=designs)
@click.argument("file", type=click.Path(path_type=Path, dir_okay=False))
@click.option("--part", type=Choice(EXPORTS), default="throw", show_default=True, help="What to write.")
@click.option(
    "--facet-mm",
    type=Number(0.01, 100),
    help="STL facets; by default 1 mm for journals of 42 to 84 mm, others in proportion.",
)
@throw_option
@click.option("--force", is_flag=True, help="Replace an existing file.")
@verbosity_options
def command(
    design: str, file: Path, part: Exported, facet_mm: float | None, throw: int | None, force: bool
) -> None:
    """Write the exact solid of DESIGN to FILE (.step or .stl), or its workshop drawing (.pdf, .svg or .png).

    The volume is checked against the closed form, and a STEP file is read back before it counts as written.
    The drawing is an A3 sheet at a true scale, dimensions in mm; of halves that differ, one each. With
    [forging] another one shows the raw part; --part raw draws that alone. A PDF has a page for each sheet.

    With --part reduced FILE (.npz) is the vibrating shaft as matrices over few coordinates, for other
    programs, with the stress on all fillets by them; its array `about` tells what each array is.

    Example: cranktopo export mikron-iiic throw.step
    """
    from cranktopo.design.assumed import THROW, assumed_text, assumptions
    from cranktopo.design.loading import load_scene
    from cranktopo.engine.one_throw import one_throw
    from cranktopo.runs.destination import check_file

    _check_ending(file.suffix.lower(), part)
    check_file(file, "file", ARRAYS if part == "reduced" else (*SOLIDS, *PLOTS), replace=force)
    _check_options(file.suffix.lower(), part, facet_mm)
    whole = part in _ALL_THROWS
    if whole and throw is not None:
        raise click.UsageError(f"--throw: --part {part} is all throws: leave it out")
    if part == "reduced":
        tell(f"{file}: reduced model of the shaft, {_reduced(design, file)}")
        return
    crank = load_scene(design, whole=True)
    scene = crank if whole else one_throw(crank, throw, all_fire=False)
    assumed = assumptions(scene, (THROW,))
    if assumed:
        note(assumed_text(assumed))
    if part in ("half", "throw"):
        from cranktopo.bodies.crank_drillings import crossing_words

        for words in filter(None, [crossing_words(scene)]):
            note(f"{scene.name}: {words}")
    if file.suffix.lower() in PLOTS:
        tell(f"{file}: workshop drawing, {_drawn(scene, file, part)}")
        return
    from cranktopo.bodies.solid.files import export_solid

    volume = export_solid(scene, part, file, facet_mm)
    beside = _bolted_words(scene, part, file.suffix.lower()) or _without_masses(scene, part)
    tell(f"{file}: {part}, {volume:.1f} mm3{_of_raw(scene, part)}{beside}")


def _reduced(design: str, file: Path) -> str:
    """Write the reduced model; return what it holds in words."""
    from cranktopo.design.assumed import CARRIED
    from cranktopo.tasks.export.reduced import export_reduced
    from cranktopo.tasks.shaft.stage import shaft_tables
    from cranktopo.tasks.throw_fea.stage import print_assumed
    from cranktopo.tasks.throw_fea.targets import resolve_target

    target = resolve_target(design, fillets=True, whole=True, crank=True)
    print_assumed([target], (*shaft_tables(target.scene, "spring"), *CARRIED))
    return export_reduced(target, file)


def _bolted_words(scene: Scene, part: SolidPart, suffix: str) -> str:
    """Return where the counterweights that are bolted to a part are; empty without any."""
    from cranktopo.bodies.solid.files import bolted_bodies

    if part not in ("throw", "half", "crankshaft") or not (names := bolted_bodies(scene, part)):
        return ""
    if suffix == ".stl" or part == "half":
        return "; without what is bolted on"
    return f"; {len(names)} bolted counterweights as bodies of their own"


def _without_masses(scene: Scene, part: SolidPart) -> str:
    """Return what the body of a balancer shaft lacks; its masses have an unbalance and no shape."""
    masses = scene.balancer is not None and scene.balancer.weight
    return (
        "; without its masses, of which only the unbalance is known" if part == "balancer" and masses else ""
    )


def _drawn(scene: Scene, file: Path, part: SolidPart) -> str:
    """Draw the throw, and its raw part where it has one, or that alone; return the sheets in words."""
    from cranktopo.tasks.drawing.raw_sheet import raw_pages, write_raw_drawing
    from cranktopo.tasks.drawing.sheet import export_drawing, throw_sheets

    if part == "raw":
        halves = write_raw_drawing(scene, file)
        return f"raw part, {_sheets_in_words(halves, 0, paged=file.suffix.lower() == '.pdf')}"
    sheets = throw_sheets(scene)
    more = raw_pages(scene, sheets)
    export_drawing(scene, file, sheets, more)
    return _sheets_in_words(len(sheets), len(more), paged=file.suffix.lower() == ".pdf")


def _sheets_in_words(finished: int, raw: int, *, paged: bool) -> str:
    if finished + raw == 1:
        return "A3"
    count = f"{finished + raw} {'pages A3' if paged else 'sheets A3 one below the other'}"
    last = {0: [], 1: ["the last of the raw part"], 2: ["the last two of the raw part"]}[raw]
    return ", ".join([count, *["one of each half"] * (finished == 2), *last])


def _of_raw(scene: Scene, part: SolidPart) -> str:
    """Return the masses of a raw part, and what is machined out of it; nothing of other parts."""
    from cranktopo.bodies.raw_crankshaft import machined_out_of_crank, parting_text, raw_crank_mass_kg
    from cranktopo.bodies.raw_part import machined_out, raw_mass_kg
    from cranktopo.engine.balance.crank import drawn_crank_mass
    from cranktopo.engine.balance.throw import throw_balance

    if part == "raw":
        raw_kg, finished_kg = raw_mass_kg(scene), throw_balance(scene).mass_kg
        cut, plane = machined_out(scene), ""
    elif part == "raw_crankshaft":
        raw_kg, finished_kg = raw_crank_mass_kg(scene), drawn_crank_mass(scene).mass_kg
        cut, plane = machined_out_of_crank(scene), f"; {parting_text(scene.shaft_angles_deg)}"
    else:
        return ""
    masses = f"{raw_kg:.3f} kg; finished {finished_kg:.3f} kg, {finished_kg / raw_kg:.1%} of it"
    return f", {masses}; machined out of the full: {', '.join(cut) or 'nothing'}{plane}"


def _check_ending(suffix: str, part: Exported) -> None:
    if suffix in ARRAYS and part != "reduced":
        raise click.UsageError(f"--part {part}: {suffix} is for --part reduced: give that, or another ending")


def _check_options(suffix: str, part: Exported, facet_mm: float | None) -> None:
    if facet_mm is not None and suffix != ".stl":
        raise click.UsageError(f"--facet-mm is the size of STL facets, and {suffix} has none: leave it out")
    if part not in _DRAWN and suffix in PLOTS:
        raise click.UsageError(
            f"--part {part}: {_ITS_SHEET.get(part, _NO_SHEET)}; export draws the throw with its web, or with "
            "--part raw its raw part"
        )
