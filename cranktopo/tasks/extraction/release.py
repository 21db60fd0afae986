"""The check by rays: what the process of a scene would leave of the web that was found."""

from __future__ import annotations

import numpy as np

from cranktopo.bodies.undercuts import half_throw_undercuts
from cranktopo.design.schema import Scene
from cranktopo.numerics.surfaces.mesh import SurfaceMesh
from cranktopo.tasks.extraction.result import ShapedUndercuts, UndercutMeasures
from cranktopo.throw.bevel import EndBevel
from cranktopo.throw.primitives import Point

_ROUNDED_DEG = 0.0051
"""Draft that rounding may take."""


def shaped_undercuts(half_throw: SurfaceMesh, scene: Scene) -> ShapedUndercuts:
    """Return what the scene's process would leave of a web, and the feature that holds it."""
    found = half_throw_undercuts(half_throw, scene)
    at_mm = None if found.negligible else found.deepest_at_mm
    holder = None if at_mm is None else _feature_at(scene, at_mm)
    measures = dict(UndercutMeasures.of(found, _without_draft(scene)))
    return ShapedUndercuts(**measures, process=scene.optimise.process, held_by=holder)


def _without_draft(scene: Scene) -> tuple[str, ...]:
    """Return what has less draft than asked: bevels across the web with less, a web's outline has none."""
    if not _drafted(scene):
        return ()
    kept = kept_without_draft(scene)
    if scene.optimise.parting == "web_faces":
        return ("web.outline", *kept)
    least = scene.optimise.draft_deg - _ROUNDED_DEG
    bevels = ((key, one) for key, one in scene.web.features() if isinstance(one, EndBevel))
    return (*(key for key, bevel in bevels if bevel.draft_deg < least), *kept)


def kept_without_draft(scene: Scene) -> tuple[str, ...]:
    """Return what no optimiser changes and has less draft than asked: the flanks of a counterweight."""
    weight = scene.web.counterweight
    if not _drafted(scene) or weight is None or weight.bolted or not weight.has_flanks(scene):
        return ()
    draft_deg = 0.0 if scene.optimise.parting == "web_faces" else weight.flank_draft_deg
    return ("web.counterweight",) if draft_deg < scene.optimise.draft_deg - _ROUNDED_DEG else ()


def _drafted(scene: Scene) -> bool:
    """Tell whether a die or mould asks for a draft."""
    return scene.optimise.process in ("forged", "cast") and bool(scene.optimise.draft_deg)


def _feature_at(scene: Scene, at_mm: Point) -> str | None:
    """Return the key path of the feature that takes out a point."""
    x, y, z = at_mm
    for key, feature in scene.web.features():
        for body in feature.bodies(scene, key):
            within = not body.adds and body.z_mm[0] <= z <= body.z_mm[1]
            if within and body.contains(np.array([x]), np.array([y]), z).any():
                return key
    return None
