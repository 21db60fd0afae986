"""Volumes and masses of the placed bolts of a counterweight and of their holes, in closed form.

Each hole is a cylinder along the throw that ends at a curved face: strips across it, by Gauss's rule.
"""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from cranktopo.base.arrays import Array
from cranktopo.base.quadrature import gauss_legendre
from cranktopo.base.units import density_kg_per_mm3
from cranktopo.design.bolt_holes import BoltHole, bolt_holes, lower_end_mm
from cranktopo.design.schema import Scene
from cranktopo.throw.moments import Moments

BOLT_KG_M3 = 7850.0
"""Density of bolts, which are of steel."""
_STRIPS = 60
_NOTHING = Moments(0.0, 0.0, 0.0, 0.0)
_Ends = Callable[[Array], Array]


def holes_in_weight(scene: Scene, before_z_mm: float | None = None) -> Moments:
    """Return the moments of what bolts' holes take out of the counterweight, weighted as `body_moments`."""

    def of(bolt: BoltHole) -> Moments:
        through = _column(bolt, bolt.hole_radius_mm, _at(bolt.seat_mm), _joint(scene), before_z_mm)
        return through + _column(bolt, bolt.head_radius_mm, _rim(scene), _at(bolt.seat_mm), before_z_mm)

    return sum((of(bolt) for bolt in bolt_holes(scene)), _NOTHING)


def holes_in_web(scene: Scene, before_z_mm: float | None = None) -> Moments:
    """Return the moments of the core holes of the threads, weighted as `body_moments`."""
    columns = (
        _column(bolt, bolt.core_radius_mm, _joint(scene), _at(bolt.floor_mm), before_z_mm)
        for bolt in bolt_holes(scene)
    )
    return sum(columns, _NOTHING)


def bolts_added_kg_mm(scene: Scene, before_z_mm: float | None = None) -> Moments:
    """Return what placed bolts add to a web with its counterweight, less their holes, kg and mm.

    The engaged thread fills its hole with what the web lost; the core hole beyond it is empty.
    """
    weight = scene.web.counterweight
    if weight is None or not weight.bolted:
        return _NOTHING
    steel = density_kg_per_mm3(BOLT_KG_M3)
    lost = holes_in_weight(scene, before_z_mm).times(density_kg_per_mm3(weight.density_kg_m3 or 0.0))
    added = _NOTHING - lost
    for bolt in bolt_holes(scene):
        wide = bolt.joint.nominal.diameter_mm
        added += _column(
            bolt, bolt.joint.head_mm / 2, _at(bolt.head_end_mm), _at(bolt.seat_mm), before_z_mm
        ).times(steel)
        added += _column(bolt, wide / 2, _at(bolt.seat_mm), _at(bolt.joint_mm), before_z_mm).times(steel)
        empty = _column(bolt, bolt.core_radius_mm, _at(bolt.thread_mm), _at(bolt.floor_mm), before_z_mm)
        added += empty.times(-density_kg_per_mm3(scene.material.density_kg_m3))
    return added


def _at(y_mm: float) -> _Ends:
    return lambda x: np.full_like(x, y_mm)


def _joint(scene: Scene) -> _Ends:
    return lambda x: lower_end_mm(scene, x)


def _rim(scene: Scene) -> _Ends:
    weight = scene.web.counterweight
    assert weight is not None
    return lambda x: -np.sqrt(weight.outer_radius_mm**2 - x**2)


def _column(bolt: BoltHole, radius_mm: float, low: _Ends, high: _Ends, before_z_mm: float | None) -> Moments:
    """Return the moments of a cylinder along the throw about a bolt's axis, between two heights over x."""
    nodes, weights = gauss_legendre(_STRIPS)
    turn = math.pi / 2 * nodes
    x = bolt.x_mm + radius_mm * np.sin(turn)
    area = math.pi * weights * (radius_mm * np.cos(turn)) ** 2
    if before_z_mm is not None:
        area = area * (before_z_mm - bolt.z_mm)
    bottom, top = low(x), high(x)
    length, first, second = ((top**power - bottom**power) / power for power in (1, 2, 3))
    values = (length, x * length, first, x**2 * length + second)
    return Moments(*(float(area @ value) for value in values))
