"""Drillings of unlike halves that meet in the middle of the crankpin.

Tools that end there in one plane leave crescents in it, micrometres wide and millimetres long, because one
drilling leans more than the other: another kernel finds no triangles for them. Tools that go on a little
inside each other's mouth leave none. The pin is one piece there: where the halves were joined in that plane
its edge would go through the corners of the mouths.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from cranktopo.base.arrays import Array
from cranktopo.bodies.solid.checked import ClosedForm, misfit, without_crumbs
from cranktopo.bodies.solid.drilled import BEYOND, Heights, drilled_at
from cranktopo.bodies.solid.shapes import cut, fused
from cranktopo.design.halves import halves
from cranktopo.design.schema import Scene
from cranktopo.numerics.gmsh_session import DimTags, unless_it_fails
from cranktopo.throw.drilling.bore import DrillBore
from cranktopo.throw.drilling.table import drill_bores

_RIDGE = 1e-7
"""Largest share of the throw that tools may take besides: of a ridge between mouths that do not overlap."""
_SIDES, _CHORDS = 360, 720
_SAME = 1e-9
"""Difference of directions, and of places in mm, that counts as none."""
_PIECE, _AROUND = 0.6, 1.05
"""Length of the piece over that of the pin without fillets; radius of what it replaces over the pin's."""


def reaches_over(bore: DrillBore, half: Scene) -> bool:
    """Tell whether a bore of a half, roundings with it, reaches over the middle of the crankpin."""
    return bore.heights_mm[1] > half.pitch_mm / 2


def all_mirrored(scene: Scene) -> bool:
    """Tell whether all drillings that both halves have over the middle of the crankpin are mirror images.

    Each half is drilled by itself then, as in a throw of equal webs: where the rounding of an outlet ends in
    the plane in which the halves meet the kernel finds its curve to 1e-5 mm, and to 0.02 mm where a tool ends
    there.
    """
    first, second = (
        [bore for bore in drill_bores(half) if not bore.alone and reaches_over(bore, half)]
        for half in halves(scene)
    )
    pitch_mm = halves(scene)[0].pitch_mm  # of a throw of two first halves
    images = [bore.in_second_half(scene.pitch_mm).in_second_half(pitch_mm) for bore in second]
    return len(first) == len(images) and all(map(_are_images, first, images))


def heights_beyond(
    half: Scene, first: Sequence[DrillBore], second: Sequence[DrillBore], throw_mm3: float
) -> dict[DrillBore, Heights]:
    """Return heights of tools that go on beyond the middle of the crankpin; none where one would harm.

    Args:
        half: first half of the throw.
        first, second: bores of each half that reach beyond the middle, in the frame of the throw.
    """
    middle = half.pitch_mm / 2
    if any(bore.heights_mm[1] > middle - _reach_mm(half) for bore in set(drill_bores(half)) - set(first)):
        return {}  # the new piece of the pin would fill it
    others, found = {bore.key: bore for bore in second}, dict[DrillBore, Heights]()
    for one in first:
        other = others.get(one.key)
        if other is None or one.alone or _are_images(one, other.in_second_half(2 * middle)):
            continue
        ends = middle + BEYOND * one.radius_mm, middle - BEYOND * one.radius_mm
        if _ridge_mm3(half, one, other, ends) < _RIDGE * throw_mm3:
            found |= {one: (-np.inf, ends[0]), other: (ends[1], np.inf)}
    return found


def drilled_in_one_piece(
    occ: Any,
    body: DimTags,
    half: Scene,
    bores: Sequence[tuple[float, DrillBore]],
    heights: dict[DrillBore, Heights],
    form: ClosedForm,
) -> DimTags:
    """Return a drilled copy of a throw whose pin is one piece in its middle; nothing where it misfits.

    One bore after the other, those of the second half first: the kernel then finds where two roundings meet
    to 1e-3 mm. In one call it misses that by up to 2.3e-3 mm.
    """

    def made() -> DimTags:
        whole = _with_piece(occ, occ.copy(body), half)
        for bore in reversed(bores):
            whole = drilled_at(occ, whole, [bore], between_mm=heights)
        return without_crumbs(occ, whole, form)

    before = set(occ.getEntities(3))
    found = unless_it_fails(made)
    if found and misfit(occ, found, form) <= 1:
        return found
    occ.remove([pair for pair in occ.getEntities(3) if pair not in before], recursive=True)
    return []


def _with_piece(occ: Any, body: DimTags, half: Scene) -> DimTags:
    """Return a throw with a new piece in the middle of its crankpin."""
    pin, reach = half.throw.crankpin, _reach_mm(half)

    def round_bar(radius_mm: float) -> DimTags:
        low = half.pitch_mm / 2 - reach
        return [(3, occ.addCylinder(0, half.throw.radius_mm, low, 0, 0, 2 * reach, radius_mm))]

    body = cut(occ, body, round_bar(_AROUND * pin.radius_mm))
    piece = round_bar(pin.radius_mm)
    if pin.bore_diameter_mm:
        piece = cut(occ, piece, round_bar(pin.bore_radius_mm))
    return fused(occ, [body, piece], one_face=False)


def _reach_mm(half: Scene) -> float:
    """Half the length of the new piece."""
    pin = half.throw.crankpin
    return _PIECE * (pin.length_mm / 2 - (pin.fillet.reach_mm if pin.fillet_mm else 0.0))


def _are_images(one: DrillBore, other: DrillBore) -> bool:
    return bool(np.allclose(_ends(one), _ends(other), rtol=0, atol=_SAME))


def _ends(bore: DrillBore) -> Array:
    return np.array([[*end.point_mm, *end.outward, end.rounding_mm] for end in bore.outlets])


def _ridge_mm3(half: Scene, one: DrillBore, other: DrillBore, ends: tuple[float, float]) -> float:
    """Return what two tools take of the pin beyond its middle, each outside of the other, in triangles."""
    from manifold3d import Manifold

    from cranktopo.bodies.drill_tool import drill_tool  # as manifold3d, which most throws need not load

    middle, pin = half.pitch_mm / 2, half.throw.crankpin
    bar = Manifold.cylinder(pin.length_mm, pin.radius_mm, pin.radius_mm, _CHORDS)
    bar = bar.translate((0.0, half.throw.radius_mm, middle - pin.length_mm / 2))
    tools = [drill_tool(bore, _SIDES) for bore in (one, other)]
    total = 0.0
    for own, beside, up, end in zip(tools, reversed(tools), (1.0, -1.0), ends, strict=True):
        beyond = (own ^ bar).trim_by_plane((0.0, 0.0, up), up * middle)
        total += (beyond.trim_by_plane((0.0, 0.0, -up), -up * end) - beside).volume()
    return total
