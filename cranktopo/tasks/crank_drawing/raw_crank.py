"""Sheet of the raw crank: lengthwise with the finished one in it, from the free end with its flash lines."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from datetime import datetime
from functools import lru_cache
from math import cos, radians, sin
from typing import TYPE_CHECKING, Any

import numpy as np

from cranktopo.base.arrays import Array
from cranktopo.base.frames import about_z_deg
from cranktopo.bodies.crank_ends import SIDES
from cranktopo.bodies.raw_crankshaft import (
    machined_out_of_crank,
    parting_planes_deg,
    parting_text,
    raw_crank_mass_kg,
    raw_end_lines,
)
from cranktopo.bodies.solid.files import kernel_surface_of, raw_end_surface_of
from cranktopo.design.schema import Scene
from cranktopo.numerics.surfaces.mesh import solid_of
from cranktopo.report.drafting import centre_line, edges, extent, finish, ghost, hatched, leader
from cranktopo.tasks.crank_drawing.crank_shape import CrankShape, Piece, PlacedThrow
from cranktopo.tasks.crank_drawing.crank_views import Lengthwise, end_edges, lengthwise
from cranktopo.tasks.crank_drawing.layout import SheetLayout, View, ViewBlock
from cranktopo.tasks.crank_drawing.paper import Paper, sheet_figure
from cranktopo.tasks.drawing.raw_sheet import flash_notes, forging_lines, machined_lines, raw_throw_lines
from cranktopo.tasks.drawing.views import Room

if TYPE_CHECKING:
    from manifold3d import Manifold
    from matplotlib.figure import Figure

_GAP_MM, _LABEL_MM = 9.0, 34.0


@lru_cache(maxsize=8)
def _raw_throw(scene: Scene) -> Manifold:
    return solid_of(kernel_surface_of(scene, "raw"), "raw part")


def raw_crank_shape(scene: Scene, shape: CrankShape) -> CrankShape:
    """Return the raw crank of a design, its throws where those of the finished one are."""
    pieces = [_placed(throw) for throw in shape.throws]
    found = {side: raw_end_surface_of(scene, side) for side in SIDES}
    first, last = shape.throws[0].z_mm, shape.throws[-1].z_mm + shape.throws[-1].scene.pitch_mm
    at = {"free": first, "output": last}
    ends = tuple(
        Piece(solid_of(mesh, f"raw end of the crank, {side}"), (at[side],))
        for side, mesh in found.items()
        if mesh
    )
    open_ = {at[side] for side, mesh in found.items() if not mesh}
    pieces = [replace(one, seams_mm=tuple(z for z in one.seams_mm if z not in open_)) for one in pieces]
    return CrankShape(scene.name, shape.throws, (), (*pieces, *ends), ends)


def _placed(throw: PlacedThrow) -> Piece:
    solid = _raw_throw(throw.scene).rotate((0.0, 0.0, about_z_deg(throw.angle_deg)))
    seams = throw.z_mm, throw.z_mm + throw.scene.pitch_mm
    return Piece(solid.translate((0.0, 0.0, throw.z_mm)), seams)


def raw_crank_figure(
    scene: Scene, shape: CrankShape, raw: CrankShape, written: datetime, finished_kg: float
) -> tuple[Figure, SheetLayout]:
    """Return the sheet of the raw crank as a figure, and its layout."""
    kg = raw_crank_mass_kg(scene)
    paper = Paper(
        scene=scene,
        shape=shape,
        lines=_lines(scene, raw),
        notes=["NOTES", *_notes(scene, shape)],
        title=f"{scene.name}: raw part of the crankshaft",
        number="2/2",
        mass=f"raw {kg:.3f} kg, finished {finished_kg:.3f} kg, {finished_kg / kg:.0%} of it",
        webs=False,
        written=written,
    )
    return sheet_figure(paper, _blocks(shape, raw))


def _notes(scene: Scene, shape: CrankShape) -> list[str]:
    parting = parting_text([throw.angle_deg for throw in shape.throws])
    return [f"Parting: {parting}.", *flash_notes(scene), "Dashed: the finished crank."]


def _lines(scene: Scene, raw: CrankShape) -> list[str]:
    """Return allowance, draft and flash, sizes of the whole, each distinct throw, ends, what is machined."""
    (start, end), (left, right, low, high) = raw.z_mm, raw.reach_mm
    whole = ["WHOLE", f"   length {end - start:.1f}", f"   across {right - left:.1f} x {high - low:.1f}", ""]
    scenes = list(dict.fromkeys(throw.scene for throw in raw.throws))
    named = [[f"{one.name}:"] * (len(scenes) > 1) + raw_throw_lines(one) for one in scenes]
    steps = raw_end_lines(scene)
    ends = ["ENDS, from the outer main journals", *(f"   {line}" for line in steps), ""] if steps else []
    throws = [line for lines in named for line in lines]
    return [*forging_lines(scene), *whole, *throws, *ends, *machined_lines(machined_out_of_crank(scene))]


def _blocks(shape: CrankShape, raw: CrankShape) -> Any:
    lengthwise_view, finished, seen = lengthwise(raw), lengthwise(shape).cut, end_edges(raw)

    def blocks(scale: float, _: float) -> Sequence[ViewBlock]:
        views = (
            View(
                _room(raw.z_mm, raw),
                lambda axes, s: _lengthwise(axes, raw, lengthwise_view, finished, s),
                scale,
            ),
            View(_end_room(raw), lambda axes, s: _end(axes, raw, seen, s), scale),
        )
        return [ViewBlock(((view, (0.0, 0.0)),)) for view in views]

    return blocks


def _room(x_mm: tuple[float, float], raw: CrankShape) -> Room:
    paper = (3 * _GAP_MM, 2 * _GAP_MM, 3 * _GAP_MM, 2 * _GAP_MM)
    return Room(x_mm, raw.reach_mm[2:], paper)


def _end_room(raw: CrankShape) -> Room:
    left, right, low, high = raw.reach_mm
    return Room((-right, -left), (low, high), (_LABEL_MM, _LABEL_MM, 3 * _GAP_MM, 3 * _GAP_MM))


def _lengthwise(
    axes: Any, raw: CrankShape, view: Lengthwise, finished: Sequence[Array], scale: float
) -> None:
    """Draw the raw crank with its upper half in section, the finished one dashed in that, and its sizes."""
    mm, (start, end), (_, _, low, high) = 1 / scale, raw.z_mm, raw.reach_mm
    hatched(axes, view.cut)
    edges(axes, view.chains)
    ghost(axes, list(finished))
    centre_line(axes, (start - 4 * mm, 0.0), (end + 4 * mm, 0.0))
    points = np.concatenate([*view.chains, *view.cut])
    extent(axes, points, 0, low - _GAP_MM * mm, f"{end - start:.1f}")
    extent(axes, points, 1, start - _GAP_MM * mm, f"{high - low:.1f}")
    finish(axes, "Raw crank, upper half in section")


def _end(axes: Any, raw: CrankShape, chains: Sequence[Array], scale: float) -> None:
    """Draw the raw crank from its free end, the planes that dies part in, and its sizes."""
    mm, (left, right, low, _) = 1 / scale, raw.reach_mm
    edges(axes, chains)
    extent(axes, np.concatenate(chains), 0, low - _GAP_MM * mm, f"{right - left:.1f}")
    reach = max(map(abs, raw.reach_mm)) + 3 * mm
    for angle in parting_planes_deg(throw.angle_deg for throw in raw.throws):
        way = -sin(radians(angle)), cos(radians(angle))
        tip = reach * way[0], reach * way[1]
        centre_line(axes, (-tip[0], -tip[1]), tip)
        text, out = f"flash line, {angle:g}°", 6 * mm
        leader(axes, tip, (tip[0] + out * way[0], tip[1] + out * way[1]), text)
    finish(axes, "From the free end")
