"""Consistency of every roller bearing: a reaction for each displacement, both rising, and its direction."""

from __future__ import annotations

import math
from collections.abc import Iterator
from itertools import pairwise

from cranktopo.design.schema import Scene
from cranktopo.design.shaft import RollerBearing


def roller_bearings(scene: Scene) -> Iterator[tuple[str, RollerBearing]]:
    """Yield the roller bearings of a scene with the paths of their tables: main ones, balancer shaft."""
    if scene.supports.roller_bearing is not None:
        yield "supports.roller_bearing", scene.supports.roller_bearing
    part = scene.balancer
    added = part.redesign.bearing if part and part.redesign else ()
    for table, bearings in (("balancer", part.bearing if part else ()), ("balancer.redesign", added)):
        for number, bearing in enumerate(bearings):
            if bearing.roller_bearing is not None:
                yield f"{table}.bearing[{number}].roller_bearing", bearing.roller_bearing


def check_roller_bearings(scene: Scene) -> None:
    """Check the tables of all roller bearings; a main bearing is a radial one."""
    main = scene.supports.roller_bearing
    if main is not None and main.kind == "thrust":
        raise scene.invalid("supports.roller_bearing.name", "a thrust bearing has no radial stiffness")
    for key, bearing in roller_bearings(scene):
        count = len(bearing.displacement_mm)
        if len(bearing.reaction_N) != count:
            raise scene.invalid(f"{key}.reaction_N", f"must have one value per displacement ({count})")
        if bearing.pitch_diameter_mm is not None and bearing.roller_diameter_mm is not None:
            around = math.pi * bearing.pitch_diameter_mm / bearing.rollers
            if bearing.roller_diameter_mm > around:
                told = (
                    f"must leave room for {bearing.rollers} rollers beside each other: at most {around:.4g}"
                )
                raise scene.invalid(f"{key}.roller_diameter_mm", told)
        for name in ("displacement_mm", "reaction_N"):
            if any(b <= a for a, b in pairwise(getattr(bearing, name))):
                raise scene.invalid(f"{key}.{name}", "must increase")
