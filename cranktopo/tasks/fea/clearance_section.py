"""The room of a turning web as a section of a report: to piston skirt, crankcase and neighbouring rod."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from cranktopo.base.arrays import Array
from cranktopo.design.clearance import (
    clearance_limit,
    clearances_of_points_mm,
    clearances_text,
    turning_limits,
)
from cranktopo.design.schema import Scene
from cranktopo.numerics.surfaces.mesh import solid_of
from cranktopo.report.page import Section
from cranktopo.report.plot import picture
from cranktopo.report.result_table import ResultTable, Row
from cranktopo.report.viewer.scene3d import ShownBody
from cranktopo.tasks.fea.clearance_plot import draw_clearance

_STEP_MM = 0.25
"""Distance of the points of a silhouette where its room is measured."""


def clearance_sections(scene: Scene, bodies: Sequence[ShownBody]) -> tuple[Section, ...]:
    """Return the room of each body, the result first; nothing for a scene without `[envelope.clearance]`."""
    envelope = scene.envelope
    if envelope is None or envelope.clearance is None or not bodies:
        return ()
    silhouettes = {body.name: _silhouette(body) + _bolted(scene) for body in bodies}
    points = {name: np.concatenate([_along(loop) for loop in loops]) for name, loops in silhouettes.items()}
    rooms = {name: clearances_of_points_mm(scene, *at.T) for name, at in points.items()}
    limits, name = turning_limits(scene), bodies[0].name
    text = (
        f"The {name} leaves {clearances_text(rooms[name])}; "
        f"at least {envelope.clearance.least_gap_mm:g} mm stay. "
        "Limits are drawn in the frame of the web, the piston where it comes nearest during a turn. "
        f"Rods run beside the web: {envelope.rod_clearance_mm:g} mm along the crank axis are kept free of "
        "material there (envelope.rod_clearance_mm)."
    )
    alt = "; ".join(f"{body}: {clearances_text(room)}" for body, room in rooms.items())
    drawn = picture("clearance", alt, draw_clearance, silhouettes, limits, clearance_limit(scene))
    return (Section("clearance", "Room of the turning web", text, (("Room", _table(rooms)),), (drawn,)),)


def _table(rooms: dict[str, dict[str, float]]) -> ResultTable:
    names = {f"to_the_{key.replace(' ', '_')}_mm": key for room in rooms.values() for key in room}
    rows: tuple[Row, ...] = tuple(
        {"web": body, **{column: room[key] for column, key in names.items()}} for body, room in rooms.items()
    )
    return ResultTable({"web": 0, **dict.fromkeys(names, 2)}, rows)


def _silhouette(body: ShownBody) -> list[Array]:
    """Loops (n, 2) around the web of a half throw as it is seen along the crank axis."""
    low, high = body.web_z_mm
    web = solid_of(body.mesh).trim_by_plane((0.0, 0.0, 1.0), low).trim_by_plane((0.0, 0.0, -1.0), -high)
    return [np.asarray(loop) for loop in web.project().to_polygons()]


def _bolted(scene: Scene) -> list[Array]:
    """Loop around a counterweight that is a part of its own, which no surface has."""
    weight = scene.web.counterweight
    return [np.array(weight.drawing(scene).added)] if weight is not None and weight.bolted else []


def _along(loop: Array) -> Array:
    """Points (n, 2) along a closed loop, near enough to each other that none is missed."""
    edges = np.roll(loop, -1, axis=0) - loop
    steps = np.ceil(np.linalg.norm(edges, axis=1) / _STEP_MM).astype(int) + 1
    return np.concatenate(
        [at + np.linspace(0, 1, n)[:, None] * edge for at, edge, n in zip(loop, edges, steps, strict=True)]
    )
