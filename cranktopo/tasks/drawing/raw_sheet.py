"""Sheet of the raw part: views with the finished part in it, allowances, draft, flash line, masses."""

from __future__ import annotations

import textwrap
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from cranktopo.base.arrays import Array
from cranktopo.base.errors import CranktopoError, invalid
from cranktopo.base.files import replacing
from cranktopo.base.notes import note
from cranktopo.bodies.raw_part import forging_of, machined_of_half, raw_mass_kg
from cranktopo.bodies.solid.files import cut_in_halves, surface_of
from cranktopo.design.schema import Scene
from cranktopo.engine.balance.throw import throw_balance
from cranktopo.numerics.surfaces.mesh import solid_of
from cranktopo.numerics.surfaces.plane_section import section_x, section_y
from cranktopo.report.drafting import (
    centre_line,
    circle,
    dimension,
    extent,
    finish,
    ghost,
    hatched,
    leader,
)
from cranktopo.tasks.drawing.sheet import SheetPage, throw_sheets, write_pages
from cranktopo.tasks.drawing.views import Room, Sheet, silhouette
from cranktopo.throw.raw_part.half import raw_half

if TYPE_CHECKING:
    from manifold3d import Manifold

_GAP_MM = 8.0
_COLUMN = 44
"""Characters of a line of the table."""


@dataclass(frozen=True)
class _RawView:
    """A raw half throw and the finished one in it."""

    sheet: Sheet
    raw: Manifold

    @property
    def scene(self) -> Scene:
        return self.sheet.scene

    @property
    def rooms(self) -> tuple[Room, Room, Room]:
        """The rooms of the finished part, for the raw one."""
        (x0, y0, _, x1, y1, _), front, long, across = self.raw.bounding_box(), *self.sheet.rooms
        low, high = self._cut.min(axis=0), self._cut.max(axis=0)
        return (
            replace(front, x_mm=(x0, x1), y_mm=(y0, y1)),
            replace(long, y_mm=(y0, y1)),
            replace(across, x_mm=(low[0], high[0]), y_mm=(low[1], high[1])),
        )

    @property
    def _across_mm(self) -> float:
        """Place of the section across the throw: half-way between the axes."""
        return self.scene.throw.radius_mm / 2

    @property
    def _cut(self) -> Array:
        """Points (x, z) of the raw half throw's section across the throw."""
        return np.concatenate(section_y(self.raw, self._across_mm).to_polygons())

    @property
    def _web(self) -> Manifold:
        """Return the raw web with so much of the journals that is as thick as the raw web rises."""
        half = raw_half(self.scene, forging_of(self.scene))
        low, high = min(part.z_mm[0] for part in half.web), max(part.z_mm[1] for part in half.web)
        return self.raw.trim_by_plane((0.0, 0.0, 1.0), low).trim_by_plane((0.0, 0.0, -1.0), -high)

    def front(self, axes: Any, scale: float) -> None:
        """Draw the view along the crank axis, and the plane that the die parts in."""
        outline = silhouette(self.raw)
        hatched(axes, outline, "")
        ghost(axes, silhouette(self.sheet.solid))
        (x0, y0, _, x1, y1, _), gap = self.raw.bounding_box(), _GAP_MM / scale
        centre_line(axes, (0.0, y0 - 0.7 * gap), (0.0, y1 + 0.7 * gap))
        for (journal, y), style in zip(self.scene.throw.journals, ("--", "-"), strict=True):
            circle(axes, journal.radius_mm + forging_of(self.scene).allowance_mm, y, style, 1.0)
        middle = (self.scene.throw.radius_mm + y1) / 2
        leader(axes, (0.0, middle), (x1 + 0.5 * gap, y1), "die parts here: flash line", "left")
        points = np.concatenate(outline)
        extent(axes, points, 0, y0 - gap, f"{x1 - x0:.1f}")
        extent(axes, points, 1, x0 - gap, f"{y1 - y0:.1f}")
        finish(axes, "Front, from the crankpin side")

    def lengthwise(self, axes: Any, scale: float) -> None:
        """Draw the section in the plane that the die parts in."""
        hatched(axes, section_x(self.raw).to_polygons())
        ghost(axes, section_x(self.sheet.solid).to_polygons())
        throw, end, gap = self.scene.throw, self.scene.pitch_mm / 2, _GAP_MM / scale
        more = forging_of(self.scene).allowance_mm
        low = self.raw.bounding_box()[1]
        _, bottom, start, _, _, stop = self._web.bounding_box()
        dimension(axes, (start, bottom), (stop, bottom), (0, low - gap - bottom), f"{stop - start:.1f}")
        for (journal, y), z, side in zip(throw.journals, (0.0, end), (-1, 1), strict=True):
            ends = [(z, y + way * (journal.radius_mm + more)) for way in (-1, 1)]
            dimension(axes, ends[0], ends[1], (side * gap, 0), f"⌀{journal.outer_diameter_mm + 2 * more:g}")
        finish(axes, "Section x = 0, where the die parts")

    def across(self, axes: Any, scale: float) -> None:
        """Draw the section across the throw, journals with it where it cuts them."""
        y, gap, forging = self._across_mm, _GAP_MM / scale, forging_of(self.scene)
        hatched(axes, section_y(self.raw, y).to_polygons())
        ghost(axes, section_y(self.sheet.solid, y).to_polygons())
        start, end = self.scene.web_z_mm
        wide, more = float(self._cut[:, 0].max()), forging.allowance_mm
        faces = start - more, end + more
        dimension(axes, (-wide, faces[0]), (-wide, faces[1]), (-gap, 0), f"{faces[1] - faces[0]:g}")
        tip = (0.85 * wide, faces[1] + 0.15 * wide * forging.draft_slope)
        leader(axes, tip, (1.1 * wide, faces[1] + 1.5 * gap), f"draft {forging.draft_deg:g}°", "left")
        axes.invert_yaxis()
        finish(axes, f"Section y = {y:.2f}")


def raw_pages(scene: Scene, sheets: Sequence[Sheet]) -> list[SheetPage]:
    """Return a page of the raw part for each sheet of the finished throw; none without a forging.

    A raw part that the kernel cannot build is told in a line and has none.
    """
    if scene.forging is None:
        return []
    try:
        return _pages(scene, sheets)
    except CranktopoError as error:
        note(f"the drawing has no sheet of the raw part: {error.message}")
        return []


def write_raw_drawing(scene: Scene, path: Path) -> int:
    """Write the sheets of the raw part alone (.pdf, .svg or .png) and return how many there are.

    Raises:
        CranktopoError: no `[forging]`, or a raw part that the kernel cannot build.
    """
    if scene.forging is None:
        raise invalid("forging", None, "a raw part needs one", "Add a [forging] table.")
    pages = _pages(scene, throw_sheets(scene))
    with replacing(path) as temporary:
        write_pages(pages, scene.name, [temporary])
    return len(pages)


def _pages(scene: Scene, sheets: Sequence[Sheet]) -> list[SheetPage]:
    solids = list(cut_in_halves(scene, solid_of(surface_of(scene, "raw"), "raw part"))[: len(sheets)])
    if len(solids) > 1:
        solids[1] = solids[1].mirror((1.0, 0.0, 0.0))
    raw_kg, finished_kg = raw_mass_kg(scene), throw_balance(scene).mass_kg
    return [
        SheetPage(
            rooms=view.rooms,
            views=(view.front, view.lengthwise, view.across),
            lines=[
                *forging_lines(view.scene),
                *raw_throw_lines(view.scene),
                *machined_lines(machined_of_half(scene, sheet.half or "first")),
            ],
            title=f"{scene.name}: raw part, {sheet.half or 'half of it'}{' half' * bool(sheet.half)} shown",
            material=scene.material.name,
            mass=f"raw {raw_kg:.3f} kg, finished {finished_kg:.3f} kg, {finished_kg / raw_kg:.0%} of it",
            notes=["Die parts in x = 0, which holds both axes.", *flash_notes(scene)],
            ghost="finished part",
        )
        for sheet, view in zip(sheets, map(_RawView, sheets, solids), strict=True)
    ]


def forging_lines(scene: Scene) -> list[str]:
    """Return allowance, draft and flash as lines of a table."""
    forging = forging_of(scene)
    return [
        "RAW PART",
        f"   allowance {forging.allowance_mm:g} on journals, fillets, faces",
        f"   draft {forging.draft_deg:g}° toward the parting plane x = 0",
        f"   flash {forging.flash_mm:g}, trimmed to the flash line",
        "",
    ]


def raw_throw_lines(scene: Scene) -> list[str]:
    """Return raw journals and web of a throw as lines of a table."""
    throw, web, more = scene.throw, scene.web, 2 * forging_of(scene).allowance_mm
    return [
        f"MAIN JOURNAL ⌀{throw.main_journal.outer_diameter_mm + more:g}",
        f"CRANKPIN     ⌀{throw.crankpin.outer_diameter_mm + more:g}",
        f"WEB          {web.thickness_mm + more:g} thick at its widest place",
        "",
    ]


def machined_lines(keys: Sequence[str]) -> list[str]:
    """Return the keys of what is machined out of the full as lines of a table."""
    if not keys:
        return []
    wrapped = (textwrap.wrap(key, _COLUMN, initial_indent="   ", subsequent_indent="      ") for key in keys)
    return ["MACHINED OUT OF THE FULL", *(line for lines in wrapped for line in lines)]


def flash_notes(scene: Scene) -> list[str]:
    """Return notes on the flash and on what the forge rounds."""
    land = forging_of(scene).flash_mm
    return [
        f"Land of the flash {land:g} mm high." if land else "Flash trimmed flush.",
        "Edges and corners without radius are rounded as the die needs.",
    ]
