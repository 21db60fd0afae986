"""OCC solid of the whole crank: its throws, turned and placed along the shaft, and its two ends, checked."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

from cranktopo.base.frames import about_z_deg
from cranktopo.bodies.crank_drillings import crank_crossings, taken_beyond
from cranktopo.bodies.crank_ends import SIDES, EndPiece, crank_end, main_journal_places_mm
from cranktopo.bodies.solid.checked import ClosedForm, check_body, check_no_hollow
from cranktopo.bodies.solid.shapes import add_all, cut, fused
from cranktopo.bodies.solid.step import import_solid
from cranktopo.bodies.solid.throw import add_full_throw, throw_form
from cranktopo.design.crank import Side
from cranktopo.design.crank_throws import refuse_split_pins, throw_scenes
from cranktopo.design.schema import Scene
from cranktopo.numerics.gmsh_session import DimTags
from cranktopo.throw.crank_end import BodyStep


def add_crankshaft(occ: Any, scene: Scene) -> DimTags:
    """Return throws, turned by firing order, and ends of a crank as one checked body, journal 0 at z = 0."""
    pieces = [piece for side in SIDES for piece in crank_end(scene, side)]
    bodies = [*placed_throws(occ, scene, add_full_throw), *(_add_piece(occ, piece) for piece in pieces)]
    body = cut(occ, fused(occ, bodies), _crossing_tools(occ, scene))
    forms = [throw_form(throw) for throw in throw_scenes(scene)]
    volume = sum(form.volume_mm3 for form in forms) + sum(piece.moments.volume for piece in pieces)
    volume -= taken_beyond(scene).volume
    check_body(occ, body, ClosedForm(volume, sum(form.roundings_mm3 for form in forms)), "crankshaft")
    check_no_hollow(occ, body, "crankshaft")
    return body


def _crossing_tools(occ: Any, scene: Scene) -> DimTags:
    """Return the drillings that go on in a neighbour of their throw, each in its place along the crank."""
    tools: DimTags = []
    for one in crank_crossings(scene):
        tools += _in_place(occ, add_all(occ, [one.bore]), one.angle_deg, one.z_mm)
    return tools


def _in_place(occ: Any, body: DimTags, angle_deg: float, z_mm: float) -> DimTags:
    """Turn a body of a throw, which may be nothing, by the angle of that, and move it along the crank."""
    if not body:
        return body
    occ.rotate(body, 0, 0, 0, 0, 0, 1, math.radians(about_z_deg(angle_deg)))
    occ.translate(body, 0, 0, z_mm)
    return body


def placed_throws(occ: Any, scene: Scene, add: Callable[[Any, Scene], DimTags]) -> list[DimTags]:
    """Return the throws of a crank, each made once by `add`, turned by firing order and in its place."""
    refuse_split_pins(scene)
    bodies: list[DimTags] = []
    by_name: dict[str, DimTags] = {}
    places = zip(throw_scenes(scene), scene.shaft_angles_deg, main_journal_places_mm(scene), strict=False)
    for throw, angle, z in places:
        if throw.name not in by_name:
            by_name[throw.name] = add(occ, throw)
        own = by_name[throw.name]
        bodies.append(_in_place(occ, occ.copy(own) if own else [], angle, z))
    for throw_body in filter(None, by_name.values()):
        occ.remove(throw_body, recursive=True)
    return bodies


def add_end(occ: Any, scene: Scene, side: Side) -> DimTags:
    """Return an end of the crank as one checked body, in its place along the shaft."""
    pieces = crank_end(scene, side)
    body = fused(occ, [_add_piece(occ, piece) for piece in pieces])
    volume = sum(piece.moments.volume for piece in pieces)
    check_body(occ, body, ClosedForm(volume), f"{side} end of the crank")
    return body


def _add_piece(occ: Any, piece: EndPiece) -> DimTags:
    step, (inner, outer) = piece.step, piece.z_mm
    if isinstance(step, BodyStep):
        body = [import_solid(occ, step.file)]
        occ.translate(body, 0, 0, inner)
        return body
    return cut(occ, [_turned(occ, step.radii_mm, inner, outer - inner)], _tools(occ, piece))


def _turned(occ: Any, radii: tuple[float, float], z: float, along: float) -> tuple[int, int]:
    if radii[0] == radii[1]:
        return 3, occ.addCylinder(0, 0, z, 0, 0, along, radii[0])
    return 3, occ.addCone(0, 0, z, 0, 0, along, *radii)


def _tools(occ: Any, piece: EndPiece) -> DimTags:
    """Bore, bolt holes and keyway of a step."""
    step, (inner, outer) = piece.step, piece.z_mm
    holes = [(0.0, 0.0, step.bore_radius_mm)] if step.bore_radius_mm else []
    tools = [
        (3, occ.addCylinder(x, y, inner, 0, 0, outer - inner, radius))
        for x, y, radius in (*holes, *step.bolt_holes_mm)
    ]
    slot = step.slot
    if slot is not None:
        size = slot.width_mm, 2 * step.radii_mm[0], abs(outer - inner)
        box = [(3, occ.addBox(-slot.width_mm / 2, slot.bottom_mm, min(inner, outer), *size))]
        occ.rotate(box, 0, 0, 0, 0, 0, 1, math.radians(about_z_deg(slot.angle_deg)))
        tools += box
    return tools
