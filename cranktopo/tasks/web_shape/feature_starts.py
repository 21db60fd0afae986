"""Features to try: bevels, a groove, and pockets where the sensitivity of the cells says they pay most."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from cranktopo.base.arrays import Array
from cranktopo.design.schema import Scene
from cranktopo.numerics.optimisers.gradient_search import Multipliers
from cranktopo.tasks.refit.family import with_part
from cranktopo.tasks.web_shape.search import SearchResult
from cranktopo.tasks.web_shape.search_goal import SearchGoal
from cranktopo.tasks.web_shape.web_model import WebModel
from cranktopo.throw.bevel import FittedBevel
from cranktopo.throw.fitted import FittedFeature
from cranktopo.throw.fitted_pocket import FittedBox, FittedPocket
from cranktopo.throw.fitted_slot import FittedSlot
from cranktopo.throw.manufacturing_limits import ManufacturingLimits

_GROOVE_FLOOR, _GROOVE_DRAFT_DEG = 0.85, 7.0
"""Of a first groove: its floor over the half-width, and its draft."""
_BEVEL_SHARE = 1 / 3
"""Depth of a first bevel over the web's thickness."""
_PASSES = 5
"""Steps until the edge of a first bevel, which its draft brings nearer to the journal, is clear of it."""
_SIZES = (0.4, 0.25), (0.6, 0.5)
"""Edge and depth of first pockets over the web's thickness: a search from the smaller one may close it where
one from the larger one finds a pocket that pays."""
_STEPS = 0.2
"""Distance of the places tried over the web's thickness."""
_KEPT_MM = 0.5
"""By how much a start may break a rule; the search mends it."""
_TRIED = 2
"""Kinds tried of each size."""
_KINDS = tuple(FittedBox(face, pair) for face in ("pin", "journal") for pair in (True, False))


def end_starts(scene: Scene, limits: ManufacturingLimits) -> Iterator[tuple[FittedFeature, Array]]:
    """Yield the bevels and the groove that scene and workshop have room for, with their first values."""
    bevels = (FittedBevel(face, hollow=True).manufactured(limits) for face in ("journal", "pin"))
    for bevel in bevels:
        if bevel.possible(scene):
            yield bevel, bevel_start(scene, bevel)
    groove = FittedSlot(through=True).manufactured(limits)
    if groove is not None and groove.possible(scene):
        yield groove, _groove_start(scene, limits, groove)


def bevel_start(scene: Scene, bevel: FittedBevel) -> Array:
    """Return start, depth and crown of a first bevel: just clear of the journal, a third deep, plane."""
    on_journal_face = bevel.face == "journal"
    journal, axis = scene.throw.journals[0 if on_journal_face else 1]
    outward = 1.0 if on_journal_face else -1.0
    clear = journal.clear_radius_mm + 1.0
    values = np.array([axis + outward * clear, _BEVEL_SHARE * scene.web.thickness_mm, 0.0])
    ends = np.array(scene.web.y_range_mm(scene.throw.radius_mm))
    for _ in range(_PASSES if bevel.draft_deg else 0):
        arc = bevel.arc(bevel.named(values), ends)
        values[0] = axis + outward * clear * np.hypot(1.0, arc.inward)
    return values


def _groove_start(scene: Scene, limits: ManufacturingLimits, groove: FittedSlot) -> Array:
    """Return a shallow groove through both ends, a quarter of the thickness high, amid the flanks.

    It is deeper and higher where the round edges of its floor need it.
    """
    widest, draft = scene.web.largest_half_width_mm, max(_GROOVE_DRAFT_DEG, limits.min_draft_deg)
    (least, _), *_ = groove.bounds(scene, limits)
    floor = min(_GROOVE_FLOOR * widest, widest - groove.shallowest_mm(draft))
    return np.array([max(scene.web.thickness_mm / 4, least), floor, 0.0, draft])


def pocket_starts(
    model: WebModel, best: SearchResult, goal: SearchGoal, paid: Multipliers
) -> Iterator[tuple[FittedFeature, Array]]:
    """Yield pockets where they would gain most and keep the rules: of each size the most promising first."""
    sensitivity = goal.sensitivity_by_cell(best.responses.by_cell, paid.limits)
    for size in _SIZES:
        found = []
        for kind in _kinds(model.limits):
            places = [
                (gain, values) for gain, values in _places(model, best, kind, sensitivity, size) if gain > 0
            ]
            found += [(kind, *max(places, key=lambda place: place[0]))] if places else []
        for kind, _, values in sorted(found, key=lambda item: -item[1])[:_TRIED]:
            yield kind, values


def _kinds(limits: ManufacturingLimits) -> list[FittedPocket | FittedSlot]:
    """Return the pockets that a workshop can make: from the sides where it opens nowhere else."""
    kinds: tuple[FittedPocket | FittedSlot, ...] = _KINDS
    if limits.workshop.opens == "sides":
        kinds = (FittedSlot(),)
    parts = (kind.manufactured(limits) for kind in kinds)
    return [part for part in parts if part is not None]


def _places(
    model: WebModel,
    best: SearchResult,
    kind: FittedPocket | FittedSlot,
    sensitivity: Array,
    size: tuple[float, float],
) -> Iterator[tuple[float, Array]]:
    """Yield gain and values of the pocket at each place of a lattice where it keeps walls and shoulders."""
    scene, web = model.scene, model.web(replace(best.layout, parts=(*best.layout.parts, kind)))
    thickness = scene.web.thickness_mm
    step, depth = _STEPS * thickness, size[1] * thickness
    edge = max(size[0] * thickness, 2 * model.domain.grid.largest_edge_mm)
    least, most = np.array(kind.bounds(scene, model.limits)).T
    low, high = best.values[:2]
    widest = best.values[2 : best.layout.stations].max()
    aside = isinstance(kind, FittedPocket) and kind.pair
    rest = [depth] if isinstance(kind, FittedPocket) else [widest - depth, 0.0, model.limits.min_draft_deg]
    for x in np.arange(edge / 2, widest, step) if aside else [None]:
        for y in np.arange(low, high, step):
            own = np.clip([*([] if x is None else [x]), y, edge, edge, *rest], least, most)
            _, values = with_part(best.layout, best.values, kind, own)
            if web.constraints(values).max() < _KEPT_MM:
                taken = best.responses.fill - model.fill(web, values)
                yield float((sensitivity * taken).sum()), own
