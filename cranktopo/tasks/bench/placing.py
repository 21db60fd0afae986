"""A new pocket or hole at a place of a web face, as near and as large as the rules allow."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from itertools import product
from typing import Any

import numpy as np

from cranktopo.base.errors import CranktopoError
from cranktopo.design.edits import changed_data
from cranktopo.design.halves import WebName, halves, named_in_throw
from cranktopo.design.loading import scene_from_dict, value_at
from cranktopo.design.schema import Scene
from cranktopo.tasks.bench.live import violated_rules_of
from cranktopo.throw.hole import FACES, uncut_half_width_mm

_GRID_MM = 0.5
_MIDDLE = 0.06
"""Distance from the middle of the web over the throw's radius within which a pocket is put in the middle."""
_SIZES = (0.35, 0.28, 0.22, 0.17, 0.13, 0.1)
"""Sizes that are tried, over the throw's radius, the largest first."""
_DEPTH = 0.25
"""Depth of a pocket over the thickness of the web."""
_WAYS = 6
"""Places that are tried, from the one that is wanted on toward the middle of the web."""


def placed_pocket(data: dict[str, Any], kind: str, place: Mapping[str, Any]) -> dict[str, Any]:
    """Return the change that adds a `hole` through the web or a `pocket` from one of its faces.

    Args:
        place: `face`, `x_mm`, `y_mm` and `side`, the half of the throw, as `picking.picked` returns them.

    Raises:
        CranktopoError: no size keeps the rules there.
    """
    scene = scene_from_dict(data, "design", whole=True)
    side: WebName = "second" if place["side"] == "second" else "first"
    half, face = halves(scene)[side == "second"], str(place["face"])
    key = named_in_throw("web.pocket", scene, side)
    number = len(value_at(data, key) or ())
    radius, wanted = half.throw.radius_mm, (float(place["x_mm"]), float(place["y_mm"]))
    sizes = [max(_GRID_MM, _on_grid(share * radius)) for share in _SIZES]
    for clear_of_fillets, (x, y), size in product((True, False), [*_places(radius, *wanted)], sizes):
        changes = {f"{key}[{number}]": _table(kind, face, x, y, size, half.web.thickness_mm)}
        free = _in_free_face(half, kind, face, x, y, size, clear_of_fillets=clear_of_fillets)
        if free and not violated_rules_of(changed_data(data, changes)):
            return changes
    raise CranktopoError(
        f"{kind}: none of {_on_grid(_SIZES[-1] * radius):g} mm and more has room near x = {wanted[0]:.1f}, "
        f"y = {wanted[1]:.1f} mm.",
        hint="Click farther from journals, bores and edges, or add it on the left.",
    )


def _in_free_face(
    half: Scene, kind: str, face: str, x: float, y: float, size: float, *, clear_of_fillets: bool
) -> bool:
    """Tell whether it lies within the outline, and outside of the journals at the faces that it opens at.

    Where it may cut their fillets, its middle lies outside.
    """
    along = np.linspace(y - size / 2, y + size / 2, 9)
    reach = size / 2 if kind == "hole" else size / math.sqrt(2)
    journals = dict(zip(FACES, half.throw.journals, strict=True))
    met = (one for name, one in journals.items() if kind == "hole" or name == face)
    outside = (
        math.hypot(x, y - axis) >= (one.clear_radius_mm + reach if clear_of_fillets else one.radius_mm)
        for one, axis in met
    )
    return bool((uncut_half_width_mm(half, along) >= abs(x) + size / 2).all()) and all(outside)


def _places(radius_mm: float, x_mm: float, y_mm: float) -> Iterator[tuple[float, float]]:
    x = 0.0 if abs(x_mm) < _MIDDLE * radius_mm else x_mm
    for step in range(_WAYS):
        share = step / _WAYS
        yield _on_grid((1 - share) * x), _on_grid((1 - share) * y_mm + share * radius_mm / 2)


def _on_grid(length_mm: float) -> float:
    return round(length_mm / _GRID_MM) * _GRID_MM + 0.0


def _table(kind: str, face: str, x: float, y: float, size: float, thickness: float) -> dict[str, Any]:
    place, depth = {"x_mm": x, "y_mm": y}, max(_GRID_MM, _on_grid(_DEPTH * thickness))
    if kind == "hole":
        return {"shape": "cylinder", "face": "through", **place, "diameter_mm": size}
    return {"shape": "box", "face": face, **place, "size_x_mm": size, "size_y_mm": size, "depth_mm": depth}
