"""Details of the fillets: the section through both axes around each, magnified."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from cranktopo.base.arrays import Array
from cranktopo.design.opened_fillets import opened_fillets
from cranktopo.numerics.surfaces.plane_section import section_x
from cranktopo.report.drafting import circle, finish, hatched, leader, number_mm
from cranktopo.tasks.drawing.views import Room, Sheet
from cranktopo.throw.journal import Journal

_PAPER_MM = 18.0
"""Radius of what a detail shows, on paper."""
_SCALES = (50.0, 20.0, 10.0, 5.0, 2.0, 1.0)


@dataclass(frozen=True)
class Detail:
    """A fillet of a half throw, around the point (z, y) where journal and web would meet."""

    letter: str
    sheet: Sheet
    journal: Journal
    at_mm: tuple[float, float]
    toward: float

    @property
    def scale(self) -> float:
        """Scale at which the fillet fills a good part of the detail."""
        largest = max(self.journal.fillet.radial_mm, self.journal.fillet.axial_mm)
        return next((scale for scale in _SCALES if scale * largest <= 0.7 * _PAPER_MM), _SCALES[-1])

    @property
    def radius_mm(self) -> float:
        """Radius of what it shows, mm of the body."""
        return _PAPER_MM / self.scale

    @property
    def room(self) -> Room:
        """Room of the detail."""
        (z, y), r = self.at_mm, self.radius_mm
        return Room((z - r, z + r), (y - r, y + r), (8.0, 8.0, 6.0, 10.0))


def details(sheet: Sheet, letters: Sequence[str]) -> list[Detail]:
    """Return the details of a half throw: the fillets of main journal and crankpin that it has.

    Each is toward the other axis, or away from it where a bore opens it there.
    """
    scene = sheet.scene
    (start, stop), (main, pin) = scene.web_z_mm, (scene.throw.main_journal, scene.throw.crankpin)
    at_main, at_pin = (-1.0 if is_open else 1.0 for is_open in opened_fillets(scene))
    found = (
        (main, (start, at_main * main.radius_mm), -1.0),
        (pin, (stop, scene.throw.radius_mm - at_pin * pin.radius_mm), 1.0),
    )
    return [
        Detail(letter, sheet, *one)
        for letter, one in zip(letters, [one for one in found if one[0].fillet_mm], strict=False)
    ]


def draw_detail(axes: Any, detail: Detail, scale: float) -> None:
    """Draw a detail with the radius of its fillet and its roughness."""
    from manifold3d import CrossSection

    (z, y), radius = detail.at_mm, detail.radius_mm
    window = CrossSection.circle(radius, 96).translate((z, y))
    hatched(axes, (section_x(detail.sheet.solid) ^ window).to_polygons())
    circle(axes, radius, y, "-.", 0.5, x=z)
    fillet = detail.journal.fillet
    axis = 0.0 if detail.toward < 0 else detail.sheet.scene.throw.radius_mm
    outward = float(np.sign(y - axis))
    tip = z + detail.toward * 0.3 * fillet.axial_mm, y + outward * 0.3 * fillet.radial_mm
    at = z + detail.toward * 0.62 * radius, y + outward * 0.66 * radius
    ra = f"Ra {detail.sheet.scene.drawing.fillet_roughness_um:g}"
    leader(axes, tip, at, f"{fillet}\n{ra}")
    finish(axes, f"Detail {detail.letter}, {scale:g}:1")


def mark_detail(axes: Any, detail: Detail, scale: float) -> None:
    """Mark a detail in the section that it is taken from."""
    (z, y), radius = detail.at_mm, min(detail.radius_mm, 5.0 / scale)
    circle(axes, radius, y, "-", 0.6, x=z)
    place = _letter_place(axes, detail, radius, 1 / scale)
    white = {"fc": "white", "ec": "none", "pad": 0.4}
    axes.text(*place, detail.letter, fontsize=9, ha="center", va="center", bbox=white)


def _letter_place(axes: Any, detail: Detail, radius: float, mm: float) -> tuple[float, float]:
    """Return the place of a letter beside the mark of a detail: off the body, else within it, not on an edge.

    Places are taken in turn from the upper right one on, away from texts, leaders and dimensions there.
    """
    from manifold3d import CrossSection

    body = section_x(detail.sheet.solid)
    size = np.array([2.0 * mm * len(detail.letter) + 1.2 * mm, 4.0 * mm])
    letter = CrossSection.square(tuple(size), center=True)
    turn = np.radians([45, 315, 135, 225, 0, 90, 180, 270])
    places = np.array(detail.at_mm) + (radius + 2.6 * mm) * np.column_stack([np.cos(turn), np.sin(turn)])
    low, high = _taken(axes, mm)

    def worst(place: Array) -> float:
        share = (letter.translate(tuple(place)) ^ body).area() / letter.area()
        on_edge = 1e-3 < share < 1 - 1e-3
        on_text = ((low < place + size / 2) & (high > place - size / 2)).all(axis=1).any()
        return 4.0 * on_text + 2.0 * on_edge + (share > 0.5)

    z, y = min(places, key=worst)
    return float(z), float(y)


def _taken(axes: Any, mm: float) -> tuple[Array, Array]:
    """Return lower left and upper right corners, (n, 2) each, of texts with leaders, and of dimensions."""
    low, high = [], []
    for text in axes.texts:
        size = np.array([number_mm(text.get_text()), 3.4]) * mm * bool(text.get_text())
        at, half = np.array(text.get_position()), size[:: -1 if text.get_rotation() else 1] / 2
        tip = np.array(getattr(text, "xy", at))
        low.append(np.minimum(at - half, tip))
        high.append(np.maximum(at + half, tip))
    return np.array(low).reshape(-1, 2), np.array(high).reshape(-1, 2)
