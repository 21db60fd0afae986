"""Consistency of the rod with what it meets: crankpin between its fillets, bearing, piston and cylinder."""

from __future__ import annotations

from cranktopo.base.errors import CranktopoError
from cranktopo.design.bearing_room import big_end_room_mm
from cranktopo.design.checks.plain_bearings import check_room_of_free_dimensions
from cranktopo.design.crank_throws import throw_scenes
from cranktopo.design.halves import halves
from cranktopo.design.rod import Rod
from cranktopo.design.schema import Scene

_ROUNDING_MM = 1e-9


def check_rod_place(scene: Scene, rod: Rod) -> None:
    """Check that the rod fits onto each crankpin of the crank, and its piston pin into the cylinder."""
    if scene.has_master_rod:
        raise CranktopoError(
            "[rod]: is given, but a master rod carries the other rods of its pin here; it is not modelled.",
            hint="Take [rod] out, and give the masses of one cylinder in [engine.masses].",
        )
    for throw in dict.fromkeys(throw_scenes(scene)):
        _check_bore(scene, rod, throw)
        _check_width(scene, rod, throw)
    bearing = scene.bearings and scene.bearings.big_end_width_mm
    if bearing and bearing > rod.big_end_width_mm:
        raise scene.invalid(
            "bearings.big_end_width_mm", f"must be at most rod.big_end_width_mm, {rod.big_end_width_mm:g} mm"
        )
    if scene.engine is not None:
        _check_cylinder(scene, rod, scene.engine.bore_mm)
    check_room_of_free_dimensions(scene, _check_own_width, "Narrow the range, or rod.big_end_width_mm.")


def _check_bore(scene: Scene, rod: Rod, throw: Scene) -> None:
    """Check that pin and clearance leave a thickness for the bearing in the big end."""
    pin = max(half.throw.crankpin.outer_diameter_mm for half in halves(throw))
    given = scene.bearings
    clearance = (given.big_end_clearance_mm or given.clearance_mm) if given else 0.0
    left = rod.big_end_bore_mm - pin - clearance
    runs_without_shells = clearance > 0 and not rod.shells_kg
    if left < -_ROUNDING_MM or (left <= _ROUNDING_MM and not runs_without_shells):
        beside = f" and the clearance of its bearing, {clearance:g} mm" if clearance else ""
        allowed = (
            f"must be above the diameter of the crankpin, {pin:g} mm{beside}: the bearing is between them"
        )
        raise scene.invalid("rod.big_end_bore_mm", allowed, "Usual is a bore 5 to 10 % larger than the pin.")


def _check_own_width(scene: Scene) -> None:
    assert scene.rod is not None
    _check_width(scene, scene.rod, scene)


def _check_width(scene: Scene, rod: Rod, throw: Scene) -> None:
    room = big_end_room_mm(throw)
    if rod.big_end_width_mm > room + _ROUNDING_MM:
        rods = scene.big_ends
        share = f", over the {rods} rods on it" if rods > 1 else ""
        allowed = f"must be at most {room:.4g} mm, the crankpin's length between its fillets{share}"
        if room <= 0:
            allowed = f"the fillets leave the crankpin no length for it{share}"
        raise scene.invalid("rod.big_end_width_mm", allowed, "Make it narrower, or the crankpin longer.")


def _check_cylinder(scene: Scene, rod: Rod, bore_mm: float) -> None:
    """Check that small end and piston pin are within the bore."""
    within = {"rod.small_end_width_mm": rod.small_end_width_mm}
    if rod.pin is not None:
        within["rod.pin.length_mm"] = rod.pin.length_mm
    for key, value in within.items():
        if value >= bore_mm:
            raise scene.invalid(key, f"must be below engine.bore_mm, {bore_mm:g} mm")
