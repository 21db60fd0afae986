"""Sections of a report: the room of the turning web, and the stresses of its load cases."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from cranktopo.base.arrays import Array
from cranktopo.design.clearance import (
    ClearanceLimit,
    clearance_limit,
    clearances_of_points_mm,
    clearances_text,
    turning_limits,
)
from cranktopo.design.schema import Scene
from cranktopo.numerics.surfaces.mesh import solid_of
from cranktopo.report.page import Section
from cranktopo.report.plot import GREY, Picture, picture, plain
from cranktopo.report.result_table import ResultTable, Row
from cranktopo.report.shading import STRESS_COLOURS, ShadedMesh, shaded
from cranktopo.report.viewer.scene3d import (
    JOURNAL_SIDE,
    PIN_SIDE,
    SHARE,
    Scene3D,
    ShownBody,
    StressScale,
    gallery,
    quantiles_MPa,
)

if TYPE_CHECKING:
    from matplotlib.figure import Figure


# Name of a body, what to draw of it, and the stress on its faces (cases, faces), MPa.
_Solved = tuple[str, ShadedMesh, NDArray[np.float64]]
_COLUMNS = {"design": 0, "load_case": 0, "99_percent_below_MPa": 1, "half_below_MPa": 1, "element_size_mm": 2}
_TITLE = "Stress"
_TEXT = (
    "Von Mises stress of each load case alone on body-fitted quadratic tetrahedra. The colours "
    f"end at the stress that {100 * SHARE:g} % of every surface stays below: at sharp edges stress has no "
    "limit, and fillets need a finer mesh, which 'cranktopo fatigue' makes."
)


def stress_section(scene3d: Scene3D | None, command: str, refused: str = "") -> Section:
    """Return quantiles and pictures of the stresses, or the `command` that would solve for them.

    Where `refused` says why none does, it stands in place of the command.
    """
    if refused:
        return Section("stress", _TITLE, f"Not solved: {refused}")
    if scene3d is None or not scene3d.stress_scales:
        return Section("stress", _TITLE, f"Not solved: '{command}' adds them to this page.")
    rows: list[Row] = []
    for body in scene3d.bodies:
        assert body.stress is not None
        most, middle = quantiles_MPa(body.mesh, body.stress, SHARE, 0.5)
        for scale, high, low in zip(scene3d.stress_scales, most, middle, strict=True):
            cells = (body.name, scale.label, float(high), float(low), body.stress.element_size_mm)
            rows.append(dict(zip(_COLUMNS, cells, strict=True)))
    table = ResultTable(_COLUMNS, tuple(rows))
    solved = [_solved(body) for body in scene3d.bodies]
    pictures = tuple(_picture(solved, number, scale) for number, scale in enumerate(scene3d.stress_scales))
    return Section("stress", _TITLE, _TEXT, (("Von Mises stress on the surface", table),), pictures)


def _solved(body: ShownBody) -> _Solved:
    assert body.stress is not None
    mesh = shaded(body.mesh, body.web_z_mm)
    return body.name, mesh, body.stress.at(mesh.vertices_mm)[:, mesh.faces].mean(axis=2)


def _picture(solved: Sequence[_Solved], number: int, scale: StressScale) -> Picture:
    names = ", ".join(name for name, _, _ in solved)
    alt = f"Von Mises stress of {names} under {scale.label}; colours from 0 to {scale.top_MPa:.3g} MPa"
    return Picture(f"stress-{scale.case}", _figure(solved, number, scale), alt, raster=True)


def _figure(solved: Sequence[_Solved], number: int, scale: StressScale) -> Figure:
    from matplotlib.cm import ScalarMappable
    from matplotlib.colors import LinearSegmentedColormap, Normalize

    colours = LinearSegmentedColormap.from_list("stress", STRESS_COLOURS)
    norm = Normalize(0.0, scale.top_MPa)
    panels = [
        (name, replace(mesh, colours=np.asarray(colours(norm(stress[number])))[:, :3]), PIN_SIDE)
        for name, mesh, stress in solved
    ]
    if len(panels) == 1:
        panels = [
            ("from the journal side", panels[0][1], JOURNAL_SIDE),
            ("from the crankpin side", *panels[0][1:]),
        ]
    figure, axes = gallery(panels)
    bar = figure.colorbar(ScalarMappable(norm, colours), ax=axes, shrink=0.7, extend="max", pad=0.01)
    bar.ax.tick_params(labelsize=10)
    figure.suptitle(f"von Mises stress (MPa), {scale.label}", fontsize=11, color=GREY)
    return figure


_LIMITS = {"crankcase": "#7a5195", "piston skirt": "#d1632a"}
_BODIES = ("#1f6fb4", GREY)
_FAR = 1.12
"""Length that it is drawn over the farthest point of the bodies."""
_MARGIN = 1.04
"""The same over a limit that is near all round, such as a crankcase."""


def _draw_clearance(
    axes: Any,
    silhouettes: Mapping[str, Sequence[Array]],
    limits: Mapping[str, ClearanceLimit],
    least: ClearanceLimit | None,
) -> None:
    """Draw loops (n, 2) of bodies and limits in the frame of the web, which turns about (0, 0)."""
    far = _drawn_to_mm(silhouettes, limits)
    for order, ((name, loops), colour) in enumerate(zip(silhouettes.items(), _BODIES, strict=False)):
        for number, loop in enumerate(loops):
            closed, label = np.vstack([loop, loop[:1]]), None if number else name
            axes.plot(*closed.T, color=colour, linewidth=1.4, label=label, zorder=3 - order / 2)
    for name, limit in limits.items():
        axes.plot(*_near(limit, far), color=_LIMITS[name], linewidth=1.4, label=name)
    if least is not None:
        axes.plot(*_near(least, far), color="black", linewidth=0.8, linestyle=":", label="least gap")
    axes.plot(0, 0, "+", color=GREY)
    axes.set(xlim=(-far, far), ylim=(-far, far), aspect="equal", anchor="W")
    axes.set_xlabel("x (mm)", fontsize=9)
    axes.set_ylabel("y, to the crankpin (mm)", fontsize=9)
    axes.legend(fontsize=8, loc="center left", bbox_to_anchor=(1.03, 0.5), frameon=False)
    plain(axes)


def _drawn_to_mm(silhouettes: Mapping[str, Sequence[Array]], limits: Mapping[str, ClearanceLimit]) -> float:
    """Return how far the axes reach to each side: over bodies, and over limits that are near all round."""
    bodies = max(np.abs(loop).max() for loops in silhouettes.values() for loop in loops)
    farthest = (limit.radius_mm.max() for limit in limits.values())
    return max([_FAR * bodies, *(_MARGIN * radius for radius in farthest if radius < 2 * bodies)])


def _near(limit: ClearanceLimit, far: float) -> Array:
    radius = np.where(limit.radius_mm < 2 * far, limit.radius_mm, np.nan)
    angle = np.concatenate([-limit.angle_rad[::-1], limit.angle_rad])
    both = np.concatenate([radius[::-1], radius])
    return np.stack([both * np.sin(angle), both * np.cos(angle)])


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
    drawn = picture("clearance", alt, _draw_clearance, silhouettes, limits, clearance_limit(scene))
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
    weight = scene.web.counterweight
    return [np.array(weight.drawing(scene).added)] if weight is not None and weight.bolted else []


def _along(loop: Array) -> Array:
    """Points (n, 2) along a closed loop, near enough to each other that none is missed."""
    edges = np.roll(loop, -1, axis=0) - loop
    steps = np.ceil(np.linalg.norm(edges, axis=1) / _STEP_MM).astype(int) + 1
    return np.concatenate(
        [at + np.linspace(0, 1, n)[:, None] * edge for at, edge, n in zip(loop, edges, steps, strict=True)]
    )
