"""Centrifugal load of a throw on its mesh: that of its material and the pull of what is fastened to its webs.

A bolted counterweight and plugs are in no mesh. Their pull acts on their web: spread over what of it lies
below the crank axis, where a bolted counterweight's flanks meet, or below the innermost plug. Per volume it
is linear along and across the crank axis, so that force and moments are those of the masses where they are.
"""

from __future__ import annotations

import numpy as np

from cranktopo.base.arrays import Array
from cranktopo.base.frames import Span
from cranktopo.base.units import KG_PER_TONNE, density_tonne_per_mm3
from cranktopo.bodies.volume import bolted_mass
from cranktopo.design.halves import halves
from cranktopo.design.schema import Scene
from cranktopo.numerics.tetrahedra.elasticity import Elasticity, centrifugal_force, gathered, load_points
from cranktopo.tasks.fea.condense import Lateral

_PLANE_MM = 1e-9
"""Quadrature points on a face of the web count as inside, whatever their rounding."""


def turning_load(model: Elasticity, scene: Scene, span: Span, lateral: Lateral) -> Array:
    """Return the nodal forces of rotation about the z axis at 1 rad/s, shape (unknowns,), N.

    Args:
        model: mesh of the half throw, of the whole one (`span` "whole"), or of the part x >= 0 of either
            (`lateral` not "none").
    """
    load = centrifugal_force(model, density_tonne_per_mm3(scene.material.density_kg_m3))
    for side in (0, 1) if span == "whole" else (0,):
        if bolted_mass(halves(scene)[side]).volume:
            load = load + _pull(model, scene, side, lateral)
    return load


def _pull(model: Elasticity, scene: Scene, side: int, lateral: Lateral) -> Array:
    """Return the nodal forces of what is fastened to one web, at 1 rad/s, N."""
    half = halves(scene)[side]
    elements = np.arange(model.mesh.nelements)
    (x, y, height), dx = load_points(model, elements)
    z = scene.pitch_mm - height if side else height
    low, high = half.web_z_mm
    seat = dx * ((z > low - _PLANE_MM) & (z < high + _PLANE_MM) & (y < _innermost_mm(half)))
    across, along = _moments(half)
    if lateral == "none":
        side_force = _linear((seat, z), across)
        twist = float((y * side_force).sum())
        forces = {0: side_force, 1: _linear((seat, z, x), (*along, twist))}
    else:  # what is on both sides of x = 0 is alike, and each side has half of the pull
        forces = {1: _linear((seat, z), (along[0] / 2, along[1] / 2))}
    nodal = np.zeros(model.nodes_mm.shape)
    for axis, force in forces.items():
        nodal[axis] = gathered(model, elements, force)
    return nodal.T.ravel()


def _innermost_mm(half: Scene) -> float:
    """Return the place along the throw, mm, below which a counterweight bolted on or the plugs are."""
    weight = half.web.counterweight
    assert weight is not None
    return 0.0 if weight.bolted else max(hole.y_range_mm[1] for hole in weight.holes(half))


def _moments(half: Scene) -> tuple[tuple[float, float], tuple[float, float]]:
    """Return mass times place in x, and that times the height as well, then the same of y; tonne, mm."""
    mass = bolted_mass(half)
    before = bolted_mass(half, 0.0)  # weighted by the distance before z = 0
    return (
        (mass.first_x / KG_PER_TONNE, -before.first_x / KG_PER_TONNE),
        (mass.first_y / KG_PER_TONNE, -before.first_y / KG_PER_TONNE),
    )


def _linear(seat_and_places: tuple[Array, ...], totals: tuple[float, ...]) -> Array:
    """Return forces at points that grow linearly with places, by their sum and moments by the places."""
    seat, *places = seat_and_places
    middles = [float((seat * place).sum() / seat.sum()) for place in places]
    terms = [np.ones_like(seat), *(place - middle for place, middle in zip(places, middles, strict=True))]
    about = [totals[0], *(moment - totals[0] * at for moment, at in zip(totals[1:], middles, strict=True))]
    matrix = [[float((seat * one * other).sum()) for other in terms] for one in terms]
    factors = np.linalg.solve(np.array(matrix), np.array(about))
    return np.asarray(seat * sum(factor * term for factor, term in zip(factors, terms, strict=True)))
