"""Do the oil drillings run inside the throw? Refusals of those that break out of it or into each other."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import combinations

import numpy as np
from numpy.typing import NDArray

from cranktopo.base.arrays import Array
from cranktopo.base.errors import CranktopoError, invalid
from cranktopo.throw.drilling.bore import DrillBore
from cranktopo.throw.drilling.limits import (
    Accepts,
    largest_accepted,
    least_accepted,
    nearest_whole_angle,
    rounded_down,
    rounded_up,
)
from cranktopo.throw.drilling.outlet import DrillingEnd, DrillOutlet, ring_points
from cranktopo.throw.feature import Body, ThrowView, least_shoulder_mm
from cranktopo.throw.journal import Journal
from cranktopo.throw.web import web_bodies

Ends = tuple[tuple[str, DrillingEnd], tuple[str, DrillingEnd]]
"""Ends of a drilling with their keys."""
_LARGEST_SHARE = 0.4
"""Largest diameter of a drilling over that of the thinnest journal it opens in."""
_LARGEST_OBLIQUITY_DEG = 50.0
"""Most that a drilling leans from the normal of a surface; beyond, its outlet becomes a knife's edge."""
_BORE_SHARE = 0.9
_LEAST_LAND, _LEAST_OVERLAP = 0.001, 0.005
"""Least distance of an outlet's rim before and beyond the middle of its journal over the drilling's diameter.

Its half throw ends there, and less is a needle. The CAD kernel turns a face inside out where rims reach
3e-5 of the diameter beyond the middle, and leaves gaps between facets up to 4e-3
(`python -m tests.studies.outlets_at_the_middle`).
"""
_ENDS = ("from", "to")
_BORES = "throw."
"""Start of the keys of the bodies that are bores."""


def check_surfaces(scene: ThrowView, key: str, ends: Ends) -> None:
    """Check that the surfaces are there on which a drilling ends."""
    for name, end in ends:
        journal: Journal = getattr(scene.throw, end.journal_key)
        if end.in_bore and not journal.bore_diameter_mm:
            allowed = f"throw.{end.journal_key} has no bore (bore_diameter_mm = 0)"
            raise invalid(f"{key}.{name}.on", end.on, allowed, f"Write '{end.journal_key}', or give a bore.")


def check_bore(scene: ThrowView, ends: Ends, bore: DrillBore, outlet_mm: float, accepts: Accepts) -> None:
    """Check the dimensions of a drilling, and that it joins its two surfaces inside the throw.

    Args:
        outlet_mm: radius of the rounding of its outlets.
        accepts: tells of the same drilling with another value whether it passes, for what a refusal tells.
    """
    _check_sizes(scene, ends, bore, outlet_mm, accepts)
    _check_lean(bore, dict(ends), accepts)
    tool, rims = bore.surface_mm(bore.radius_mm), [rim_z_mm(bore, outlet) for outlet in bore.outlets]
    _check_outlets(scene, ends, bore, accepts, tool, rims)
    _check_middles(scene, ends, bore, accepts, rims)
    _check_in_journals(scene, bore, tool)
    _check_in_web(scene, bore)
    _check_bores(scene, bore)


def _check_sizes(scene: ThrowView, ends: Ends, bore: DrillBore, outlet_mm: float, accepts: Accepts) -> None:
    diameter_mm = 2 * bore.radius_mm
    for name, end in ends:
        journal: Journal = getattr(scene.throw, end.journal_key)
        if end.place_mm > journal.length_mm / 2:
            why = f"lies beyond half the length of throw.{end.journal_key}, {journal.length_mm / 2:g} mm"
            raise _too_large(bore.key, f"{name}.place_mm", end.place_mm, why, accepts)
        if diameter_mm > _LARGEST_SHARE * journal.outer_diameter_mm:
            why = f"is more than {_LARGEST_SHARE:g} of the diameter of throw.{end.journal_key}"
            raise _too_large(bore.key, "diameter_mm", diameter_mm, why, accepts)
    if outlet_mm > diameter_mm:
        why = f"is more than diameter_mm = {diameter_mm:g} mm"
        raise _too_large(bore.key, "outlet_radius_mm", outlet_mm, why, accepts)


def _too_large(key: str, name: str, value: float, why: str, accepts: Accepts) -> CranktopoError:
    """Return the refusal of a value with the largest one that all checks of the drilling accept."""
    limit = largest_accepted(accepts, name, value)
    if limit is None:
        hint = f"No smaller {name} fits by itself: change its ends, diameter_mm or outlet_radius_mm, too."
        return invalid(f"{key}.{name}", value, why, hint)
    return invalid(f"{key}.{name}", value, f"{why}; must be at most {limit:g} mm")


def check_apart(scene: ThrowView, bores: Sequence[DrillBore]) -> None:
    """Check that no drilling meets another."""
    for one, other in combinations(bores, 2):
        _check_apart(scene, one, other)


def check_across_pin(
    halves: tuple[ThrowView, ThrowView], bores: tuple[Sequence[DrillBore], Sequence[DrillBore]]
) -> None:
    """Check drillings of one half alone, named as in the whole scene, against the pin beyond its middle."""
    for own, other, found, facing in zip(halves, halves[::-1], bores, bores[::-1], strict=True):
        beyond = [bore.in_second_half(own.pitch_mm) for bore in facing]
        for bore in (one for one in found if one.alone):
            _check_crossing(own, other, bore)
            for one in beyond:
                _check_apart(own, bore, one)


def _check_crossing(own: ThrowView, other: ThrowView, bore: DrillBore) -> None:
    """Return what of an outlet reaches across the middle of the pin stays on its straight part there."""
    pin = other.throw.crankpin
    room = pin.length_mm / 2 - pin.fillet.axial_mm - least_shoulder_mm(own.throw)
    over = float(bore.surface_mm(bore.reach_mm)[:, 2].max()) - own.pitch_mm / 2
    if over > room:
        raise CranktopoError(
            f"{bore.key}: reaches {over:.4g} mm beyond the crankpin's middle, where {room:.4g} mm are "
            "free before its fillet.",
            hint="Move its end toward its own web (place_mm), or reduce diameter_mm or outlet_radius_mm.",
        )


def _check_lean(bore: DrillBore, ends: Mapping[str, DrillingEnd], accepts: Accepts) -> None:
    if not bore.length_mm:
        raise CranktopoError(f"{bore.key}: begins where it ends.", hint="Give 'from' and 'to' two places.")
    for name, outlet in zip(_ENDS, bore.outlets, strict=True):
        angle = outlet.obliquity_deg
        if angle > 90:
            raise CranktopoError(
                f"{bore.key}.{name}: the drilling lies outside the {_words(outlet)} there.",
                hint="Move that end to the side of the journal that faces away from the other end.",
            )
        if angle > _LARGEST_OBLIQUITY_DEG:
            raise CranktopoError(
                f"{bore.key}.{name}: the drilling leans {angle:.0f} deg from the normal of the "
                f"{_words(outlet)}, at most {_LARGEST_OBLIQUITY_DEG:g} deg.",
                hint=_nearest_angle(bore.key, name, ends[name].angle_deg, accepts),
            )


def _nearest_angle(key: str, name: str, angle_deg: float, accepts: Accepts) -> str:
    """Return the nearest whole angle of an end with which the drilling passes its checks, in words."""
    angle = nearest_whole_angle(accepts, f"{name}.angle_deg", angle_deg)
    if angle is None:
        return "Change both angles, or a place_mm."
    return f"The nearest that fits is {key}.{name}.angle_deg = {angle}."


def _words(outlet: DrillOutlet) -> str:
    return outlet.journal.replace("_", " ") + ("'s bore" if outlet.in_bore else "")


def _check_outlets(
    scene: ThrowView, ends: Ends, bore: DrillBore, accepts: Accepts, tool: Array, rims: Sequence[Array]
) -> None:
    """Outlets with their rounding stay on the cylinder of the journal, clear of the fillet."""
    for (name, end), outlet, rim in zip(ends, bore.outlets, rims, strict=True):
        if not outlet.in_bore and _over_fillet_mm(scene, bore, outlet, tool, rim) > 0:
            why = "the outlet runs into the fillet beside it"
            raise _too_large(bore.key, f"{name}.place_mm", end.place_mm, why, accepts)


def _over_fillet_mm(scene: ThrowView, bore: DrillBore, outlet: DrillOutlet, tool: Array, rim: Array) -> float:
    """Return how far an outlet and its tool reach beyond the journal's straight part, mm."""
    journal, toward, face = _end_of(scene, outlet)
    at = 0.0 if outlet is bore.outlets[0] else bore.length_mm
    near = np.hypot(bore.places_mm - at, bore.radius_mm) < 4 * bore.radius_mm
    x, y, z = tool.reshape(len(near), -1, 3)[near].reshape(-1, 3).T
    outside = np.hypot(x, y - outlet.y_mm) > outlet.surface_mm
    z = np.concatenate([rim, z[outside]])
    limit = toward * face - journal.fillet.axial_mm - least_shoulder_mm(scene.throw)
    return float((toward * z).max() - limit)


def rim_z_mm(bore: DrillBore, outlet: DrillOutlet) -> Array:
    """Return heights of points all around the rim of an outlet, where its rounding ends."""
    if outlet.rounding_mm:
        turn = np.linspace(0, 2 * np.pi, 181)
        return ring_points(bore.radius_mm, outlet, turn, np.ones(181), np.ones(181))[:, 2]
    offsets = bore.radius_mm * bore.around
    heights = outlet.height_mm(offsets, outlet.surface_mm)
    return np.asarray(outlet.point_mm[2] + offsets[:, 2] + heights * outlet.outward[2])


def _check_middles(
    scene: ThrowView, ends: Ends, bore: DrillBore, accepts: Accepts, rims: Sequence[Array]
) -> None:
    """Rims of outlets are clear of the middle of their journal, or reach well beyond it."""
    for (name, end), outlet, rim in zip(ends, bore.outlets, rims, strict=True):
        if not outlet.surface_mm or (bore.alone and outlet.journal == "crankpin"):
            continue
        _, toward, _ = _end_of(scene, outlet)
        middle = 0.0 if toward > 0 else scene.pitch_mm / 2
        before = float((toward * (rim - middle)).min())
        if -_LEAST_OVERLAP < before / (2 * bore.radius_mm) < _LEAST_LAND:
            raise _at_middle(f"{name}.place_mm", end, bore, before, accepts)


def _at_middle(
    name: str, end: DrillingEnd, bore: DrillBore, before_mm: float, accepts: Accepts
) -> CranktopoError:
    """Return the refusal of a place with those on either side that all checks of the drilling accept."""
    side = "before" if before_mm >= 0 else "beyond"
    why = (
        f"the rim of the outlet ends {abs(before_mm):.1g} mm {side} the middle of throw.{end.journal_key}, "
        "where its half throw ends"
    )
    limits = (
        ("at most", largest_accepted(accepts, name, end.place_mm)),
        ("at least", least_accepted(accepts, name, end.place_mm)),
    )
    allowed = " or ".join(f"{word} {limit:g} mm" for word, limit in limits if limit is not None)
    return invalid(f"{bore.key}.{name}", end.place_mm, f"{why}; must be {allowed}" if allowed else why)


def _end_of(scene: ThrowView, outlet: DrillOutlet) -> tuple[Journal, int, float]:
    """Return a journal, on which side of it the web lies, and the height of that face."""
    start, end = scene.web_z_mm
    if outlet.journal == "main_journal":
        return scene.throw.main_journal, 1, start
    return scene.throw.crankpin, -1, end


def _check_in_journals(scene: ThrowView, bore: DrillBore, points: Array) -> None:
    """Beside the web a drilling is inside the journal, so that no fillet is cut."""
    start, end = scene.web_z_mm
    least = least_shoulder_mm(scene.throw)
    sides = ((start, 1), (end, -1))
    for (journal, y), (face, toward), name in zip(
        scene.throw.journals, sides, ("main journal", "crankpin"), strict=True
    ):
        depth = toward * (face - points[:, 2])
        passing = (depth >= 0) & (depth <= max(journal.fillet.axial_mm, bore.radius_mm))
        x, along, _ = points[passing].T
        off_mm = np.hypot(x, along - y).max(initial=0.0)
        if off_mm > journal.radius_mm - least:
            raise CranktopoError(
                f"{bore.key}: breaks through the fillet of the {name}: it passes the web's face "
                f"{off_mm:.4g} mm from the axis, the journal has {journal.radius_mm:.4g} mm.",
                hint="Move its end on that journal to the journal's middle, or its other end to the web.",
            )


def _check_in_web(scene: ThrowView, bore: DrillBore) -> None:
    """A drilling is inside the web's outline and clear of its pockets and bevels."""
    least = least_shoulder_mm(scene.throw)
    x, y, z = bore.surface_mm(bore.radius_mm + least).T
    start, end = scene.web_z_mm
    inside = (z >= start) & (z <= end)
    if not inside.any():
        return
    held = np.zeros(x.shape, dtype=bool)
    for body in web_bodies(scene):
        here = inside & (z >= body.z_mm[0]) & (z <= body.z_mm[1])
        if body.key.startswith(_BORES) or not here.any():
            continue
        holds = _holds(body, x[here], y[here], z[here])
        if body.adds:
            held[here] |= holds
        elif holds.any():
            raise _refusal(bore, f"runs into {body.key}", least)
    if not held[inside].all():
        raise _refusal(bore, "breaks out of the web's outline", least)


def _refusal(bore: DrillBore, what: str, least: float) -> CranktopoError:
    hint = f"Keep at least {rounded_up(least):g} mm of web around the drilling."
    return CranktopoError(f"{bore.key}: {what}.", hint=hint)


def _holds(body: Body, x: Array, y: Array, z: Array) -> NDArray[np.bool_]:
    low, high = body.y_range_mm
    parts = [(x >= left) & (x <= right) & (left < right) for left, right in body.spans(y, z)]
    return np.asarray(np.any(parts, axis=0) & (y >= low) & (y <= high))


def _check_bores(scene: ThrowView, bore: DrillBore) -> None:
    """A drilling opens into an axial bore with its whole section, or passes beside it."""
    along = bore.direction[:2] / np.hypot(*bore.direction[:2])
    start, end = scene.web_z_mm
    ranges = ((0.0, end), (start, scene.pitch_mm / 2))
    heights = sorted(outlet.point_mm[2] for outlet in bore.outlets)
    least = least_shoulder_mm(scene.throw)
    for (journal, y), (low, high), name in zip(
        scene.throw.journals, ranges, ("main_journal", "crankpin"), strict=True
    ):
        off = np.array([0.0, y]) - np.array(bore.outlets[0].point_mm[:2])
        aside = abs(float(off[0] * along[1] - off[1] * along[0]))
        radius = journal.bore_radius_mm
        meets = radius and heights[0] <= high and heights[1] >= low
        if meets and _BORE_SHARE * radius - bore.radius_mm < aside < radius + bore.radius_mm + least:
            raise CranktopoError(
                f"{bore.key}: grazes the bore of throw.{name}: its axis passes {aside:.3g} mm beside that "
                f"of the bore of {2 * radius:g} mm.",
                hint="Let it run through the bore's axis, or clear of the bore.",
            )


def _check_apart(scene: ThrowView, one: DrillBore, other: DrillBore) -> None:
    least = least_shoulder_mm(scene.throw)
    places = np.linspace(*one.extent_mm, 400)[:, None]
    points = np.array(one.outlets[0].point_mm) + places * one.direction
    gap = float(other.off_axis_mm(*points.T).min())
    needed = one.reach_mm + other.reach_mm + least
    if gap < needed:
        raise CranktopoError(
            f"{one.key}: meets {other.key}: their axes are {rounded_down(gap):g} mm apart, at least "
            f"{rounded_up(needed):g} mm with the outlets.",
            hint="Move them apart; a drilling from journal to journal may be one instead of two.",
        )
