"""Refusals of bodies whose faces show no crank."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from cranktopo.base.arrays import Array
from cranktopo.base.errors import CranktopoError
from cranktopo.tasks.importing.faces import PARALLEL, CylinderFace, Faces, parallel

PIN_SHARE = 0.25
"""Radius of a crankpin over that of the thickest main journal, at least."""
_LEANING = 0.1
"""Sine between axes up to which one of them leans; what lies across the crank is no journal."""


def no_crank(name: str, what: str) -> CranktopoError:
    """Return the error of a body without main journals, crankpins or webs between them."""
    return CranktopoError(
        f"{name}: looks like no crank: {what}.",
        hint="A crank has main journals and crankpins: full cylinders on parallel axes. "
        "Choose another solid with --solid, or export the body again as STEP with exact faces.",
    )


def splines_words(faces: Faces) -> str:
    """Tell why a body may have no cylinder; empty where most of its faces are of other kinds."""
    count = faces.others.count("BSpline surface")
    if count <= len(faces.planes) + len(faces.cylinders) + len(faces.tori):
        return ""
    return (
        f", and {count} are B-spline surfaces, as shear, uneven scaling or a general map in CAD leaves them"
    )


def check_parallel(shafts: Sequence[CylinderFace], direction: Array, name: str) -> None:
    """Refuse a body of which a thick shaft leans a little: the journals of a crank are parallel."""
    thick = max(face.radius_mm for face in shafts if parallel(face.axis, direction))
    for face in shafts:
        sine = float(np.linalg.norm(np.cross(face.axis, direction)))
        if PARALLEL < sine < _LEANING and face.radius_mm > PIN_SHARE * thick:
            raise CranktopoError(
                f"{name}: a journal of {2 * face.radius_mm:.5g} mm leans by {math.degrees(sine):.2g} deg "
                f"to the crank axis (at most {math.degrees(PARALLEL):.1g} deg).",
                hint="Make the journals parallel in CAD, or export directions with more digits.",
            )
