"""Volume of the half throw without a CAD kernel: sections and quadrature, the oracle of every solid."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from functools import lru_cache
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from cranktopo.scene import Scene
from cranktopo.scene.bevel import bevel_arc, height_range_mm
from cranktopo.scene.features import Feature, Wedge, bores, pockets
from cranktopo.scene.geometry import Journal
from cranktopo.scene.outline import half_width_mm, outline_kinks_mm, y_range_mm

Array = NDArray[np.float64]
_POINTS = 200
_SEARCH = 201
_BISECTIONS = 45


def half_throw_volume_mm3(scene: Scene) -> float:
    """Volume of the half throw, mm3: journals, web and fillets less bores and pockets."""
    throw = scene.throw
    total = web_volume_mm3(scene)
    for journal in (throw.main_journal, throw.crankpin):
        ring = journal.radius_mm**2 - journal.bore_radius_mm**2
        total += math.pi * ring * journal.length_mm / 2
    start, end = scene.web_z_mm
    total += _fillet_volume(scene, throw.main_journal, 0.0, start)
    return total + _fillet_volume(scene, throw.crankpin, throw.radius_mm, end)


@lru_cache(maxsize=16)
def web_volume_mm3(scene: Scene) -> float:
    """Volume of the web between its two faces, mm3: layer by layer, each layer an area of constant shape."""
    features: list[Feature] = [*bores(scene), *pockets(scene)]
    wedges = [f for f in features if isinstance(f, Wedge)]
    prisms = [f for f in features if not isinstance(f, Wedge)]
    levels = sorted({*scene.web_z_mm, *(z for f in prisms for z in f.z_mm)})
    total = 0.0
    for low, high in pairwise(levels):
        cuts = [f for f in prisms if f.z_mm[0] <= low and f.z_mm[1] >= high]
        total += _layer_volume(scene, cuts, (low, high))
    return total - sum(_wedge_volume(scene, wedge) for wedge in wedges)


def _layer_volume(scene: Scene, cuts: Sequence[Feature], layer: tuple[float, float]) -> float:
    """Volume between two heights; bevels make the layer's height depend on the place along the throw."""
    web, radius, start = scene.web, scene.throw.radius_mm, scene.web_z_mm[0]

    def slice_area(y: Array) -> Array:
        half = half_width_mm(web, radius, y)
        low, high = height_range_mm(web, radius, y)
        height = np.minimum(layer[1], start + high) - np.maximum(layer[0], start + low)
        return np.asarray(np.maximum(height, 0.0) * (2 * half - _cut_length(cuts, y, half)))

    return _integrate(slice_area, _breaks(scene, cuts, layer))


def _wedge_volume(scene: Scene, wedge: Wedge) -> float:
    """Volume that one slot with sloped walls takes from the web, from sections across the throw.

    In a section the slot's depth falls off linearly beyond its floor, and the bevels bound its height.
    """
    web, radius, start = scene.web, scene.throw.radius_mm, scene.web_z_mm[0]

    def slice_area(y: Array) -> Array:
        low, high = (start + height for height in height_range_mm(web, radius, y))
        deep = half_width_mm(web, radius, y) - wedge.open_from_mm(y)
        flat = _flat_half_height(wedge, y)
        upper = _slot_side(deep, high - wedge.z_centre_mm, flat, wedge.slope)
        lower = _slot_side(deep, wedge.z_centre_mm - low, flat, wedge.slope)
        return np.asarray(np.where(deep > 0, upper + lower, 0.0))

    corners = {wedge.y_mm - wedge.half_length_mm, wedge.y_mm + wedge.half_length_mm}
    places = sorted(corners | set(_breaks(scene, [wedge], scene.web_z_mm)))
    edges = [_root_places(gap, a, b) for a, b in pairwise(places) for gap in _slot_edges(scene, wedge)]
    return _integrate(slice_area, sorted({*places, *(y for found in edges for y in found)}))


def _flat_half_height(wedge: Wedge, y_mm: Array) -> Array:
    """Half-height over which a slot has its full depth: more in its end walls, which are less deep."""
    return np.asarray(wedge.half_height_mm + wedge.slope * (wedge.open_from_mm(y_mm) - wedge.floor_mm))


def _slot_side(deep: Array, height: Array, flat: Array, slope: float) -> Array:
    """Area on one side of a slot's middle up to a height: full depth, then the sloped wall."""
    wall = np.clip(height - flat, 0.0, np.maximum(slope * deep, 0.0))
    return np.asarray(deep * (np.minimum(height, flat) + wall) - wall**2 / (2 * slope))


def _slot_edges(scene: Scene, wedge: Wedge) -> list[Callable[[Array], Array]]:
    """Functions of y that vanish where a bevel meets an edge of the slot's floor or of its opening."""
    web, radius, start = scene.web, scene.throw.radius_mm, scene.web_z_mm[0]

    def edge_of(side: int, opening: float) -> Callable[[Array], Array]:
        def gap(y: Array) -> Array:
            height = start + height_range_mm(web, radius, y)[side] - wedge.z_centre_mm
            deep = np.maximum(half_width_mm(web, radius, y) - wedge.open_from_mm(y), 0.0)
            return (height if side else -height) - _flat_half_height(wedge, y) - opening * wedge.slope * deep

        return gap

    return [edge_of(side, opening) for side in (0, 1) for opening in (0.0, 1.0)]


def _root_places(gap: Callable[[Array], Array], start: float, end: float) -> list[float]:
    """Places between two ends where a function changes its sign, by bisection."""
    margin = 1e-9 * (end - start)
    grid = np.linspace(start + margin, end - margin, _SEARCH)
    signs = np.sign(gap(grid))
    changes = np.flatnonzero(signs[:-1] * signs[1:] < 0)
    low, high = grid[changes], grid[changes + 1]
    for _ in range(_BISECTIONS if len(changes) else 0):
        middle = (low + high) / 2
        before = np.sign(gap(middle)) == signs[changes]
        low, high = np.where(before, middle, low), np.where(before, high, middle)
    return [float(y) for y in (low + high) / 2]


def _breaks(scene: Scene, cuts: Sequence[Feature], layer: tuple[float, float]) -> list[float]:
    """Places along the throw where a section's width or height has a kink, the ends of the web included."""
    web, radius = scene.web, scene.throw.radius_mm
    low, high = y_range_mm(web, radius)
    found = {*outline_kinks_mm(web, radius), *(y for f in cuts for y in f.y_range_mm)}
    for bevel in web.bevel:
        arc = bevel_arc(web, radius, bevel)
        heights = [z - scene.web_z_mm[0] for z in layer]
        depths = heights if bevel.face == "journal" else [web.thickness_mm - z for z in heights]
        found.add(bevel.y_mm)
        found |= {arc.outward * arc.reach_at_mm(d) for d in depths if 0 <= d < bevel.depth_mm}
    inside = sorted(y for y in found if low <= y <= high)
    return sorted({*inside, *(y for a, b in pairwise(inside) for y in _crossings(scene, cuts, a, b))})


def _crossings(scene: Scene, cuts: Sequence[Feature], start: float, end: float) -> list[float]:
    """Where the edge of a cut crosses the outline between two places."""

    def gap_of(cut: Feature, edge: int) -> Callable[[Array], Array]:
        return lambda y: np.abs(cut.spans(y)[edge]) - half_width_mm(scene.web, scene.throw.radius_mm, y)

    return [y for cut in cuts for edge in (0, 1) for y in _root_places(gap_of(cut, edge), start, end)]


def _integrate(function: Callable[[Array], Array], breaks: list[float]) -> float:
    """Gauss quadrature in the cosine of y, which takes the square roots at the ends of round shapes."""
    nodes, weights = np.polynomial.legendre.leggauss(_POINTS)
    angle = (nodes + 1) * math.pi / 2
    total = 0.0
    for start, end in pairwise(breaks):
        y = (start + end) / 2 - (end - start) / 2 * np.cos(angle)
        scale = (end - start) / 2 * np.sin(angle) * math.pi / 2
        total += float(np.sum(weights * scale * function(y)))
    return total


def _cut_length(cuts: Sequence[Feature], y: Array, half: Array) -> Array:
    """Length of the union of the cuts' lateral intervals inside the outline at each y, mm."""
    if not cuts:
        return np.zeros_like(y)
    spans = [f.spans(y) for f in cuts]
    start = np.clip(np.stack([s for s, _ in spans]), -half, half)
    end = np.clip(np.stack([e for _, e in spans]), -half, half)
    order = np.argsort(start, axis=0)
    start, end = np.take_along_axis(start, order, 0), np.take_along_axis(end, order, 0)
    reached, total = -half, np.zeros_like(y)
    for s, e in zip(start, end, strict=True):
        total += np.maximum(e - np.maximum(s, reached), 0.0)
        reached = np.maximum(reached, e)
    return total


def _fillet_volume(scene: Scene, journal: Journal, y: float, face_z: float) -> float:
    """Volume of a fillet ring, less what opens under it: shells of height h(rho) = f - sqrt(f2 - d2)."""
    fillet, radius = journal.fillet_mm, journal.radius_mm
    nodes, weights = np.polynomial.legendre.leggauss(40)
    t = (nodes + 1) / 2
    rho, jacobian = radius + fillet * t**2, 2 * fillet * t / 2
    height = fillet - np.sqrt(np.maximum(fillet**2 - (radius + fillet - rho) ** 2, 0.0))
    cuts = [f for f in (*bores(scene), *pockets(scene)) if face_z in f.z_mm]
    angle = np.linspace(0, 2 * math.pi, 20001)[:-1, None]
    px, py = rho * np.cos(angle), y + rho * np.sin(angle)
    solid = np.ones(px.shape, dtype=bool)
    for cut in cuts:
        solid &= ~cut.contains(px, py)
    return float(np.sum(weights * jacobian * height * rho * 2 * math.pi * solid.mean(axis=0)))
