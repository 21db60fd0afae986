"""Bolts of a counterweight in the views of its throw: their holes, axes, dimensions and thread note."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from cranktopo.design.bolt_holes import BoltHole, bolt_holes
from cranktopo.design.schema import Scene
from cranktopo.report.drafting import INK, THIN, centre_line, circle
from cranktopo.throw.primitives import DimensionLine, FeatureDrawing

_OVER_MM, _BEYOND_MM = 2.0, 5.0
"""Length of an axis beyond its hole; distance of a dimension from the web, mm."""
_UNPLACED = "", "BOLTS of the counterweight: not drawn,", "   no bolted_joint.places_mm are given"


def bolt_feature(scene: Scene) -> FeatureDrawing | None:
    """Return the dimensions of placed bolts to the axes and the faces, and their notes.

    Of bolts without places a note; None where nothing is bolted on.
    """
    bolts, weight = bolt_holes(scene), scene.web.counterweight
    if not bolts:
        return FeatureDrawing(lines=_UNPLACED) if weight is not None and weight.bolted else None
    (start, end), first = scene.web_z_mm, bolts[0]
    rows = {round(bolt.z_mm, 6): bolt for bolt in bolts}
    pairs = {round(bolt.x_mm, 6): bolt for bolt in bolts if bolt.x_mm > 0}
    return FeatureDrawing(
        lengthwise=tuple(
            DimensionLine((start, bolt.seat_mm), (z, bolt.seat_mm), (0.0, -1.0), f"{z - start:.2f}")
            for z, bolt in list(rows.items())[:1]
        ),
        across=tuple(
            DimensionLine((-x, z.z_mm), (x, z.z_mm), (0.0, end - z.z_mm + _BEYOND_MM), f"{2 * x:.2f}")
            for x, z in list(pairs.items())[:1]
        ),
        section_y_mm=(first.joint_mm + first.thread_mm) / 2,
        lines=tuple(_lines(scene, bolts)),
        places=tuple((bolt.x_mm, bolt.seat_mm) for bolt in bolts),
    )


def _lines(scene: Scene, bolts: Sequence[BoltHole]) -> list[str]:
    """Return the notes of each joint: thread, hole, seat of the head, and the places of its bolts."""
    found = []
    for key in dict.fromkeys(bolt.key for bolt in bolts):
        own = [bolt for bolt in bolts if bolt.key == key]
        first, joint = own[0], own[0].joint
        deep = f"{joint.engaged_mm:g} deep, core ⌀{2 * first.core_radius_mm:.2f} × {_core_mm(first):.2f}"
        found += [
            "",
            f"BOLTS of the counterweight, {len(own)} × {joint.thread}, {joint.strength_class}",
            f"   web: {joint.thread} {deep} from the joint",
            f"   counterweight: ⌀{2 * first.hole_radius_mm:.2f} through",
            f"   head: ⌀{2 * first.head_radius_mm:.2f} from the rim, flat, {joint.grip_mm:g} from the joint",
            "   no.        x  from the journal face   seat y",
        ]
        start = scene.web_z_mm[0]
        found += [
            f"   {number:2d}  {bolt.x_mm:9.2f}  {bolt.z_mm - start:9.2f}            {bolt.seat_mm:9.2f}"
            for number, bolt in enumerate(own, 1)
        ]
    return found


def _core_mm(bolt: BoltHole) -> float:
    return bolt.floor_mm - bolt.joint_mm


def draw_bolts(axes: Any, scene: Scene, *, along: bool) -> None:
    """Draw the holes of placed bolts, hidden, and their axes, in a view across the throw's direction.

    Args:
        along: the view has z to the right; else x.
    """
    weight = scene.web.counterweight
    for bolt in bolt_holes(scene):
        assert weight is not None
        at = bolt.z_mm if along else bolt.x_mm
        rim = -((weight.outer_radius_mm**2 - bolt.x_mm**2) ** 0.5)
        for radius, low, high in (
            (bolt.core_radius_mm, bolt.joint_mm, bolt.floor_mm),
            (bolt.hole_radius_mm, bolt.seat_mm, bolt.joint_mm),
            (bolt.head_radius_mm, rim, bolt.seat_mm),
        ):
            corners = [(at - radius, low), (at - radius, high), (at + radius, high), (at + radius, low)]
            axes.plot(*zip(*corners, strict=True), color=INK, lw=0.8, ls="--")
        for side in (-1, 1):
            wide = at + side * bolt.joint.nominal.diameter_mm / 2
            axes.plot([wide, wide], [bolt.joint_mm, bolt.thread_mm], color=THIN, lw=0.5, ls="--")
        centre_line(axes, (at, rim - _OVER_MM), (at, bolt.floor_mm + _OVER_MM))


def draw_threads(axes: Any, scene: Scene, y_mm: float) -> None:
    """Draw the nominal diameters of the threads, and their axes, in a section across the throw."""
    for bolt in bolt_holes(scene):
        if bolt.joint_mm < y_mm < bolt.thread_mm:
            radius = bolt.joint.nominal.diameter_mm / 2
            circle(axes, radius, bolt.z_mm, "-", 0.5, x=bolt.x_mm)
            reach = radius + _OVER_MM
            centre_line(axes, (bolt.x_mm - reach, bolt.z_mm), (bolt.x_mm + reach, bolt.z_mm))
            centre_line(axes, (bolt.x_mm, bolt.z_mm - reach), (bolt.x_mm, bolt.z_mm + reach))
