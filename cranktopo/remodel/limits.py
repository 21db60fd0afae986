"""Manufacturing constraints of the fit, each kept where it is <= 0 (JAX): walls, radii, access of a tool."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from cranktopo.remodel.checks import SHOULDER_MM
from cranktopo.remodel.family import ROUNDING_MM, Bevel, Layout, Pocket, flank_of
from cranktopo.remodel.fill import bevel_arc_of
from cranktopo.remodel.rules import Rules
from cranktopo.scene import Scene
from cranktopo.scene.bevel import BevelArc

_CHECKS = 12
_LEAST_RISE = 0.01
"""Least rise in y per mm along the outline, which keeps its half-width single-valued."""
_CLEAR_MM = 2 * ROUNDING_MM
_BEND_MARGIN = 0.99


def violations(layout: Layout, values: Any, scene: Scene, rules: Rules) -> Any:
    """All constraints of a parameter vector, kept where <= 0.

    Walls and shoulders (mm), curvature of the outline times the least radius less 1, rise of the outline.
    """
    import jax.numpy as jnp

    flank = flank_of(jnp, layout, values)
    u = (np.arange(_CHECKS) + 0.5) / _CHECKS
    points = flank.at(jnp, u).reshape(-1, 2)
    rise = flank.derivatives(jnp, u)[0][..., 1].ravel()
    bend = flank.curvature_per_mm(jnp, np.linspace(0, 1, _CHECKS)).ravel() * rules.min_radius_mm
    found = [bend - _BEND_MARGIN, -bend - _BEND_MARGIN, _LEAST_RISE - rise[1:-1]]
    (main, main_reach), (pin, pin_reach) = reaches = reaches_mm(scene, rules)
    found += [reach - jnp.hypot(points[:, 0], points[:, 1] - y) for y, reach in reaches]
    terms = [main_reach - main + values[0], pin_reach + pin - values[1]]
    arcs = [
        (part, bevel_arc_of(part, named, values))
        for part, named in layout.split(values)
        if isinstance(part, Bevel)
    ]
    for bevel, arc in arcs:
        terms += _bevel(bevel, arc, scene, rules)
    for part, named in layout.split(values):
        if isinstance(part, Pocket) and part.shape == "side":
            terms += _side(named, points[jnp.argmax(points[:, 0]), 0], arcs, scene, rules)
        elif isinstance(part, Pocket):
            terms += _pocket(part, named, points, scene, rules)
    return jnp.concatenate([*found, jnp.stack(terms)])


def reaches_mm(scene: Scene, rules: Rules) -> list[tuple[float, float]]:
    """Axes along the throw and the least distance of the outline from each: wall of the bore, fillet."""
    return [
        (y, max(j.bore_radius_mm + rules.min_wall_mm, j.radius_mm + j.fillet_mm + SHOULDER_MM) + _CLEAR_MM)
        for j, y in scene.throw.journals
    ]


def _bevel(part: Bevel, arc: BevelArc, scene: Scene, rules: Rules) -> Iterator[Any]:
    """Clear of the journal on its face, a wall under the other journal's edge, no turning back."""
    import jax.numpy as jnp

    main, pin = scene.throw.main_journal, scene.throw.crankpin
    journal, other = (main, pin) if part.face == "journal" else (pin, main)
    offset = 0.0 if part.face == "journal" else -scene.throw.radius_mm
    far = scene.throw.radius_mm if part.face == "journal" else 0.0
    yield offset + journal.radius_mm + journal.fillet_mm + SHOULDER_MM + _CLEAR_MM - arc.start_mm
    yield rules.min_wall_mm + arc.start_mm - arc.end_mm
    wall = scene.web.thickness_mm - rules.min_wall_mm
    yield -arc.distance_mm(jnp, wall, far + other.radius_mm)
    rise, run = arc.end_mm - arc.start_mm, arc.depth_mm
    yield 4 * arc.crown_mm - 0.95 * _twice_tangent(rise, run)


def _twice_tangent(rise: Any, run: Any) -> Any:
    """2 L tan(min(slope, 90 deg - slope) / 2): four times a crown this large makes the arc turn back."""
    import jax.numpy as jnp

    chord = jnp.hypot(rise, run)
    shorter, longer = jnp.minimum(rise, run), jnp.maximum(rise, run)
    return 2 * chord * shorter / (chord + longer)


def _side(
    named: dict[str, Any], widest: Any, arcs: list[tuple[Bevel, BevelArc]], scene: Scene, rules: Rules
) -> Iterator[Any]:
    """Flanges on both sides, walls toward bores and bevels."""
    import jax.numpy as jnp

    slope = jnp.tan(jnp.deg2rad(named["draft"]))
    deep = widest - named["floor"]
    tall = named["height"] / 2 + slope * deep
    wall = rules.min_wall_mm + _CLEAR_MM
    yield 1.0 - deep
    offset = named["offset"]
    yield tall + jnp.abs(offset) + wall - scene.web.thickness_mm / 2
    for journal, y in scene.throw.journals:
        if journal.bore_radius_mm:
            beyond = jnp.maximum(jnp.abs(y - named["y"]) - named["length"] / 2, 0.0)
            yield journal.bore_radius_mm + wall - jnp.hypot(named["floor"], beyond)
    for part, arc in arcs:
        reach = arc.outward * named["y"] + named["length"] / 2 + slope * deep
        depth = scene.web.thickness_mm / 2 + offset * (1.0 if part.face == "journal" else -1.0)
        yield wall - arc.distance_mm(jnp, depth - tall, reach)


def _pocket(part: Pocket, named: dict[str, Any], points: Any, scene: Scene, rules: Rules) -> Iterator[Any]:
    """Walls toward bores and the outline, between twins, and journals out of the tool's way."""
    import jax.numpy as jnp

    x, y = named.get("x", 0.0), named["y"]
    wall = rules.min_wall_mm + _CLEAR_MM

    def gap(px: Any, py: Any) -> Any:
        if part.shape == "cylinder":
            return jnp.sqrt((px - x) ** 2 + (py - y) ** 2 + 1e-12) - named["diameter"] / 2
        over_x, over_y = jnp.abs(px - x) - named["size_x"] / 2, jnp.abs(py - y) - named["size_y"] / 2
        outside = jnp.sqrt(jnp.maximum(over_x, 0.0) ** 2 + jnp.maximum(over_y, 0.0) ** 2 + 1e-12)
        return outside + jnp.minimum(jnp.maximum(over_x, over_y), 0.0)

    gaps = gap(points[:, 0], points[:, 1])
    yield wall - gaps[jnp.argmin(gaps)]
    if part.pair:
        yield wall / 2 + (named["diameter"] if part.shape == "cylinder" else named["size_x"]) / 2 - x
    for face, (journal, axis) in zip(("journal", "pin"), scene.throw.journals, strict=True):
        yield journal.bore_radius_mm + wall - gap(0.0, axis)
        if part.face in (face, "through"):
            yield journal.radius_mm + journal.fillet_mm + SHOULDER_MM - gap(0.0, axis)
