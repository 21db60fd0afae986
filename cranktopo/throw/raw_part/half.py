"""The raw half throw: webs with allowance on their faces, thicker journals, collars in place of fillets."""

from __future__ import annotations

import math
from collections.abc import Iterator
from functools import lru_cache

import numpy as np

from cranktopo.base.arrays import Array
from cranktopo.base.errors import invalid
from cranktopo.throw.feature import Body, ThrowView
from cranktopo.throw.journal import Journal
from cranktopo.throw.raw_part.bodies import Collar, DraftedPrism, RawBody, RawHalf
from cranktopo.throw.raw_part.drafted_outline import drafted_outline
from cranktopo.throw.raw_part.prism import drafted_disc, drafted_prism
from cranktopo.throw.raw_part.table import Forging
from cranktopo.throw.web import web_bodies

_LEAST_COLLAR = 0.005
"""Leg of the smallest collar over the journal's radius: a smaller one is a sliver."""
_SMALLEST = 0.9
"""Radius of a collar's end over that of its journal, at least."""
_ACROSS_CONE = math.sqrt(2)
"""Sine of the angle across a cone of 45 deg over the sine of its draft."""


@lru_cache(maxsize=8)
def raw_half(scene: ThrowView, forging: Forging) -> RawHalf:
    """Return the raw half throw, z from the mid-main-journal plane to the mid-pin plane."""
    (start, end), throw = scene.web_z_mm, scene.throw
    web = tuple(_web_part(body, forging) for body in web_bodies(scene) if body.adds)
    forged = [body for key, one in scene.web.features() for body in one.forged(scene, key, forging)]
    main, pin = throw.main_journal, throw.crankpin
    journals = [*_journal("throw.main_journal", main, 0.0, 0.0, start, forging)]
    journals += _journal("throw.crankpin", pin, throw.radius_mm, scene.pitch_mm / 2, end, forging)
    half = RawHalf("forging", (0.0, scene.pitch_mm / 2), web, tuple(forged), tuple(journals))
    _check_room(scene, half, forging)
    return half


def machined(scene: ThrowView, forging: Forging) -> tuple[str, ...]:
    """Return the keys of what the die leaves full: bores, drillings, features that it does not release."""
    forged = {cut.key for cut in raw_half(scene, forging).cuts}
    cut = [body.key for body in web_bodies(scene) if not body.adds and body.key not in forged]
    return tuple(dict.fromkeys([*cut, *(f"throw.drilling[{n}]" for n in range(len(scene.throw.drilling)))]))


def _web_part(body: Body, forging: Forging) -> DraftedPrism:
    """Return what adds material to the web with the allowance on its faces and the draft everywhere."""
    middle = np.asarray(sum(body.z_mm) / 2)

    def own(y_mm: Array) -> Array:
        return body.spans(y_mm, middle)[-1][1]

    (low, high), allowance = body.z_mm, forging.allowance_mm
    outline = drafted_outline(own, body.y_range_mm, forging.draft_slope, forging.land_mm)
    return drafted_prism(
        body, outline, (low - allowance, high + allowance), (True, True), body.x_range_mm[1], forging
    )


def _journal(
    name: str, journal: Journal, y_mm: float, far_mm: float, face_mm: float, forging: Forging
) -> Iterator[RawBody]:
    """Yield the raw journal from its middle to a web's face, and the collar that holds its fillet."""
    allowance, toward = forging.allowance_mm, math.copysign(1.0, face_mm - far_mm)
    radius = journal.radius_mm + allowance
    yield _disc(name, radius, y_mm, (far_mm, face_mm), forging)
    fillet = max(journal.fillet.radial_mm, journal.fillet.axial_mm)
    if fillet > allowance:  # the cone is the chord of the fillet's arc that is moved off by the allowance
        wide = radius + max(fillet - allowance, _LEAST_COLLAR * radius)
        foot = face_mm - toward * allowance
        collar = _collar(name, y_mm, (foot, wide), -toward, radius, forging)
        yield _disc(name, wide * _over_disc(collar.draft, forging), y_mm, (foot, face_mm), forging)
        yield collar


def _collar(
    name: str, y_mm: float, wide: tuple[float, float], way: float, radius_mm: float, forging: Forging
) -> Collar:
    """Return a cone that ends in a journal's cylinder, there no longer in the plane where the die parts."""
    steep = _ACROSS_CONE * math.sin(math.radians(forging.draft_deg))
    draft = math.asin(max(steep, forging.land_mm / (_SMALLEST * radius_mm)))
    narrow = radius_mm / _over_disc(draft, forging)
    end = wide[0] + way * (wide[1] - narrow)
    z_mm = min(wide[0], end), max(wide[0], end)
    return Collar(name, z_mm, y_mm, wide, (end, narrow), draft, forging.land_mm)


def _over_disc(draft: float, forging: Forging) -> float:
    """Return how much farther lines with a draft, rad, reach about a circle than those of the forging."""
    return math.cos(math.radians(forging.draft_deg)) / math.cos(draft)


def _disc(
    name: str, radius_mm: float, y_mm: float, ends_mm: tuple[float, float], forging: Forging
) -> DraftedPrism:
    """Return a cylinder with draft; its second end, in the web, has it too."""
    upward = ends_mm[1] > ends_mm[0]
    faces = min(ends_mm), max(ends_mm)
    return drafted_disc(name, radius_mm, y_mm, faces, (not upward, upward), forging)


def _check_room(scene: ThrowView, half: RawHalf, forging: Forging) -> None:
    """Refuse webs or collars that meet those of the neighbours, and a flash too thick for a journal."""
    if scene.throw.main_journal.length_mm == 0:
        raise invalid(
            "throw.main_journal.length_mm",
            0.0,
            "a flying web is forged as one with its neighbour, whose raw part is not modelled",
            "Give the journal a length, or leave [forging] out.",
        )
    thinnest = min(journal.radius_mm for journal, _ in scene.throw.journals)
    if forging.land_mm > thinnest / 4:
        raise invalid(
            "forging.flash_mm",
            forging.flash_mm,
            f"must be at most {thinnest / 2:.4g} mm, a quarter of a journal",
        )
    bodies = [*half.web, *(one for one in half.journals if isinstance(one, Collar))]
    low, high = min(body.z_mm[0] for body in bodies), max(body.z_mm[1] for body in bodies)
    rooms = {"main_journal": low, "crankpin": half.z_mm[1] - high}
    for name, room in rooms.items():
        if room <= 0:
            raise invalid(
                "forging.allowance_mm",
                forging.allowance_mm,
                f"with the draft of {forging.draft_deg:g} deg raw webs meet in the middle of throw.{name}: "
                f"each reaches {-room:.4g} mm too far",
                "Reduce it, the draft, or the width of web and counterweight.",
            )
