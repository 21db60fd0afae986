"""Sheet of the whole crank: all views, numbers of each distinct web, notes, title block of ISO 7200."""

from __future__ import annotations

import textwrap
from collections.abc import Sequence
from dataclasses import replace
from datetime import datetime
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

from cranktopo.base.errors import CranktopoError
from cranktopo.base.files import replacing
from cranktopo.base.notes import note
from cranktopo.base.reproducible import time_of_writing
from cranktopo.base.units import stem_and_unit
from cranktopo.design.crank_throws import is_split, straightened
from cranktopo.design.drawing import surface_notes
from cranktopo.design.halves import difference, web_asymmetry
from cranktopo.design.named import DesignLike, as_scene
from cranktopo.design.schema import Scene
from cranktopo.design.strength import strength_notes, treatment_notes
from cranktopo.engine.balance.crank import beyond_throws_kg
from cranktopo.engine.balance.throw import throw_balance
from cranktopo.report.drafting import THIN, number_mm
from cranktopo.report.dxf import write_dxf
from cranktopo.report.plot import save_figure, save_pages
from cranktopo.tasks.crank_drawing.balancing import balancing_notes
from cranktopo.tasks.crank_drawing.crank_shape import CrankShape, crank_shape, throw_solid
from cranktopo.tasks.crank_drawing.crank_views import (
    draw_end,
    draw_lengthwise,
    end_edges,
    end_room,
    lengthwise,
    lengthwise_room,
)
from cranktopo.tasks.crank_drawing.detail import Detail, details, draw_detail, mark_detail
from cranktopo.tasks.crank_drawing.end_views import end_blocks, end_views
from cranktopo.tasks.crank_drawing.layout import (
    TITLE_MM,
    SheetLayout,
    View,
    ViewBlock,
)
from cranktopo.tasks.crank_drawing.paper import Paper, sheet_figure
from cranktopo.tasks.crank_drawing.raw_crank import raw_crank_figure, raw_crank_shape
from cranktopo.tasks.drawing.sheet import beside_text, scale_text, table_lines, throw_sheets
from cranktopo.tasks.drawing.views import Sheet, cross_section, front_view, lengthwise_section

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_END_LETTERS = 56
"""Letters of a line on an end."""
_LETTERS = tuple(f"{first}{second}" for first in ("", *"KLMNPRSTUVWXYZ") for second in "KLMNPRSTUVWXYZ")
"""Letters of details, in order: K to Z, then KK to ZZ."""


def draw_crank(design: DesignLike, path: Path | str, started: datetime | None = None) -> tuple[str, float]:
    """Write the drawing of a crank (.pdf, .svg, .png or .dxf); return its sheet, such as A2, and scale.

    A PDF of a design with [forging] has a second page with the raw crank, of the same or another size.
    """
    import matplotlib as mpl

    scene, path = as_scene(design), Path(path)
    written, suffix, shape = time_of_writing(started), path.suffix.lower(), crank_shape(scene)
    raw = _raw_of(scene, shape, suffix)
    figure, found = crank_figure(scene, shape, written, "1/2" if raw else "1/1")
    with replacing(path) as temporary, mpl.rc_context({"svg.hashsalt": scene.name}):
        if suffix == ".dxf":
            write_dxf(figure, found.scale, temporary, written)
        elif raw:
            second, _ = raw_crank_figure(scene, shape, raw, written, finished_mass_kg(scene, shape))
            save_pages([figure, second], temporary, {"CreationDate": written})
        else:
            date = {".svg": {"Date": written.isoformat()}, ".pdf": {"CreationDate": written}}
            save_figure(figure, temporary, dpi=100, metadata=date.get(suffix))
    return found.sheet, found.scale


def _raw_of(scene: Scene, shape: CrankShape, suffix: str) -> CrankShape | None:
    """Return the raw crank for the second page; None where there is none, with a line where one could be."""
    if scene.forging is None:
        return None
    if suffix != ".pdf":
        note(f"a {suffix} file has one sheet, without the raw crank: a .pdf has both")
        return None
    try:
        return raw_crank_shape(scene, shape)
    except CranktopoError as error:
        note(f"the drawing has no sheet of the raw crank: {error.message}")
        return None


def crank_figure(
    scene: Scene, shape: CrankShape, written: datetime, number: str = "1/1"
) -> tuple[Figure, SheetLayout]:
    """Return the drawing of a crank as a figure, and its layout; `scene` has the material and the title.

    `number` is that of the sheet among all.
    """
    sheets = _distinct(shape)
    marked = _all_details([sheet for _, sheet in sheets])
    lines = [line for name, sheet in sheets for line in (name, *table_lines(sheet), "")]
    paper = Paper(
        scene=scene,
        shape=shape,
        lines=[*lines, *_end_lines(shape)],
        notes=_notes(scene, shape),
        title=f"{scene.name}: crankshaft",
        number=number,
        mass=_mass_text(scene, shape),
        webs=True,
        written=written,
    )
    return sheet_figure(paper, _blocks(shape, sheets, marked))


def _distinct(shape: CrankShape) -> list[tuple[str, Sheet]]:
    """Return each half throw that differs from those before, and where it is."""
    found: list[tuple[str, Sheet]] = []
    scenes = list(dict.fromkeys(throw.scene for throw in shape.throws))
    for scene in scenes:
        where = _places(
            [k for k, throw in enumerate(shape.throws, 1) if throw.scene == scene], len(scenes) == 1
        )
        straight = straightened(scene)
        if difference(scene):
            pair = throw_sheets(straight, throw=throw_solid(straight))
            first, second = (replace(sheet, placed=True) for sheet in pair)
            found += [(f"first web of {where}", first), (f"second web of {where}", second)]
        else:
            found.append((f"both webs of {where}", Sheet(straight, throw_solid(straight), placed=True)))
    return [(f"WEB {k}: {where}", sheet) for k, (where, sheet) in enumerate(found, 1)]


def _places(numbers: Sequence[int], alone: bool) -> str:
    """Return which throws these are: `all throws`, `throw 2`, `throws 1, 3 to 6`."""
    if alone and len(numbers) > 1:
        return "all throws"
    runs: list[list[int]] = []
    for number in numbers:
        if runs and runs[-1][-1] == number - 1:
            runs[-1].append(number)
        else:
            runs.append([number])
    words = [f"{run[0]} to {run[-1]}" if len(run) > 2 else ", ".join(map(str, run)) for run in runs]
    return f"throw{'s' * (len(numbers) > 1)} {', '.join(words)}"


def _all_details(sheets: Sequence[Sheet]) -> list[list[Detail]]:
    found: list[list[Detail]] = []
    for sheet in sheets:
        found.append(details(sheet, _LETTERS[sum(map(len, found)) :]))
    return found


def _blocks(
    shape: CrankShape, sheets: Sequence[tuple[str, Sheet]], marked: Sequence[Sequence[Detail]]
) -> Any:
    long, end, ends = lengthwise(shape), end_edges(shape), end_views(shape)

    def blocks(scale: float, web_scale: float) -> list[ViewBlock]:
        crank = View(
            lengthwise_room(shape, scale), lambda axes, s: draw_lengthwise(axes, shape, long, s), scale
        )
        seen = View(end_room(shape), lambda axes, s: draw_end(axes, shape, end, s), scale)
        found = [ViewBlock(((crank, (0.0, 0.0)),)), ViewBlock(((seen, (0.0, 0.0)),))]
        found += end_blocks(ends, web_scale)
        for (name, sheet), own in zip(sheets, marked, strict=True):
            found.append(_web_block(name, sheet, own, web_scale))
            found += [
                ViewBlock(((View(one.room, partial(_detail, one), one.scale), (0.0, 0.0)),)) for one in own
            ]
        return found

    return blocks


def _detail(detail: Detail, axes: Any, scale: float) -> None:
    draw_detail(axes, detail, scale)


def _web_block(name: str, sheet: Sheet, own: Sequence[Detail], scale: float) -> ViewBlock:
    """Front view, section through both axes beside it and its title, section across below."""
    front, _, across = (room.size_mm(scale) for room in sheet.rooms)
    up, title = across[1] + TITLE_MM, f"{name.capitalize()}, {scale_text(scale)}, from the crankpin"
    beside = max(front[0], number_mm(title))

    def section(axes: Any, s: float) -> None:
        lengthwise_section(axes, sheet, s)
        for detail in own:
            mark_detail(axes, detail, s)

    def named(axes: Any, s: float) -> None:
        front_view(axes, sheet, s)
        axes.set_title(title, fontsize=9, loc="left", color=THIN)

    views = (named, section, lambda axes, s: cross_section(axes, sheet, s))
    places = ((0.0, up), (beside, up), ((front[0] - across[0]) / 2 if front[0] > across[0] else 0.0, 0.0))
    drawn = (View(room, draw, scale) for room, draw in zip(sheet.rooms, views, strict=True))
    return ViewBlock(tuple(zip(drawn, places, strict=True)))


def _notes(scene: Scene, shape: CrankShape) -> list[str]:
    drawing, mass = scene.drawing, finished_mass_kg(scene, shape)
    notes = [
        "NOTES",
        *surface_notes(drawing),
        "A-B: axis of the outer main journals, on which it is measured.",
    ]
    notes += strength_notes(scene) + treatment_notes(scene)
    notes += balancing_notes(scene, mass)
    if any(web_asymmetry(throw.scene) and not difference(throw.scene) for throw in shape.throws):
        notes.append("A web drawn for both of a throw is the first; the second is its mirror image.")
    if is_split(scene):
        notes.append(_split_note(shape))
    if not shape.ends:
        notes.append("The shaft ends in the middle of its outer journals: the design has no ends.")
    return [*notes, *drawing.notes]


def _split_note(shape: CrankShape) -> str:
    near, far = shape.throws[0].half_angles_deg
    return (
        f"Split crankpins: half pins a and b of a throw, from the free end, lie {abs(far - near):g}° apart, "
        "each web in line with its own. Webs are drawn with their half pin alone."
    )


def _end_lines(shape: CrankShape) -> list[str]:
    """Return the steps of both ends with their dimensions, from the free end; its places are in the view."""
    lines = []
    for part in sorted(shape.end_parts, key=lambda one: min(one.z_mm)):
        step_values = part.step.model_dump(exclude={"length_mm", "file"}, exclude_defaults=True)
        kind = step_values.pop("kind").replace("_", " ")
        dimensions = ", ".join(
            f"{stem_and_unit(key)[0].replace('_', ' ')} {value}" for key, value in step_values.items()
        )
        lines += textwrap.wrap(
            f"{kind}, length {part.step.length_mm:g}, {dimensions}",
            _END_LETTERS,
            subsequent_indent="   ",
        )
    return ["ENDS of the crank, from the free end", *lines] if lines else []


def _mass_text(scene: Scene, shape: CrankShape) -> str:
    """Return the mass of what the crank's material makes, and of what is bolted on or let in beside it."""
    beside = sum(sum(throw_balance(throw.scene).bolted_kg) for throw in shape.throws)
    return f"{finished_mass_kg(scene, shape) - beside:.3f} kg{beside_text(beside)}"


def finished_mass_kg(scene: Scene, shape: CrankShape) -> float:
    """Return the mass of a crank without rods, ends included."""
    return beyond_throws_kg(scene) + sum(throw_balance(throw.scene).mass_kg for throw in shape.throws)
