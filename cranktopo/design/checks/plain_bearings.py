"""Consistency of the plain bearings with their journals."""

from __future__ import annotations

from collections.abc import Callable
from itertools import pairwise

from cranktopo.base.errors import CranktopoError
from cranktopo.design.bearing_room import BETWEEN_FILLETS, own_main_room_mm, widest_big_end_mm
from cranktopo.design.free_dimensions import DIMENSIONS, free_range_mm, with_dimensions
from cranktopo.design.plain_bearings import PlainBearings
from cranktopo.design.schema import Scene

_LARGEST_CLEARANCE = 0.01
"""Clearance over the diameter."""
_WIDEST_HOLE = 0.5
"""Diameter of a feed hole over the width of a bearing."""
_NARROWEST = 0.02
"""Width of a film over its diameter."""


def check_plain_bearings(scene: Scene) -> None:
    """Check widths, groove and clearances against the room between the fillets."""
    bearings, throw = scene.bearings, scene.throw
    if bearings is None:
        return
    _check_viscosity(scene, bearings)
    rooms = {
        "width_mm": (own_main_room_mm(scene), BETWEEN_FILLETS),
        "big_end_width_mm": widest_big_end_mm(scene),
    }
    for key, (room, what) in rooms.items():
        own_width = getattr(bearings, key)
        if own_width is not None and own_width > room:
            raise scene.invalid(f"bearings.{key}", f"must be at most {room:.4g} mm, {what}")
        if own_width is None and room <= 0:
            raise scene.invalid(
                f"bearings.{key}", "the fillets leave no room for it", "Give a width above 0 mm."
            )
    width, big_end = (getattr(bearings, key) or room for key, (room, _) in rooms.items())
    narrowest = min(width, big_end)
    if bearings.feed_hole_mm is not None and bearings.feed_hole_mm > _WIDEST_HOLE * narrowest:
        raise scene.invalid(
            "bearings.feed_hole_mm",
            f"must be at most {_WIDEST_HOLE * narrowest:.4g} mm, half the width of the narrowest bearing",
            "Usual is a tenth of the journal's diameter.",
        )
    most = width - 2 * _NARROWEST * throw.main_journal.outer_diameter_mm
    if bearings.groove_mm and bearings.groove_mm > most:
        raise scene.invalid(
            "bearings.groove_mm",
            f"leaves each film of a {width:.4g} mm bearing less than {100 * _NARROWEST:g} % of the diameter",
            f"Take at most {max(most, 0.0):.4g} mm, 0 for none.",
        )
    for key, journal in (("clearance_mm", throw.main_journal), ("big_end_clearance_mm", throw.crankpin)):
        most = _LARGEST_CLEARANCE * journal.outer_diameter_mm
        if (getattr(bearings, key) or 0.0) > most:
            raise scene.invalid(
                f"bearings.{key}",
                f"must be at most {most:.4g} mm, 1 % of the journal's diameter",
                "Usual is 0.05 to 0.15 %.",
            )


def _check_viscosity(scene: Scene, bearings: PlainBearings) -> None:
    curve = bearings.viscosity_curve_mPas
    if curve is None:
        return
    if bearings.viscosity_mPas is not None:
        raise scene.invalid(
            "bearings.viscosity_curve_mPas",
            "must not stand beside bearings.viscosity_mPas",
            "Keep one of them.",
        )
    if any(hot <= cold or thin >= thick for (cold, thick), (hot, thin) in pairwise(curve)):
        raise scene.invalid(
            "bearings.viscosity_curve_mPas",
            "must have rising temperatures and falling viscosities",
            "Give pairs of degC and mPa s, the coldest first.",
        )


def check_bearings_of_free_dimensions(scene: Scene) -> None:
    """Check that the bearings still fit between the greatest fillets, beside the thickest web."""
    if scene.bearings is not None:
        hint = "Narrow the range, or leave the width out: then a bearing is as wide as its room."
        check_room_of_free_dimensions(scene, check_plain_bearings, hint)


def check_room_of_free_dimensions(scene: Scene, check: Callable[[Scene], None], hint: str) -> None:
    """Check what lies between the fillets once more with the greatest of them, and the thickest web."""
    taking = [name for name in DIMENSIONS if name == "web_thickness" or "fillet" in name]
    greatest = {name: found[1] for name in taking if (found := free_range_mm(scene, name))}
    if not greatest:
        return
    try:
        check(with_dimensions(scene, greatest))
    except CranktopoError as error:
        dimensions = ", ".join(f"{name}_mm = {value:g}" for name, value in greatest.items())
        raise scene.invalid(
            f"shape.free.{next(reversed(greatest))}_mm",
            f"with the greatest, {dimensions}, {error.message.rstrip('.')}",
            hint,
        ) from None
