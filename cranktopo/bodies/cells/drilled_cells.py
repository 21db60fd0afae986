"""Oil drillings on the cells: void that no optimiser fills, and a wall around it that none takes away.

At each height a drilling is a section like any other, which changes along the crank axis.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from cranktopo.base.arrays import Array
from cranktopo.base.errors import invalid
from cranktopo.base.spans import Section, common, holds, section_difference, together
from cranktopo.bodies.cells.grid import CellGrid
from cranktopo.bodies.cells.layers import AxialLayer
from cranktopo.bodies.cells.plane_fractions import slab_fractions
from cranktopo.bodies.envelope_file import envelope_section
from cranktopo.design.schema import Scene
from cranktopo.throw.drilling.bore import DrillBore
from cranktopo.throw.drilling.table import drill_bores

_ROUNDING = 1e-6
"""Largest fraction that is left of a cell by rounding."""
_HEIGHTS = 24
"""Heights of the web at which the envelope must hold the drilling."""


def drill_cells(
    scene: Scene, grid: CellGrid, layers: Sequence[AxialLayer], fractions: dict[str, Array]
) -> dict[str, Array]:
    """Fractions of the cells after drilling; the same ones where the scene has no drilling.

    Args:
        layers: of the half throw.
        fractions: those of the domain, each (nx, ny, nz).

    Raises:
        CranktopoError: a drilling leaves the design envelope.
    """
    found = drill_bores(scene)
    if not found:
        return fractions
    if any(layer.design for layer in layers):
        for bore in found:
            _check_held(scene, bore)
    drilled = {kind: fraction.copy() for kind, fraction in fractions.items()}
    for layer in layers:
        for slab in _slabs(grid, found, layer.z_mm):
            for kind, gained in slab.gains(grid, found, layer).items():
                drilled[kind][slab.x, slab.y, slab.cells] += gained
    # Rounding must leave neither void nor solid that is not there.
    return {kind: np.where(fraction < _ROUNDING, 0.0, fraction) for kind, fraction in drilled.items()}


@dataclass(frozen=True)
class _Slab:
    """What lies between two heights, in one layer of cells.

    Attributes:
        z_mm: the heights.
        share: of the height of the cells.
        x, y: cells that drillings or their walls may reach.
        cells: their layer.
    """

    z_mm: tuple[float, float]
    share: float
    x: slice
    y: slice
    cells: int

    def gains(self, grid: CellGrid, found: Sequence[DrillBore], layer: AxialLayer) -> dict[str, Array]:
        """Return what is added to each kind of fraction in its cells, negative where it is taken away."""
        hole = together(*(bore.section(bore.radius_mm) for bore in found))
        wall = together(*(bore.section(bore.wall_mm) for bore in found))
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
        return slab_fractions(x, y, self.z_mm, section) * self.share


def _slabs(grid: CellGrid, found: Sequence[DrillBore], z_mm: tuple[float, float]) -> Iterator[_Slab]:
    """Slabs between two heights that drillings or their walls reach."""
    tools = [(bore, radius) for bore in found for radius in (bore.radius_mm, bore.wall_mm)]
    ends = [float(end[2]) for bore, radius in tools for end in bore.box_mm(radius)]
    low, high = max(z_mm[0], min(ends)), min(z_mm[1], max(ends))
    planes = sorted({low, high, *(z for z in (*grid.z_mm.tolist(), *ends) if low < z < high)})
    for start, end in pairwise(planes if low < high else ()):
        cells = int(np.searchsorted(grid.z_mm, (start + end) / 2)) - 1
        share = (end - start) / float(grid.z_mm[cells + 1] - grid.z_mm[cells])
        corners = np.array([bore.box_mm(radius, (start, end)) for bore, radius in tools])
        first, last = corners[:, 0].min(axis=0), corners[:, 1].max(axis=0)
        x, y = (_cells(nodes, first[i], last[i]) for i, nodes in enumerate((grid.x_mm, grid.y_mm)))
        yield _Slab((start, end), share, x, y, cells)


def _cells(nodes: Array, low: float, high: float) -> slice:
    """Cells that a range touches; at least one."""
    first = int(np.searchsorted(nodes, low, side="right")) - 1
    last = int(np.searchsorted(nodes, high, side="left"))
    first = min(max(first, 0), len(nodes) - 2)
    return slice(first, min(max(last, first + 1), len(nodes) - 1))


def _check_held(scene: Scene, bore: DrillBore) -> None:
    """The envelope must hold a drilling and the wall around it between the web's faces."""
    (start, end), envelope = scene.web_z_mm, scene.envelope
    points = bore.surface_mm(bore.wall_mm)
    edges = np.linspace(start, end, _HEIGHTS + 1)
    assert envelope is not None  # or there is nothing to design
    for low, high in pairwise(edges.tolist()):
        x, y, z = points[(points[:, 2] > low) & (points[:, 2] < high)].T
        if not holds(envelope_section(envelope, (low + high) / 2)(y, z), x).all():
            raise invalid(
                "envelope",
                envelope.shape,
                f"does not hold {bore.key} and the wall of {bore.wall_mm - bore.radius_mm:.3g} mm around it",
                "Enlarge the envelope, or move the drilling.",
            )
