"""Rules that keep the zones of a web as they are while its parameters change.

Points of the web in a zone, and points of its voids there, are taken along lines across the web, a little
inward of every surface. What cuts the former, or fills the latter, breaks a rule by the distance.
"""

from __future__ import annotations

import functools
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import product

import numpy as np

from cranktopo.base.arrays import Array, Mask
from cranktopo.base.spans import Section, common, holds, section_difference
from cranktopo.bodies.envelope_file import envelope_bounds_mm
from cranktopo.bodies.zones import frozen_at, own_section, staying_at, zone_heights_mm
from cranktopo.design.halves import has_zones
from cranktopo.design.schema import Scene
from cranktopo.tasks.refit.model_fill import MovedFillet
from cranktopo.throw.counterweight.edge import EdgeCut
from cranktopo.throw.counterweight.holes import RadialHole
from cranktopo.throw.fitted import CLEAR_MM, FittedFeature, Named, Rule
from cranktopo.throw.web import kept_holes, web_bodies, web_spans

_INWARD_MM = 0.05
"""Distance of the points inward of a surface; the web's own surfaces may move by a part of it."""
_STEP_MM, _HEIGHTS = 1.0, 9
_STEEP = 2.0
"""Slope of a section's ends over the place along the throw from which every line is taken."""
_WALL_MM = 0.15
"""Distance along the throw within which points on every line are taken beside the wall of a cut."""
_KEEPS, _EMPTY = "what stays of the web is not cut by the", "empty part of a frozen zone"


@dataclass(frozen=True)
class ZonePoints:
    """Points (3, n) of the web that stay material, and of zones that stay empty, at x >= 0."""

    solid: Array
    empty: Array


@functools.lru_cache(maxsize=8)
def zone_points(scene: Scene) -> ZonePoints | None:
    """Return the points that zones hold; None without any."""
    if not has_zones(scene):
        return None
    solid, empty = list[Array](), list[Array]()
    for z in _heights_mm(scene):
        holes = [hole.spans for hole in kept_holes(scene)]
        own = section_difference(own_section(scene, z), *holes)
        stay = (section_difference(stays, *holes) for stays, _ in staying_at(scene, z, seated=False))
        solid += [_along_lines(scene, stays, own, z, solid=True) for stays in stay]
        voids = (section_difference(zone, own, *holes) for zone in frozen_at(scene, z, seated=False))
        empty += [_along_lines(scene, void, own, z, solid=False) for void in voids]
    return ZonePoints(*(np.concatenate([np.zeros((3, 0)), *found], axis=1) for found in (solid, empty)))


def _heights_mm(scene: Scene) -> list[float]:
    """Return heights through the web, among them one on either side of every change of its section."""
    (start, end), off = scene.web_z_mm, 2 * _INWARD_MM
    steps = np.linspace(start + off, end - off, _HEIGHTS).tolist()
    beside = [z + side * off for z in zone_heights_mm(scene) for side in (-1, 1)]
    return sorted({round(z, 6) for z in (*steps, *beside) if start < z < end})


def _along_lines(scene: Scene, section: Section, own: Section, z_mm: float, *, solid: bool) -> Array:
    """Return points inside a section on lines across the web, at x >= 0, inward of the web's surfaces."""
    y, found = _lines_mm(scene), [np.zeros((3, 0))]
    every = np.arange(y.size) % round(_STEP_MM / _INWARD_MM) == 0
    for left, right in _inward(section, own, solid=solid)(y, np.full_like(y, z_mm)):
        start, stop = np.maximum(left, 0.0) + _INWARD_MM * (left > 0), right - _INWARD_MM
        share = np.linspace(0.0, 1.0, max(2, int(np.ceil(np.max(stop - start, initial=0.0) / _STEP_MM))))
        usual, steep = _some_of(stop > start, every), (stop > start) & _steep(start, stop)
        for held in (usual, steep & ~usual):
            x = start[held, None] + (stop - start)[held, None] * share
            at = np.stack([x.ravel(), np.repeat(y[held], len(share)), np.full(x.size, z_mm)])
            found.append(at if held is usual else at[:, _at_wall(scene, own, at, solid=solid)])
    return np.concatenate(found, axis=1)


def _inward(section: Section, own: Section, *, solid: bool) -> Section:
    """Return what of a section keeps clear of the web's surfaces along the throw and along the crank."""
    beside = [_moved(own, up, off) for up, off in product((_INWARD_MM, -_INWARD_MM), repeat=2)]
    return functools.reduce(common, beside, section) if solid else section_difference(section, *beside)


def _moved(section: Section, up_mm: float, off_mm: float) -> Section:
    return lambda y, z: section(y + up_mm, z + off_mm)


def _lines_mm(scene: Scene) -> Array:
    """Return places along the web, its counterweight and the envelope, either side of every body's ends."""
    bodies = web_bodies(scene)
    ends = [y for body in bodies if body.adds for y in body.y_range_mm]
    if scene.envelope is not None:
        ends += envelope_bounds_mm(scene.envelope)[2:]
    beside = [y + side * _INWARD_MM for body in bodies for y in body.y_range_mm for side in (-1, 1)]
    lines = np.concatenate([np.arange(min(ends) + _INWARD_MM, max(ends), _INWARD_MM), beside])
    return np.unique(lines.round(6))


def _some_of(held: Mask, every: Mask) -> Mask:
    """Return which lines to take of those that a section holds: some, and all near its ends."""
    near = np.pad(held, 2)
    inner = near[:-4] & near[1:-3] & near[3:-1] & near[4:]
    return held & (~inner | every)


def _steep(start: Array, stop: Array) -> Mask:
    """Return between which lines an end of a section moves by much, as at a wall across the throw."""
    steps = np.abs(np.diff([start, stop], axis=1)).max(axis=0) > _STEEP * _INWARD_MM
    return np.pad(steps, (1, 0)) | np.pad(steps, (0, 1))


def _at_wall(scene: Scene, own: Section, at: Array, *, solid: bool) -> Mask:
    """Tell which points lie near the wall of a cut along the throw, in the material or in the cut."""
    x, y, z = at
    added = [body for body in web_bodies(scene) if body.adds]

    def within(up: float) -> tuple[Mask, Mask]:
        filled = holds(list(zip(*web_spans(added, y + up, z), strict=True)), x)
        return filled, holds(own(y + up, z), x)

    beside = [within(side * _WALL_MM) for side in (-1, 1)]
    if solid:
        return np.logical_or.reduce([filled & ~held for filled, held in beside])
    return within(0.0)[0] & np.logical_or.reduce([held for _, held in beside])


def zone_rules(
    own: ZonePoints,
    scene: Scene,
    outline_mm: Array,
    named: Sequence[tuple[FittedFeature, Named]],
    fillet: MovedFillet | None,
) -> Iterator[Rule]:
    """Yield the rules, mm: outline with counterweight, each feature, each bore, and what stays empty.

    Args:
        outline_mm: points (n, 2) of the outline's right half, upward.
        fillet: the counterweight's.
    """
    if own.solid.size:
        edge = "outline" if scene.web.counterweight is None else "outline or counterweight"
        inside = _inside_outline(scene, outline_mm, fillet, own.solid)
        yield f"{_KEEPS} {edge}", CLEAR_MM - float(inside.min())
        for part, values in named:
            away = _outside_part(part, values, outline_mm, scene, own.solid)
            yield f"{_KEEPS} {part.title}", CLEAR_MM - float(away.min())
        yield f"{_KEEPS} bores", CLEAR_MM - float(_outside_bores(scene, own.solid).min())
        for what, kind in (("holes from the rim", RadialHole), ("bevelled edge", EdgeCut)):
            moved = [cut.outside_mm(own.solid).min() for cut in kept_holes(scene) if isinstance(cut, kind)]
            if moved:
                yield f"{_KEEPS} {what}", CLEAR_MM - float(min(moved))
    if own.empty.size:
        parts = (_outside_part(part, values, outline_mm, scene, own.empty) for part, values in named)
        inside = _inside_outline(scene, outline_mm, fillet, own.empty)
        fields = [inside, _outside_bores(scene, own.empty), *parts]
        yield _EMPTY, CLEAR_MM + float(np.min(fields, axis=0).max())


def _inside_outline(scene: Scene, outline_mm: Array, fillet: MovedFillet | None, at: Array) -> Array:
    """Return how far points lie inside the outline, across the throw, or the counterweight, its fillet."""
    (x, y), (low, high) = outline_mm.T, (outline_mm[0, 1], outline_mm[-1, 1])
    inside = np.minimum(np.interp(at[1], y, x) - at[0], np.minimum(at[1] - low, high - at[1]))
    weight = scene.web.counterweight
    if weight is not None and not weight.bolted:
        sector = weight.sector(scene)
        beside = (at[2] <= sector.z_mm[0]) | (at[2] >= sector.z_mm[1])
        inside = np.maximum(inside, np.where(beside, -np.inf, sector.inside_mm(at[0], at[1])))
    return np.asarray(inside if fillet is None else np.maximum(inside, fillet.at_mm(*at)))


def _outside_part(part: FittedFeature, values: Named, outline_mm: Array, scene: Scene, at: Array) -> Array:
    away = part.outside_mm(values, outline_mm[[0, -1], 1], (at[0], at[1], at[2]), scene.web_z_mm)
    return np.broadcast_to(away, at.shape[1:])


def _outside_bores(scene: Scene, at: Array) -> Array:
    away = [np.hypot(at[0], at[1] - y) - journal.bore_radius_mm for journal, y in scene.throw.journals]
    return np.asarray(np.min(away, axis=0))
