"""Prisms and discs of a raw part, with the draft on their outlines and on their faces."""

from __future__ import annotations

from dataclasses import replace

from cranktopo.throw.feature import Body
from cranktopo.throw.raw_part.bodies import Disc, DraftedPrism
from cranktopo.throw.raw_part.drafted_outline import DraftedOutline, drafted_outline
from cranktopo.throw.raw_part.table import Forging


def drafted_prism(
    body: Body,
    outline: DraftedOutline,
    faces_mm: tuple[float, float],
    tilted: tuple[bool, bool],
    widest_mm: float,
    forging: Forging,
) -> DraftedPrism:
    """Return a body as a prism with draft, whose faces lie at heights where it is widest."""
    rise = forging.draft_slope * (widest_mm - forging.land_mm)
    low, high = faces_mm[0] - rise * tilted[0], faces_mm[1] + rise * tilted[1]
    own = replace(body, z_mm=(low, high))
    return DraftedPrism(
        body.key, (low, high), own, outline, faces_mm, tilted, widest_mm, forging.draft_slope, forging.land_mm
    )


def drafted_disc(
    name: str,
    radius_mm: float,
    y_mm: float,
    faces_mm: tuple[float, float],
    tilted: tuple[bool, bool],
    forging: Forging,
) -> DraftedPrism:
    """Return a cylinder with draft between its faces, lower first; `tilted` ones have it too."""
    disc = Disc(name, faces_mm, y_mm, radius_mm)
    outline = drafted_outline(disc.half_width_mm, disc.y_range_mm, forging.draft_slope, forging.land_mm)
    return drafted_prism(disc, outline, faces_mm, tilted, radius_mm, forging)
