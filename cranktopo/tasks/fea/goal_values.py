"""What a body-fitted evaluation tells of the quantities of a goal."""

from __future__ import annotations

import math

from cranktopo.design.goal.wanted import wanted
from cranktopo.design.schema import Scene
from cranktopo.engine.plan.planning import plan
from cranktopo.engine.states import load_cases
from cranktopo.tasks.fea.result import EvaluationResult


def goal_values(scene: Scene, found: EvaluationResult) -> dict[str, float]:
    """Return the quantities that are known, each in its internal unit.

    Args:
        scene: with the engine whose loads move the throw.
        found: with the fatigue safety where that was assessed.
    """
    mass, torsion, bending = found.mass_kg.throw, found.torsion_Nm_per_rad, found.bending_N_per_mm
    safety = found.fatigue_safety
    return {
        "mass": mass,
        "inertia": found.inertia_kg_mm2,
        "unbalance": found.unbalance_kg_mm,
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
