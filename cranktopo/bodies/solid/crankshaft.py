"""OCC solid of the whole crank: its throws, turned and placed along the shaft, and its two ends, checked."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable
from typing import Any

from cranktopo.base.frames import about_z_deg
from cranktopo.bodies.crank_drillings import halved_crossings, taken_beyond
from cranktopo.bodies.crank_ends import SIDES, EndPiece, crank_end, main_journal_places_mm
from cranktopo.bodies.solid.checked import ClosedForm, check_body, check_no_hollow, without_crumbs
from cranktopo.bodies.solid.drilled import ALL_HEIGHTS, Heights, drilled_at, to_middle
from cranktopo.bodies.solid.shapes import cut, fused, turned
from cranktopo.bodies.solid.step import import_solid
from cranktopo.bodies.solid.throw import add_full_throw, throw_form
from cranktopo.design.crank import Side
from cranktopo.design.crank_throws import half_turns_deg, throw_scenes
from cranktopo.design.halves import halves
from cranktopo.design.schema import Scene
from cranktopo.numerics.gmsh_session import DimTags
from cranktopo.throw.crank_end import BodyStep
from cranktopo.throw.drilling.bore import DrillBore
from cranktopo.throw.drilling.table import Drilling, drill_bores


def add_crankshaft(occ: Any, scene: Scene) -> DimTags:
    """Return throws, turned by firing order, and ends of a crank as one checked body, journal 0 at z = 0."""
    pieces = [piece for side in SIDES for piece in crank_end(scene, side)]
    throws = placed_throws(occ, scene, lambda occ, throw: add_full_throw(occ, _without_crossing(throw)))
    ends = [_add_piece(occ, piece) for piece in pieces]
    body = fused(occ, [*throws, *ends], one_face=False)
    body = _drilled(occ, scene, body)
    forms = [throw_form(throw) for throw in throw_scenes(scene)]
    volume = sum(form.volume_mm3 for form in forms) + sum(piece.moments.volume for piece in pieces)
    volume -= taken_beyond(scene).volume
    form = ClosedForm(volume, sum(form.roundings_mm3 for form in forms))
    body = without_crumbs(occ, body, form)
    check_body(occ, body, form, "crankshaft")
    check_no_hollow(occ, body, "crankshaft")
    return body


def _drilled(occ: Any, scene: Scene, body: DimTags) -> DimTags:
    """Return a crank with the drillings that cross the middle of a main journal.

    Cut into the whole crank: the middle would halve an outlet, and the kernel leaves crumbs where a rounding
    of its own ends there and meets a tool of the same surface from the other side. Neighbours that are turned
    alike are drilled in one call, as halves of a throw are.
    """
    places = zip(throw_scenes(scene), scene.shaft_angles_deg, main_journal_places_mm(scene), strict=False)
    bores: list[tuple[float, DrillBore]] = []
    heights: dict[DrillBore, Heights] = {}
    for throw, angle, z in places:
        own = [[bore.moved(z) for bore in half] for half in _crossing_bores(throw)]
        heights |= to_middle([*own[0], *own[1]], z + halves(throw)[0].pitch_mm / 2)
        turns = [angle + turn for turn in half_turns_deg(throw)]
        bores += [(turn, bore) for turn, half in zip(turns, own, strict=True) for bore in half]
    for one in halved_crossings(scene):
        bore = one.bore.moved(one.z_mm)
        low, high = heights.get(bore, ALL_HEIGHTS)
        heights[bore] = (one.plane_mm, high) if one.outward < 0 else (low, one.plane_mm)
    return drilled_at(occ, body, bores, between_mm=heights)


def _crossing_bores(throw: Scene) -> tuple[list[DrillBore], list[DrillBore]]:
    """Return the drillings of both halves that cross the middle of a main journal, in a throw's frame."""
    crossing = _crossing(throw)
    own, other = ([bore for one, bore in _with_bores(half) if one in crossing] for half in halves(throw))
    return own, [bore.in_second_half(throw.pitch_mm) for bore in other]


def _crossing(throw: Scene) -> list[Drilling]:
    return [one for half in halves(throw) for one, bore in _with_bores(half) if bore.crosses_middle]


def _with_bores(half: Scene) -> Iterable[tuple[Drilling, DrillBore]]:
    return zip(half.throw.drilling, drill_bores(half), strict=True)


def _without_crossing(throw: Scene) -> Scene:
    """Return a throw without drillings that cross the middle of a main journal."""
    crossing = _crossing(throw)
    return throw.with_drillings(tuple(one for one in throw.throw.drilling if one not in crossing))


def placed_throws(occ: Any, scene: Scene, add: Callable[[Any, Scene], DimTags]) -> list[DimTags]:
    """Return the throws of a crank, each made once by `add`, turned by firing order and in its place."""
    bodies: list[DimTags] = []
    by_name: dict[str, DimTags] = {}
    places = zip(throw_scenes(scene), scene.shaft_angles_deg, main_journal_places_mm(scene), strict=False)
    for throw, angle, z in places:
        if throw.name not in by_name:
            by_name[throw.name] = add(occ, throw)
        own = by_name[throw.name]
        bodies.append(turned(occ, occ.copy(own) if own else [], angle))
        occ.translate(bodies[-1], 0, 0, z)
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
