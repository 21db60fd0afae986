"""Centrifugal load of a throw on its mesh: that of its material and the pull of what is fastened to its webs.

A bolted counterweight and plugs are in no mesh. Their pull acts on their web: spread over what of it lies
below the crank axis, where a bolted counterweight's flanks meet, or below the innermost plug. Per volume it
is linear along and across the crank axis, so that force and moments are those of the masses where they are.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from cranktopo.base.arrays import Array, Mask
from cranktopo.base.frames import Span
from cranktopo.base.units import KG_PER_TONNE, density_tonne_per_mm3
from cranktopo.bodies.volume import bolted_mass
from cranktopo.design.halves import halves
from cranktopo.design.schema import Scene
from cranktopo.numerics.tetrahedra.elasticity import (
    LOAD_ORDER,
    Elasticity,
    centrifugal_force,
    gathered,
    load_points,
)
from cranktopo.numerics.tetrahedra.node_gradients import gather, nodal_values, shape_slopes
from cranktopo.tasks.throw_fea.condense import Lateral

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


def pull_totals(half: Scene) -> Array:
    """Return the moments of what is fastened to one web that its pull follows from: in x, x z, y, y z.

    Tonne times mm or mm2.
    """
    across, along = _moments(half)
    return np.array([*across, *along])


def pull_slopes(model: Elasticity, scene: Scene, lateral: Lateral, field: Array) -> tuple[Array, Array]:
    """Return the derivative of the pull on a half throw times a field, by the nodes and by `pull_totals`.

    Which quadrature points lie in the seat is held.

    Args:
        model: as of `turning_load`, `span` "symmetric".
        field: displacements, (unknowns,).

    Returns:
        Shapes (3, nodes) and (4,).
    """
    slopes, half = np.zeros(model.nodes_mm.shape), halves(scene)[0]
    if not bolted_mass(half).volume:
        return slopes, np.zeros(4)
    basis, inside = _seat_basis(model, half)
    values, (x, y, z) = nodal_values(basis), np.asarray(basis.global_coordinates())
    moved = np.einsum("neq,ine->ieq", values, field.reshape(-1, 3).T[:, basis.element_dofs])
    weights, (across, along) = basis.dx * inside, _moments(half)
    if lateral == "none":
        twist = float((y * _linear((weights, z), across)).sum())
        own = _spread(weights, {2: z, 0: x}, (*along, twist), moved[1])
        side = _spread(weights, {2: z}, across, moved[0] + own.by_totals[2] * y)
        found, by_totals = [own, side], np.array([*side.by_totals, *own.by_totals[:2]])
        turned = side.force * own.by_totals[2]
    else:
        own = _spread(weights, {2: z}, (along[0] / 2, along[1] / 2), moved[1])
        found, by_totals = [own], np.array([0.0, 0.0, *(own.by_totals / 2)])
        turned = np.zeros_like(y)
    density = np.sum([one.by_volume for one in found], axis=0)
    places = np.sum([one.by_place for one in found], axis=0)
    places[1] += turned
    parts = np.einsum("eq,njeq->nje", weights * density, shape_slopes(basis), optimize=True)
    parts += np.einsum("eq,ieq,neq->nie", weights, places, values, optimize=True)
    gather(slopes, basis, parts)
    return slopes, by_totals


def _seat_basis(model: Elasticity, half: Scene) -> tuple[Any, Array]:
    """Return the basis of the elements that reach into the seat of a web; 1 at points inside it, else 0."""
    from skfem import Basis, ElementTetP2

    (_, y, z), _ = load_points(model, np.arange(model.mesh.nelements))
    seat = _in_seat(half, y, z)
    elements = np.flatnonzero(seat.any(axis=1))
    basis = Basis(model.mesh, ElementTetP2(), intorder=LOAD_ORDER, elements=elements)
    return basis, seat[elements].astype(np.float64)


class _Spread(NamedTuple):
    """A force per volume, linear in places, and the derivatives of its work on a field.

    By its totals, by each volume and by each place (3, elements, points).
    """

    force: Array
    by_totals: Array
    by_volume: Array
    by_place: Array


def _spread(weights: Array, places: dict[int, Array], totals: tuple[float, ...], field: Array) -> _Spread:
    """Return what a force with these totals, spread as by `_linear`, does on a field at the points.

    Its factors solve M a = totals, M of the terms' products; c = M^-1 of the terms' products with the field.
    """
    terms = np.stack([np.ones_like(weights), *places.values()])
    matrix = np.einsum("ieq,jeq,eq->ij", terms, terms, weights)
    factors = np.linalg.solve(matrix, np.array(totals))
    by_totals = np.linalg.solve(matrix, np.einsum("ieq,eq,eq->i", terms, field, weights))
    force, fitted = (np.einsum("i,ieq->eq", one, terms) for one in (factors, by_totals))
    by_place = np.zeros((3, *weights.shape))
    for number, axis in enumerate(places, start=1):
        by_place[axis] = (field - fitted) * factors[number] - force * by_totals[number]
    return _Spread(force, by_totals, (field - fitted) * force, by_place)


def _pull(model: Elasticity, scene: Scene, side: int, lateral: Lateral) -> Array:
    """Return the nodal forces of what is fastened to one web, at 1 rad/s, N."""
    half = halves(scene)[side]
    elements = np.arange(model.mesh.nelements)
    (x, y, height), dx = load_points(model, elements)
    z = scene.pitch_mm - height if side else height
    seat = dx * _in_seat(half, y, z)
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


def _in_seat(half: Scene, y_mm: Array, z_mm: Array) -> Mask:
    low, high = half.web_z_mm
    return np.asarray((z_mm > low - _PLANE_MM) & (z_mm < high + _PLANE_MM) & (y_mm < _innermost_mm(half)))


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
