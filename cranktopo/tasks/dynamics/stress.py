"""Stress of the throws of a shaft with mass: the fields of the shaft without it, and those of inertia."""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from cranktopo.base.arrays import Array
from cranktopo.numerics.tetrahedra.stress import joined
from cranktopo.tasks.dynamics.moving_shaft import MovingCycle
from cranktopo.tasks.dynamics.moving_throw import MovingThrow
from cranktopo.tasks.shaft.assembly import SECTIONS
from cranktopo.tasks.shaft.loaded_throw import ACTING, SWING
from cranktopo.tasks.throw_fatigue.shaft_stress import ShaftStress
from cranktopo.tasks.throw_fatigue.stress_model import StressModel, stress_model


def moving_stress(stress: ShaftStress, throw: MovingThrow, fillet_fraction: float) -> ShaftStress:
    """Return the stresses of a throw with those of its own inertia; times are those of what is added.

    Args:
        fillet_fraction: of its mesh.
    """
    begin = time.perf_counter()
    fields, body, model = throw.inertial_fields(), stress.body, stress.model
    more = stress_model(model.name, model.scene, body.meshed, body.model, fields, fillet_fraction)
    still = np.delete(stress.shares, SECTIONS + ACTING.index(SWING), axis=1)  # a load of the inertia of disks
    rows, columns = still.shape
    shares = np.zeros((rows + len(fields), columns + len(fields)))
    shares[:rows, :columns] = still
    shares[rows:, columns:] = np.eye(len(fields))
    return ShaftStress(body, _joined(model, more), shares, (0.0, 0.0, time.perf_counter() - begin))


def _joined(one: StressModel, other: StressModel) -> StressModel:
    """Return a model with the fields of two on the same surface."""
    stress = joined([one.stress, other.stress])
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
