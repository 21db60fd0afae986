"""Volumes and moments of webs and half throws without a CAD kernel: the oracle of every solid."""

from __future__ import annotations

import math
from collections.abc import Sequence
from functools import lru_cache

import numpy as np

from cranktopo.base.arrays import Array
from cranktopo.base.quadrature import gauss_legendre
from cranktopo.base.units import density_kg_per_mm3
from cranktopo.bodies.bolt_masses import bolts_added_kg_mm, holes_in_weight
from cranktopo.design.halves import of_halves
from cranktopo.design.schema import Scene
from cranktopo.throw.drilling.moments import drilled
from cranktopo.throw.feature import Body
from cranktopo.throw.journal import Journal
from cranktopo.throw.moments import Moments, body_moments
from cranktopo.throw.web import web_bodies


def web_moments(scene: Scene, before_z_mm: float | None = None) -> Moments:
    """Return the moments of one whole web, bores and features taken out; weighted as `body_moments`."""
    return body_moments(web_bodies(scene), before_z_mm)


_NOTHING = Moments(0.0, 0.0, 0.0, 0.0)


def bolted_mass(scene: Scene, before_z_mm: float | None = None) -> Moments:
    """Return mass moments of what is fastened to one web, kg and mm: a counterweight bolted on, plugs."""
    weight = scene.web.counterweight
    if weight is None:
        return _NOTHING
    return counterweight_mass(scene, before_z_mm) if weight.bolted else _plug_mass(scene, before_z_mm)


def _plug_mass(scene: Scene, before_z_mm: float | None) -> Moments:
    """Return mass moments of the plugs of a counterweight that is there; full cylinders, each in its hole."""
    weight, total = scene.web.counterweight, _NOTHING
    assert weight is not None
    for plug, hole in zip(weight.plug, weight.holes(scene), strict=False):
        arm = 1.0 if before_z_mm is None else before_z_mm - sum(hole.z_mm) / 2
        total = total + Moments(*plug.moments()).times(arm * density_kg_per_mm3(plug.density_kg_m3))
    return total


@lru_cache(maxsize=16)
def counterweight_mass(scene: Scene, before_z_mm: float | None = None) -> Moments:
    """Return mass moments of what a counterweight adds to one web, kg and mm; all 0 without one.

    What of it lies within the web is the web's, and what a pocket cuts is neither's; its plugs and its placed
    bolts are its own.
    """
    weight = scene.web.counterweight
    if weight is None:
        return _NOTHING
    density = density_kg_per_mm3(weight.density_kg_m3 or scene.material.density_kg_m3)
    added = _beside_web(scene, before_z_mm).times(density)
    return added + _plug_mass(scene, before_z_mm) + bolts_added_kg_mm(scene, before_z_mm)


def _beside_web(scene: Scene, before_z_mm: float | None = None) -> Moments:
    """Return the moments of what a counterweight that is there adds to one web, holes of bolts filled."""
    weight = scene.web.counterweight
    assert weight is not None
    bare = scene.model_copy(update={"web": scene.web.model_copy(update={"counterweight": None})})
    bodies = [*web_bodies(bare), *weight.parts(scene), *weight.cuts(scene)]
    return body_moments(bodies, before_z_mm) - web_moments(bare, before_z_mm)


def bolted_volume_mm3(scene: Scene) -> float:
    """Return the volume of the counterweight that is bolted to one web, its holes taken out."""
    return _beside_web(scene).volume - holes_in_weight(scene).volume


def half_throw_volume_mm3(scene: Scene) -> float:
    """Return the volume, mm3, of journals, web and fillets less bores, pockets and drillings."""
    throw = scene.throw
    total = web_moments(scene).volume - drilled(scene).volume
    for journal in (throw.main_journal, throw.crankpin):
        ring = journal.radius_mm**2 - journal.bore_radius_mm**2
        total += math.pi * ring * journal.length_mm / 2
    start, end = scene.web_z_mm
    total += _fillet_volume(scene, throw.main_journal, 0.0, start)
    return total + _fillet_volume(scene, throw.crankpin, throw.radius_mm, end)


def outlet_roundings_mm3(scene: Scene) -> float:
    """Return what the roundings of drillings' outlets take out of a half throw, mm3."""
    sharp = tuple(one.model_copy(update={"outlet_radius_mm": 0.0}) for one in scene.throw.drilling)
    bare = scene.with_drillings(sharp)
    return drilled(scene).volume - drilled(bare).volume


def throw_volume_mm3(scene: Scene) -> float:
    """Return the volume of the throw between its two mid-main-journal planes, mm3."""
    return sum(of_halves(scene, half_throw_volume_mm3))


def web_volume_mm3(scene: Scene) -> float:
    """Return the volume of the web between its two faces, mm3."""
    return web_moments(scene).volume - drilled(scene, "web").volume


def _fillet_volume(scene: Scene, journal: Journal, y: float, face_z: float) -> float:
    """Volume of a fillet ring, less what opens under it: shells of height h(rho) = f - sqrt(f2 - d2).

    Of an ellipse the height is larger by its axial over its radial semi-axis f.
    """
    fillet, radius = journal.fillet_mm, journal.radius_mm
    nodes, weights = gauss_legendre(40)
    t = (nodes + 1) / 2
    wide = fillet - journal.fillet.half_mouth_mm
    rho, jacobian = radius + wide * t**2, 2 * wide * t / 2
    above = fillet - journal.fillet.recess_mm
    height = above - np.sqrt(np.maximum(fillet**2 - (radius + fillet - rho) ** 2, 0.0))
    height = height / journal.fillet.flattening
    low, high = y - radius - fillet, y + radius + fillet
    cuts = [
        body
        for body in web_bodies(scene)
        if not body.adds and face_z in body.z_mm and body.y_range_mm[0] < high and body.y_range_mm[1] > low
    ]
    share = _uncut_share(cuts, rho, y, face_z) if cuts else np.ones_like(rho)
    return float(np.sum(weights * jacobian * height * rho * 2 * math.pi * share))


def _uncut_share(cuts: Sequence[Body], rho: Array, y: float, face_z: float) -> Array:
    """Share of each circle about (0, y) in a face of the web that no cut takes away."""
    angle = np.linspace(0, 2 * math.pi, 20001)[:-1, None]
    px, py = rho * np.cos(angle), y + rho * np.sin(angle)
    solid = np.ones(px.shape, dtype=bool)
    for cut in cuts:
        solid &= ~cut.contains(px, py, face_z)
    return np.asarray(solid.mean(axis=0))
