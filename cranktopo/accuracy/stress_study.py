"""The ladder of the peak stress in the fillets: element size there over the fillet's radius."""

from __future__ import annotations

import time
from collections.abc import Mapping

from cranktopo.accuracy.level import STRESS, Level
from cranktopo.accuracy.machine import PeakMemory
from cranktopo.effects import plan
from cranktopo.evaluate.equivalent import von_mises
from cranktopo.evaluate.stress_model import solve_stresses
from cranktopo.evaluate.targets import Target
from cranktopo.loads import load_cases
from cranktopo.scene import Scene
from cranktopo.units import NMM_PER_NM

LADDER = (0.5, 0.35, 0.25, 0.17, 0.12)
"""Element sizes in the fillets over their radius; the rule IACS UR M53 asks for 0.25 at most."""


def calls_for_stress(target: Target) -> bool:
    """Whether the scene wants the stress in fillets that have a radius."""
    scene = target.scene
    rounded = min(scene.throw.main_journal.fillet_mm, scene.throw.crankpin.fillet_mm) > 0
    return target.file is None and rounded and "fatigue" in plan(scene).enabled and bool(peaks(scene))


def peaks(scene: Scene) -> Mapping[str, float]:
    """Factor of the unit loads (1 N on the pin, 1 N mm) in the load cases of the scene."""
    cases = load_cases(scene, plan(scene).enabled)
    factors = {case.kind: case.radial_N or case.torque_Nm * NMM_PER_NM for case in cases}
    return {kind: factor for kind, factor in factors.items() if kind in ("bending", "torsion")}


def solve_stress_level(target: Target, fraction: float) -> Level:
    """Largest von Mises stress in the fillets under the load cases of the scene, one by one.

    Args:
        target: a design with fillets.
        fraction: element size in the fillets over their radius.

    Raises:
        CranktopoError: a failed mesh or solve.
    """
    memory, began = PeakMemory(), time.perf_counter()
    loads = peaks(target.scene)
    found = solve_stresses(target, [kind for kind in ("bending", "torsion") if kind in loads], fraction)
    on_fillet = von_mises(found.stress.stress_MPa)[:, found.on_fillet].max(axis=1)
    worst = max(loads[kind] * float(peak) for kind, peak in zip(found.kinds, on_fillet, strict=True))
    seconds = time.perf_counter() - began
    size = found.quality.fillet_size_mm
    return Level(
        ladder="fillet stress",
        name=f"fillet {fraction:g} r",
        family="fillet",
        settings={"fillet_fraction": fraction},
        size_mm=size,
        unknowns=3 * found.quality.nodes,
        seconds=seconds,
        peak_memory_MiB=memory.MiB,
        values={STRESS: worst},
        spent_seconds=seconds,
    )
