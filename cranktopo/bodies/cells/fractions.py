"""Fill of each cell by a section across the crank axis, less what oil drillings take out of it.

The section's lateral intervals are exact; along the throw a quadrature goes over parts of a cell, which
are halved where both halves differ from the whole. A drilling is void that no optimiser fills, its wall solid
that none takes away: at each height a section like any other, which changes along the crank axis.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import partial
from itertools import pairwise

import numpy as np

from cranktopo.base.arrays import Array
from cranktopo.base.errors import invalid
from cranktopo.base.spans import Section, common, holds, section_difference, superpose_sections
from cranktopo.bodies.cells.grid import CellGrid
from cranktopo.bodies.cells.layers import AxialLayer
from cranktopo.bodies.envelope_file import envelope_section
from cranktopo.design.schema import Scene
from cranktopo.throw.drilling.bore import DrillBore
from cranktopo.throw.drilling.table import drill_bores
from cranktopo.throw.feature import DrilledBody
from cranktopo.throw.moments import gauss_rule
from cranktopo.throw.web import web_bodies

_PARTS = 4
"""Parts of a cell along the throw to begin with."""
_INNER = math.sqrt(3 / 7)
_SHARES = (np.array([-1.0, -_INNER, 0.0, _INNER, 1.0]) + 1) / 2
_WEIGHTS = np.array([9.0, 49.0, 64.0, 49.0, 9.0]) / 180
"""Lobatto points of 0 .. 1 and weights: a body that only just enters a part is seen at its end."""
_HALVINGS = 40
_GRAZED = 1e-5
"""A section that fills less of a cell, or all but less, leaves it empty or full: no slivers."""
_DIGITS = 7
_HEIGHTS = 5
"""Of the quadrature through a part of a slab."""
_THINNEST = 12
"""Halvings of a slab."""


@dataclass(frozen=True)
class FillTolerance:
    """Accuracy of the filled fractions of cells.

    Attributes:
        area: largest change of a cell's fraction in a plane by halving a part.
        slab: largest change of the filled area, in cells, by halving a part of a slab, times its share of it.
    """

    area: float = 1e-6
    slab: float = 3e-4


EXACT, QUICK = FillTolerance(), FillTolerance(1e-4, 3e-3)
"""The second one moves a stiffness by some millionths of it, and takes half of the time."""


def slab_fractions(
    x_mm: Array, y_mm: Array, z_mm: Array, section: Section, tolerance: FillTolerance = EXACT
) -> Array:
    """Return the filled fractions (nx, ny, slabs) of the cells between nodes along x and y.

    Gauss quadrature goes through each slab; parts of it are halved until the areas in both halves add up.

    Args:
        z_mm: lower and upper heights (2, slabs).
    """
    low, high = z_mm
    size, slab = high - low, np.arange(len(low))
    total, whole = (
        np.zeros((len(slab), len(x_mm) - 1, len(y_mm) - 1)),
        _through(x_mm, y_mm, low, high, section, tolerance),
    )
    for _ in range(_THINNEST):
        middle = (low + high) / 2
        below, above = np.split(
            _through(x_mm, y_mm, np.append(low, middle), np.append(middle, high), section, tolerance), 2
        )
        change = np.abs((below + above - whole).sum(axis=(1, 2)))
        open_ = change > tolerance.slab * size[slab]
        np.add.at(total, slab[~open_], (below + above)[~open_])
        low, high = (np.concatenate([a[open_], b[open_]]) for a, b in ((low, middle), (middle, high)))
        whole, slab = np.concatenate([below[open_], above[open_]]), np.tile(slab[open_], 2)
        if not len(low):
            break
    np.add.at(total, slab, whole)
    return np.asarray(total.transpose(1, 2, 0) / size)


def _through(
    x_mm: Array, y_mm: Array, low: Array, high: Array, section: Section, tolerance: FillTolerance
) -> Array:
    """Fractions times the heights of parts of slabs, (parts, nx, ny), mm."""
    shares, weights = gauss_rule(_HEIGHTS)
    size = high - low
    heights = low[:, None] + size[:, None] * shares
    planes = plane_fractions(x_mm, y_mm, heights.ravel(), section, tolerance)
    mean = planes.reshape(*planes.shape[:2], *heights.shape) @ weights
    return np.asarray((mean * size).transpose(2, 0, 1))


def plane_fractions(
    x_mm: Array, y_mm: Array, z_mm: Array, section: Section, tolerance: FillTolerance = EXACT
) -> Array:
    """Return the filled fraction (nx, ny, heights) of the cells between nodes along x and y."""
    heights, cells = len(z_mm), len(y_mm) - 1
    total, largest = np.zeros((heights * cells, len(x_mm) - 1)), np.outer(np.diff(y_mm), np.diff(x_mm))
    steps = np.diff(y_mm)[:, None] * np.arange(_PARTS + 1) / _PARTS + y_mm[:-1, None]
    row = np.repeat(np.arange(heights * cells), _PARTS)
    low, high = (np.tile(ends.ravel(), heights) for ends in (steps[:, :-1], steps[:, 1:]))

    def areas(low: Array, high: Array) -> Array:
        return _areas(x_mm, low, high, z_mm[row // cells], section)

    whole = areas(low, high)
    for _ in range(_HALVINGS):
        middle = (low + high) / 2
        below, above = areas(low, middle), areas(middle, high)
        open_ = (np.abs(below + above - whole) > tolerance.area * largest[row % cells]).any(axis=1)
        np.add.at(total, row[~open_], (below + above)[~open_])
        low, high = (np.concatenate([a[open_], b[open_]]) for a, b in ((low, middle), (middle, high)))
        whole, row = np.concatenate([below[open_], above[open_]]), np.tile(row[open_], 2)
        if not len(row):
            break
    np.add.at(total, row, whole)
    fraction = np.round(total.reshape(heights, cells, -1) / largest, _DIGITS).transpose(2, 1, 0)
    return np.where(fraction < _GRAZED, 0.0, np.where(fraction > 1 - _GRAZED, 1.0, fraction))


def _areas(x_mm: Array, low: Array, high: Array, z_mm: Array, section: Section) -> Array:
    """Areas (parts, nx) that a section fills between places along the throw at heights, mm2.

    What is filled before a lateral end is 1 in the columns before it, a share of its own and 0 behind: two
    steps, of which the sum along a row is taken once for all ends.
    """
    size, columns = high - low, len(x_mm)
    places = low[:, None] + size[:, None] * _SHARES
    spans = section(places.ravel(), np.repeat(z_mm, len(_SHARES)))
    filled = [np.flatnonzero(end > start) for start, end in spans]  # most sections are empty at most places
    starts, stops = (
        np.concatenate([span[side][at] for span, at in zip(spans, filled, strict=True)]) for side in (0, 1)
    )
    place, ends = np.concatenate(filled * 2), np.concatenate([starts, stops])
    sign = np.repeat([-1.0, 1.0], len(starts))
    column = np.clip(np.searchsorted(x_mm, ends, side="right") - 1, 0, columns - 2)
    share = np.clip((ends - x_mm[column]) / np.diff(x_mm)[column], 0.0, 1.0)
    weight = sign * (size[:, None] * _WEIGHTS).ravel()[place]
    at = place // len(_SHARES) * columns + column
    steps = np.bincount(at, weight * (share - 1), len(low) * columns)
    steps -= np.bincount(at + 1, weight * share, len(low) * columns)
    return np.asarray(steps.reshape(-1, columns)[:, :-1].cumsum(axis=1) * np.diff(x_mm))


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
        for slab in _slabs(grid, found, layer.z_mm):
            for kind, gained in slab.gains(grid, found, layer).items():
                drilled[kind][slab.x, slab.y, slab.cells] += gained
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


@dataclass(frozen=True)
class _Slab:
    """Part of a layer of cells between two heights: share of their height, cells that are reached."""

    z_mm: tuple[float, float]
    share: float
    x: slice
    y: slice
    cells: int

    def gains(self, grid: CellGrid, found: Sequence[_Tool], layer: AxialLayer) -> dict[str, Array]:
        """Return what is added to each kind of fraction in its cells, negative where it is taken away."""
        hole = superpose_sections(*(tool.hole for tool in found))
        wall = superpose_sections(*(tool.wall for tool in found))
        kinds = {kind: section for kind, section in layer.sections.items() if kind != "design_fraction"}
        known = {section: self._fractions(grid, common(section, hole)) for section in {*kinds.values()}}
        gains = {kind: -known[section] for kind, section in kinds.items()}
        if layer.design:
            kept = self._fractions(grid, common(layer.design, section_difference(wall, hole)))
            gains["design_fraction"] = -self._fractions(grid, common(layer.design, wall))
            gains["passive_fraction"] = gains.get("passive_fraction", 0.0) + kept
        return gains

    def _fractions(self, grid: CellGrid, section: Section) -> Array:
        x, y = (nodes[s.start : s.stop + 1] for nodes, s in ((grid.x_mm, self.x), (grid.y_mm, self.y)))
        return slab_fractions(x, y, np.array(self.z_mm)[:, None], section)[..., 0] * self.share


def _slabs(grid: CellGrid, found: Sequence[_Tool], z_mm: tuple[float, float]) -> Iterator[_Slab]:
    boxes = [box for tool in found for box in tool.boxes]
    ends = [float(end[2]) for box in boxes for end in box(_ALL)]
    low, high = max(z_mm[0], min(ends)), min(z_mm[1], max(ends))
    planes = sorted({low, high, *(z for z in (*grid.z_mm.tolist(), *ends) if low < z < high)})
    for start, end in pairwise(planes if low < high else ()):
        cells = int(np.searchsorted(grid.z_mm, (start + end) / 2)) - 1
        share = (end - start) / float(grid.z_mm[cells + 1] - grid.z_mm[cells])
        corners = np.array([box((start, end)) for box in boxes])
        first, last = corners[:, 0].min(axis=0), corners[:, 1].max(axis=0)
        x, y = (_cells(nodes, first[i], last[i]) for i, nodes in enumerate((grid.x_mm, grid.y_mm)))
        yield _Slab((start, end), share, x, y, cells)


def _cells(nodes: Array, low: float, high: float) -> slice:
    first = int(np.searchsorted(nodes, low, side="right")) - 1
    last = int(np.searchsorted(nodes, high, side="left"))
    first = min(max(first, 0), len(nodes) - 2)
    return slice(first, min(max(last, first + 1), len(nodes) - 1))


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
