"""The section through both axes of a half throw, and dimensions along the shaft that are dragged on it."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

import numpy as np

from cranktopo.design.schema import Scene
from cranktopo.numerics.surfaces.plane_section import section_x
from cranktopo.tasks.bench.front_view import handle

if TYPE_CHECKING:
    from manifold3d import Manifold


def side_view(scene: Scene, half: Manifold) -> dict[str, Any]:
    """Return the section x = 0 of the first half throw, z to the right and y up, mm: paths and handles."""
    paths = [
        {"points": np.round(corners, 3).tolist(), "kind": "web", "closed": True}
        for corners in section_x(half).to_polygons()
    ]
    return {"paths": paths, "handles": list(_handles(scene))}


def _handles(scene: Scene) -> Iterator[dict[str, Any]]:
    throw, (start, end), middle = scene.throw, scene.web_z_mm, scene.pitch_mm / 2
    main, pin, radius = throw.main_journal, throw.crankpin, throw.radius_mm
    along, up = (1.0, 0.0), (0.0, 1.0)
    yield handle("web.thickness_mm", scene.web.thickness_mm, (end, radius / 2), along)
    yield handle("throw.main_journal.length_mm", main.length_mm, (start, -main.radius_mm), along, 2)
    yield handle("throw.crankpin.length_mm", pin.length_mm, (middle, radius - pin.radius_mm), along, 2)
    if main.fillet_mm:
        place = (start - main.fillet_mm, main.radius_mm)
        yield handle("throw.main_journal.fillet_mm", main.fillet_mm, place, (-1.0, 0.0))
    if pin.fillet_mm:
        place = (end + pin.fillet_mm, radius + pin.radius_mm)
        yield handle("throw.crankpin.fillet_mm", pin.fillet_mm, place, along)
    for name, journal, place in (
        ("main_journal", main, (0.0, main.bore_radius_mm)),
        ("crankpin", pin, (middle, radius + pin.bore_radius_mm)),
    ):
        if journal.bore_radius_mm:
            key = f"throw.{name}.bore_diameter_mm"
            yield handle(key, journal.bore_diameter_mm, place, up, 2)
