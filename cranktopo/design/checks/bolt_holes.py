"""Rules of the placed bolts of a counterweight: their holes lie in sound material, clear of other cuts."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from itertools import combinations

import numpy as np

from cranktopo.base.arrays import Array
from cranktopo.base.errors import CranktopoError
from cranktopo.design.bolt import BoltedJoint
from cranktopo.design.bolt_holes import BoltHole, bolt_holes, lower_end_mm
from cranktopo.design.halves import halves
from cranktopo.design.schema import Scene
from cranktopo.throw.counterweight.checks import in_outline, other_cuts, within
from cranktopo.throw.drilling.table import drill_bores
from cranktopo.throw.feature import Body, least_shoulder_mm

_AROUND, _ALONG = 48, 15
_WEIGHT = "web.counterweight"


def check_bolt_places(scene: Scene) -> None:
    """Check that the bolts with places are those of a joint, and that their holes can be drilled."""
    for number, joint in enumerate(scene.bolted_joint):
        if joint.places_mm:
            _check_joint(scene, f"bolted_joint[{number}]", joint)
    for half in dict.fromkeys(halves(scene)):
        holes = bolt_holes(half)
        for hole in holes:
            _check_weight(half, hole)
            _check_web(half, hole)
        for one, other in combinations(holes, 2):
            _check_apart(half, one, other)


def _check_joint(scene: Scene, path: str, joint: BoltedJoint) -> None:
    key = f"{path}.places_mm"
    if joint.holds is None:
        raise scene.invalid(key, f'has no meaning without `holds = "{_WEIGHT}"`, whose bolts it places')
    if joint.held_in == "nut":
        raise scene.invalid(f"{path}.held_in", "must be tapped_hole where places_mm are given: the thread is")
    if len(joint.places_mm) != joint.bolts:
        raise scene.invalid(f"{path}.bolts", f"must be {len(joint.places_mm)}, the number of its places_mm")
    turned = Counter((0.0 - x, z) for x, z in joint.places_mm)
    if turned != Counter((x + 0.0, z) for x, z in joint.places_mm):
        raise scene.invalid(key, "must have the mirror image (-x, z) of every place (x, z)")


def _check_weight(scene: Scene, hole: BoltHole) -> None:
    """Hole and head lie in the counterweight all around, the head below its rim."""
    weight, least = scene.web.counterweight, least_shoulder_mm(scene.throw)
    assert weight is not None
    if np.isnan(hole.joint_mm):
        raise _refused(scene, hole, "misses the outline of the web below the crank axis")
    sector, out = weight.sector(scene), hole.head_radius_mm + least
    reach = abs(hole.x_mm) + out
    if reach >= sector.corner.on_rim[0] or abs(hole.z_mm - sum(sector.z_mm) / 2) + out > _half(sector.z_mm):
        raise _refused(scene, hole, f"leaves {_WEIGHT}, all around the hole of its head of ⌀{_head(hole)} mm")
    x = hole.x_mm + np.linspace(-out, out, _AROUND)
    rim = -float(np.sqrt(sector.radius_mm**2 - x**2).min())
    high = float(np.nanmin(lower_end_mm(scene, x)))
    most = hole.joint_mm - rim - hole.joint.nominal.diameter_mm
    shortest = hole.joint_mm - high + least
    if not (hole.head_end_mm >= rim and hole.seat_mm <= high - least):
        allowed = f"must be from {shortest:.4g} to {most:.4g} mm: its head lies in {_WEIGHT}, below the rim"
        raise scene.invalid(f"{hole.key}.grip_mm", allowed, "Change it, or places_mm.")
    at = _wall(hole, hole.hole_radius_mm + least, hole.seat_mm, hole.joint_mm)
    at = at[:, ~in_outline(scene, at)]
    if not within(sector, at).all():
        raise _refused(scene, hole, f"leaves {_WEIGHT} through a flank")
    beside = (*weight.cuts(scene), *other_cuts(scene, _WEIGHT))
    _check_clear(scene, hole, beside, np.hstack([at, _wall(hole, out, rim, hole.seat_mm)]))


def _check_web(scene: Scene, hole: BoltHole) -> None:
    """The thread lies in the web all around, clear of what is cut out of it."""
    least, (start, end) = least_shoulder_mm(scene.throw), scene.web_z_mm
    out = hole.joint.nominal.diameter_mm / 2 + least
    if hole.z_mm - out < start or hole.z_mm + out > end:
        raise _refused(scene, hole, "leaves the web through one of its faces")
    at = _wall(hole, out, hole.joint_mm, hole.floor_mm + least)
    at = at[:, (at[1] >= lower_end_mm(scene, at[0])) | (at[1] > hole.joint_mm + out)]
    if not in_outline(scene, at).all():
        raise _refused(scene, hole, "leaves the outline of the web with its thread")
    _check_clear(scene, hole, (*other_cuts(scene, _WEIGHT), *drill_bores(scene)), at)


def _check_clear(scene: Scene, hole: BoltHole, cuts: Sequence[Body], at: Array) -> None:
    for cut in cuts:
        if within(cut, at).any():
            raise _refused(scene, hole, f"meets {cut.key}")


def _check_apart(scene: Scene, one: BoltHole, other: BoltHole) -> None:
    apart = float(np.hypot(one.x_mm - other.x_mm, one.z_mm - other.z_mm))
    if apart < one.head_radius_mm + other.head_radius_mm + least_shoulder_mm(scene.throw):
        raise _refused(scene, other, f"meets the one at ({one.x_mm:g}, {one.z_mm:g}) of {one.key}")


def _wall(hole: BoltHole, radius_mm: float, low_mm: float, high_mm: float) -> Array:
    return hole.wall_mm(radius_mm, np.linspace(low_mm, high_mm, _ALONG), _AROUND)


def _half(z_mm: tuple[float, float]) -> float:
    return (z_mm[1] - z_mm[0]) / 2


def _head(hole: BoltHole) -> str:
    return f"{2 * hole.head_radius_mm:.3g}"


def _refused(scene: Scene, hole: BoltHole, what: str) -> CranktopoError:
    least = least_shoulder_mm(scene.throw)
    middle = sum(scene.web.counterweight.sector(scene).z_mm) / 2 if scene.web.counterweight else 0.0
    place = f"the bolt at x {hole.x_mm:g}, z {hole.z_mm - middle:g} mm"
    return CranktopoError(
        f"{hole.key}.places_mm: {place} {what}.", hint=f"Keep at least {least:.3g} mm of material around it."
    )
