"""OCC solids of half throw and full throw, each checked.

`occ` is `gmsh.model.occ` of the open session.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from functools import lru_cache, partial
from typing import Any, Protocol

from cranktopo.base.errors import CranktopoError
from cranktopo.bodies.solid.checked import ClosedForm, check_body, misfit, without_crumbs
from cranktopo.bodies.solid.culprit import culprit
from cranktopo.bodies.solid.drilled import drilled, drilled_at, to_middle
from cranktopo.bodies.solid.joined import with_joined_edges
from cranktopo.bodies.solid.mouths import all_mirrored, drilled_in_one_piece, heights_beyond, reaches_over
from cranktopo.bodies.solid.shapes import add_bodies, add_solid, cut, turned, turned_half
from cranktopo.bodies.volume import (
    half_throw_volume_mm3,
    outlet_roundings_mm3,
    throw_volume_mm3,
    web_moments,
)
from cranktopo.design.checks.scene import check_solid
from cranktopo.design.crank_throws import check_half_pins_overlap, half_turns_deg, refuse_split_pins
from cranktopo.design.halves import (
    difference,
    halves,
    mirror_image,
    of_halves,
    of_second,
    require_equal_halves,
    usual_scale,
)
from cranktopo.design.schema import Scene
from cranktopo.numerics.gmsh_session import DimTags, points_joined
from cranktopo.throw.drilling.bore import DrillBore
from cranktopo.throw.drilling.table import drill_bores
from cranktopo.throw.journal import Journal
from cranktopo.throw.web import web_bodies

_NUDGE = 1e-6
"""Of the radius of a fillet that the kernel cannot fuse: a thousandth of the volume that is let through."""
_GRAZING_MM = 0.01
"""Overlap of a fillet's foot and a bore, on a throw of usual size, whose crescent the kernel cannot cut."""
_PIECES = (4, 3)
"""Of the arc of a drafted bevel whose section with the outline the kernel loses, in the order of tries."""


class Build(Protocol):
    """Adds what is made of a scene to the open session, arcs of drafted bevels in so many pieces."""

    def __call__(self, occ: Any, scene: Scene, *, pieces: int = 1) -> DimTags:
        """Return (dimension, tag) pairs."""


def add_half_throw(occ: Any, scene: Scene, *, by_tools: bool = False) -> DimTags:
    """Return the half throw, z from the mid-main-journal plane to the mid-pin plane, as one checked body.

    A bore runs through its journal and the web and ends at the web's far face.

    Args:
        by_tools: as of `drilled`.
    """
    require_equal_halves(scene)
    refuse_split_pins(scene)
    return _add_half(occ, scene, by_tools)


def _add_half(occ: Any, scene: Scene, by_tools: bool) -> DimTags:
    check_solid(scene)
    return built(occ, scene, "half throw", partial(_half, by_tools=by_tools), half_form)


def built(
    occ: Any,
    scene: Scene,
    name: str,
    build: Build,
    form: Callable[[Scene], ClosedForm],
) -> DimTags:
    """Return what is built of a scene as one checked body; a refusal names the feature that is wrong.

    Args:
        form: closed form of what is built.
    """
    shape = form(scene)

    def fitting() -> DimTags:
        body = build(occ, scene)
        for again in _other_ways(occ, scene, build):
            if misfit(occ, body, shape) <= 1:
                break
            occ.remove(body, recursive=True)
            body = again()
        return body

    body = with_joined_edges(occ, fitting, shape, usual_scale(scene))

    def misfit_of(part: Scene) -> float:
        tags = build(occ, part)
        found = misfit(occ, tags, form(part))
        occ.remove(tags, recursive=True)
        return found

    check_body(occ, body, shape, name, lambda: culprit(scene, misfit_of))
    return body


def _other_ways(occ: Any, scene: Scene, build: Build) -> Iterator[Callable[[], DimTags]]:
    """Yield what builds a scene again, which the kernel made wrong, in another way each."""
    other = _nudged(scene)
    if other is not None:
        yield partial(build, occ, other)
    if any(bevel.draft_deg and bevel.crown_mm for bevel in scene.web.bevel):
        yield from (partial(build, occ, scene, pieces=pieces) for pieces in _PIECES)


def _nudged(scene: Scene) -> Scene | None:
    """Return a scene with fillets changed by micrometres, where surfaces touch; None where none do.

    The kernel now and then loses a piece there: beside the fillet of a counterweight, which touches flank and
    outline, and where the fillet of a journal ends just inside the bore of the other one.
    """
    weight, throw = scene.web.counterweight, scene.throw
    main, pin = throw.main_journal, throw.crankpin
    nudged = scene
    if weight is not None and weight.fillet_mm:
        larger = weight.model_copy(update={"fillet_mm": weight.fillet_mm * (1 + _NUDGE)})
        nudged = scene.model_copy(update={"web": scene.web.model_copy(update={"counterweight": larger})})
    ended = {
        name: journal.model_copy(update={"fillet_mm": journal.fillet_mm - inside})
        for name, journal, other in (("main_journal", main, pin), ("crankpin", pin, main))
        if 0 < (inside := _inside_mm(journal, other, throw.radius_mm)) < _GRAZING_MM / usual_scale(scene)
    }
    if ended:
        nudged = nudged.model_copy(update={"throw": throw.model_copy(update=ended)})
    return None if nudged is scene else nudged


def _inside_mm(journal: Journal, other: Journal, radius_mm: float) -> float:
    """Return how far the fillet of a journal reaches into the bore of the other one; 0 without both."""
    if not journal.fillet_mm or not other.bore_diameter_mm:
        return 0.0
    return journal.clear_radius_mm + other.bore_radius_mm - radius_mm


@lru_cache(maxsize=8)
def half_form(scene: Scene) -> ClosedForm:
    """Return the closed form of a half throw."""
    return ClosedForm(half_throw_volume_mm3(scene), outlet_roundings_mm3(scene))


@lru_cache(maxsize=8)
def throw_form(scene: Scene) -> ClosedForm:
    """Return the closed form of a throw."""
    return ClosedForm(throw_volume_mm3(scene), sum(of_halves(scene, outlet_roundings_mm3)))


def _half(occ: Any, scene: Scene, *, pieces: int = 1, by_tools: bool = False) -> DimTags:
    throw, (start, end) = scene.throw, scene.web_z_mm
    main = _add_journal(occ, scene, throw.main_journal, 0.0, (0.0, start), 1) if start else []
    pin = _add_journal(occ, scene, throw.crankpin, throw.radius_mm, (end, scene.pitch_mm / 2), -1)
    body, _ = occ.fuse(add_web(occ, scene, pieces=pieces), main + pin)
    return drilled(occ, list(body), drill_bores(scene), by_tools=by_tools)


def add_full_throw(occ: Any, scene: Scene, *, by_tools: bool = False) -> DimTags:
    """Return the throw between its two mid-main-journal planes as one checked body.

    The second half is a half throw mirrored in x and turned half a revolution about the throw direction:
    gmsh's own mirror approximates every face by a spline and is 0.2 % off in volume. Drillings that reach
    into the other half, which has no mirror image of them, come last: two that end there leave a sliver.
    Of a split pin each half is turned by its own angle: half pins overlap, without a web between them.

    Args:
        by_tools: as of `drilled`.
    """
    check_half_pins_overlap(scene)
    form = throw_form(scene)
    body = with_joined_edges(occ, lambda: _full(occ, scene, form, by_tools), form, usual_scale(scene))
    check_body(occ, body, form, "full throw")
    return body


def _full(occ: Any, scene: Scene, form: ClosedForm, by_tools: bool) -> DimTags:
    first, second = halves(scene)
    half = _add_half(occ, _without_late(first, scene), by_tools)
    other = _add_second(occ, scene, second, by_tools)
    turned_half(occ, other, scene.pitch_mm)
    turns = half_turns_deg(scene)
    body, _ = occ.fuse(*(turned(occ, one, turn) for one, turn in zip((half, other), turns, strict=True)))
    late = _late_bores(first, scene), [b.in_second_half(scene.pitch_mm) for b in _late_bores(second, scene)]
    placed = [(turn, bore) for turn, own in zip(turns, late, strict=True) for bore in own]
    heights = to_middle([bore for _, bore in placed], first.pitch_mm / 2)
    beyond = heights_beyond(first, *late, form.volume_mm3) if turns[0] == turns[1] and not by_tools else {}
    if beyond:
        found = drilled_in_one_piece(occ, body, first, placed, heights | beyond, form)
        if found:
            occ.remove(body, recursive=True)
            return found
    body = drilled_at(occ, list(body), placed, between_mm=heights, by_tools=by_tools)
    return list(without_crumbs(occ, body, form))


def _add_second(occ: Any, scene: Scene, second: Scene, by_tools: bool) -> DimTags:
    """Return the second half in its own frame; what is wrong with it has the keys of the whole scene."""
    try:
        return _add_half(occ, mirror_image(_without_late(second, scene)), by_tools)
    except CranktopoError as error:
        raise (of_second(error, scene) if difference(scene) else error) from None


def _without_late(half: Scene, scene: Scene) -> Scene:
    """Return a half of a scene without drillings that are cut out of the whole throw; itself where it can."""
    kept = tuple(
        drilling
        for drilling, bore in zip(half.throw.drilling, drill_bores(half), strict=True)
        if not _late(bore, half, scene)
    )
    if kept == half.throw.drilling:
        return half
    return half.with_drillings(kept)


def _late_bores(half: Scene, scene: Scene) -> list[DrillBore]:
    return [bore for bore in drill_bores(half) if _late(bore, half, scene)]


def _late(bore: DrillBore, half: Scene, scene: Scene) -> bool:
    """Tell whether a drilling has no mirror image in the other half, or another one, and reaches into it."""
    return bore.alone or bool(difference(scene) and reaches_over(bore, half) and not all_mirrored(scene))


def add_web(occ: Any, scene: Scene, *, pieces: int = 1) -> DimTags:
    """Add the web between its two faces, bores and features cut out; return (dimension, tag) pairs.

    The sides of a bevel with a draft meet in x = 0, where one curve around an ellipse has its seam: the
    kernel now and then cuts one side alone then. Where two arcs misfit, too, the ellipse is one curve.
    """
    bodies = [body.in_pieces(pieces) for body in web_bodies(scene)]
    drafted = any(body.oblique for body in bodies)
    web = add_bodies(occ, bodies, in_arcs=drafted)
    if drafted and misfit(occ, web, ClosedForm(web_moments(scene).volume)) > 1:
        occ.remove(web, recursive=True)
        web = add_bodies(occ, bodies)
    return web


def _add_journal(
    occ: Any, scene: Scene, journal: Journal, y: float, z_mm: tuple[float, float], toward: int
) -> DimTags:
    """Return the journal at y from its mid-plane to the web face, its upper end if `toward` is +1.

    Its points are never joined: the foot of a fillet is thinner than that where it just reaches over a
    pocket, and the kernel left it there, on air.
    """
    face = z_mm[1] if toward > 0 else z_mm[0]
    far = z_mm[0] if toward > 0 else z_mm[1]
    if journal.fillet_mm:
        body = [_revolve(occ, journal, y, far, face, toward)]
    else:
        body = [(3, occ.addCylinder(0, y, z_mm[0], 0, 0, z_mm[1] - z_mm[0], journal.radius_mm))]
    tools = _under_fillet(occ, scene, journal, y, face, toward) if journal.fillet_mm else []
    if journal.bore_diameter_mm:
        length = z_mm[1] - z_mm[0]
        tools.append((3, occ.addCylinder(0, y, z_mm[0], 0, 0, length, journal.bore_radius_mm)))
    with points_joined(0.0):
        return cut(occ, body, tools)


def _revolve(occ: Any, journal: Journal, y: float, far: float, face: float, toward: int) -> tuple[int, int]:
    radius, fillet = journal.radius_mm, journal.fillet
    near, centre_radius = face - toward * fillet.reach_mm, radius + fillet.radial_mm
    reach = centre_radius - fillet.half_mouth_mm
    corners = (0.0, far), (radius, far), (radius, near), (reach, face), (0.0, face), (centre_radius, near)
    axis_far, rim, top, foot, axis_face, centre = (occ.addPoint(x, y, z) for x, z in corners)
    longer = foot if fillet.axial_mm > fillet.radial_mm else top  # the kernel wants the major axis
    curves = [
        occ.addLine(axis_far, rim),
        occ.addLine(rim, top),
        occ.addCircleArc(top, centre, foot) if fillet.round else occ.addEllipseArc(top, centre, longer, foot),
        occ.addLine(foot, axis_face),
        occ.addLine(axis_face, axis_far),
    ]
    section = occ.addPlaneSurface([occ.addCurveLoop(curves)])
    revolved = occ.revolve([(2, section)], 0, y, 0, 0, 0, 1, 2 * math.pi)
    occ.remove([(2, section)], recursive=True)
    return next((dim, tag) for dim, tag in revolved if dim == 3)


def _under_fillet(occ: Any, scene: Scene, journal: Journal, y: float, face: float, toward: int) -> DimTags:
    """Columns over pockets and bores that open under the fillet ring, which would end in a knife edge."""
    reach = journal.radius_mm + journal.fillet_mm
    along = journal.fillet.reach_mm
    z = (face - along, face) if toward > 0 else (face, face + along)
    tools: DimTags = []
    cuts = [body for body in web_bodies(scene) if not body.adds and face in body.z_mm]
    for body in cuts if journal.bore_radius_mm < reach else ():
        if 0 < body.distance_mm(y, face) < reach:
            column = [pair for solid in body.continued(z) for pair in add_solid(occ, solid)]
            if column:  # a recess has none: the fillet goes on in it
                core = [(3, occ.addCylinder(0, y, z[0], 0, 0, z[1] - z[0], journal.radius_mm))]
                tools += occ.cut(column, core)[0]
    return tools
