"""Stress of the throws of a shaft with mass: the fields of the shaft without it, and those of inertia."""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from cranktopo.base.arrays import Array
from cranktopo.numerics.tetrahedra.stress import SurfaceStress
from cranktopo.tasks.dynamics.moving_shaft import MovingCycle
from cranktopo.tasks.dynamics.moving_throw import MovingThrow
from cranktopo.tasks.fatigue.shaft_stress import ShaftStress
from cranktopo.tasks.fatigue.stress_model import StressModel, stress_model

_LEAST_SHARE = 1e-4
"""Largest stress of a sum of fields over that of all sums, below which it is left out."""


def moving_stress(stress: ShaftStress, throw: MovingThrow, fillet_fraction: float) -> ShaftStress:
    """Return the stresses of a throw with those of its own inertia; times are those of what is added.

    Args:
        fillet_fraction: of its mesh.
    """
    begin = time.perf_counter()
    fields, body, model = throw.inertial_fields(), stress.body, stress.model
    more = stress_model(model.name, model.scene, body.meshed, body.model, fields, fillet_fraction)
    rows, columns = stress.shares.shape
    shares = np.zeros((rows + len(fields), columns + len(fields)))
    shares[:rows, :columns] = stress.shares
    shares[rows:, columns:] = np.eye(len(fields))
    return ShaftStress(body, _joined(model, more), shares, (0.0, 0.0, time.perf_counter() - begin))


def _joined(one: StressModel, other: StressModel) -> StressModel:
    """Return a model with the fields of two on the same surface."""
    stress = SurfaceStress(
        *(
            np.concatenate([getattr(model.stress, name) for model in (one, other)])
            for name in ("stress_MPa", "depth_MPa_per_mm", "jump_MPa")
        )
    )
    images = tuple(
        replace(first, signs=np.concatenate([first.signs, second.signs]))
        for first, second in zip(one.images, other.images, strict=True)
    )
    return replace(one, kinds=(*one.kinds, *other.kinds), stress=stress, images=images)


def moving_factors(throws: Sequence[ShaftStress], cycle: MovingCycle) -> list[Array]:
    """Return the factors of the fields of every throw over a cycle, (states, fields) each.

    Args:
        throws: as of `moving_stress`.
    """
    return [one.loads(states) for one, states in zip(throws, cycle.strains, strict=True)]


def with_fewer_fields(model: StressModel, loads: Sequence[Array]) -> tuple[StressModel, list[Array]]:
    """Return a model whose fields are few sums of those of another, and the factors of these.

    Fields of one symmetry are summed along the axes in which their factors swing most; those that add less
    than a ten-thousandth of the largest stress are left out. Inertia strains a throw in many ways at once,
    most of them little, and the cost of the safety grows with the square of the number of fields.

    Args:
        loads: factors of the fields in all states, (..., fields) each.
    """
    size = np.sqrt((model.stress.stress_MPa**2).sum(axis=2)).max(axis=1)
    signs = np.stack([image.signs for image in model.images], axis=1)
    every = np.concatenate([one.reshape(-1, len(size)) for one in loads]) * size
    axes: list[Array] = []
    for symmetry in np.unique(signs, axis=0):
        own = np.flatnonzero((signs == symmetry).all(axis=1))
        turned = np.zeros((len(size), len(own)))
        turned[own] = np.linalg.eigh(every[:, own].T @ every[:, own])[1]
        axes.append(turned)
    way = np.hstack(axes)
    largest = np.abs(every @ way).max(axis=0)
    way = way[:, largest > _LEAST_SHARE * largest.max()]
    sums = (way / size[:, None]).T
    found = model.stress
    stress = SurfaceStress(
        np.tensordot(sums, found.stress_MPa, axes=1),
        np.tensordot(sums, found.depth_MPa_per_mm, axes=1),
        np.abs(sums) @ found.jump_MPa,
    )
    first = np.abs(way).argmax(axis=0)
    images = tuple(replace(image, signs=image.signs[first]) for image in model.images)
    fewer = replace(model, kinds=tuple(model.kinds[i] for i in first), stress=stress, images=images)
    return fewer, [np.ascontiguousarray(one @ (size[:, None] * way)) for one in loads]
