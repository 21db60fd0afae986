"""Consistency of the rod: walls of rings, bolts in their bosses, a shank between its eyes, a pin."""

from __future__ import annotations

import math

from cranktopo.base.errors import CranktopoError
from cranktopo.design.checks.rod_place import check_rod_place
from cranktopo.design.rod import PistonPin, Rod
from cranktopo.design.rod_body import fillet
from cranktopo.design.rod_bolts import bolt_shortfalls
from cranktopo.design.rod_split import oblique_shortfalls
from cranktopo.design.schema import Scene

_LEAST_WALL_MM = 0.5
_BOLT_HINT = (
    'Change the grip, the bosses or rod.bolt.engagement_mm; rod.bolt.held_in = "nut" is a through bolt.'
)
_ROUNDING = 1e-9
"""Share of a dimension that may be missing of what it must be at least."""
_WIDEST_PIN_BORE = 0.8
"""Bore over diameter of a piston pin up to which its ovalisation in closed form holds."""


def rod_of(scene: Scene) -> tuple[Rod, float]:
    """Return the rod of a design and its length; raises CranktopoError where one of them is missing."""
    if scene.rod is None or scene.engine is None:
        missing = "[rod]" if scene.rod is None else "[engine]"
        raise CranktopoError(
            f"{scene.name}: {missing} is missing: a rod needs both.",
            hint="The built-in design mikron-iiic-rod has them: cranktopo designs copy mikron-iiic-rod",
        )
    return scene.rod, scene.engine.rod_length_mm


def check_rod(scene: Scene) -> None:
    """Check that the dimensions of the rod give a body."""
    rod = scene.rod
    if rod is None:
        return
    for key, smallest in least_dimensions(rod):
        if getattr(rod, key) < smallest:
            raise scene.invalid(f"rod.{key}", f"must be at least {smallest:g} mm beside the other dimensions")
    _check_length(scene, rod)
    if rod.pin is not None:
        _check_pin(scene, rod, rod.pin)
    check_rod_place(scene, rod)


def least_dimensions(rod: Rod) -> list[tuple[str, float]]:
    """Return keys of a rod with the least value that its other dimensions leave them."""
    wall = 2 * _LEAST_WALL_MM
    hole = rod.bolt_hole_mm
    least = [
        ("small_end_diameter_mm", rod.small_end_bore_mm + wall),
        ("big_end_diameter_mm", rod.big_end_bore_mm + wall),
        ("bolt_distance_mm", rod.big_end_bore_mm + hole),
        ("boss_width_mm", rod.bolt_distance_mm + hole + wall),
        ("big_end_width_mm", hole + wall),
        ("small_end_diameter_mm", rod.shank_small_mm),
        ("big_end_diameter_mm", rod.shank_big_mm),
        ("small_end_width_mm", rod.shank_width_mm),
        ("big_end_width_mm", rod.shank_width_mm),
    ]
    if rod.bush_thickness_mm:
        least.append(("small_end_bore_mm", 2 * rod.bush_thickness_mm + wall))
    if rod.pin is not None:
        least.append(("small_end_bore_mm", 2 * rod.bush_thickness_mm + rod.pin.bore_diameter_mm + wall))
    heights = ("shank_small_mm", "shank_big_mm")
    if rod.shank == "I":
        least += [("shank_width_mm", rod.web_mm), *((key, 2 * rod.flange_mm) for key in heights)]
    if rod.shank == "H":
        least += [("shank_width_mm", 2 * rod.flange_mm), *((key, rod.web_mm) for key in heights)]
    return least


def _check_pin(scene: Scene, rod: Rod, pin: PistonPin) -> None:
    """Check that the pin reaches both bosses, the small end fits between them, and the pin is no shell."""
    widest, between = _WIDEST_PIN_BORE * rod.pin_diameter_mm, pin.boss_distance_mm
    if pin.bore_diameter_mm > widest:
        raise scene.invalid(
            "rod.pin.bore_diameter_mm", f"must be at most {widest:.4g} mm, 0.8 of the pin's diameter"
        )
    if pin.length_mm <= between:
        raise scene.invalid("rod.pin.length_mm", f"must be above boss_distance_mm, {between:g} mm")
    if rod.small_end_width_mm > between:
        raise scene.invalid("rod.small_end_width_mm", f"must be at most pin.boss_distance_mm, {between:g} mm")


def _check_length(scene: Scene, rod: Rod) -> None:
    if scene.engine is None:
        return
    eyes = (rod.small_end_diameter_mm + rod.big_end_diameter_mm) / 2
    free = scene.engine.rod_length_mm - eyes
    if free < _LEAST_WALL_MM:
        raise scene.invalid("rod.big_end_diameter_mm", f"the eyes leave {free:g} mm of the rod's length")
    low, high = (fillet(rod, scene.engine.rod_length_mm, small) for small in (False, True))
    if low and high and low.edge_y_mm > high.edge_y_mm:
        raise scene.invalid("rod.shank_fillet_mm", "the fillets of both eyes meet: make it smaller")
    web = {"I": rod.web_mm, "H": rod.web_mm}.get(rod.shank, rod.shank_width_mm)
    if rod.oil_hole_mm and rod.oil_hole_mm > web - 2 * _LEAST_WALL_MM:
        raise scene.invalid("rod.oil_hole_mm", f"must leave {_LEAST_WALL_MM:g} mm of the shank's web")
    for key, missing, why in split_shortfalls(rod, scene.engine.rod_length_mm):
        if missing > _ROUNDING:
            raise scene.invalid(f"rod.{key}", why, _BOLT_HINT if key == "bolt.grip_mm" else "")


def split_shortfalls(rod: Rod, length_mm: float) -> list[tuple[str, float, str]]:
    """Return keys of what bolts and an oblique split ask of the rod, the share that is missing, and why."""
    arc, eye = fillet(rod, length_mm, small=False), rod.big_end_diameter_mm / 2
    x, y = rod.shank_big_mm / 2, math.sqrt(max(eye**2 - rod.shank_big_mm**2 / 4, 0.0))
    if arc is not None:
        x, y = arc.eye_x_mm, arc.eye_y_mm
    oblique = oblique_shortfalls(rod, length_mm, math.degrees(math.atan2(y, x)))
    return [*oblique, *bolt_shortfalls(rod, length_mm)]
