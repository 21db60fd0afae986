"""From a scene to the domain of the optimiser: grid, solid fractions, design cells.

Every shape is an extrusion along the crank axis, so the solid fraction of a cell is a sampled plane
fraction (32 x 32 points) times an exact overlap in z: stiffness does not jump with the cell size.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from typing import Literal

import numpy as np
from manifold3d import Manifold
from numpy.typing import NDArray

from cranktopo.domain.drilled_cells import drill_cells
from cranktopo.domain.envelope_section import (
    SECTIONS,
    disc,
    envelope_bounds_mm,
    envelope_outline,
    envelope_sections,
)
from cranktopo.domain.grid import Extent, Grid, plan_grid
from cranktopo.domain.stl_envelope import bounds_mm, envelope_from_file
from cranktopo.errors import invalid
from cranktopo.scene.checks_sizes import check_envelope_reach
from cranktopo.scene.checks_web import check_counterweight_inside
from cranktopo.scene.clearance import clearance_limit
from cranktopo.scene.features import Body, kept_bodies, web_bodies, web_contains
from cranktopo.scene.geometry import Envelope, Journal
from cranktopo.scene.halves import require_equal_halves
from cranktopo.scene.polygons import Coordinates, Shape, polygons
from cranktopo.scene.schema import Scene
from cranktopo.scene.symmetry import envelope_asymmetry, may_mirror, web_asymmetry

ORIGINAL_KEY = "original.file"
GridContent = Literal["envelope", "web"]
Array = NDArray[np.float64]
SAMPLES = 32


@dataclass(frozen=True)
class Domain:
    """Cells of the throw model and what they hold.

    Attributes:
        grid: node coordinates.
        extent: "half" throw, its x >= 0 "quarter", or the "full" throw.
        fixed: fraction of each cell filled with undesignable solid (journal, pin, fixed web), (nx, ny, nz).
        design: fraction of each cell that is designable, (nx, ny, nz); fixed + design <= 1.
        pin: fraction of each cell that is crankpin between the web faces (the loaded material).
        web: fraction of each cell that belongs to the web when full (between the web faces).
    """

    grid: Grid
    extent: Extent
    fixed: Array
    design: Array
    pin: Array
    web: Array

    @property
    def mirrored_x(self) -> bool:
        """Whether the plane x = 0 is a mirror of the model."""
        return self.extent == "quarter"

    @property
    def mirrored_z(self) -> bool:
        """Whether the mid-pin plane is a mirror of the model."""
        return self.extent != "full"

    @property
    def web_layers(self) -> tuple[int, int]:
        """First and past-the-last z layer of the (first) web; its layers have one height."""
        filled = np.flatnonzero(self.web[:, :, : self._half_layers].any(axis=(0, 1)))
        return int(filled[0]), int(filled[-1]) + 1

    @property
    def _half_layers(self) -> int:
        return self.grid.cells[2] // (2 if self.extent == "full" else 1)

    @property
    def share(self) -> float:
        """Share of the full throw that the model holds."""
        return {"quarter": 0.25, "half": 0.5, "full": 1.0}[self.extent]

    @property
    def volume_mm3(self) -> Array:
        """Cell volumes broadcastable to (nx, ny, nz)."""
        return self.grid.cell_volume_mm3[None, None, :]


@dataclass(frozen=True)
class _Layer:
    """What fills the plane between two z values of the half throw."""

    z: tuple[float, float]
    fixed: Shape | None
    design: Shape | None
    pin: Shape | None
    web: Shape | None


def laterally_symmetric(scene: Scene, target: GridContent) -> bool:
    """Whether the geometry is its own mirror image in x and the scene allows the mirror.

    Args:
        target: whose geometry, that of the design envelope or of the scene's own web.
    """
    return may_mirror(scene, web_asymmetry(scene) if target == "web" else envelope_asymmetry(scene))


def build_domain(
    scene: Scene,
    resolution_mm: float,
    target: GridContent = "envelope",
    extent: Extent | None = None,
    grid: Grid | None = None,
) -> Domain:
    """Grid and cell fractions of a scene.

    Args:
        resolution_mm: largest cell edge, mm.
        target: "envelope" makes the design space designable, "web" makes the scene's own web fixed solid.
        extent: part of the throw; by default the quarter when the geometry is symmetric in x, else the half.
        grid: a grid to fill instead of planning one, e.g. the envelope's for the original web.

    Raises:
        CranktopoError: no envelope, one that does not touch a journal, or halves of the throw that differ.
    """
    require_equal_halves(scene)
    if extent is None:
        extent = "quarter" if laterally_symmetric(scene, target) else "half"
    layers = _layers(scene, target)
    grid = grid or _grid(scene, resolution_mm, target, extent)
    sampled: dict[Shape, Array] = {}  # a shape serves as design and as web: sample it once
    planes = {
        kind: _fractions(grid, [(layer.z, getattr(layer, kind)) for layer in layers], sampled)
        for kind in ("fixed", "design", "pin", "web")
    }
    planes = drill_cells(scene, grid, planes)
    if extent == "full":
        half = len(grid.z_mm) // 2
        planes = {k: np.concatenate([v[..., :half], v[..., :half][..., ::-1]], -1) for k, v in planes.items()}
    domain = Domain(grid, extent, **planes)
    if target == "envelope":
        _check_touches(scene, domain)
    return domain


def _layers(scene: Scene, target: GridContent) -> list[_Layer]:
    """The half throw as layers along z: main journal, web (cut where its section changes), crankpin."""
    start, stop = scene.web_z_mm
    pin_shape = _annulus(scene.throw.crankpin, scene.throw.radius_mm)
    layers = [_Layer((0.0, start), _annulus(scene.throw.main_journal, 0.0), None, None, None)]
    layers += _own_web(scene) if target == "web" else _design_space(scene)
    layers.append(_Layer((stop, scene.pitch_mm / 2), pin_shape, None, pin_shape, None))
    return layers


def _annulus(journal: Journal, y_mm: float) -> Shape:
    outer, bore = disc(journal.radius_mm, y_mm), disc(journal.bore_radius_mm, y_mm)
    if journal.bore_radius_mm == 0:
        return outer
    return lambda x, y: outer(x, y) & ~bore(x, y)


def _own_web(scene: Scene) -> list[_Layer]:
    """The web of the scene, or the body named as the original, as layers with the section in their middle."""
    if scene.original is not None:
        return _body_from_file(scene, envelope_from_file(Path(scene.original.file), key=ORIGINAL_KEY))
    bodies, found = web_bodies(scene), []
    for z in _ranges_mm(scene, [z for body in bodies for z in body.layers_mm(SECTIONS)]):
        shape = _section(bodies, sum(z) / 2)
        found.append(_Layer(z, fixed=shape, design=None, pin=None, web=shape))
    return found


def _body_from_file(scene: Scene, body: Manifold) -> list[_Layer]:
    found = []
    for z in _ranges_mm(scene, [float(z) for z in np.linspace(*scene.web_z_mm, SECTIONS + 1)]):
        shape = polygons([np.asarray(contour) for contour in body.slice(sum(z) / 2).to_polygons()])
        found.append(_Layer(z, fixed=shape, design=None, pin=None, web=shape))
    return found


def _section(bodies: Sequence[Body], z_mm: float) -> Shape:
    return lambda x, y: web_contains(bodies, x, y, z_mm)


def _design_space(scene: Scene) -> list[_Layer]:
    """The envelope less the bores as layers, a counterweight solid; in a clearance the journal alone."""
    (start, stop), envelope, throw = scene.web_z_mm, _envelope(scene), scene.throw
    low, high = start + envelope.bearing_clearance_mm, stop - envelope.rod_clearance_mm
    bores = [disc(journal.bore_radius_mm, y) for journal, y in throw.journals if journal.bore_radius_mm > 0]
    weights, found = kept_bodies(scene), []
    heights = [float(z) for z in np.linspace(low, high, envelope_sections(envelope) + 1)]
    for z in _ranges_mm(scene, [*heights, *(z for body in weights for z in body.z_mm)]):
        middle = sum(z) / 2
        if low < middle < high:
            outline = _turning_free(scene, envelope_outline(envelope, middle))
            check_counterweight_inside(scene, outline, middle)
            web = _without(outline, bores)
            here = [body for body in weights if body.z_mm[0] < middle < body.z_mm[1]]
            fixed = _without(_section(here, middle), bores) if here else None
            design = _without(web, [fixed]) if fixed else web
            found.append(_Layer(z, fixed=fixed, design=design, pin=None, web=web))
            continue
        journal, y = throw.journals[0 if middle < low else 1]
        shape = _without(disc(journal.radius_mm, y), bores)
        found.append(_Layer(z, fixed=shape, design=None, pin=None, web=shape))
    return found


def _turning_free(scene: Scene, outline: Shape) -> Shape:
    """The part of an outline that piston and crankcase leave free."""
    limit = clearance_limit(scene)
    if limit is None:
        return outline
    return lambda x, y: outline(x, y) & (limit.outside_mm(x, y) <= 0)


def _ranges_mm(scene: Scene, cuts: list[float]) -> list[tuple[float, float]]:
    start, stop = scene.web_z_mm
    return list(pairwise(sorted({start, stop, *(z for z in cuts if start < z < stop)})))


def _without(outline: Shape, holes: Sequence[Shape]) -> Shape:
    def inside(x: Coordinates, y: Coordinates) -> NDArray[np.bool_]:
        result = outline(x, y)
        for hole in holes:
            result = result & ~hole(x, y)
        return result

    return inside


def _envelope(scene: Scene) -> Envelope:
    if scene.envelope is None:
        raise invalid("envelope", None, "an optimisation needs a design envelope", "Add an [envelope] table.")
    return scene.envelope


def throw_ranges_mm(scene: Scene, target: GridContent) -> tuple[tuple[float, float], tuple[float, float]]:
    """Lateral range and range along the throw that hold journals, web and, for a design, the envelope, mm.

    Args:
        target: "envelope" for a design, "web" for the scene's own web.
    """
    main, pin, r = scene.throw.main_journal.radius_mm, scene.throw.crankpin.radius_mm, scene.throw.radius_mm
    reach = max(main, pin)
    bounds = [(-reach, reach, -main, r + pin)]
    bounds += [(*body.x_range_mm, *body.y_range_mm) for body in web_bodies(scene) if body.adds]
    if scene.original is not None:
        bounds.append(bounds_mm(Path(scene.original.file), key=ORIGINAL_KEY))
    if target == "envelope":
        bounds.append(envelope_bounds_mm(_envelope(scene)))
        check_envelope_reach(scene, bounds[-1])
    x_low, x_high, y_low, y_high = zip(*bounds, strict=True)
    return (min(x_low), max(x_high)), (min(y_low), max(y_high))


def _grid(scene: Scene, resolution_mm: float, target: GridContent, extent: Extent) -> Grid:
    x_range, y_range = throw_ranges_mm(scene, target)
    planes = (0.0, *scene.web_z_mm, scene.pitch_mm / 2)
    return plan_grid(x_range, y_range, planes, resolution_mm, extent)


def _fractions(
    grid: Grid, layers: list[tuple[tuple[float, float], Shape | None]], sampled: dict[Shape, Array]
) -> Array:
    """Filled fraction of every cell for shapes extruded between z values."""
    result = np.zeros(grid.cells)
    heights = np.diff(grid.z_mm)
    for (low, high), shape in layers:
        if shape is None:
            continue
        overlap = (
            np.clip(np.minimum(grid.z_mm[1:], high) - np.maximum(grid.z_mm[:-1], low), 0, None) / heights
        )
        # Rounding must not leave 1e-16 of a layer in its neighbour: that would be a void cell with stiffness.
        overlap[overlap < 1e-9] = 0.0
        if shape not in sampled:
            sampled[shape] = _plane_fraction(grid, shape)
        result += sampled[shape][:, :, None] * overlap
    return np.minimum(result, 1.0)


def _plane_fraction(grid: Grid, shape: Shape) -> Array:
    """Filled fraction of every (x, y) cell from SAMPLES x SAMPLES points."""
    nx, ny, _ = grid.cells
    x = _sample_points(grid.x_mm)
    y = _sample_points(grid.y_mm)
    fraction = np.empty((nx, ny))
    rows = max(1, math.floor(2e6 / (len(y) * SAMPLES)))  # bounded memory
    for first in range(0, nx, rows):
        part = x[first * SAMPLES : (first + rows) * SAMPLES]
        hits = shape(part[:, None], y[None, :]).reshape(-1, SAMPLES, ny, SAMPLES)
        fraction[first : first + rows] = hits.mean(axis=(1, 3))
    return fraction


def _sample_points(edges: Array) -> Array:
    step = np.diff(edges)[:, None]
    offsets = (np.arange(SAMPLES) + 0.5) / SAMPLES
    return np.asarray((edges[:-1, None] + step * offsets).ravel())


def _check_touches(scene: Scene, domain: Domain) -> None:
    """Both journals must meet designable cells at the web faces."""
    start, stop = scene.web_z_mm
    z = domain.grid.z_mm
    faces = (
        ("throw.main_journal", int(np.argmin(np.abs(z - start))), 0),
        ("throw.crankpin", int(np.argmin(np.abs(z - stop))), -1),
    )
    for key, plane, side in faces:
        journal = domain.fixed[:, :, plane - 1 if side == 0 else plane]
        layer = plane if side == 0 else plane - 1
        web = domain.design[:, :, layer] + domain.fixed[:, :, layer]
        contact = np.sum(np.minimum(journal, web)) / np.sum(journal)
        if contact < 0.1:
            raise invalid(
                "envelope",
                scene.envelope.shape if scene.envelope else None,
                f"touches {100 * contact:.0f} % of the end face of {key}, at least 10 % is needed",
                "Enlarge or move the envelope so that it covers the journal.",
            )
