"""Fill of cells by a web of the family, differentiable: signed distances through a smooth step (JAX).

The step's width shrinks during the fit. It is odd about the surface, so that a flat surface is fitted
without bias at any width.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from cranktopo.remodel.family import Bevel, Layout, Pocket, flank_of
from cranktopo.remodel.occupancy import Occupancy
from cranktopo.scene import Scene
from cranktopo.scene.bevel import BevelArc
from cranktopo.scene.profile import Flank

CHORDS = 6
"""Chords per piece of the outline in the distance field."""


def fill(layout: Layout, values: Any, cells: Occupancy, scene: Scene, width_mm: float) -> Any:
    """Fill of every cell by the web of a parameter vector, bores not cut, (nx, ny, nz).

    Args:
        layout: the parameters.
        values: their values.
        cells: where.
        scene: height of the web.
        width_mm: half-width of the smooth step.
    """
    import jax.numpy as jnp

    flank = flank_of(jnp, layout, values)
    inside = outline_distance(flank, cells)[:, :, None]
    for part, named in layout.split(values):
        if isinstance(part, Bevel):
            arc = bevel_arc_of(part, named, values)
            depth, reach = _depth(part.face, cells.z_mm, scene), arc.outward * cells.y_mm[:, None]
            inside = jnp.minimum(inside, arc.distance_mm(jnp, depth[None, :], reach)[None])
        else:
            inside = jnp.minimum(inside, -_pocket_distance(part, named, cells, scene))
    u = jnp.clip(inside / width_mm, -1.0, 1.0)
    return jnp.broadcast_to(0.5 + 0.75 * u - 0.25 * u**3, cells.filled.shape)


def bevel_arc_of(part: Bevel, named: dict[str, Any], values: Any) -> BevelArc:
    """The arc of a bevel of the family; `values` is the whole parameter vector."""
    if part.face == "journal":
        return BevelArc(named["y"], values[1], named["depth"], named["crown"], 1.0)
    return BevelArc(-named["y"], -values[0], named["depth"], named["crown"], -1.0)


def outline_distance(flank: Flank, cells: Occupancy) -> Any:
    """Signed distance from the outline at x times y, (nx, ny), mm; positive inside."""
    import jax.numpy as jnp

    pieces = flank.at(jnp, np.linspace(0, 1, CHORDS + 1))
    start, end = pieces[:, :-1].reshape(-1, 2), pieces[:, 1:].reshape(-1, 2)
    x, y = jnp.asarray(cells.x_mm)[:, None, None], jnp.asarray(cells.y_mm)[None, :, None]
    dx, dy = end[:, 0] - start[:, 0], end[:, 1] - start[:, 1]
    px, py = x - start[:, 0], y - start[:, 1]
    along = jnp.clip((px * dx + py * dy) / (dx**2 + dy**2), 0.0, 1.0)
    square = (px - along * dx) ** 2 + (py - along * dy) ** 2
    # By index: the derivative of min() finds its place by comparing numbers that a compiled program may
    # round in two ways, and is then 0.
    nearest = jnp.argmin(square, axis=-1, keepdims=True)
    distance = jnp.sqrt(jnp.take_along_axis(square, nearest, axis=-1)[..., 0] + 1e-12)
    across = (start[:, 1] <= y) & (y < end[:, 1])
    edge = jnp.where(across, start[:, 0] + py / dy * dx, 0.0).sum(axis=-1)
    return jnp.where(x[..., 0] < edge, distance, -distance)


def _pocket_distance(part: Pocket, named: dict[str, Any], cells: Occupancy, scene: Scene) -> Any:
    """Signed distance of a pocket, positive in it, broadcastable to the cells, mm."""
    import jax.numpy as jnp

    x, y = cells.x_mm[:, None, None], cells.y_mm[None, :, None]
    along = jnp.abs(y - named["y"])
    if part.shape == "side":
        angle = jnp.deg2rad(named["draft"])
        deep = x - named["floor"]
        opening, lean = deep * jnp.tan(angle), jnp.cos(angle)
        height = jnp.abs(cells.z_mm - sum(scene.web_z_mm) / 2 - named["offset"])
        walls = jnp.minimum(named["length"] / 2 + opening - along, named["height"] / 2 + opening - height)
        return jnp.minimum(deep, walls * lean)
    across = x - named.get("x", 0.0)
    if part.shape == "cylinder":
        result = named["diameter"] / 2 - jnp.sqrt(across**2 + along**2 + 1e-12)
    else:
        result = jnp.minimum(named["size_x"] / 2 - jnp.abs(across), named["size_y"] / 2 - along)
    if part.face == "through":
        return result
    return jnp.minimum(result, named["depth"] - _depth(part.face, cells.z_mm, scene))


def _depth(face: str, z_mm: Any, scene: Scene) -> Any:
    start, end = scene.web_z_mm
    return z_mm - start if face == "journal" else end - z_mm
