"""Exact solids of the half throw: journals, bores, design envelope; as fine prisms in the boolean engine."""

from __future__ import annotations

import operator
from functools import reduce

import numpy as np
from manifold3d import CrossSection, FillRule, JoinType, Manifold

from cranktopo.base.arrays import Array
from cranktopo.base.frames import X
from cranktopo.bodies.cells.grid import DensityGrid
from cranktopo.bodies.drill_tool import drill_tool, segments
from cranktopo.bodies.envelope_file import (
    envelope_from_file,
    envelope_z_mm,
    mirror_difference,
    through_holes,
    with_faces_at,
)
from cranktopo.bodies.seat import seat_z_mm, sector_less_web
from cranktopo.bodies.zones import zone_solids
from cranktopo.design.bolt_holes import bolt_holes, far_mm
from cranktopo.design.clearance import clearance_limit
from cranktopo.design.schema import Scene
from cranktopo.numerics.surfaces.mesh import SurfaceMesh, mesh_of, snapped
from cranktopo.throw.drilling.outlet import across
from cranktopo.throw.drilling.table import drill_bores
from cranktopo.throw.envelope import BoxEnvelope, CylinderEnvelope, OutlineEnvelope, StlEnvelope
from cranktopo.throw.journal import Journal
from cranktopo.throw.primitives import Cylinder, Extrusion, LineSegment, Solid
from cranktopo.throw.web import kept_bodies, kept_holes

_BEYOND_MM = 1.0
_OVERLAP_MM = 0.2
_SLICES = 32
ON_MIRROR_MM = 1e-4


def cylinder(radius_mm: float, y_mm: float, z_mm: tuple[float, float]) -> Manifold:
    """Return a cylinder parallel to the crank axis at x = 0, with its vertices on the true circle."""
    solid = Manifold.cylinder(z_mm[1] - z_mm[0], radius_mm, radius_mm, segments(radius_mm))
    return solid.translate((0.0, y_mm, z_mm[0]))


def journal_halves(scene: Scene) -> tuple[Manifold, Manifold]:
    """Return half main journal (z = 0 to the web) and half crankpin (web to pitch / 2), with their bores."""
    start, end = scene.web_z_mm
    throw = scene.throw
    main = _tube(throw.main_journal, 0.0, (0.0, start))
    pin = _tube(throw.crankpin, throw.radius_mm, (end, scene.pitch_mm / 2))
    if not scene.throw.drilling:
        return main, pin
    drilled = drillings(scene)
    return main - drilled, pin - drilled


def web_bores(scene: Scene) -> Manifold:
    """Return what bores and drillings take out of the web: a bore runs from face to face, and stops there."""
    start, end = scene.web_z_mm
    through = (start - _BEYOND_MM, end + _BEYOND_MM)
    bores = [cylinder(j.bore_radius_mm, y, through) for j, y in scene.throw.journals if j.bore_radius_mm > 0]
    return sum(bores, drillings(scene))


def feature_holes(scene: Scene) -> Manifold:
    """Return what no optimiser fills: holes of features, each as its tool, and empty parts of zones."""
    solids = (solid for body in kept_holes(scene) for solid in body.solids())
    return sum((_tool(solid) for solid in solids), zone_solids(scene)[1])


def bolted_counterweight(scene: Scene) -> Manifold:
    """Return a counterweight that is a part of its own, its holes and bevels cut; empty without one."""
    weight, ends = scene.web.counterweight, seat_z_mm(scene)
    if weight is None or ends is None:
        return Manifold()
    solids = [solid for cut in weight.cuts(scene) for solid in cut.solids()]
    solids += [tool for bolt in bolt_holes(scene) for tool in bolt.weight_tools(far_mm(scene))]
    tools = (_tool(solid) for solid in solids)
    return _prism(sector_less_web(scene), *ends) - sum(tools, Manifold())


def with_bolted(half_throw: SurfaceMesh, scene: Scene) -> SurfaceMesh:
    """Return the surface of a half throw and of what is bolted to its web, to look at: bodies that touch."""
    bolted = bolted_counterweight(scene)
    if bolted.is_empty():
        return half_throw
    beside, own = mesh_of(bolted), len(half_throw.vertices_mm)
    vertices = np.concatenate([half_throw.vertices_mm, beside.vertices_mm])
    return SurfaceMesh(vertices, np.concatenate([half_throw.faces, beside.faces + own]))


def thread_holes(scene: Scene) -> Manifold:
    """Return the core holes of the bolts of a counterweight in one web; empty where none are placed."""
    return sum((_tool(bolt.thread_tool(far_mm(scene))) for bolt in bolt_holes(scene)), Manifold())


def _tool(solid: Solid) -> Manifold:
    """Return a cylinder, or a convex contour of straight edges that is swept; holes of features are these."""
    if isinstance(solid, Cylinder):
        return _hole(np.array(solid.start), np.array(solid.axis), solid.radius)
    assert isinstance(solid, Extrusion)
    corners = np.array([edge.start for edge in solid.contour if isinstance(edge, LineSegment)])
    return Manifold.hull_points(np.concatenate([corners, corners + solid.path]))


def _hole(start: Array, axis: Array, radius_mm: float) -> Manifold:
    """Return a cylinder about any axis, from the middle of its first end."""
    length = float(np.linalg.norm(axis))
    hole = Manifold.cylinder(length, radius_mm, radius_mm, segments(radius_mm))
    return hole.transform(np.column_stack([*across(axis / length), axis / length, start]))


def drillings(scene: Scene, around: int | None = None) -> Manifold:
    """Return what the oil drillings take out of the half throw, with the roundings of their outlets.

    Their circles have so many chords; by default as many as an export needs.
    """
    return sum((drill_tool(bore, around) for bore in drill_bores(scene)), Manifold())


def envelope_holes(scene: Scene) -> Manifold:
    """Return holes through the envelope, drilled after forging as bores are; in slices, just wider."""
    start, end = envelope_z_mm(scene)
    edges = np.linspace(start, end, _SLICES + 1)
    holes = through_holes(scene, ((edges[1:] + edges[:-1]) / 2).tolist())
    edges[0], edges[-1] = scene.web_z_mm[0] - _BEYOND_MM, scene.web_z_mm[1] + _BEYOND_MM
    drilled = Manifold()
    for contours, low, high in zip(holes, edges[:-1], edges[1:], strict=True):
        if contours:
            wider = CrossSection(contours, FillRule.NonZero).offset(_OVERLAP_MM, JoinType.Miter)
            drilled += _prism(wider, float(low), float(high))
    return drilled


def journal_stubs(scene: Scene) -> Manifold:
    """Return both journals through the clearances that the envelope leaves at the web faces."""
    envelope, throw = scene.envelope, scene.throw
    start, end = scene.web_z_mm
    stubs = Manifold()
    if envelope is not None and envelope.bearing_clearance_mm > 0:
        stubs += cylinder(throw.main_journal.radius_mm, 0.0, (start, start + envelope.bearing_clearance_mm))
    if envelope is not None and envelope.rod_clearance_mm > 0:
        stubs += cylinder(throw.crankpin.radius_mm, throw.radius_mm, (end - envelope.rod_clearance_mm, end))
    return stubs


def kept_solid(scene: Scene) -> Manifold:
    """Return what no optimiser takes away, within what the envelope's clearances leave."""
    return _kept_prisms(scene) + zone_solids(scene)[0]


def _kept_prisms(scene: Scene) -> Manifold:
    low, high = envelope_z_mm(scene)
    solids = [
        _prism(
            CrossSection([body.polygon_mm(segments)], FillRule.NonZero),
            max(low, body.z_mm[0]),
            min(high, body.z_mm[1]),
        )
        for body in kept_bodies(scene)
    ]
    return reduce(operator.add, solids) if solids else Manifold()


def envelope_solid(scene: Scene, grid: DensityGrid) -> Manifold:
    """Return the envelope between web faces less the clearances, and what piston and crankcase leave of it.

    Raises CranktopoError: the envelope's STL is missing or not closed, or an outline crosses itself.
    """
    whole, limit = _whole_envelope(scene, grid), clearance_limit(scene)
    if limit is None:
        return whole
    far = float(np.abs([grid.origin_mm[:2], grid.upper_mm[:2]]).max())
    free = CrossSection([limit.contour(2 * far)], FillRule.NonZero)
    return whole ^ _prism(free, *envelope_z_mm(scene))


def _whole_envelope(scene: Scene, grid: DensityGrid) -> Manifold:
    envelope = scene.envelope
    start, end = envelope_z_mm(scene)
    if envelope is None:
        return _prism(_rectangle(grid.origin_mm[:2], grid.upper_mm[:2]), start, end)
    match envelope:
        case StlEnvelope(symmetric=symmetric):
            between = _prism(_rectangle(grid.origin_mm[:2] - 1e3, grid.upper_mm[:2] + 1e3), start, end)
            return with_faces_at(envelope_from_file(envelope.stl_file, symmetric), start, end) ^ between
        case CylinderEnvelope(radius_mm=radius):
            return cylinder(radius, 0.0, (start, end))
        case BoxEnvelope(half_width_mm=half):
            corners = np.array([[-half, envelope.y_min_mm], [half, envelope.y_max_mm]])
            return _prism(_rectangle(*corners), start, end)
        case OutlineEnvelope(points_mm=points):
            return _prism(CrossSection([np.array(points)], FillRule.EvenOdd), start, end)


def journal_ends(scene: Scene) -> Manifold:
    """Return what stands on the web's faces: a slice of each journal, bores filled."""
    start, end = scene.web_z_mm
    ends = ((start - _BEYOND_MM / 2, start), (end, end + _BEYOND_MM / 2))
    slices = [cylinder(j.radius_mm, y, z) for (j, y), z in zip(scene.throw.journals, ends, strict=True)]
    return sum(slices, Manifold())


def web_region(solid: Manifold, scene: Scene) -> Manifold:
    """Return the part of a solid between the web faces."""
    start, end = scene.web_z_mm
    return solid.trim_by_plane((0.0, 0.0, 1.0), start).trim_by_plane((0.0, 0.0, -1.0), -end)


def snapped_to_mirror_plane(points: np.ndarray, within_mm: float = ON_MIRROR_MM) -> np.ndarray:
    """Put points (n, 3) with a tiny |x| on x = 0, in place: mirrored halves then leave no slivers there."""
    return snapped(points, X, 0.0, within_mm)


def is_mirror_image(solid: Manifold, share: float = 1e-9) -> bool:
    """Tell whether a solid is its own mirror image in the plane x = 0."""
    return mirror_difference(solid) <= share


def _tube(journal: Journal, y_mm: float, z_mm: tuple[float, float]) -> Manifold:
    body = cylinder(journal.radius_mm, y_mm, z_mm)
    if journal.bore_radius_mm == 0:
        return body
    return body - cylinder(journal.bore_radius_mm, y_mm, (z_mm[0] - _BEYOND_MM, z_mm[1] + _BEYOND_MM))


def _rectangle(lower: np.ndarray, upper: np.ndarray) -> CrossSection:
    return CrossSection.square(tuple(upper - lower)).translate(tuple(lower))


def _prism(section: CrossSection, start_mm: float, end_mm: float) -> Manifold:
    return section.extrude(end_mm - start_mm).translate((0.0, 0.0, start_mm))
