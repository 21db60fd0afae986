"""A web of a scene read back as one of the family: the inverse of `family.web_of`."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field

import numpy as np

from cranktopo.base.arrays import Array
from cranktopo.design.free_dimensions import DimensionName
from cranktopo.design.halves import usual_scale
from cranktopo.design.schema import Scene
from cranktopo.tasks.refit.family import DECIMALS, Layout, flank_of, station_shares, surroundings_of
from cranktopo.throw.feature import Feature
from cranktopo.throw.fitted import FittedFeature, Frame
from cranktopo.throw.profile import ProfileWeb
from cranktopo.throw.web import FITTED

_ROUNDED = 0.51 * 10**-DECIMALS
"""Distance by which rounding may move a station, mm."""


@dataclass(frozen=True)
class WebRead:
    """A web as one of the family.

    Attributes:
        values: parameters of the layout, mm or degrees.
        left_out: what of the web the family lacks, in words, by its key in the scene.
        sizes: dimensions of its throw that are free and not those of the design, mm.
    """

    layout: Layout
    values: Array
    left_out: tuple[str, ...] = ()
    sizes: Mapping[DimensionName, float] = field(default_factory=dict)


def read_web(scene: Scene, sampled: Array) -> WebRead:
    """Return the scene's web in the family; `sampled` where its own outline is none of the family's."""
    outline, web = _family_outline(scene), scene.web
    own, left_out = sampled if outline is None else outline, list[str]()
    if outline is None:
        frame = (*web.y_range_mm(scene.throw.radius_mm), web.largest_half_width_mm)
        left_out.append(f"web.outline = '{web.outline}', sampled at {len(own)} stations")
    else:
        frame = surroundings_of(flank_of(Layout(len(own)), own))
    found = list(_features(scene, frame))
    left_out += [key for key, part in found if part is None]
    parts = [part for _, part in found if part is not None]
    layout = Layout(len(own), tuple(part for part, _ in parts))
    return WebRead(layout, np.concatenate([own, *(values for _, values in parts)]), tuple(left_out))


def _family_outline(scene: Scene) -> Array | None:
    """Return ends and half-widths of an outline whose stations lie as the family's do; None for any other.

    The stations are rounded in a scene: the ends are those that come nearest to all of them.
    """
    web = scene.web
    if not isinstance(web, ProfileWeb) or not all(web.round_ends):
        return None
    low, high, off = _line_through(station_shares(len(web.stations_mm)), np.array(web.stations_mm))
    if off > _ROUNDED * max(1.0, 1 / usual_scale(scene)):
        return None
    return np.array([low, high, *web.half_widths_mm[1:-1]])


def _line_through(shares: Array, places: Array) -> tuple[float, float, float]:
    """Return the ends of the line that comes nearest to places at shares of it, and the largest distance."""
    from scipy.optimize import linprog

    sides, one = np.stack([1 - shares, shares], axis=1), np.ones((len(shares), 1))
    rows = np.block([[sides, -one], [-sides, -one]])
    found = linprog(
        [0, 0, 1], rows, np.concatenate([places, -places]), bounds=[(None, None)] * 2 + [(0, None)]
    )
    low, high, off = map(float, found.x)
    return low, high, off


def _features(scene: Scene, frame: Frame) -> Iterator[tuple[str, tuple[FittedFeature, Array] | None]]:
    """Return every feature of the web with its key, as one of the family or None; a pair counts as one."""
    waiting = [
        (key, feature)
        for key, feature in scene.web.features()
        if key.removeprefix("web.") not in scene.web.single_keys
    ]
    while waiting:
        key, feature = waiting.pop(0)
        twin = feature.mirrored()
        if twin == feature:
            yield key, _read(feature, False, frame)
            continue
        places = [place for place, (_, other) in enumerate(waiting) if other == twin]
        if not places:
            yield f"{key}, which has no mirror image", None
            continue
        waiting.pop(places[0])
        yield key, _read(max(feature, twin, key=lambda pocket: getattr(pocket, "x_mm", 0.0)), True, frame)


def _read(feature: Feature, pair: bool, frame: Frame) -> tuple[FittedFeature, Array] | None:
    found = (kind.read(feature, pair, frame) for kind in FITTED)
    return next((part for part in found if part is not None), None)
