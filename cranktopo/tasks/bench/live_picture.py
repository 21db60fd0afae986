"""The picture of a drag: the solid, the front view and the section; a pure function of the tables."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from manifold3d import Manifold

from cranktopo.base.arrays import Array, Int64
from cranktopo.base.frames import about_z_deg
from cranktopo.bodies.prisms import bolted_counterweight
from cranktopo.bodies.shown_solid import display_half
from cranktopo.design.halves import halves
from cranktopo.design.loading import unchecked_scene
from cranktopo.design.schema import Scene
from cranktopo.report.shading import SHARP_DEGREES, sharp_edges, web_sides_mm
from cranktopo.report.viewer.scene3d import PARTNERS, Arrays, scaled
from cranktopo.tasks.bench.front_view import front_view
from cranktopo.tasks.bench.live import of_sound
from cranktopo.tasks.bench.side_view import side_view


def live_picture(data: dict[str, Any]) -> dict[str, Any]:
    """Return the solid and both views of a design, or what of it is broken, where that cannot be shown.

    The numbers of a drag, made beside it, check the design: that takes a sixth of the time of a picture.
    """
    try:
        return _shown(unchecked_scene(data, "design"))
    except Exception:  # whatever a body raises whose parts do not fit: what is broken is told then
        return of_sound(data, _shown)


def _shown(scene: Scene) -> dict[str, Any]:
    pair = halves(scene)
    alike = pair[0] is pair[1]
    solids = [(half, display_half(half)) for half in (pair[:1] if alike else pair)]
    return {
        "picture": _picture(solids),
        "front": {**front_view(scene), "side": side_view(scene, solids[0][1])},
        "turns_deg": turns_deg(scene),
    }


def _picture(solids: Sequence[tuple[Scene, Manifold]]) -> str:
    """Return both half throws, or the one where they are alike, for the 3D view."""
    arrays = Arrays()
    bodies = [
        _arrays_of_half(arrays, half, solid, partner)
        for (half, solid), partner in zip(solids, PARTNERS[len(solids)], strict=True)
    ]
    return arrays.packed_with({"bodies": bodies, "first": 0, "stress": None, "steps": None}, quick=True)


def _arrays_of_half(arrays: Arrays, half: Scene, solid: Manifold, partner: int) -> dict[str, Any]:
    bodies = [_with_normals(body) for body in (solid, bolted_counterweight(half)) if body.num_tri()]
    starts = np.cumsum([0, *(len(table) for table, _, _ in bodies)])
    table = np.concatenate([table for table, _, _ in bodies])
    faces, corner_of = (
        np.concatenate([body[k] + start for body, start in zip(bodies, starts, strict=False)]) for k in (1, 2)
    )
    low, high = table[:, :3].min(axis=0), table[:, :3].max(axis=0)
    return {
        "name": half.name,
        "half_pitch_mm": half.pitch_mm / 2,
        "partner": partner,
        "low_mm": low.tolist(),
        "size_mm": (high - low).tolist(),
        "sides_mm": web_sides_mm(half.web_z_mm),
        "positions": arrays.add(scaled((table[:, :3] - low) / (high - low), 65535, np.uint16)),
        "normals": arrays.add(scaled(table[:, 3:6], 127, np.int8)),
        "faces": arrays.add(faces.astype(np.uint32)),
        "edges": arrays.add(sharp_edges(table[:, :3], corner_of[faces])),
        "stress": [],
    }


def _with_normals(body: Manifold) -> tuple[Array, Int64, Int64]:
    """Return vertices with normals, faces, and of vertices at one place the first."""
    mesh = body.calculate_normals(0, SHARP_DEGREES).to_mesh64(0)
    table, faces = np.asarray(mesh.vert_properties), np.asarray(mesh.tri_verts, np.int64)
    corner_of = np.arange(len(table))
    corner_of[np.asarray(mesh.merge_from_vert, np.intp)] = np.asarray(mesh.merge_to_vert, np.intp)
    return table, faces, corner_of


def turns_deg(scene: Scene) -> list[float]:
    """Return the angle of every throw about z, deg; one throw where there is no engine."""
    return [about_z_deg(angle) for angle in scene.shaft_angles_deg] if scene.engine else [0.0]
