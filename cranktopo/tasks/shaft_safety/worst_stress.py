"""Stress of the worst point of a shaft over the crank angle: its signed equivalent, and in the surface."""

from __future__ import annotations

import math

import numpy as np

from cranktopo.base.arrays import Array
from cranktopo.tasks.fatigue.superposition import signed_von_mises
from cranktopo.tasks.shaft_safety.result import StressOverCycle
from cranktopo.tasks.throw_fatigue.result import CriticalPoint
from cranktopo.tasks.throw_fatigue.safety_field import FatigueField
from cranktopo.tasks.throw_fatigue.stress_model import Image

_SQUARE = 1e-3
"""Sine of the angle between a surface's normal and the crank axis below which a face is square to that."""
_DECIMALS = 3


def stress_over_cycle(field: FatigueField, loads: Array, angle_deg: Array) -> StressOverCycle:
    """Return the stress of the point of least safety of a throw in every state of its cycle.

    Args:
        loads: factor of each field in each state, (states, fields), as those that the field was judged in.
    """
    model = field.model
    judged = np.where(model.judged, field.safety, np.inf)
    number, node = (int(one) for one in np.unravel_index(int(judged.argmin()), judged.shape))
    image = model.images[number]
    stress = (loads * image.signs) @ model.stress.stress_MPa[:, node]  # (states, 6), in the model's axes
    axes = surface_axes(field.critical, _mirror(image) @ model.surface.normals[node])
    curves = signed_von_mises(stress), *in_surface(stress, axes * np.diagonal(_mirror(image)))
    signed, along, around, shear = (tuple(np.round(curve, _DECIMALS).tolist()) for curve in curves)
    return StressOverCycle(
        angle_deg=tuple(angle_deg.tolist()),
        signed_von_mises_MPa=signed,
        along_MPa=along,
        around_MPa=around,
        shear_MPa=shear,
        along=_direction(axes[0]),
        around=_direction(axes[1]),
    )


def surface_axes(point: CriticalPoint, normal: Array) -> Array:
    """Return unit vectors in the surface at a point, (2, 3): along a fillet's arc, and around the axis.

    Off the fillets the second one is square to the crank axis, on a face square to that across the throw.
    """
    if point.around_deg is not None:
        turn = math.radians(point.around_deg)
        around = np.array([math.cos(turn), -math.sin(turn), 0.0])
    else:
        around = np.array([-normal[1], normal[0], 0.0])
        size = float(np.linalg.norm(around))
        around = around / size if size > _SQUARE else np.array([1.0, 0.0, 0.0])
    around = around - (around @ normal) * normal  # normals of curved elements are off by a little
    around /= np.linalg.norm(around)
    return np.stack([np.cross(normal, around), around])


def in_surface(stress_MPa: Array, axes: Array) -> tuple[Array, Array, Array]:
    """Return the normal stresses along two axes (2, 3), and the shear stress, of states (n, 6), (n,) each."""
    xx, yy, zz, xy, yz, zx = stress_MPa.T
    tensor = np.array([[xx, xy, zx], [xy, yy, yz], [zx, yz, zz]])
    first, second = axes
    along, around, shear = (
        np.einsum("i,ijn,j->n", a, tensor, b) for a, b in ((first, first), (second, second), (first, second))
    )
    return along, around, shear


def _mirror(image: Image) -> Array:
    """Return the matrix by which an image mirrors the model, (3, 3)."""
    return np.diag([-1.0 if image.flip_x else 1.0, 1.0, -1.0 if image.flip_z else 1.0])


def _direction(axis: Array) -> tuple[float, float, float]:
    x, y, z = (float(value) for value in np.round(axis, 6))
    return x, y, z
