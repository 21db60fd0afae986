"""The check by rays: what the process of a scene would leave of the web that was found."""

from __future__ import annotations

import numpy as np

from cranktopo.bodies.undercuts import half_throw_undercuts
from cranktopo.design.draft import asks_for_draft, kept_without_draft, least_draft_deg
from cranktopo.design.schema import Scene
from cranktopo.numerics.surfaces.mesh import SurfaceMesh
from cranktopo.tasks.extraction.result import ShapedUndercuts, UndercutMeasures
from cranktopo.throw.bevel import EndBevel
from cranktopo.throw.primitives import Point


def shaped_undercuts(half_throw: SurfaceMesh, scene: Scene) -> ShapedUndercuts:
    """Return what the scene's process would leave of a web, and the feature that holds it."""
    found = half_throw_undercuts(half_throw, scene)
    at_mm = None if found.negligible else found.deepest_at_mm
    holder = None if at_mm is None else _feature_at(scene, at_mm)
    measures = dict(UndercutMeasures.of(found, _without_draft(scene)))
    return ShapedUndercuts(**measures, process=scene.optimise.process, held_by=holder)


def _without_draft(scene: Scene) -> tuple[str, ...]:
    """Return what has less draft than asked: bevels across the web with less, a web's outline has none."""
    if not asks_for_draft(scene):
        return ()
    kept = kept_without_draft(scene)
    if scene.optimise.parting == "web_faces":
        return ("web.outline", *kept)
    least = least_draft_deg(scene)
    bevels = ((key, one) for key, one in scene.web.features() if isinstance(one, EndBevel))
    return (*(key for key, bevel in bevels if bevel.draft_deg < least), *kept)


def _feature_at(scene: Scene, at_mm: Point) -> str | None:
    """Return the key path of the feature that takes out a point."""
    x, y, z = at_mm
    for key, feature in scene.web.features():
        for body in feature.bodies(scene, key):
            within = not body.adds and body.z_mm[0] <= z <= body.z_mm[1]
            if within and body.contains(np.array([x]), np.array([y]), z).any():
                return key
    return None
