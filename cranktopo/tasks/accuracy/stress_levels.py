"""Levels of the peak stress in the fillets: element size there over the fillet's radius."""

from __future__ import annotations

import time
from collections.abc import Mapping

from cranktopo.base.machine import forget_peak_memory, peak_memory_MiB
from cranktopo.design.schema import Scene
from cranktopo.engine.cases import load_cases
from cranktopo.engine.plan.planning import plan
from cranktopo.numerics.tetrahedra.stress import von_mises
from cranktopo.tasks.fatigue.stress_model import solve_stresses
from cranktopo.tasks.fea.case_stress import UNIT_LOADS
from cranktopo.tasks.fea.level import FILLET_STRESS, STRESS, Level, PlannedLevel
from cranktopo.tasks.fea.targets import Target

FRACTIONS = (0.5, 0.35, 0.25, 0.17, 0.12)
"""Element sizes in the fillets over their radius; the rule IACS UR M53 asks for 0.25 at most."""
_COST_POWER = 1.8
"""Growth of a mesh's cost with the fineness of its fillets (`python -m tests.benchmarks.fatigue_mesh`)."""


def stress_levels(target: Target) -> list[PlannedLevel]:
    """Levels of a target, cheapest first; none where it has sharp fillets or the scene asks for no stress."""
    if not _calls_for_stress(target):
        return []

    def planned(fraction: float) -> PlannedLevel:
        return PlannedLevel(
            f"{fraction:g} of the radius", fraction**-_COST_POWER, lambda: _solve(target, fraction)
        )

    return [planned(fraction) for fraction in FRACTIONS]


def _calls_for_stress(target: Target) -> bool:
    scene = target.scene
    rounded = min(scene.throw.main_journal.fillet_mm, scene.throw.crankpin.fillet_mm) > 0
    return target.file is None and rounded and "fatigue" in plan(scene).enabled and bool(_factors(scene))


def _factors(scene: Scene) -> Mapping[str, float]:
    """Factor of the unit loads (1 N on the pin, 1 N mm) in the load cases of the scene."""
    cases = load_cases(scene, plan(scene).enabled)
    return {case.kind: UNIT_LOADS[case.kind](case) for case in cases if case.kind in ("bending", "torsion")}


def _solve(target: Target, fraction: float) -> Level:
    """Largest von Mises stress in the fillets under the load cases of the scene, one by one."""
    forget_peak_memory()
    began = time.perf_counter()
    factors = _factors(target.scene)
    found = solve_stresses(target, [kind for kind in ("bending", "torsion") if kind in factors], fraction)
    on_fillet = von_mises(found.stress.stress_MPa)[:, found.on_fillet].max(axis=1)
    worst = max(factors[kind] * float(peak) for kind, peak in zip(found.kinds, on_fillet, strict=True))
    return Level(
        study=FILLET_STRESS,
        name=f"fillet {fraction:g} r",
        family="fillet",
        settings={"fillet_fraction": fraction},
        size_mm=found.quality.fillet_size_mm,
        unknowns=3 * found.quality.nodes,
        seconds=time.perf_counter() - began,
        peak_memory_MiB=peak_memory_MiB(),
        values={STRESS: worst},
    )
