"""What a body-fitted evaluation tells of the quantities of a goal."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

from cranktopo.design.goal.wanted import wanted
from cranktopo.design.schema import Scene
from cranktopo.engine.cases import load_cases
from cranktopo.engine.plan.planning import plan


def goal_values(scene: Scene, found: Mapping[str, Any]) -> dict[str, float]:
    """The quantities that are known, each in its internal unit.

    Args:
        scene: with the engine whose loads move the throw.
        found: an entry of `evaluate --json`, with `fatigue_safety` where that was assessed.
    """
    supports, mass = found["supports"], found["mass_kg"]["throw"]
    torsion = found["torsion"][f"{supports['torsion']}_Nm_per_rad"]
    bending = found["bending"][f"{supports['bending']}_N_per_mm"]
    safety = found.get("fatigue_safety")
    return {
        "mass": mass,
        "inertia": found["inertia_kg_mm2"],
        "unbalance": found["unbalance_kg_mm"],
        "torsion": torsion,
        "bending": bending,
        "torsion_per_mass": torsion / mass,
        "bending_per_mass": bending / mass,
        **_motions(scene, torsion, bending),
        **({} if safety is None else {"fatigue_safety": safety}),
    }


def _motions(scene: Scene, torsion: float, bending: float) -> dict[str, float]:
    """Motions of the loads of the engine; none where the loads are unit loads."""
    if scene.engine is None:
        return {}
    cases = {case.kind: case for case in load_cases(scene, plan(scene, goal=wanted(scene)).enabled)}
    motions = {}
    if "bending" in cases:
        motions["pin_displacement"] = abs(cases["bending"].radial_N) / bending
    if "torsion" in cases:
        motions["twist"] = math.degrees(abs(cases["torsion"].torque_Nm) / torsion)
    return motions
