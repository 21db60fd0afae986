"""The bare crankshaft as disks and springs: torsional natural frequencies and the model for openTorsion."""

from __future__ import annotations

from cranktopo.base.units import MM2_PER_M2
from cranktopo.design.schema import Scene
from cranktopo.engine.vibration.shaft_chain import moving_inertia_kg_mm2
from cranktopo.numerics.disk_chain import DiskChain


def disk_model(scene: Scene, throw_inertia_kg_mm2: float, throws_Nm_per_rad: tuple[float, ...]) -> DiskChain:
    """Half of each throw's inertia in either of its mid-journal sections, throws as springs.

    To a throw's own inertia come the rotating rod mass and the mean of the reciprocating mass.
    """
    inertia = (throw_inertia_kg_mm2 + moving_inertia_kg_mm2(scene)) / MM2_PER_M2
    ends, inner = inertia / 2, len(throws_Nm_per_rad) - 1
    return DiskChain((ends, *[inertia] * inner, ends), throws_Nm_per_rad)
