"""Stress on all planes through points, and the plane on which a criterion of shear and normal is worst.

The shear stress on a plane runs along a path in it; its amplitude is the radius of the smallest circle around
that path (K. Dang Van, ASTM STP 1191, 1993; I. V. Papadopoulos, Int. J. Fatigue 20, 1998).
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cranktopo.base.arrays import Array
from cranktopo.numerics.enclosing_balls import enclosing_balls

PlaneValue = Callable[[Array, Array], Array]
"""Value of a criterion from shear amplitude and largest normal stress; it rises with both."""

_PLANES = 300
"""Planes looked at first: their normals are some 8 degrees apart."""
_STARTS, _APART = 4, math.cos(math.radians(14.0))
"""Planes near which the worst one is looked for, and the cosine of the least angle between them."""
_ROUGH, _FINE = 4, 14
"""Halvings of the step about each of these planes, and about the best one: to 0.00003 degrees."""
_VALUES = 2**21
"""Stresses on planes at a time."""
_AROUND = np.array([(a, b) for a in (-1, 0, 1) for b in (-1, 0, 1) if (a, b) != (0, 0)], dtype=float)


@dataclass(frozen=True)
class WorstPlane:
    """The plane of each point with the largest value; arrays of shape (n,), normals (n, 3).

    Attributes:
        shear_MPa: radius of the smallest circle around the path of the shear stress.
        normal_MPa: largest normal stress.
    """

    value: Array
    normal: Array
    shear_MPa: Array
    normal_MPa: Array


def half_sphere(count: int) -> Array:
    """Return even directions (count, 3) over a half sphere: a Fibonacci lattice (A. Gonzalez, 2010)."""
    turn = math.pi * (3 - math.sqrt(5)) * np.arange(count)
    z = (np.arange(count) + 0.5) / count
    rim = np.sqrt(1 - z * z)
    return np.stack([rim * np.cos(turn), rim * np.sin(turn), z], axis=1)


def in_plane(normals: Array) -> tuple[Array, Array]:
    """Return two unit vectors (..., 3) that span the planes of unit normals (..., 3)."""
    least = np.eye(3)[np.abs(normals).argmin(axis=-1)]
    first = np.cross(normals, least)
    first /= np.linalg.norm(first, axis=-1, keepdims=True)
    return first, np.cross(normals, first)


def functionals(normals: Array) -> Array:
    """Return what makes normal stress and both shear stresses of planes of six components, (..., 3, 6)."""
    x, y, z = np.moveaxis(normals[..., None, :], -1, 0)
    u, v, w = np.moveaxis(np.stack([normals, *in_plane(normals)], axis=-2), -1, 0)
    return np.stack([u * x, v * y, w * z, u * y + v * x, v * z + w * y, w * x + u * z], axis=-1)


def on_planes(history: Array, normals: Array) -> tuple[Array, Array]:
    """Return normal stress (n, planes, states) and shear stress (n, planes, states, 2).

    Args:
        history: stress of n points in each state, shape (n, states, 6).
        normals: of all points (planes, 3), or of each (n, planes, 3).
    """
    weights = functionals(normals)
    flat = weights.reshape(*weights.shape[:-3], -1, 6)
    found = (history @ flat.swapaxes(-1, -2)).reshape(*history.shape[:2], -1, 3).transpose(0, 2, 1, 3)
    return found[..., 0], found[..., 1:]


def worst_planes(history: Array, value: PlaneValue) -> WorstPlane:
    """Return the plane of the largest value of each point, over all planes; history (n, states, 6)."""
    step = max(_VALUES // (3 * _PLANES * history.shape[1]), 1)
    parts = [_worst_planes(history[at : at + step], value) for at in range(0, len(history), step)]
    names = ("value", "normal", "shear_MPa", "normal_MPa")
    return WorstPlane(*(np.concatenate([getattr(part, name) for part in parts]) for name in names))


def _worst_planes(history: Array, value: PlaneValue) -> WorstPlane:
    normals = half_sphere(_PLANES)
    found = _starts(_on_even_planes(history, normals, value), normals)
    angle = math.sqrt(2 * math.pi / _PLANES)
    for halving in range(_ROUGH):
        found = _stepped(history, found, angle / 2**halving, value)
    found = _best(history, found, value)
    for halving in range(_ROUGH, _ROUGH + _FINE):
        found = _stepped(history, found, angle / 2**halving, value)
    shear, normal = _amplitudes(history, found)
    return WorstPlane(value(shear, normal)[:, 0], found[:, 0], shear[:, 0], normal[:, 0])


def _on_even_planes(history: Array, normals: Array, value: PlaneValue) -> Array:
    """Return the value on each plane that may have the largest one of its point, (n, planes); else -inf."""
    normal, shear = on_planes(history, normals)
    largest = normal.max(axis=2)
    least, most = _radius_between(shear)
    may = value(most, largest) >= value(least, largest).max(axis=1, keepdims=True)
    found = np.full(largest.shape, -np.inf)
    found[may] = value(enclosing_balls(shear[may])[1], largest[may])
    return found


def _radius_between(path: Array) -> tuple[Array, Array]:
    """Return bounds of the radius of the smallest circle, from the widths of the path (..., states, 2)."""
    x, y = path[..., 0], path[..., 1]
    across = [np.ptp(x, axis=-1), np.ptp(y, axis=-1)]
    aslant = [np.ptp(x + y, axis=-1) / math.sqrt(2), np.ptp(x - y, axis=-1) / math.sqrt(2)]
    least = np.maximum.reduce([*across, *aslant]) / 2
    most = np.minimum(np.hypot(*across), np.hypot(*aslant)) / 2
    return least * (1 - 1e-12), most * (1 + 1e-12)


def _starts(values: Array, normals: Array) -> Array:
    """Return the normals (n, starts, 3) of the largest values that are some way apart."""
    near = np.abs(normals @ normals.T) > _APART
    left, chosen = values.copy(), []
    for _ in range(_STARTS):
        best = left.argmax(axis=1)
        chosen.append(normals[best])
        left[near[best]] = -np.inf
    return np.stack(chosen, axis=1)


def _stepped(history: Array, normals: Array, angle: float, value: PlaneValue) -> Array:
    """Return for each normal (n, starts, 3) the best of itself and eight around it."""
    first, second = in_plane(normals)
    a, b = _AROUND.T[:, :, None] * angle
    around = normals[:, :, None] + a * first[:, :, None] + b * second[:, :, None]
    around /= np.linalg.norm(around, axis=-1, keepdims=True)
    tried = np.concatenate([normals[:, :, None], around], axis=2)
    found = _values(history, tried.reshape(len(history), -1, 3), value).reshape(tried.shape[:3])
    return np.asarray(np.take_along_axis(tried, found.argmax(axis=2)[..., None, None], axis=2)[:, :, 0])


def _best(history: Array, normals: Array, value: PlaneValue) -> Array:
    best: NDArray[np.intp] = _values(history, normals, value).argmax(axis=1)
    return np.asarray(np.take_along_axis(normals, best[:, None, None], axis=1))


def _values(history: Array, normals: Array, value: PlaneValue) -> Array:
    return value(*_amplitudes(history, normals))


def _amplitudes(history: Array, normals: Array) -> tuple[Array, Array]:
    """Return shear amplitude and largest normal stress (n, planes) on planes (n, planes, 3) of points."""
    normal, shear = on_planes(history, normals)
    radius = enclosing_balls(shear.reshape(-1, *shear.shape[2:]))[1]
    return radius.reshape(normal.shape[:2]), normal.max(axis=2)
