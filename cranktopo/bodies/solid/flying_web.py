"""OCC solid of a flying web with the half pins on either side, checked."""

from __future__ import annotations

from typing import Any

from cranktopo.bodies.solid.checked import ClosedForm, check_body
from cranktopo.bodies.solid.shapes import fused, turned, turned_half
from cranktopo.bodies.solid.throw import add_half_throw, half_form
from cranktopo.design.flying_web import FlyingWeb
from cranktopo.design.halves import mirror_image
from cranktopo.numerics.gmsh_session import DimTags


def add_flying_web(occ: Any, web: FlyingWeb, *, by_tools: bool = False) -> DimTags:
    """Return a flying web from the middle of the near crankpin, z = 0, to that of the far one.

    The near throw is up, the far one turned by its angle ahead.

    Args:
        by_tools: as of `drilled`.
    """
    near = add_half_throw(occ, mirror_image(web.near), by_tools=by_tools)
    turned_half(occ, near, web.back_mm)
    far = turned(occ, add_half_throw(occ, web.far, by_tools=by_tools), web.turn_deg)
    occ.translate(far, 0, 0, web.back_mm)
    body = fused(occ, [near, far], one_face=False)  # round ends go on in each other, their seams do not
    one, other = half_form(web.near), half_form(web.far)
    whole = ClosedForm(one.volume_mm3 + other.volume_mm3, one.roundings_mm3 + other.roundings_mm3)
    check_body(occ, body, whole, "flying web")
    return body
