"""OCC solids of bolted counterweights, and the holes of their bolts in web and counterweight, checked."""

from __future__ import annotations

from typing import Any

from cranktopo.bodies.bolt_masses import holes_in_web
from cranktopo.bodies.solid.checked import ClosedForm, check_body
from cranktopo.bodies.solid.shapes import add_all, add_solid, cut, turned, turned_half
from cranktopo.bodies.volume import bolted_volume_mm3
from cranktopo.design.bolt_holes import bolt_holes, far_mm
from cranktopo.design.crank_throws import half_turns_deg
from cranktopo.design.halves import halves, mirror_image
from cranktopo.design.schema import Scene
from cranktopo.numerics.gmsh_session import DimTags
from cranktopo.throw.web import web_bodies


def add_bolted(occ: Any, scene: Scene) -> DimTags:
    """Return the counterweights that are bolted to the webs of a throw, each a body, the first web's first.

    A web without one has none.
    """
    (first, second), turns = halves(scene), half_turns_deg(scene)
    beyond = turned_half(occ, _weight(occ, mirror_image(second)), scene.pitch_mm)
    return [*turned(occ, _weight(occ, first), turns[0]), *turned(occ, beyond, turns[1])]


def bolted_names(scene: Scene) -> tuple[str, ...]:
    """Return the names of these bodies in their order, each with its density."""
    weights = ((web, half.web.counterweight) for web, half in enumerate(halves(scene), start=1))
    return tuple(
        f"counterweight of web {web}, {weight.density_kg_m3:g} kg/m3"
        for web, weight in weights
        if weight is not None and weight.density_kg_m3 is not None
    )


def add_thread_tools(occ: Any, scene: Scene, *, half: bool = False) -> DimTags:
    """Return the core holes of bolts in both webs of a throw, or in that of its first half."""
    (first, second), turns = halves(scene), half_turns_deg(scene)
    if half:
        return _threads(occ, first)
    beyond = turned_half(occ, _threads(occ, mirror_image(second)), scene.pitch_mm)
    return [*turned(occ, _threads(occ, first), turns[0]), *turned(occ, beyond, turns[1])]


def threads_mm3(scene: Scene, *, half: bool = False) -> float:
    """Return what these take out of the webs, by the closed form."""
    first, second = (holes_in_web(one).volume for one in halves(scene))
    return first if half else first + second


def with_threads(occ: Any, body: DimTags, tools: DimTags, lost_mm3: float, name: str) -> DimTags:
    """Return one body less core holes, which must take their whole volume out of it."""
    if not tools:
        return body
    whole = sum(occ.getMass(*pair) for pair in body if pair[0] == 3)
    bored = cut(occ, body, tools)
    check_body(occ, bored, ClosedForm(whole - lost_mm3), f"{name} with the holes of its bolts")
    return bored


def _weight(occ: Any, half: Scene) -> DimTags:
    weight = half.web.counterweight
    if weight is None or not weight.bolted:
        return []
    taken = [*web_bodies(half), *weight.cuts(half)]
    holes = [tool for bolt in bolt_holes(half) for tool in bolt.weight_tools(far_mm(half))]
    tools = [*add_all(occ, taken), *(pair for hole in holes for pair in add_solid(occ, hole))]
    body = cut(occ, add_all(occ, [weight.sector(half)]), tools)
    check_body(occ, body, ClosedForm(bolted_volume_mm3(half)), "web.counterweight")
    return body


def _threads(occ: Any, half: Scene) -> DimTags:
    tools = (bolt.thread_tool(far_mm(half)) for bolt in bolt_holes(half))
    return [pair for tool in tools for pair in add_solid(occ, tool)]
