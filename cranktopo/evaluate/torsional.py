"""The shaft as disks and springs: torsional natural frequencies and the model for openTorsion."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from cranktopo.scene import Scene
from cranktopo.units import MM2_PER_M2


@dataclass(frozen=True)
class DiskModel:
    """Disks joined by massless springs.

    Attributes:
        stiffness_Nm_per_rad: of the spring after each disk but the last.
    """

    inertia_kg_m2: tuple[float, ...]
    stiffness_Nm_per_rad: tuple[float, ...]

    def natural_frequencies_Hz(self) -> tuple[float, ...]:
        """Natural frequencies above the rigid rotation, Hz, rising."""
        disks = len(self.inertia_kg_m2)
        matrix = np.zeros((disks, disks))
        for i, k in enumerate(self.stiffness_Nm_per_rad):
            matrix[i : i + 2, i : i + 2] += k * np.array([[1.0, -1.0], [-1.0, 1.0]])
        scale = 1.0 / np.sqrt(self.inertia_kg_m2)
        squares = np.linalg.eigvalsh(matrix * np.outer(scale, scale))
        return tuple(float(math.sqrt(max(s, 0.0)) / (2 * math.pi)) for s in squares[1:])

    def as_opentorsion(self) -> dict[str, Any]:
        """Arguments of openTorsion's `Disk(node, I)` and `Shaft(nl, nr, k=..., I=0)`, SI units.

        All inertia sits in the disks: openTorsion 0.3.2 takes an inertia given with `k` six times too large.
        """
        return {
            "disks": [{"node": i, "I": inertia} for i, inertia in enumerate(self.inertia_kg_m2)],
            "shafts": [
                {"nl": i, "nr": i + 1, "k": k, "I": 0.0} for i, k in enumerate(self.stiffness_Nm_per_rad)
            ],
        }


def disk_model(scene: Scene, throw_inertia_kg_mm2: float, throws_Nm_per_rad: tuple[float, ...]) -> DiskModel:
    """Half of each throw's inertia in either of its mid-journal sections, throws as springs.

    To a throw's own inertia come the rotating rod mass and half the reciprocating mass at the throw radius
    (the usual mean of a slider crank; Ker Wilson, Practical Solution of Torsional Vibration Problems).
    """
    moving = 0.0
    if scene.engine is not None:
        engine = scene.engine
        moving_kg = engine.rods_per_pin * (engine.rod_rotating_kg + engine.reciprocating_kg / 2)
        moving = moving_kg * scene.throw.radius_mm**2
    inertia = (throw_inertia_kg_mm2 + moving) / MM2_PER_M2
    ends, inner = inertia / 2, len(throws_Nm_per_rad) - 1
    return DiskModel((ends, *[inertia] * inner, ends), throws_Nm_per_rad)
