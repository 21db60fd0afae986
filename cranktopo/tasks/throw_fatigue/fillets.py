"""Place of a point of the surface: on which fillet, at which angles."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import partial
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from cranktopo.base.arrays import Array
from cranktopo.design.halves import halves
from cranktopo.design.schema import Scene
from cranktopo.throw.drilling.bore import DrillBore
from cranktopo.throw.drilling.outlet import DrillOutlet
from cranktopo.throw.drilling.table import drill_bores
from cranktopo.throw.journal import FilletSection

Fillet = Literal["journal", "pin"]
_OFF_MM = 1e-4
"""Largest distance from the fillet's surface of a node on it, for curved elements."""


@dataclass(frozen=True)
class Place:
    """A point of the throw in words and numbers.

    Attributes:
        fillet: "journal" or "pin", or "" off the fillets.
        around_deg: angle about the journal's or the pin's axis from the throw direction +y toward +x, deg.
        along_deg: angle along the fillet's arc, 0 at the cylinder, 90 at the web's face or the bottom of its
            recess; of an ellipse, of the circle that it is when stretched along the crank.
        point_mm: (x, y, z) in the frame of `cranktopo.base.frames`.
        web: "first" or "second" of a throw with two different halves, else "".
        outlet: journal whose oil outlet it lies at, else "".
    """

    fillet: str
    around_deg: float
    along_deg: float
    point_mm: tuple[float, float, float]
    web: str = ""
    outlet: str = ""

    def __str__(self) -> str:
        x, y, z = self.point_mm
        where = f"x {x:.1f}, y {y:.1f}, z {z:.1f} mm"
        web = f" of the {self.web} web" if self.web else ""
        if self.outlet:
            return f"oil outlet on the {self.outlet}{web}, {where}"
        if not self.fillet:
            return where
        return (
            f"{self.fillet} fillet{web}, {self.around_deg:+z.0f} deg around, {self.along_deg:.0f} deg along"
        )


def fillet_nodes(scene: Scene, fillet: Fillet, points_mm: Array) -> NDArray[np.bool_]:
    """Return which points (3, n) of the near half throw lie on a fillet's surface, rims included, (n,)."""
    across, height, section = _section(scene, fillet, points_mm)
    on = np.abs(section.off_mm(across, height)) < _OFF_MM
    return on & (across < section.half_mouth_mm + _OFF_MM) & (height > -_OFF_MM)


def place(scene: Scene, point_mm: Array) -> Place:
    """Return the place of one surface point (3,) of the near or far half."""
    x, y, z = (float(v) for v in point_mm)
    near, far = halves(scene)
    second = z > near.pitch_mm / 2
    web = "" if near is far else "second" if second else "first"
    half, at = (far, scene.pitch_mm - z) if second else (near, z)
    point = np.array([[x], [y], [at]])
    for fillet in ("journal", "pin"):
        if fillet_nodes(half, fillet, point)[0]:
            across, height, section = _section(half, fillet, point)
            axis = scene.throw.radius_mm if fillet == "pin" else 0.0
            around = math.degrees(math.atan2(x, y - axis))
            along = math.degrees(math.atan2(section.flattening * float(height[0]), -float(across[0])))
            return Place(fillet, around, along, (x, y, z), web)
    return Place("", math.nan, math.nan, (x, y, z), web, _outlet(half, point[:, 0]))


def outlet_nodes(half: Scene, points_mm: Array) -> NDArray[np.bool_]:
    """Return which points (3, n) of the near half throw lie at an outlet of an oil bore, (n,)."""
    near = np.zeros(points_mm.shape[1], dtype=bool)
    for at in _at_outlets(half, points_mm).values():
        near |= at
    return near


def cut_outlet_nodes(half: Scene, points_mm: Array) -> NDArray[np.bool_]:
    """Return which points (3, n) of the near half throw lie at an outlet across its mid-journal plane, (n,).

    That section moves as one rigid body in the model, so that a hole in it has stresses that no shaft has.
    """
    cut = np.zeros(points_mm.shape[1], dtype=bool)
    for bore in drill_bores(half):
        for outlet in bore.outlets:
            cut |= at_outlet(bore, outlet, points_mm) if is_cut(bore, outlet) else False
    return cut


def is_cut(bore: DrillBore, outlet: DrillOutlet) -> bool:
    """Tell whether an outlet of a half throw lies across its mid-journal plane."""
    return not outlet.in_bore and abs(outlet.point_mm[2]) < _reach_mm(bore, outlet)


def rounded_outlet_nodes(half: Scene, points_mm: Array) -> NDArray[np.bool_]:
    """Return which points (3, n) of the near half throw lie at a rounded outlet of an oil bore, (n,)."""
    near = np.zeros(points_mm.shape[1], dtype=bool)
    for outlet, at in _by_outlet(half, points_mm):
        near |= at if outlet.rounding_mm else False
    return near


def _outlet(half: Scene, point_mm: Array) -> str:
    """Return the journal of the oil outlet that a point of a half throw lies at, else ""."""
    return next((journal for journal, at in _at_outlets(half, point_mm[:, None]).items() if at[0]), "")


def _at_outlets(half: Scene, points_mm: Array) -> dict[str, NDArray[np.bool_]]:
    """Return which points (3, n) lie at outlets, by the journal of these."""
    found: dict[str, NDArray[np.bool_]] = {}
    for outlet, at in _by_outlet(half, points_mm):
        journal = outlet.journal.replace("_", " ")
        found[journal] = found.get(journal, False) | at
    return found


def _by_outlet(half: Scene, points_mm: Array) -> Iterator[tuple[DrillOutlet, NDArray[np.bool_]]]:
    """Yield the outlets on journals, and which points (3, n) lie at each."""
    for bore in drill_bores(half):
        for outlet in bore.outlets:
            if not outlet.in_bore:
                yield outlet, at_outlet(bore, outlet, points_mm)


def at_outlet(bore: DrillBore, outlet: DrillOutlet, points_mm: Array) -> NDArray[np.bool_]:
    """Return which points (3, n) lie at an outlet of a bore, (n,)."""
    away = np.linalg.norm(points_mm - np.array(outlet.point_mm)[:, None], axis=0)
    return np.asarray(away < _reach_mm(bore, outlet))


def _reach_mm(bore: DrillBore, outlet: DrillOutlet) -> float:
    return 1.5 * bore.radius_mm / math.cos(math.radians(outlet.obliquity_deg)) + outlet.rounding_mm


def _section(scene: Scene, fillet: Fillet, points: Array) -> tuple[Array, Array, FilletSection]:
    """Position relative to the fillet's centre circle: outward from the axis, toward the web; its section."""
    start, end = scene.web_z_mm
    pin = fillet == "pin"
    journal = scene.throw.crankpin if pin else scene.throw.main_journal
    axis = scene.throw.radius_mm if pin else 0.0
    across = np.hypot(points[0], points[1] - axis) - (journal.radius_mm + journal.fillet_mm)
    along = journal.fillet.reach_mm
    centre = end + along if pin else start - along
    height = (centre - points[2]) if pin else (points[2] - centre)
    return across, height, journal.fillet


def on_fillets(scene: Scene, whole: bool, points_mm: Array) -> tuple[NDArray[np.bool_], NDArray[np.bool_]]:
    """Return which points (3, n) lie on the journal's fillet, and which on the pin's."""
    journal, pin = (
        on_either_half(scene, whole, partial(_on_fillet, fillet), points_mm) for fillet in ("journal", "pin")
    )
    return journal, pin


def _on_fillet(fillet: Fillet, half: Scene, points_mm: Array) -> NDArray[np.bool_]:
    return fillet_nodes(half, fillet, points_mm)


def on_either_half(
    scene: Scene, whole: bool, of_half: Callable[[Scene, Array], NDArray[np.bool_]], points_mm: Array
) -> NDArray[np.bool_]:
    """Return which points (3, n) are found in the half throw, or in either half of the whole one."""
    near, far = halves(scene)
    found = of_half(near, points_mm)
    if whole:
        x, y, z = points_mm
        found |= of_half(far, np.stack([x, y, scene.pitch_mm - z]))
    return found
