"""The bare crankshaft as disks and springs: torsional natural frequencies and the model for openTorsion."""

from __future__ import annotations

import numpy as np

from cranktopo.base.units import MM2_PER_M2
from cranktopo.design.schema import Scene
from cranktopo.engine.vibration.end_chain import end_chain
from cranktopo.engine.vibration.shaft_chain import moving_inertia_kg_mm2
from cranktopo.numerics.disk_chain import DiskChain


def disk_model(
    scene: Scene, throw_inertia_kg_mm2: float | tuple[float, ...], throws_Nm_per_rad: tuple[float, ...]
) -> DiskChain:
    """Half of each throw's inertia in either of its mid-journal sections, throws as springs.

    To a throw's own inertia come the rotating rod mass and the mean of the reciprocating mass. Ends of the
    crank add a spring and a disk each.
    """
    count = len(throws_Nm_per_rad)
    whole = (np.array(throw_inertia_kg_mm2) + moving_inertia_kg_mm2(scene)) / MM2_PER_M2
    half = np.broadcast_to(whole, (count,)) / 2
    inertia = [float(half[0]), *(half[:-1] + half[1:]).tolist(), float(half[-1])]
    stiffness = list(throws_Nm_per_rad)
    free, output = end_chain(scene, "free", 0.0), end_chain(scene, "output", 0.0)
    if output is not None:
        inertia = [*inertia[:-1], inertia[-1] + output.inner_kg_m2, output.tip_kg_m2]
        stiffness.append(output.stiffness_Nm_per_rad)
    if free is not None:
        inertia = [free.tip_kg_m2, inertia[0] + free.inner_kg_m2, *inertia[1:]]
        stiffness.insert(0, free.stiffness_Nm_per_rad)
    return DiskChain(tuple(inertia), tuple(stiffness))
