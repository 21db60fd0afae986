"""OCC solid of the whole crank: its throws, turned and placed along the shaft, and its two ends, checked."""

from __future__ import annotations

import math
from typing import Any

from cranktopo.base.frames import about_z_deg
from cranktopo.bodies.crank_ends import SIDES, EndPiece, crank_end, main_journal_places_mm
from cranktopo.bodies.solid.checked import ClosedForm, check_body
from cranktopo.bodies.solid.shapes import DimTags, cut
from cranktopo.bodies.solid.step import import_solid
from cranktopo.bodies.solid.throw import add_full_throw, throw_form
from cranktopo.design.crank import Side
from cranktopo.design.crank_throws import throw_scenes
from cranktopo.design.schema import Scene
from cranktopo.throw.crank_end import BodyStep


def add_crankshaft(occ: Any, scene: Scene) -> DimTags:
    """Return throws, turned by firing order, and ends of a crank as one checked body, journal 0 at z = 0."""
    angles, throws = scene.shaft_angles_deg, throw_scenes(scene)
    bodies: DimTags = []
    made: dict[str, DimTags] = {}
    for throw, angle, z in zip(throws, angles, main_journal_places_mm(scene), strict=False):
        if throw.name not in made:
            made[throw.name] = add_full_throw(occ, throw)
        copy = occ.copy(made[throw.name])
        occ.rotate(copy, 0, 0, 0, 0, 0, 1, math.radians(about_z_deg(angle)))
        occ.translate(copy, 0, 0, z)
        bodies += copy
    for throw_body in made.values():
        occ.remove(throw_body, recursive=True)
    pieces = [piece for side in SIDES for piece in crank_end(scene, side)]
    for piece in pieces:
        bodies += _add_piece(occ, piece)
    if len(bodies) > 1:
        bodies, _ = occ.fuse(bodies[:1], bodies[1:])
    forms = [throw_form(throw) for throw in throws]
    volume = sum(form.volume_mm3 for form in forms) + sum(piece.moments.volume for piece in pieces)
    expected = ClosedForm(volume, sum(form.roundings_mm3 for form in forms))
    check_body(occ, bodies, expected, "crankshaft")
    return bodies


def add_end(occ: Any, scene: Scene, side: Side) -> DimTags:
    """Return an end of the crank as one checked body, in its place along the shaft."""
    pieces = crank_end(scene, side)
    bodies = [pair for piece in pieces for pair in _add_piece(occ, piece)]
    if len(bodies) > 1:
        bodies, _ = occ.fuse(bodies[:1], bodies[1:])
    volume = sum(piece.moments.volume for piece in pieces)
    check_body(occ, bodies, ClosedForm(volume), f"{side} end of the crank")
    return bodies


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
