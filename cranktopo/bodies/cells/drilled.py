"""Oil drillings and holes, taken out of the filled fractions of cells.

A drilling is void that no optimiser fills, its wall solid that none takes away: at each height a section like
any other, which changes along the crank axis.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import partial
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from cranktopo.base.arrays import Array
from cranktopo.base.errors import invalid
from cranktopo.base.spans import Section, common, holds, section_difference, superpose_sections
from cranktopo.bodies.cells.fractions import slab_fractions
from cranktopo.bodies.cells.grid import CellGrid
from cranktopo.bodies.cells.layers import AxialLayer
from cranktopo.bodies.envelope_file import envelope_section
from cranktopo.design.schema import Scene
from cranktopo.throw.drilling.bore import DrillBore
from cranktopo.throw.drilling.table import drill_bores
from cranktopo.throw.feature import DrilledBody
from cranktopo.throw.web import web_bodies

_ROUNDING = 1e-6
"""Largest fraction that is left of a cell by rounding."""
_CHECKED_HEIGHTS = 24
"""Heights of the web at which the envelope must hold the drilling."""


def drill_cells(
    scene: Scene, grid: CellGrid, layers: Sequence[AxialLayer], fractions: dict[str, Array]
) -> dict[str, Array]:
    """Return the cells' fractions after drilling; raises CranktopoError where one leaves the envelope."""
    bores = drill_bores(scene)
    holes = [body for body in web_bodies(scene) if isinstance(body, DrilledBody)]
    if not bores and not holes:
        return fractions
    if any(layer.design for layer in layers):
        for bore in bores:
            _check_held(scene, bore)
    found = [*map(_tool_of_bore, bores), *map(_tool_of_hole, holes)]
    drilled = {kind: fraction.copy() for kind, fraction in fractions.items()}
    for layer in layers:
        slabs = list(_slabs(grid, found, layer.z_mm))
        if not slabs:
            continue
        x, y = _window(grid, found, (slabs[0].z_mm[0], slabs[-1].z_mm[1]))
        for kind, gained in _gains((grid.x_mm[x], grid.y_mm[y]), slabs, found, layer).items():
            for number, slab in enumerate(slabs):
                drilled[kind][x.start : x.stop - 1, y.start : y.stop - 1, slab.cells] += gained[..., number]
    # Rounding must leave neither void nor solid that is not there.
    return {kind: np.where(fraction < _ROUNDING, 0.0, fraction) for kind, fraction in drilled.items()}


_Box = Callable[[tuple[float, float]], tuple[Array, Array]]
"""Least and largest x, y and z between two heights."""
_ALL = -math.inf, math.inf


@dataclass(frozen=True)
class _Tool:
    """A hole to drill out of the cells, with the wall around it that stays, and boxes around either."""

    hole: Section
    wall: Section
    boxes: tuple[_Box, ...]


def _tool_of_bore(bore: DrillBore) -> _Tool:
    radii = bore.radius_mm, bore.wall_mm
    hole, wall = map(bore.section, radii)
    return _Tool(hole, wall, tuple(partial(bore.box_mm, radius) for radius in radii))


def _tool_of_hole(hole: DrilledBody) -> _Tool:
    return _Tool(hole.spans, hole.spans, (hole.bounds_mm,))


class _Slab(NamedTuple):
    """Part of a layer of cells between two heights: share of their height."""

    z_mm: tuple[float, float]
    share: float
    cells: int


def _gains(
    nodes_mm: tuple[Array, Array], slabs: Sequence[_Slab], found: Sequence[_Tool], layer: AxialLayer
) -> dict[str, Array]:
    """Return what slabs add to each kind of fraction (nx, ny, slabs), negative where it is taken away."""
    z_mm, shares = np.transpose([slab.z_mm for slab in slabs]), np.array([slab.share for slab in slabs])

    def filled(section: Section) -> Array:
        return slab_fractions(*nodes_mm, z_mm, section) * shares

    hole = superpose_sections(*(tool.hole for tool in found))
    wall = superpose_sections(*(tool.wall for tool in found))
    kinds = {kind: section for kind, section in layer.sections.items() if kind != "design_fraction"}
    known = {section: filled(common(section, hole)) for section in {*kinds.values()}}
    gains = {kind: -known[section] for kind, section in kinds.items()}
    if layer.design:
        kept = filled(common(layer.design, section_difference(wall, hole)))
        gains["design_fraction"] = -filled(common(layer.design, wall))
        gains["passive_fraction"] = gains.get("passive_fraction", 0.0) + kept
    return gains


def _slabs(grid: CellGrid, found: Sequence[_Tool], z_mm: tuple[float, float]) -> Iterator[_Slab]:
    boxes = [box for tool in found for box in tool.boxes]
    ends = [float(end[2]) for box in boxes for end in box(_ALL)]
    low, high = max(z_mm[0], min(ends)), min(z_mm[1], max(ends))
    planes = sorted({low, high, *(z for z in (*grid.z_mm.tolist(), *ends) if low < z < high)})
    for start, end in pairwise(planes if low < high else ()):
        cells = int(np.searchsorted(grid.z_mm, (start + end) / 2)) - 1
        share = (end - start) / float(grid.z_mm[cells + 1] - grid.z_mm[cells])
        yield _Slab((start, end), share, cells)


def _window(grid: CellGrid, found: Sequence[_Tool], z_mm: tuple[float, float]) -> tuple[slice, slice]:
    """Return the nodes along x and y around what tools reach between two heights."""
    corners = np.array([box(z_mm) for tool in found for box in tool.boxes])
    first, last = corners[:, 0].min(axis=0), corners[:, 1].max(axis=0)
    x, y = (_nodes(nodes, first[i], last[i]) for i, nodes in enumerate((grid.x_mm, grid.y_mm)))
    return x, y


def _nodes(nodes: Array, low: float, high: float) -> slice:
    first = int(np.searchsorted(nodes, low, side="right")) - 1
    last = int(np.searchsorted(nodes, high, side="left"))
    first = min(max(first, 0), len(nodes) - 2)
    return slice(first, min(max(last, first + 1), len(nodes) - 1) + 1)


def _check_held(scene: Scene, bore: DrillBore) -> None:
    """The envelope must hold a drilling and the wall around it between the web's faces, but in the bores."""
    (start, end), envelope = scene.web_z_mm, scene.envelope
    points = bore.surface_mm(bore.wall_mm)
    edges = np.linspace(start, end, _CHECKED_HEIGHTS + 1)
    assert envelope is not None  # or there is nothing to design
    for low, high in pairwise(edges.tolist()):
        x, y, z = points[(points[:, 2] > low) & (points[:, 2] < high)].T
        held = holds(envelope_section(envelope, (low + high) / 2)(y, z), x)
        for journal, axis in scene.throw.journals:
            held |= np.hypot(x, y - axis) <= journal.bore_radius_mm
        if not held.all():
            raise invalid(
                "envelope",
                envelope.shape,
                f"does not hold {bore.key} and the wall of {bore.wall_mm - bore.radius_mm:.3g} mm around it",
                "Enlarge the envelope, or move the drilling.",
            )
