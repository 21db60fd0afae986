"""The limits of a design's goal by the evaluation: the optimiser's own model has not the last word."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

from cranktopo.effects import plan
from cranktopo.evaluate.evaluation import Evaluation
from cranktopo.evaluate.targets import Target
from cranktopo.loads import load_cases
from cranktopo.report.comparison import Entry
from cranktopo.scene import Scene
from cranktopo.scene.goal.outcome import goal_json
from cranktopo.scene.goal.wanted import wanted


def evaluated_goals(
    targets: Sequence[Target], entries: Sequence[Entry], baseline: int
) -> dict[str, dict[str, Any]]:
    """Goal and limits of every target that has a goal, but for the baseline, by name of the target.

    Args:
        entries: of the targets, in their order; percent are of the baseline's values.
    """
    original = evaluated_values(targets[baseline].scene, entries[baseline])
    found = {}
    for row, (target, entry) in enumerate(zip(targets, entries, strict=True)):
        goal = wanted(target.scene)
        if goal is not None and row != baseline:
            found[target.name] = goal_json(goal, evaluated_values(target.scene, entry), original)
    return found


def evaluated_values(scene: Scene, entry: Entry) -> dict[str, float]:
    """What an evaluation tells of the quantities of a goal, each in its internal unit."""
    found = entry.evaluation
    torsion, bending, mass = found.torsion_Nm_per_rad, found.bending_N_per_mm, found.throw_kg
    return {
        "mass": mass,
        "inertia": found.inertia_kg_mm2,
        "unbalance": found.unbalance_kg_mm,
        "torsion": torsion,
        "bending": bending,
        "torsion_per_mass": torsion / mass,
        "bending_per_mass": bending / mass,
        **_motions(scene, found),
        **({} if entry.safety is None else {"fatigue_safety": entry.safety}),
    }


def _motions(scene: Scene, found: Evaluation) -> dict[str, float]:
    """Motions of the loads of the engine; none where the loads are unit loads."""
    if scene.engine is None:
        return {}
    cases = {case.kind: case for case in load_cases(scene, plan(scene, goal=wanted(scene)).enabled)}
    motions = {}
    if "bending" in cases:
        motions["pin_displacement"] = abs(cases["bending"].radial_N) / found.bending_N_per_mm
    if "torsion" in cases:
        motions["twist"] = math.degrees(abs(cases["torsion"].torque_Nm) / found.torsion_Nm_per_rad)
    return motions
