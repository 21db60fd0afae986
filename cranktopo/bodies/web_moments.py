"""Moments of the webs of a scene, and of the parts that are bolted to them."""

from __future__ import annotations

from functools import lru_cache

from cranktopo.base.units import density_kg_per_mm3
from cranktopo.design.schema import Scene
from cranktopo.throw.moments import Moments, body_moments, body_section_moments
from cranktopo.throw.web import web_bodies


@lru_cache(maxsize=16)
def web_moments(scene: Scene) -> Moments:
    """Moments of one whole web, bores and features taken out."""
    return body_moments(web_bodies(scene))


_NOTHING = Moments(0.0, 0.0, 0.0, 0.0)


def bolted_mass(scene: Scene, before_z_mm: float | None = None) -> Moments:
    """Mass moments of a counterweight that is bolted to one web, kg and mm; all 0 without one.

    Args:
        before_z_mm: as `body_moments`.
    """
    weight = scene.web.counterweight
    return counterweight_mass(scene, before_z_mm) if weight is not None and weight.bolted else _NOTHING


@lru_cache(maxsize=16)
def counterweight_mass(scene: Scene, before_z_mm: float | None = None) -> Moments:
    """Mass moments of what a counterweight adds to one web, kg and mm; all 0 without one.

    What of it lies within the web is the web's, and what a pocket cuts is neither's.

    Args:
        before_z_mm: as `body_moments`.
    """
    weight = scene.web.counterweight
    if weight is None:
        return _NOTHING
    bare = scene.model_copy(update={"web": scene.web.model_copy(update={"counterweight": None})})
    bodies = web_bodies(bare)
    added = body_moments([*bodies, *weight.parts(scene)], before_z_mm)
    added = added + body_moments(bodies, before_z_mm).times(-1.0)
    return added.times(density_kg_per_mm3(weight.density_kg_m3 or scene.material.density_kg_m3))


def section_moments(scene: Scene, z_mm: float) -> Moments:
    """Return the moments of the web's section at a height, per mm of height."""
    return body_section_moments(web_bodies(scene), z_mm)
