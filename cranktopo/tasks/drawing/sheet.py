"""Workshop drawing of a throw: views at a true scale on A3, title block, tolerances, table of dimensions.

A throw whose halves differ has two sheets, one above the other on A2.

Lengths are in mm. The projection is first angle (ISO 5456-2), the title block holds the fields of ISO 7200,
general tolerances are those of ISO 2768.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from datetime import datetime
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

from cranktopo.base.files import replacing
from cranktopo.base.frames import about_z_deg
from cranktopo.base.reproducible import time_of_writing
from cranktopo.base.units import MM_PER_INCH
from cranktopo.bodies.prisms import thread_holes
from cranktopo.bodies.solid.files import cut_in_halves, kernel_surface_of
from cranktopo.design.crank_throws import half_turns_deg, is_split
from cranktopo.design.drawing import surface_notes
from cranktopo.design.halves import difference, halves, mirror_image, web_asymmetry
from cranktopo.design.schema import Scene
from cranktopo.design.strength import strength_notes, treatment_notes
from cranktopo.engine.balance.throw import ThrowBalance, throw_balance
from cranktopo.numerics.surfaces.mesh import SurfaceMesh, solid_of
from cranktopo.report.drafting import GHOST, INK, TEXT_SIZE, folded, frame, projection_symbol
from cranktopo.report.dxf import write_dxf
from cranktopo.report.plot import save_figure, save_pages
from cranktopo.tasks.drawing.half_pin import split_lines, split_notes
from cranktopo.tasks.drawing.views import Room, Sheet, cross_section, front_view, lengthwise_section
from cranktopo.throw.journal import Journal
from cranktopo.throw.profile import ProfileWeb

if TYPE_CHECKING:
    from manifold3d import Manifold
    from matplotlib.figure import Figure, SubFigure


_WIDTH_MM, _HEIGHT_MM, _BORDER_MM = 420.0, 297.0, 10.0
_TABLE_MM, _FIELDS_MM = 112.0, 40.0
_NOTES_MM, _NOTE_MM = 22.0, 3.3
"""Least paper for the notes above the fields of the title block, and that of a line of them."""
SCALES = (10.0, 5.0, 2.0, 1.0, 0.5, 0.2, 0.1, 0.05, 0.02, 0.01)
"""Scales of ISO 5455."""
_SHOWN = {
    None: "half of it shown",
    "first": "first half, sheet 1 of 2",
    "second": "second half, sheet 2 of 2",
}
_REDUCED = " on A3; reduced on this page, not to scale"
_TURNED = "Half a turn about the throw from where sheet 1 is drawn: x of the design runs to the left."
_FLYING = ["MAIN JOURNAL none: this web and the next throw's", f"{'':13}are one flying web, back to back"]
_IMAGE = "The other half is the mirror image beyond the middle of the crankpin."


@dataclass(frozen=True)
class SheetPage:
    """Content of one A3: three views with their rooms, a table, title block and notes.

    Attributes:
        views: front, section through both axes, section across the throw; each takes axes and scale.
        ghost: what the dashed outlines are of; empty without any.
        in_row: the third view stands beside the second, not below the first.
    """

    rooms: tuple[Room, Room, Room]
    views: tuple[Callable[[Any, float], None], ...]
    lines: Sequence[str]
    title: str
    material: str
    mass: str
    notes: Sequence[str]
    ghost: str = ""
    in_row: bool = False


def write_drawing(
    sheets: Sequence[Sheet],
    balance: ThrowBalance,
    paths: Sequence[Path],
    started: datetime | None = None,
    more: Sequence[SheetPage] = (),
) -> None:
    """Draw a half throw, or both, and more pages into files, dated `started` or today."""
    write_pages([*(_page(sheet, balance) for sheet in sheets), *more], sheets[0].scene.name, paths, started)


def write_pages(
    pages: Sequence[SheetPage], name: str, paths: Sequence[Path], started: datetime | None = None
) -> None:
    """Draw pages into files; `name` is that of the design.

    A PDF has an A3 page for each; SVG, PNG and DXF have them one above the other. DXF needs the extra `dxf`.
    """
    import matplotlib as mpl

    written = time_of_writing(started)
    with mpl.rc_context({"svg.hashsalt": name}):  # the same names of parts in every drawing
        for path in paths:
            suffix = path.suffix.lower()
            if suffix == ".dxf":
                write_dxf(pages_figure(pages, written), page_scale(pages[0]), path, written)
            elif suffix == ".pdf":
                save_pages([pages_figure([page], written) for page in pages], path, {"CreationDate": written})
            else:
                date = {"Date": written.isoformat()} if suffix == ".svg" else None
                save_figure(pages_figure(pages, written), path, dpi=150, metadata=date)


def drawing_figures(sheets: Sequence[Sheet], balance: ThrowBalance, reduced: bool = False) -> list[Figure]:
    """Return the sheets of a drawing as figures, each an A3, dated today.

    Those that are shown `reduced`, on a page of a report, say so beside their scale.
    """
    return [pages_figure([_page(sheet, balance)], time_of_writing(), reduced) for sheet in sheets]


def pages_figure(pages: Sequence[SheetPage], written: datetime, reduced: bool = False) -> Figure:
    """Return pages as one figure, one A3 above the other."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(_WIDTH_MM / MM_PER_INCH, len(pages) * _HEIGHT_MM / MM_PER_INCH))
    parts = figure.subfigures(len(pages), 1, squeeze=False)[:, 0]
    for part, page in zip(parts, pages, strict=True):
        _draw(part, page, written, _REDUCED * reduced)
    return figure


def _page(sheet: Sheet, balance: ThrowBalance) -> SheetPage:
    scene = sheet.scene
    return SheetPage(
        rooms=sheet.rooms,
        views=tuple(
            partial(_on_sheet, view, sheet) for view in (front_view, lengthwise_section, cross_section)
        ),
        lines=table_lines(sheet),
        title=f"{scene.name}: crank throw, {_SHOWN[sheet.half]}",
        material=scene.material.name,
        mass=_mass_text(sheet, balance),
        notes=[
            *surface_notes(scene.drawing),
            *strength_notes(scene),
            *treatment_notes(scene),
            *(["Web symmetric in x."] if not web_asymmetry(scene) else [_IMAGE] * (sheet.half is None)),
            *split_notes(scene, alone=sheet.half is None),
            *[_TURNED] * sheet.turned,
        ],
        ghost="" if sheet.body is None else "body that was re-modelled",
    )


def _mass_text(sheet: Sheet, balance: ThrowBalance) -> str:
    """Return the masses of what the material makes, and of what is bolted on or let in beside it."""
    second = sheet.half == "second"
    web_kg = (balance.second_web_kg if second else balance.web_kg) - balance.bolted_kg[second]
    beside = sum(balance.bolted_kg)
    own = f"throw {balance.mass_kg - beside:.3f} kg, {sheet.half or 'one'} web {web_kg:.3f} kg"
    return own + beside_text(beside)


def beside_text(bolted_kg: float) -> str:
    """Return what a drawing tells of masses bolted on or let in, behind the mass of the part."""
    return f"; bolted on {bolted_kg:.3f} kg" if bolted_kg else ""


def _on_sheet(view: Callable[[Any, Sheet, float], None], sheet: Sheet, axes: Any, scale: float) -> None:
    view(axes, sheet, scale)


def _draw(figure: SubFigure, page: SheetPage, written: datetime, beside_scale: str) -> None:
    scale = page_scale(page)
    front, long, across = sizes = [room.size_mm(scale) for room in page.rooms]
    wide, tall = _extent_mm(page, scale)
    # the views stand in the middle of their room
    x = _BORDER_MM + (_WIDTH_MM - 2 * _BORDER_MM - _TABLE_MM - wide) / 2
    low = _BORDER_MM + (_HEIGHT_MM - 2 * _BORDER_MM - tall) / 2
    y = low if page.in_row else low + across[1]
    places = ((x, y), (x + front[0], y), (x + front[0] + long[0], y) if page.in_row else (x, low))
    for view, room, size, place in zip(page.views, page.rooms, sizes, places, strict=True):
        axes = _axes(figure, place, size)
        room.set_limits(axes, scale)
        view(axes, scale)
    paper = _axes(figure, (0.0, 0.0), (_WIDTH_MM, _HEIGHT_MM))
    paper.set_xlim(0, _WIDTH_MM)
    paper.set_ylim(0, _HEIGHT_MM)
    paper.axis("off")
    frame(paper, _BORDER_MM, _BORDER_MM, _WIDTH_MM - 2 * _BORDER_MM, _HEIGHT_MM - 2 * _BORDER_MM, 1.2)
    _table(paper, page.lines)
    _title_block(paper, page, scale_text(scale) + beside_scale, written)


def page_scale(page: SheetPage) -> float:
    """Return the largest scale at which the views of a page fit."""
    for scale in SCALES:
        wide, tall = _extent_mm(page, scale)
        fits_across = wide <= _WIDTH_MM - 2 * _BORDER_MM - _TABLE_MM
        if fits_across and tall <= _HEIGHT_MM - 2 * _BORDER_MM:
            return scale
    return SCALES[-1]


def _extent_mm(page: SheetPage, scale: float) -> tuple[float, float]:
    """Width and height of the views on paper."""
    front, long, across = (room.size_mm(scale) for room in page.rooms)
    if page.in_row:
        return front[0] + long[0] + across[0], max(front[1], long[1], across[1])
    return max(front[0] + long[0], across[0]), max(front[1], long[1]) + across[1]


def _axes(figure: SubFigure, corner: tuple[float, float], size: tuple[float, float]) -> Any:
    (x, y), (width, height) = corner, size
    return figure.add_axes((x / _WIDTH_MM, y / _HEIGHT_MM, width / _WIDTH_MM, height / _HEIGHT_MM))


def _table(paper: Any, lines: Sequence[str]) -> None:
    size = min(8.0, 8.0 * 60 / max(len(lines), 1))
    left, top = _WIDTH_MM - _BORDER_MM - _TABLE_MM + 4, _HEIGHT_MM - _BORDER_MM - 4
    paper.text(left, top, "\n".join(lines), va="top", family="monospace", fontsize=size, linespacing=1.25)


def table_lines(sheet: Sheet) -> list[str]:
    """Return the lines of the table of dimensions: journals, throw, outline, features."""
    told = replace(sheet, scene=mirror_image(sheet.scene)) if sheet.turned else sheet  # x of the design
    lines = [*_journal_lines(told), *_outline_lines(told.scene)]
    return lines + [line for feature in told.features for line in feature.lines]


def _journal_lines(sheet: Sheet) -> list[str]:
    scene, lines = sheet.scene, list[str]()
    for (journal, _), name in zip(scene.throw.journals, ("MAIN JOURNAL", "CRANKPIN"), strict=True):
        lines += _one_journal(journal, name) if journal.length_mm else _FLYING
    long = f"this half {scene.pitch_mm / 2:g} long" if sheet.half else f"pitch {scene.pitch_mm:g}"
    throw = f"{'THROW':13}radius {scene.throw.radius_mm:g}, {long}"
    drilled = [line for _, one in scene.throw.features() for line in one.drawing(scene).lines]
    return [*lines, *split_lines(scene), throw, *drilled, ""]


def _one_journal(journal: Journal, name: str) -> list[str]:
    bore = f", bore ⌀{journal.bore_diameter_mm:g}" if journal.bore_diameter_mm else ", solid"
    fillet = f", fillets {journal.fillet}" if journal.fillet_mm else ", no fillets"
    return [f"{name:13}⌀{journal.outer_diameter_mm:g}{bore}", f"{'':13}length {journal.length_mm:g}{fillet}"]


def _outline_lines(scene: Scene) -> list[str]:
    web = scene.web
    if not isinstance(web, ProfileWeb):
        kept = web.model_dump(exclude={"bevel", "pocket", "outline"})
        numbers = {key: value for key, value in kept.items() if isinstance(value, float)}
        return [f"OUTLINE {web.outline}", *(f"   {key:24}{value:10.3f}" for key, value in numbers.items())]
    ends = ", ".join(
        f"{name} {'round' if closed else 'straight'}"
        for name, closed in zip(("lower end", "upper end"), web.round_ends, strict=True)
    )
    rows = enumerate(zip(web.stations_mm, web.half_widths_mm, strict=True), start=1)
    return [
        "OUTLINE  cubic spline (degree 3, C2) through",
        "         these points, over chord length;",
        f"         {ends}:",
        "         a round end crosses x = 0 at 90 deg",
        "  no.         y    half-width x",
        *(f"   {number:2d}  {y:9.3f}     {half:9.3f}" for number, (y, half) in rows),
    ]


def _title_block(paper: Any, page: SheetPage, scale: str, written: datetime) -> None:
    """Draw the fields of ISO 7200 in the lower right corner, the notes above them."""
    left, bottom = _WIDTH_MM - _BORDER_MM - _TABLE_MM, _BORDER_MM
    rows = (
        ("Title", page.title),
        ("Material", page.material),
        ("Mass", page.mass),
        ("Scale", scale),
        ("Date", f"{written:%Y-%m-%d}"),
        ("Units", "mm, degrees; A3, first-angle projection"),
    )
    notes = folded(page.notes, _TABLE_MM - 4)
    step, room = _FIELDS_MM / len(rows), max(_NOTES_MM, 3.0 + _NOTE_MM * len(notes))
    top = bottom + _FIELDS_MM + room
    frame(paper, left, bottom, _TABLE_MM, top - bottom, 1.0)
    for number, (name, text) in enumerate(reversed(rows)):
        y = bottom + number * step
        frame(paper, left, y, _TABLE_MM, step, 0.5)
        paper.text(left + 2, y + step / 2, name, fontsize=TEXT_SIZE - 1, va="center", color=INK)
        paper.text(left + 18, y + step / 2, text, fontsize=TEXT_SIZE + 0.5, va="center", color=INK)
    projection_symbol(paper, left + _TABLE_MM - 18, bottom + step * (len(rows) - 3.5))
    note_text = "\n".join(notes)
    paper.text(left + 2, top - 2, note_text, fontsize=TEXT_SIZE - 0.5, va="top", linespacing=1.3)
    if page.ghost:
        paper.plot([left + 2, left + 12], [top + 4] * 2, color=GHOST, lw=1, ls="--")
        paper.text(left + 14, top + 4, page.ghost, fontsize=TEXT_SIZE, va="center")


def scale_text(scale: float) -> str:
    """Return a scale such as `1:2`."""
    return f"{scale:g}:1" if scale >= 1 else f"1:{1 / scale:g}"


def export_drawing(
    scene: Scene, path: Path, sheets: Sequence[Sheet] = (), more: Sequence[SheetPage] = ()
) -> None:
    """Write the sheets of a scene's throw, by default all, and more pages after them (.pdf, .svg or .png)."""
    with replacing(path) as temporary:
        write_drawing(sheets or throw_sheets(scene), throw_balance(scene), [temporary], more=more)


def throw_sheets(scene: Scene, half: SurfaceMesh | None = None, throw: Manifold | None = None) -> list[Sheet]:
    """Return the sheets of a throw: half of it, or both halves where one does not tell the other.

    They have the kernel's triangles, which follow a fillet, unless `half` or a `throw` whose halves differ is
    at hand. The second half is turned half a turn about the throw direction, so that it too has its main
    journal on the left and is seen from the crankpin. Of a split pin each half has its own half pin up.
    """
    if not difference(scene) and not is_split(scene):
        solid = solid_of(half or kernel_surface_of(scene, "half"), "half throw")
        return [Sheet(scene, solid - thread_holes(scene))]
    near, far = halves(scene)
    whole = throw or solid_of(kernel_surface_of(scene, "throw"), "throw")
    turns = half_turns_deg(scene)
    cut = {turn: cut_in_halves(scene, whole.rotate((0.0, 0.0, about_z_deg(-turn)))) for turn in turns}
    first, second = (cut[turn][side] for side, turn in enumerate(turns))
    first, second = first - thread_holes(near), second - thread_holes(far)
    if not difference(scene) and not web_asymmetry(scene):
        return [Sheet(near, first)]
    turned = second.mirror((1.0, 0.0, 0.0))
    return [Sheet(near, first, half="first"), Sheet(mirror_image(far), turned, half="second")]
