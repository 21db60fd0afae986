"""A web for a page that shows hundreds: few triangles, from which the browser makes normals and parts."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from cranktopo.base.arrays import Int64
from cranktopo.report.shading import web_sides_mm
from cranktopo.report.viewer.scene3d import Arrays, ShownBody, scaled, simplified

MOST_FACES = 2000
STEPS = 4095
"""Of a position along the body: 0.03 mm of a throw of 120 mm."""


def packed_web(*halves: ShownBody) -> str:
    """Return a half throw, or both where they differ, as `packed` of `scene3d`, in a quarter of the space.

    Positions are rounded to 1/4095 of the size. A corner is told by how many vertices came after its own, so
    that 0 is a new one: small numbers compress better.
    """
    arrays = Arrays()
    bodies = [_small(arrays, body) for body in halves]
    return arrays.packed_with({"bodies": bodies, "first": 0, "stress": None, "steps": None})


def _small(arrays: Arrays, body: ShownBody) -> dict[str, Any]:
    mesh = simplified(body.mesh, MOST_FACES)
    low, high = mesh.vertices_mm.min(axis=0), mesh.vertices_mm.max(axis=0)
    points, faces = _in_order(scaled((mesh.vertices_mm - low) / (high - low), STEPS, np.uint16), mesh.faces)
    return {
        "half_pitch_mm": body.half_pitch_mm,
        "partner": body.partner,
        "low_mm": low.tolist(),
        "size_mm": (high - low).tolist(),
        "sides_mm": web_sides_mm(body.web_z_mm),
        "steps": STEPS,
        "points": arrays.add(points),
        "corners": arrays.add(_newer(faces)),
    }


def _in_order(points: NDArray[Any], faces: Int64) -> tuple[NDArray[Any], Int64]:
    """Vertices in the order in which faces use them first."""
    used, first, name = np.unique(faces, return_index=True, return_inverse=True)
    order = np.argsort(first)
    return points[used[order]], np.argsort(order)[name].reshape(faces.shape)


def _newer(faces: Int64) -> NDArray[np.uint16]:
    """For each corner how many vertices were named before it and after its own."""
    corners = faces.reshape(-1)
    named = np.maximum.accumulate(np.concatenate([[0], corners[:-1] + 1]))
    return (named - corners).astype(np.uint16)
