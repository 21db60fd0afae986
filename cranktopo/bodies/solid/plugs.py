"""OCC solids of the plugs of both counterweights of a throw, each a named body where it sits."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from cranktopo.base.errors import CranktopoError
from cranktopo.bodies.solid.shapes import add_solid, turned_half
from cranktopo.design.halves import halves, mirror_image
from cranktopo.design.schema import Scene
from cranktopo.numerics.gmsh_session import DimTags
from cranktopo.throw.counterweight.holes import Plug
from cranktopo.throw.primitives import Cylinder


def add_plugs(occ: Any, scene: Scene) -> DimTags:
    """Return the plugs of the first web, then those of the second, in the frame of the throw."""
    first, second = halves(scene)
    found, beyond = (
        [pair for _, cylinder in _plugs(half) for pair in add_solid(occ, cylinder)]
        for half in (first, mirror_image(second))
    )
    if not found and not beyond:
        raise CranktopoError(
            f"{scene.name}: no counterweight of it has plugs.", hint="Add [[web.counterweight.plug]]."
        )
    return [*found, *turned_half(occ, beyond, scene.pitch_mm)]


def plug_names(scene: Scene) -> tuple[str, ...]:
    """Return the names of the plugs in the order of their bodies, each with its density."""
    return tuple(
        f"plug {number} of web {web}, {plug.density_kg_m3:g} kg/m3"
        for web, half in enumerate(halves(scene), start=1)
        for number, (plug, _) in enumerate(_plugs(half), start=1)
    )


def _plugs(half: Scene) -> Iterator[tuple[Plug, Cylinder]]:
    weight = half.web.counterweight
    if weight is not None:
        sector = weight.sector(half)
        yield from ((plug, plug.cylinder(sector, weight.face)) for plug in weight.plug)
