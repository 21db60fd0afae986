"""From a scene to the domain of the optimiser: grid, solid fractions, design cells.

Most bodies are prisms along the crank axis: the solid fraction of a cell is a plane fraction times an overlap
in z, both exact, so stiffness does not jump with the cell size. Where a section changes along the axis, Gauss
quadrature goes through each layer of cells.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from cranktopo.base.arrays import Array
from cranktopo.base.errors import invalid
from cranktopo.base.spans import Section
from cranktopo.bodies.cells.drilled import drill_cells
from cranktopo.bodies.cells.fractions import EXACT, FillTolerance, plane_fractions, slab_fractions
from cranktopo.bodies.cells.grid import CellGrid, Extent, Reach, plan_grid
from cranktopo.bodies.cells.layers import (
    ORIGINAL_KEY,
    AxialLayer,
    GridContent,
    design_envelope,
    half_throw_layers,
)
from cranktopo.bodies.envelope_file import bounds_mm, envelope_bounds_mm
from cranktopo.design.checks.scene import check_envelope_reach
from cranktopo.design.crank_throws import refuse_flying_web, refuse_split_pins
from cranktopo.design.halves import envelope_asymmetry, may_mirror, require_equal_halves, web_asymmetry
from cranktopo.design.schema import Scene
from cranktopo.throw.web import web_bodies


@dataclass(frozen=True)
class Domain:
    """Cells of the throw model and what they hold.

    Attributes:
        grid: node coordinates.
        extent: "half" throw, its x >= 0 "quarter", or the "full" throw.
        passive_fraction: of each cell filled with undesignable solid (journal, pin, fixed web), (nx, ny, nz).
        design_fraction: of each cell that is designable, (nx, ny, nz); together they are at most 1.
        pin: fraction of each cell that is crankpin between the web faces (the loaded material).
        web: fraction of each cell that belongs to the web when full (between the web faces).
    """

    grid: CellGrid
    extent: Extent
    passive_fraction: Array
    design_fraction: Array
    pin: Array
    web: Array

    @property
    def mirrored_x(self) -> bool:
        """True if the plane x = 0 is a mirror of the model."""
        return self.extent == "quarter"

    @property
    def mirrored_z(self) -> bool:
        """True if the mid-pin plane is a mirror of the model."""
        return self.extent != "full"

    @property
    def web_layers(self) -> tuple[int, int]:
        """First and past-the-last z layer of the (first) web; its layers have one height."""
        half = self.grid.cells[2] // (2 if self.extent == "full" else 1)
        filled = np.flatnonzero(self.web[:, :, :half].any(axis=(0, 1)))
        return int(filled[0]), int(filled[-1]) + 1

    @property
    def symmetry_fraction(self) -> float:
        """Share of the full throw that the model holds."""
        return {"quarter": 0.25, "half": 0.5, "full": 1.0}[self.extent]

    @property
    def volume_mm3(self) -> Array:
        """Cell volumes broadcastable to (nx, ny, nz)."""
        return self.grid.cell_volume_mm3[None, None, :]


def laterally_symmetric(scene: Scene, target: GridContent) -> bool:
    """Tell whether the geometry (envelope or web) mirrors itself in x and the scene allows the mirror."""
    return may_mirror(scene, web_asymmetry(scene) if target == "web" else envelope_asymmetry(scene))


def build_domain(
    scene: Scene,
    resolution_mm: float,
    target: GridContent = "envelope",
    extent: Extent | None = None,
    grid: CellGrid | None = None,
    tolerance: FillTolerance = EXACT,
) -> Domain:
    """Return grid and cell fractions of a scene, without fillets and their recesses.

    Args:
        target: "envelope" makes the design space designable, "web" makes the scene's own web fixed solid.
        extent: part of the throw; by default the quarter when the geometry is symmetric in x, else the half.
        grid: a grid to fill instead of planning one, e.g. the envelope's for the original web.
        tolerance: accuracy of the fractions.

    Raises CranktopoError: no envelope, one that touches no journal, or halves of the throw that differ.
    """
    require_equal_halves(scene)
    refuse_flying_web(scene)
    refuse_split_pins(scene)
    if extent is None:
        extent = "quarter" if laterally_symmetric(scene, target) else "half"
    layers = half_throw_layers(scene, target)
    if grid is None:
        grid = plan_grid(*throw_reach(scene, target), resolution_mm, extent)
    planes = drill_cells(scene, grid, layers, _fractions(grid, layers, tolerance))
    planes = {kind: np.minimum(fraction, 1.0) for kind, fraction in planes.items()}
    planes["design_fraction"] = np.minimum(planes["design_fraction"], 1.0 - planes["passive_fraction"])
    if extent == "full":
        half = len(grid.z_mm) // 2
        planes = {k: np.concatenate([v[..., :half], v[..., :half][..., ::-1]], -1) for k, v in planes.items()}
    domain = Domain(grid, extent, **planes)
    if target == "envelope":
        _check_touches(scene, domain)
    return domain


def own_web(scene: Scene, domain: Domain) -> Array:
    """Return the solid fractions (nx, ny, nz) of the throw with the scene's own web on the same grid."""
    original = build_domain(scene, scene.optimise.resolution_mm, "web", domain.extent, domain.grid)
    return original.passive_fraction


def throw_reach(scene: Scene, target: GridContent) -> Reach:
    """Return the ranges of x and y of `throw_ranges_mm`, and the ends and web faces along z, mm."""
    return *throw_ranges_mm(scene, target), (0.0, *scene.web_z_mm, scene.pitch_mm / 2)


def throw_ranges_mm(scene: Scene, target: GridContent) -> tuple[tuple[float, float], tuple[float, float]]:
    """Return the ranges of x and y that hold journals, web and, for a design, the envelope, mm."""
    main, pin, r = scene.throw.main_journal.radius_mm, scene.throw.crankpin.radius_mm, scene.throw.radius_mm
    reach = max(main, pin)
    bounds = [(-reach, reach, -main, r + pin)]
    bounds += [(*body.x_range_mm, *body.y_range_mm) for body in web_bodies(scene) if body.adds]
    if scene.original is not None:
        bounds.append(bounds_mm(Path(scene.original.file), key=ORIGINAL_KEY))
    if target == "envelope":
        bounds.append(envelope_bounds_mm(design_envelope(scene)))
        check_envelope_reach(scene, bounds[-1])
    x_low, x_high, y_low, y_high = zip(*bounds, strict=True)
    return (min(x_low), max(x_high)), (min(y_low), max(y_high))


def _fractions(grid: CellGrid, layers: Sequence[AxialLayer], tolerance: FillTolerance) -> dict[str, Array]:
    result = {kind: np.zeros(grid.cells) for kind in ("passive_fraction", "design_fraction", "pin", "web")}
    for layer in layers:
        filled = {section: _filled(grid, layer, section, tolerance) for section in {*layer.sections.values()}}
        for kind, section in layer.sections.items():
            result[kind] += filled[section]
        if layer.replaces_design and layer.passive:
            result["design_fraction"] -= filled[layer.passive]
    result["design_fraction"] = np.maximum(result["design_fraction"], 0.0)
    return result


_ROWS_AT_ONCE = 2000
"""Rows of cells that are filled together, which bounds the memory: some 100 MiB."""


def _filled(grid: CellGrid, layer: AxialLayer, section: Section, tolerance: FillTolerance) -> Array:
    low, high = (np.clip(grid.z_mm[cells], *layer.z_mm) for cells in (slice(-1), slice(1, None)))
    shares = (high - low) / np.diff(grid.z_mm)
    # Rounding must not leave 1e-16 of a layer in its neighbour: that would be a void cell with stiffness.
    shares[shares < 1e-9] = 0.0
    if not layer.changes:
        plane = plane_fractions(grid.x_mm, grid.y_mm, sum(layer.z_mm) / 2, section, tolerance)
        return plane[..., None] * shares
    result, changing = np.zeros(grid.cells), np.flatnonzero(shares)
    for cells in np.array_split(changing, -(-len(changing) * grid.cells[1] // _ROWS_AT_ONCE)):
        slabs = np.array([low[cells], high[cells]])
        filled = slab_fractions(grid.x_mm, grid.y_mm, slabs, section, tolerance)
        result[:, :, cells] = filled * shares[cells]
    return result


def _check_touches(scene: Scene, domain: Domain) -> None:
    start, stop = scene.web_z_mm
    z = domain.grid.z_mm
    for key, face, before in (("throw.main_journal", start, 0), ("throw.crankpin", stop, 1)):
        layer = int(np.argmin(np.abs(z - face))) - before
        journal = domain.passive_fraction[:, :, layer + 1 if before else layer - 1]
        web = domain.design_fraction[:, :, layer] + domain.passive_fraction[:, :, layer]
        contact = np.sum(np.minimum(journal, web)) / np.sum(journal)
        if contact < 0.1:
            raise invalid(
                "envelope",
                scene.envelope.shape if scene.envelope else None,
                f"touches {100 * contact:.0f} % of the end face of {key}, at least 10 % is needed",
                "Enlarge or move the envelope so that it covers the journal.",
            )


def centres_mm(domain: Domain) -> tuple[Array, Array, Array]:
    """Return the centres of the cells of the web's layers along each axis, mm."""
    first, last = domain.web_layers
    x, y, z = (
        (nodes[1:] + nodes[:-1]) / 2 for nodes in (domain.grid.x_mm, domain.grid.y_mm, domain.grid.z_mm)
    )
    return x, y, z[first:last]


def on_cells(there: Domain, field: Array, here: Domain) -> Array:
    """Return a field on some cells (nx, ny, nw, ...) on others of the throw, linear between centres.

    Beyond the outermost centres the nearest value holds.
    """
    from scipy.interpolate import RegularGridInterpolator

    known, centres = centres_mm(there), centres_mm(here)
    inside = [np.clip(at, own[0], own[-1]) for at, own in zip(centres, known, strict=True)]
    points = np.stack(np.meshgrid(*inside, indexing="ij"), axis=-1)
    found: Array = RegularGridInterpolator(known, field)(points)
    return found
