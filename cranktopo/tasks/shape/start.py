"""The start of a search: a scene's web as a layout with values, and features where they would pay most."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from cranktopo.base.arrays import Array
from cranktopo.design.free_dimensions import (
    DIMENSIONS,
    DimensionName,
    free_range_mm,
    is_axial,
    is_of_counterweight,
    journal_of,
    own_dimension_mm,
)
from cranktopo.design.manufacturing_limits import ManufacturingLimits
from cranktopo.design.schema import Scene
from cranktopo.tasks.refit.family import station_shares
from cranktopo.tasks.refit.parametric_web import reaches_mm
from cranktopo.tasks.refit.read_web import WebRead, read_web
from cranktopo.throw.bevel import FittedBevel
from cranktopo.throw.fitted import FittedFeature
from cranktopo.throw.side_pocket import FittedSlot

STATIONS = 7
_GROOVE_FLOOR, _GROOVE_DRAFT_DEG = 0.85, 7.0
"""Of a first groove: its floor over the half-width, and its draft."""
_SAME_MM = 1e-6
_BEVEL_SHARE = 1 / 3
"""Depth of a first bevel over the web's thickness."""


def outline_start(scene: Scene, limits: ManufacturingLimits, stations: int = STATIONS) -> Array:
    """Return ends and half-widths of the scene's own outline, clear of journals and bores, mm."""
    reaches = reaches_mm(scene, limits)
    low, high = scene.web.y_range_mm(scene.throw.radius_mm)
    low, high = min(low, *(y - r for y, r in reaches)), max(high, *(y + r for y, r in reaches))
    places = low + (high - low) * station_shares(stations)[1:-1]
    wide = scene.web.half_width_mm(scene.throw.radius_mm, places)
    for y, reach in reaches:
        wide = np.maximum(wide, np.sqrt(np.maximum(reach**2 - (places - y) ** 2, 0.0)))
    return np.concatenate([[low, high], wide])


def bevel_start(scene: Scene, bevel: FittedBevel) -> Array:
    """Return start, depth and crown of a first bevel: just clear of the journal, a third deep, plane."""
    on_journal_face = bevel.face == "journal"
    journal, axis = scene.throw.journals[0 if on_journal_face else 1]
    outward = 1.0 if on_journal_face else -1.0
    clear = journal.radius_mm + journal.fillet_mm + 1.0
    return np.array([axis + outward * clear, _BEVEL_SHARE * scene.web.thickness_mm, 0.0])


def groove_start(scene: Scene) -> tuple[FittedFeature, Array]:
    """Return a shallow groove through both ends, a quarter of the thickness high, amid the flanks."""
    thickness, floor = scene.web.thickness_mm, _GROOVE_FLOOR * scene.web.largest_half_width_mm
    return FittedSlot(through=True), np.array([thickness / 4, floor, 0.0, _GROOVE_DRAFT_DEG])


def scene_start(scene: Scene, limits: ManufacturingLimits, begun: Scene | None = None) -> WebRead:
    """Return a web in the family: exactly where it is one of the family, else its outline sampled.

    Args:
        begun: scene of the web to begin with, by default the scene itself; of its throw only the free
            dimensions are taken over.
    """
    found = read_web(begun or scene, outline_start(begun or scene, limits))
    if begun is None:
        return found
    other = {
        name: (own_dimension_mm(begun, name), own_dimension_mm(scene, name))
        for name in _own_dimensions(scene, begun)
        if abs(own_dimension_mm(begun, name) - own_dimension_mm(scene, name)) > _SAME_MM
    }
    free = {name: there for name, (there, _) in other.items() if free_range_mm(scene, name)}
    lost = [
        f"{name} = {there:g} mm, {own:g} mm in the design"
        for name, (there, own) in other.items()
        if name not in free
    ]
    return replace(found, left_out=(*found.left_out, *lost), sizes=free)


def _own_dimensions(scene: Scene, begun: Scene) -> Iterator[DimensionName]:
    """Yield dimensions that may differ alone: the axial semi-axis of a round fillet follows its radius."""
    for name in DIMENSIONS:
        if is_of_counterweight(name) and None in (scene.web.counterweight, begun.web.counterweight):
            continue
        own = is_axial(name) and not all(journal_of(of, name).fillet.round for of in (scene, begun))
        if own or not is_axial(name) or free_range_mm(scene, name):
            yield name
