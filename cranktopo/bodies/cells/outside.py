"""The part of a design's own web that its envelope does not hold, where no web that is sought may be."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

import numpy as np

from cranktopo.base.arrays import Array
from cranktopo.base.result import Result
from cranktopo.base.spans import Section, section_difference, superpose_sections
from cranktopo.bodies.cells.domain import throw_ranges_mm
from cranktopo.bodies.cells.layers import AxialLayer, half_throw_layers
from cranktopo.bodies.envelope_file import envelope_bounds_mm
from cranktopo.design.halves import difference, without_zones
from cranktopo.design.schema import Scene

_PLACES = 2000
"""Places along the throw at which sections are measured."""
_LAYERS = 16
"""Parts of a web whose section changes along the crank axis."""
_TOLD_PERCENT = 0.1


class OutsideEnvelope(Result):
    """Part of the original web that lies outside of the design's envelope."""

    volume_mm3: float
    """Volume of one web outside."""
    percent: float
    """Its share of the web between its two faces."""


def outside_envelope(scene: Scene) -> OutsideEnvelope | None:
    """Return what of a scene's web, undrilled, its envelope does not hold; None without an envelope.

    Raises:
        CranktopoError: halves that differ, or a file that cannot be read.
    """
    if scene.envelope is None or difference(scene):
        return None
    webs = half_throw_layers(scene, "web")[1:-1]
    room = half_throw_layers(without_counterweight(scene), "envelope")[1:-1]
    low, high = throw_ranges_mm(scene, "web")[1]
    ends = np.clip(envelope_bounds_mm(scene.envelope)[2:], low, high)
    edges_mm = np.unique([*np.linspace(low, high, _PLACES + 1), *ends])
    volumes = np.zeros(2)
    for start, stop in pairwise(_heights_mm(scene, [*webs, *room])):
        middle = (start + stop) / 2
        own, held = _at(webs, middle), _at(room, middle)
        areas = [_area_mm2(section, edges_mm, middle) for section in (section_difference(own, held), own)]
        volumes += (stop - start) * np.array(areas)
    return OutsideEnvelope(volume_mm3=float(volumes[0]), percent=float(100 * volumes[0] / volumes[1]))


def outside_words(outside: OutsideEnvelope | None) -> str:
    """Return in words what of the web is outside of the envelope; empty where nothing to speak of is."""
    if outside is None or outside.percent < _TOLD_PERCENT:
        return ""
    return (
        f"{outside.volume_mm3:,.0f} mm3 of the original web, {outside.percent:.2f} % of it, lie outside of "
        "the envelope, where no other web may have material"
    )


def without_counterweight(scene: Scene) -> Scene:
    """Return the scene without one kept solid: a search over dimensions pockets it. Zones would lack it."""
    if scene.web.counterweight is None:
        return scene
    bare = scene.model_copy(update={"web": scene.web.model_copy(update={"counterweight": None})})
    return without_zones(bare)


def _heights_mm(scene: Scene, layers: Sequence[AxialLayer]) -> list[float]:
    """Return heights between which no section begins or ends, or changes much."""
    ends = {z for layer in layers for z in layer.z_mm}
    changing = any(layer.changes for layer in layers)
    return sorted(ends | set(np.linspace(*scene.web_z_mm, _LAYERS * changing + 1).tolist()))


def _at(layers: Sequence[AxialLayer], z_mm: float) -> Section:
    here = [layer for layer in layers if layer.z_mm[0] < z_mm < layer.z_mm[1]]
    filled = (section for layer in here for section in (layer.passive, layer.design) if section is not None)
    return superpose_sections(*filled)


def _area_mm2(section: Section, edges_mm: Array, z_mm: float) -> float:
    y_mm = (edges_mm[1:] + edges_mm[:-1]) / 2
    spans = section(y_mm, np.full_like(y_mm, z_mm))
    return float(sum(np.diff(edges_mm) @ np.maximum(high - low, 0.0) for low, high in spans))
