"""Rules of holes and bevels of a counterweight: in sound material, clear of what else is cut there."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from cranktopo.base.arrays import Array, Mask
from cranktopo.base.errors import CranktopoError
from cranktopo.throw.counterweight.edge import EdgeCut
from cranktopo.throw.counterweight.holes import AxialHole, RadialHole
from cranktopo.throw.feature import Body, ThrowView, least_shoulder_mm
from cranktopo.throw.hole import bore_holes
from cranktopo.throw.recess import recesses


def check_holes(
    scene: ThrowView,
    key: str,
    parts: Sequence[Body],
    holes: Sequence[AxialHole | RadialHole],
    bevels: Sequence[EdgeCut],
    bolted: bool,
) -> None:
    """Refuse holes that leave the counterweight, meet each other or another cut, or lie under a fillet."""
    cuts, least = other_cuts(scene, key), least_shoulder_mm(scene.throw)
    for hole in holes:
        at = hole.wall_mm(least)
        in_web = in_outline(scene, at)
        if bolted and in_web.any():
            raise _refused(hole, "reaches into the web, to which the counterweight is bolted", least)
        if not np.any([in_web, *(within(part, at) for part in parts)], axis=0).all():
            raise _refused(hole, f"does not lie in {key} all around", least)
        if isinstance(hole, RadialHole) and in_outline(scene, hole.beyond_rim_mm()).any():
            raise _refused(hole, "leaves through the web's outline, which reaches beyond the rim", least)
        for cut in (*cuts, *bevels, *(other for other in holes if other is not hole)):
            if within(cut, at).any():
                raise _refused(hole, f"meets {cut.key}", least)
        if isinstance(hole, AxialHole):
            _check_clear_of_fillets(scene, hole, least)


def check_edge(
    scene: ThrowView, key: str, bevels: Sequence[EdgeCut], holes: Sequence[AxialHole | RadialHole]
) -> None:
    """Refuse a bevelled edge that meets a hole, a bore or a pocket."""
    cuts, least = (*other_cuts(scene, key), *holes), least_shoulder_mm(scene.throw)
    for bevel in bevels:
        at = bevel.points_mm(least)
        for cut in cuts:
            if within(cut, at).any():
                raise _refused(bevel, f"meets {cut.key}", least)


def other_cuts(scene: ThrowView, key: str) -> list[Body]:
    """Return bores, recesses, and what features beside the one with a key cut."""
    others = [
        body for path, feature in scene.web.features() if path != key for body in feature.bodies(scene, path)
    ]
    return [body for body in (*bore_holes(scene), *recesses(scene), *others) if not body.adds]


def in_outline(scene: ThrowView, at: Array) -> Mask:
    """Tell which points (3, n) lie in the outline of the web, between its faces."""
    x, y, z = at
    (low, high), (bottom, top) = scene.web_z_mm, scene.web.y_range_mm(scene.throw.radius_mm)
    half = scene.web.half_width_mm(scene.throw.radius_mm, y)
    return np.asarray((np.abs(x) <= half) & (y >= bottom) & (y <= top) & (z >= low) & (z <= high))


def within(body: Body, at: Array) -> Mask:
    """Tell which points (3, n) lie in a body."""
    x, y, z = at
    (low, high), (bottom, top) = body.z_mm, body.y_range_mm
    inside = (z >= low) & (z <= high) & (y >= bottom) & (y <= top)
    parts = [(x >= left) & (x <= right) & (left < right) for left, right in body.spans(y, z)]
    return np.asarray(inside & np.any(parts, axis=0))


def _check_clear_of_fillets(scene: ThrowView, hole: AxialHole, least: float) -> None:
    """The faces that it opens at have no journal there."""
    for face, (journal, y) in zip(scene.web_z_mm, scene.throw.journals, strict=True):
        gap = hole.distance_mm(y, face) - journal.clear_radius_mm
        if face in hole.z_mm and gap < least:
            raise _refused(hole, f"opens under a journal or its fillet ({-gap:.3g} mm)", least)


def _refused(hole: Body, what: str, least: float) -> CranktopoError:
    return CranktopoError(f"{hole.key}: {what}.", hint=f"Keep at least {least:.3g} mm of material around it.")
