"""Accuracy studies of a design: levels solved from cheap to fine until a time budget is used."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass

from cranktopo.base.errors import CranktopoError
from cranktopo.base.machine import Machine, forget_peak_memory, peak_memory_MiB, this_machine
from cranktopo.base.notes import bar, note
from cranktopo.bodies.mesh.solid_mesh import serves_polynomials
from cranktopo.design.halves import difference
from cranktopo.design.schema import Scene
from cranktopo.engine.plan.planning import plan
from cranktopo.engine.states import load_cases
from cranktopo.numerics.tetrahedra.stress import von_mises
from cranktopo.tasks.throw_fatigue.stress_model import solve_stresses
from cranktopo.tasks.throw_fea.levels import evaluation_levels
from cranktopo.tasks.throw_fea.studies import (
    EVALUATION,
    FILLET_STRESS,
    OPTIMISER,
    STRESS,
    TITLES,
    Level,
    PlannedLevel,
    StudyName,
)
from cranktopo.tasks.throw_fea.targets import Target
from cranktopo.tasks.throw_fea.unit_fields import UNIT_LOADS, FieldKind

_FRACTIONS = (0.5, 0.35, 0.25, 0.17, 0.12)
"""Element sizes in the fillets over their radius; the rule IACS UR M53 asks for 0.25 at most."""
_JUDGED: tuple[FieldKind, ...] = ("bending", "torsion")
_COST_POWER = 1.8
"""Growth of a mesh's cost with the fineness of its fillets (`python -m tests.benchmarks.fatigue_mesh`)."""


def _stress_levels(target: Target) -> list[PlannedLevel]:
    """Return levels, cheapest first; none with sharp fillets or where the scene asks for no stress."""
    if not _calls_for_stress(target):
        return []

    def planned(fraction: float) -> PlannedLevel:
        return PlannedLevel(
            f"{fraction:g} of the radius", fraction**-_COST_POWER, lambda: _solve(target, fraction)
        )

    return [planned(fraction) for fraction in _FRACTIONS]


def _calls_for_stress(target: Target) -> bool:
    scene = target.scene
    rounded = min(scene.throw.main_journal.fillet_mm, scene.throw.crankpin.fillet_mm) > 0
    return target.file is None and rounded and "fatigue" in plan(scene).enabled and bool(_factors(scene))


def _factors(scene: Scene) -> Mapping[FieldKind, float]:
    cases = {case.kind: case for case in load_cases(scene, plan(scene).enabled)}
    return {kind: UNIT_LOADS[kind](cases[kind]) for kind in _JUDGED if kind in cases}


def _solve(target: Target, fraction: float) -> Level:
    """Largest von Mises stress in the fillets under the load cases of the scene, one by one."""
    forget_peak_memory()
    began = time.perf_counter()
    factors = _factors(target.scene)
    found = solve_stresses(target, [kind for kind in _JUDGED if kind in factors], fraction)
    on_fillet = von_mises(found.stress.stress_MPa)[:, found.on_fillet].max(axis=1)
    worst = max(factors[kind] * float(peak) for kind, peak in zip(found.kinds, on_fillet, strict=True))
    return Level(
        study=FILLET_STRESS,
        name=f"fillet {fraction:g} r",
        family="fillet" if serves_polynomials(fraction) else "coarse fillet",  # stresses by other means
        settings={"fillet_fraction": fraction},
        size_mm=found.quality.fillet_size_mm,
        unknowns=3 * found.quality.nodes,
        seconds=time.perf_counter() - began,
        peak_memory_MiB=peak_memory_MiB(),
        values={STRESS: worst},
    )


_SHARES = {EVALUATION: 0.35, FILLET_STRESS: 0.2, OPTIMISER: 1.0}
"""Share of what is left of the budget that a study may use, in this order; the last one takes all."""


@dataclass(frozen=True)
class Study:
    """All levels that a budget allowed, in the order of solving; `failures` has a sentence per failed one."""

    design: str
    budget_s: float
    spent_s: float
    machine: Machine
    levels: tuple[Level, ...]
    failures: tuple[str, ...]
    interrupted: bool


def planned_studies(target: Target) -> dict[StudyName, list[PlannedLevel]]:
    """Return the studies that a target calls for; a surface file has only that of the evaluation."""
    found: dict[StudyName, list[PlannedLevel]] = {EVALUATION: evaluation_levels(target)}
    found[FILLET_STRESS] = _stress_levels(target)
    if target.file is None and target.scene.envelope is not None and not difference(target.scene):
        from cranktopo.tasks.accuracy.optimiser_levels import optimiser_levels

        found[OPTIMISER] = optimiser_levels(target.scene)
    return {name: levels for name, levels in found.items() if levels}


def run_studies(target: Target, budget_s: float) -> Study:
    """Solve level after level within a wall time; Ctrl-C ends it early and keeps what is done."""
    began = time.perf_counter()
    machine = this_machine()
    levels: list[Level] = []
    failures = _left_out(target)

    def spent_s() -> float:
        return time.perf_counter() - began

    def run(name: StudyName, planned: Sequence[PlannedLevel], share: float) -> None:
        def announce(text: str) -> None:
            spent = spent_s()
            note(f"{bar(spent, budget_s)} {spent:.0f} of {budget_s:g} s: {TITLES[name]}, {text}")

        if spent_s() < budget_s:
            for found in _solved(planned, share * (budget_s - spent_s()), announce):
                if isinstance(found, Level):
                    levels.append(found)
                else:
                    failures.append(f"{TITLES[name]}, {found}")

    interrupted = False
    try:
        studies = planned_studies(target)
        for name, planned in studies.items():
            run(name, planned, 1.0 if name == list(studies)[-1] else _SHARES[name])
    except KeyboardInterrupt:
        interrupted = True
    return Study(target.name, budget_s, spent_s(), machine, tuple(levels), tuple(failures), interrupted)


def _left_out(target: Target) -> list[str]:
    key = difference(target.scene)
    return [f"{TITLES[OPTIMISER]}: models half of a throw, and {key} makes its halves differ"] if key else []


def _solved(
    planned: Sequence[PlannedLevel], allowed_s: float, announce: Callable[[str], None]
) -> Iterator[Level | str]:
    """Solved levels, or why one failed, until the next would not fit; the first is always tried."""
    start, rate = time.perf_counter(), None
    for number, level in enumerate(planned):
        began = time.perf_counter()
        guess = None if rate is None else rate * level.cost
        if number > 0 and began - start + (guess or 0.0) > allowed_s:
            longer = "" if guess is None else f" takes about {guess:.2g} s,"
            announce(f"{level.name}{longer} more than is left of its {allowed_s:.2g} s: give a larger budget")
            return
        announce(level.name + ("" if guess is None else f", about {guess:.2g} s"))
        try:
            found = level.solve()
        except CranktopoError as error:
            yield f"{level.name}: {error}"
            continue
        rate = (time.perf_counter() - began) / level.cost
        yield found
