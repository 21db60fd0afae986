"""Oil drillings of a throw: straight holes between the surfaces of its journals, and walls around them.

A drilling is described in the half throw of its web and is in both halves, the second one the mirror image,
or in one of them alone: then its outlet may reach across the middle of the crankpin.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from functools import lru_cache
from typing import Literal, Self, cast

import numpy as np
from pydantic import Field
from typing_extensions import override

from cranktopo.base.arrays import Array
from cranktopo.base.errors import CranktopoError
from cranktopo.base.table import Length, LengthOrZero
from cranktopo.throw.drilling.bore import DrillBore
from cranktopo.throw.drilling.checks import check_apart, check_bore, check_surfaces
from cranktopo.throw.drilling.limits import Accepts
from cranktopo.throw.drilling.outlet import DrillingEnd, DrillingSecondEnd, DrillOutlet
from cranktopo.throw.feature import SMALLEST, SMALLEST_FILLET, Feature, JournalsView, ThrowView
from cranktopo.throw.fitted import Rule, Surroundings, wall_rule
from cranktopo.throw.primitives import DimensionLine, FeatureDrawing, Polyline

_DIGITS = 6


class Drilling(Feature):
    """A straight oil drilling through one web and its journals, or through either web alike.

    It joins two surfaces of the journals. No optimiser fills it, and a wall as thick as half its diameter
    stays around it.
    """

    start: DrillingEnd = Field(
        default=DrillingEnd(on="main_journal", angle_deg=180.0, place_mm=0.0), alias="from"
    )
    """Start of the drilling; by default in the middle of the main journal, away from the crankpin."""
    end: DrillingSecondEnd = Field(
        default=DrillingSecondEnd(on="crankpin", angle_deg=0.0, place_mm=0.0), alias="to"
    )
    """End of the drilling; by default in the middle of the crankpin, away from the crank axis."""
    diameter_mm: Length = Field(examples=[5.0])
    """Its diameter."""
    outlet_radius_mm: LengthOrZero = 0.0
    """Radius of the rounding of its outlets on the journals; 0 = sharp. Ends in a bore stay sharp."""
    web: Literal["both", "first", "second"] = "both"
    """The web that it runs through; `both`: the half throw beyond the crankpin has its mirror image."""

    @override
    def bodies(self, scene: ThrowView, key: str) -> tuple[DrillBore, ...]:
        return (_bore(scene.throw, scene.pitch_mm, self, key),)

    @override
    def check_alone(self, scene: ThrowView, key: str) -> None:
        check_surfaces(scene, key, self.ends)

    @override
    def check_in_web(self, scene: ThrowView, key: str) -> None:
        beside = [bore for bore in drill_bores(scene) if bore.key != key and bore.length_mm]
        self._check(scene, key, lambda name, value: self._changed(name, value).fits(scene, beside))

    def fits(self, scene: ThrowView, beside: Sequence[DrillBore] = ()) -> bool:
        """Tell whether the checks of a scene let it pass there, with these drillings beside it."""
        if not self.diameter_mm:
            return False
        try:
            self.check_alone(scene, "")
            self._check(scene, "", lambda _name, _value: False)
            (own,) = self.bodies(scene, "")
            for other in beside:
                check_apart(scene, (own, other))
        except CranktopoError:
            return False
        return True

    def _check(self, scene: ThrowView, key: str, accepts: Accepts) -> None:
        (bore,) = self.bodies(scene, key)
        check_bore(scene, self.ends, bore, self.outlet_radius_mm, accepts)

    def _changed(self, name: str, value: float) -> Self:
        """Return it with another value of a key, such as `to.place_mm`."""
        end, _, key = name.rpartition(".")
        if not end:
            return self.model_copy(update={key: value})
        field = "start" if end == "from" else "end"
        return self.model_copy(update={field: getattr(self, field).model_copy(update={key: value})})

    @override
    def dimensions_mm(self, key: str) -> Iterator[tuple[str, float, float]]:
        yield f"{key}.diameter_mm", self.diameter_mm, SMALLEST
        yield f"{key}.outlet_radius_mm", self.outlet_radius_mm, SMALLEST_FILLET

    @override
    def drawing(self, scene: ThrowView) -> FeatureDrawing:
        """Hidden edges along the crank axis, between the surfaces that it joins."""
        (bore,) = self.bodies(scene, "")
        (x0, y0, _), (x1, y1, _) = (outlet.point_mm for outlet in bore.outlets)
        level = math.hypot(x1 - x0, y1 - y0)
        dx, dy = bore.radius_mm * (y0 - y1) / level, bore.radius_mm * (x1 - x0) / level
        edges = tuple(
            Polyline(((x0 + side * dx, y0 + side * dy), (x1 + side * dx, y1 + side * dy)), hidden=True)
            for side in (1, -1)
        )
        places = ((x0, y0), (x1, y1))
        return FeatureDrawing(edges, self._lengthwise(scene), lines=self._lines, places=places)

    def _lengthwise(self, scene: ThrowView) -> tuple[DimensionLine, ...]:
        """Distance of each outlet from the middle of its journal, beside the journal."""
        throw, found = scene.throw, []
        for _, end in self.ends:
            main = end.on.startswith("main")
            journal, y = (throw.main_journal, 0.0) if main else (throw.crankpin, throw.radius_mm)
            middle, way = (0.0, 1) if main else (scene.pitch_mm / 2, -1)
            side = -1 if math.cos(math.radians(end.angle_deg)) < 0 else 1
            at = y + side * journal.radius_mm
            if end.place_mm:
                a, b = sorted((middle, middle + way * end.place_mm))
                found.append(DimensionLine((a, at), (b, at), (0.0, side * 5.0), f"{end.place_mm:g}"))
        return tuple(found)

    @property
    def _lines(self) -> tuple[str, ...]:
        rounding = f", outlets R{self.outlet_radius_mm:g}" if self.outlet_radius_mm else ", sharp"
        places = (
            f"   {word:5}{end.on.replace('_', ' ')} {end.angle_deg:g}°, {end.place_mm:g} off its middle"
            for word, end in self.ends
        )
        return (f"{'DRILLING':13}⌀{self.diameter_mm:g}{rounding}", *places)

    @property
    def ends(self) -> tuple[tuple[str, DrillingEnd], tuple[str, DrillingEnd]]:
        """Its ends with their keys."""
        return ("from", self.start), ("to", self.end)

    @override
    def mirrored(self) -> Self:
        ends = {
            name: end.model_copy(update={"angle_deg": _across(end.angle_deg)})
            for name, end in (("start", self.start), ("end", self.end))
        }
        return self.model_copy(update=ends)


def _across(angle_deg: float) -> float:
    """Return the angle of the mirror image; in the plane of the throw it is the same."""
    return angle_deg if angle_deg % 180.0 == 0 else -angle_deg


def drill_bores(scene: ThrowView) -> tuple[DrillBore, ...]:
    """Return the drillings of the half throw as bodies; none for most throws."""
    return _bores(scene.throw, scene.pitch_mm) if scene.throw.drilling else ()


@lru_cache(maxsize=16)
def _bores(throw: JournalsView, pitch_mm: float) -> tuple[DrillBore, ...]:
    return tuple(
        _bore(throw, pitch_mm, drilling, f"throw.drilling[{index}]")
        for index, drilling in enumerate(throw.drilling)
    )


def _bore(throw: JournalsView, pitch_mm: float, drilling: Drilling, key: str) -> DrillBore:
    ends = drilling.start, drilling.end
    first, second = (np.array(_point(throw, pitch_mm, end)) for end in ends)
    length = float(np.linalg.norm(second - first))
    along = (second - first) / length if length else np.zeros(3)
    outlets = tuple(
        _outlet(throw, end, point, sign * along, drilling.outlet_radius_mm)
        for end, point, sign in zip(ends, (first, second), (-1, 1), strict=True)
    )
    return DrillBore.between(key, drilling.diameter_mm / 2, (outlets[0], outlets[1]), drilling.web != "both")


def _point(throw: JournalsView, pitch_mm: float, end: DrillingEnd) -> tuple[float, float, float]:
    y, radius = _surface(throw, end)
    angle = math.radians(end.angle_deg)
    z = end.place_mm if end.journal_key == "main_journal" else pitch_mm / 2 - end.place_mm
    x, along = (round(value, 12) + 0.0 for value in (radius * math.sin(angle), y + radius * math.cos(angle)))
    return x, along, z


def _outlet(
    throw: JournalsView, end: DrillingEnd, point: Array, outward: Array, rounding: float
) -> DrillOutlet:
    y, radius = _surface(throw, end)
    place, way = (cast(tuple[float, float, float], tuple(v.tolist())) for v in (point, outward))
    return DrillOutlet(place, way, y, radius, end.in_bore, 0.0 if end.in_bore else rounding, end.journal_key)


def _surface(throw: JournalsView, end: DrillingEnd) -> tuple[float, float]:
    journal, y = throw.journals[end.journal_key == "crankpin"]
    return y, journal.bore_radius_mm if end.in_bore else journal.radius_mm


def drilling_asymmetry(scene: ThrowView) -> str:
    """Key of the first drilling that has no mirror image in x = 0; empty when there is none."""
    found = drill_bores(scene)
    places = {_signature(bore, 1) for bore in found}
    lonely = (bore.key for bore in found if _signature(bore, -1) not in places)
    return next(lonely, "")


def _signature(bore: DrillBore, side: int) -> tuple[object, ...]:
    """Return what tells a drilling from another; `side` -1: of its mirror image."""
    ends = []
    for outlet in bore.outlets:
        x, y, z = outlet.point_mm
        place = tuple(round(value, _DIGITS) + 0.0 for value in (side * x, y, z))
        ends.append((outlet.in_bore, outlet.rounding_mm, place))
    return round(bore.radius_mm, _DIGITS), frozenset(ends)


_POINTS = 33
"""Points along the axis of a drilling."""
_NamedBox = tuple[str, Array]


def drilling_rules(around: Surroundings, boxes: Sequence[_NamedBox]) -> Iterator[Rule]:
    """Yield a rule for each drilling and each of outline, bevels, boxes (2, 3), z from the journal face."""
    start, end = around.scene.web_z_mm
    least = around.limits.min_wall_mm
    for bore in drill_bores(around.scene):
        axis = _axis(bore, start, end)
        needed = bore.radius_mm + around.wall_mm
        own = f"{bore.key} and the"
        if not len(axis):
            continue
        yield wall_rule(f"between {own} outline", least), needed - _in_outline_mm(axis, around.points_mm)
        for arc in around.arcs:
            depth = axis[:, 2] if arc.outward > 0 else end - start - axis[:, 2]
            away = arc.distance_mm(depth, arc.outward * axis[:, 1], np.abs(axis[:, 0])).min()
            yield wall_rule(f"between {own} {arc.title}", least), needed - away
        both = np.concatenate([axis, axis * [-1.0, 1.0, 1.0]])  # a feature has its mirror image
        for title, (low, high) in boxes:
            yield wall_rule(f"between {own} {title}", least), needed - _off_box_mm(both, low, high)


def _axis(bore: DrillBore, start: float, end: float) -> Array:
    """Points of the axis within the web, (n, 3), z from its journal face."""
    (_, _, foot), (_, _, rise) = bore.outlets[0].point_mm, bore.direction
    ends = np.sort((np.array([start, end]) - foot) / rise) if rise else np.zeros(0)
    low, high = bore.extent_mm
    if not len(ends) or ends[0] > high or ends[1] < low:
        return np.zeros((0, 3))
    places = np.linspace(max(ends[0], low), min(ends[1], high), _POINTS)[:, None]
    points = np.array(bore.outlets[0].point_mm) + places * bore.direction
    return np.asarray(points - [0.0, 0.0, start])


def _in_outline_mm(axis: Array, points: Array) -> float:
    """Least distance of the axis inside the outline, negative where it is outside."""
    x, y = np.abs(axis[:, 0]), axis[:, 1]
    away = np.hypot(x[:, None] - points[:, 0], y[:, None] - points[:, 1]).min(axis=1)
    half = np.interp(y, points[:, 1], points[:, 0], left=0.0, right=0.0)
    return float(np.where(x < half, away, -away).min())


def _off_box_mm(points: Array, low: Array, high: Array) -> float:
    off = np.maximum(low - points, points - high)
    outside = np.sqrt((np.maximum(off, 0.0) ** 2).sum(axis=1))
    return float(np.where(outside > 0, outside, off.max(axis=1)).min())
