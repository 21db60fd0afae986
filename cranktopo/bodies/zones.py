"""Parts of a web that stay as they are: in frozen zones, and outside those to remove material from.

What a bolted counterweight needs is a frozen zone too: its seat in the web stays, its own space stays empty.
"""

from __future__ import annotations

import operator
from collections.abc import Iterator
from functools import lru_cache, reduce
from pathlib import Path
from typing import Literal

import numpy as np
from manifold3d import Manifold

from cranktopo.base.spans import Section, common, polygon_section, section_difference, superpose_sections
from cranktopo.bodies.envelope_file import SECTIONS, envelope_from_file, with_faces_at
from cranktopo.bodies.seat import seat_section, seat_solid, seat_z_mm
from cranktopo.bodies.solid.files import kernel_surface_of
from cranktopo.design.halves import keeps_parts
from cranktopo.design.schema import Scene
from cranktopo.numerics.surfaces.mesh import solid_of
from cranktopo.throw.feature import DrilledBody
from cranktopo.throw.web import web_bodies, web_spans
from cranktopo.throw.zone import BodyZone, BoxZone, CylinderZone, Zone

_Kind = Literal["frozen", "removable"]
_SIDES = 256
_FAR_MM = 1e3
"""Over the throw's radius: beyond every web."""
_BEYOND_MM = 1.0
"""Length by which a zone where material may be removed goes on beyond the web's faces."""


def frozen_at(scene: Scene, z_mm: float, *, seated: bool = True) -> list[Section]:
    """Return the frozen zones at a height, where nothing is designed.

    `seated`: with that of a bolted counterweight. Of webs by dimensions it moves with the outline.
    """
    if scene.envelope is None:
        return []
    seat = seat_section(scene, z_mm) if seated else None
    return [*_sections(scene, "frozen", z_mm), *([seat] if seat else [])]


def staying_at(scene: Scene, z_mm: float, *, seated: bool = True) -> Iterator[tuple[Section, bool]]:
    """Yield what of the web stays as it is at a height: in frozen zones, and beside those to remove from.

    Each with whether it lies in what else would be designed.
    """
    if scene.envelope is None or not keeps_parts(scene):
        return
    own, frozen = own_section(scene, z_mm), frozen_at(scene, z_mm, seated=seated)
    if frozen:
        yield common(own, frozen[0] if len(frozen) == 1 else superpose_sections(*frozen)), False
    if scene.envelope.removable:
        removable = _sections(scene, "removable", z_mm)
        yield section_difference(own, *removable, *frozen), True


def own_section(scene: Scene, z_mm: float) -> Section:
    """Return the scene's own web, or that of its original's file, at a height."""
    if scene.original is not None:
        return _slice(_original(scene), z_mm)
    bodies = [body for body in web_bodies(scene) if not isinstance(body, DrilledBody)]
    return lambda y_mm, z: list(zip(*web_spans(bodies, y_mm, z), strict=True))


def _sections(scene: Scene, kind: _Kind, z_mm: float) -> list[Section]:
    found = []
    for key, zone in _zones(scene, kind):
        low, high = zone.z_mm
        if low < z_mm < high:
            found.append(_slice(_body(zone, key), z_mm) if isinstance(zone, BodyZone) else zone.spans)
    return found


def _zones(scene: Scene, kind: _Kind) -> Iterator[tuple[str, Zone]]:
    """Yield the zones of a kind, each with its key in the scene."""
    for index, zone in enumerate(getattr(scene.envelope, kind)):
        yield f"envelope.{kind}[{index}]", zone


def _body(zone: BodyZone, key: str) -> Manifold:
    """Return the body of its file, which is its own mirror image where the zone says so."""
    return envelope_from_file(zone.body_file, zone.symmetric, f"{key}.file")


def _slice(body: Manifold, z_mm: float) -> Section:
    return polygon_section([np.asarray(contour) for contour in body.slice(z_mm).to_polygons()])


def zone_heights_mm(scene: Scene) -> list[float]:
    """Return heights between which zones, and the web in them, have one section or change smoothly."""
    if scene.envelope is None or not keeps_parts(scene):
        return []
    zones = (*scene.envelope.frozen, *scene.envelope.removable)
    found = [z for zone in zones for z in zone.z_mm if abs(z) < _FAR_MM * scene.throw.radius_mm]
    if scene.original is not None or any(zone.body_file for zone in zones):
        found += np.linspace(*scene.web_z_mm, SECTIONS + 1).tolist()
    bodies = web_bodies(scene) if scene.original is None else []
    found += seat_z_mm(scene) or ()
    return found + [z for body in bodies for ends in (body.z_mm, *body.changing_z_mm) for z in ends]


def zones_change(scene: Scene, z_mm: float) -> bool:
    """Tell whether the web that stays in zones changes along the crank axis at a height."""
    bodies = web_bodies(scene) if keeps_parts(scene) and scene.original is None else []
    ranges = (ends for body in bodies if not isinstance(body, DrilledBody) for ends in body.changing_z_mm)
    return any(low < z_mm < high for low, high in ranges)


@lru_cache(maxsize=4)
def zone_solids(scene: Scene) -> tuple[Manifold, Manifold]:
    """Return what of the web stays, and what of zones stays empty, as bodies."""
    if scene.envelope is None or not keeps_parts(scene):
        return Manifold(), Manifold()
    start, end = scene.web_z_mm
    own = _own_solid(scene)
    solids = (_solid(zone, key, start, end) for key, zone in _zones(scene, "frozen"))
    frozen = reduce(operator.add, solids, seat_solid(scene))
    kept = own ^ frozen
    if scene.envelope.removable:
        ends = start - _BEYOND_MM, end + _BEYOND_MM
        free = (_solid(zone, key, *ends) for key, zone in _zones(scene, "removable"))
        kept += own - reduce(operator.add, free)
    return kept, frozen - own


def _own_solid(scene: Scene) -> Manifold:
    start, end = scene.web_z_mm
    if scene.original is None:
        return with_faces_at(solid_of(kernel_surface_of(scene, "web"), "web"), start, end)
    body = with_faces_at(_original(scene), start, end).trim_by_plane((0.0, 0.0, 1.0), start)
    return body.trim_by_plane((0.0, 0.0, -1.0), -end)


def _original(scene: Scene) -> Manifold:
    assert scene.original is not None
    return envelope_from_file(Path(scene.original.file), key="original.file")


def _solid(zone: Zone, key: str, start_mm: float, end_mm: float) -> Manifold:
    """Return a zone as a body between two heights."""
    low, high = (max(zone.z_mm[0], start_mm), min(zone.z_mm[1], end_mm))
    if low >= high:
        return Manifold()
    match zone:
        case BoxZone():
            size = zone.x_max_mm - zone.x_min_mm, zone.y_max_mm - zone.y_min_mm, high - low
            return Manifold.cube(size).translate((zone.x_min_mm, zone.y_min_mm, low))
        case CylinderZone():
            radius = zone.diameter_mm / 2
            body = Manifold.cylinder(high - low, radius, radius, _SIDES)
            return body.translate((zone.x_mm, zone.y_mm, low))
        case BodyZone():
            body = with_faces_at(_body(zone, key), low, high)
            return body.trim_by_plane((0.0, 0.0, 1.0), low).trim_by_plane((0.0, 0.0, -1.0), -high)
