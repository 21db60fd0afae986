"""The line of safety 1 in the Haigh diagram of a critical point."""

from __future__ import annotations

import numpy as np

from cranktopo.base.arrays import Array
from cranktopo.tasks.fatigue.fkm import fkm
from cranktopo.tasks.fatigue.local_stress import LocalStress
from cranktopo.tasks.fatigue.safety_field import FatigueField, fkm_strength

_HALVINGS = 60


def haigh_limit_MPa(field: FatigueField, mean_MPa: Array) -> Array:
    """Amplitude that the critical point endures at given mean stresses, by the method of the assessment."""
    c, material = field.critical, field.model.scene.material
    if field.method == "lsa":
        return c.strength_MPa * (1 - np.maximum(mean_MPa, 0.0) / (material.ultimate_MPa or np.nan))
    amplitude = np.full(mean_MPa.shape, c.strength_MPa)
    for _ in range(_HALVINGS):  # the limit holds at a constant stress ratio: iterate to the point on the line
        stress = LocalStress(amplitude, mean_MPa, np.full(mean_MPa.shape, c.gradient_per_mm))
        amplitude = (amplitude + fkm(stress, fkm_strength(field.model.scene)).limit_MPa) / 2
    return amplitude
