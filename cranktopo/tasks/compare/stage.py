"""Several targets beside a baseline: evaluated, fatigue assessed, and everything that their page shows."""

from __future__ import annotations

import shlex
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from cranktopo.base.errors import CranktopoError, ExitCode
from cranktopo.base.files import as_path
from cranktopo.base.notes import note
from cranktopo.base.units import plain_number
from cranktopo.bodies.cells.outside import outside_envelope, outside_words
from cranktopo.bodies.prisms import with_bolted
from cranktopo.bodies.solid.files import coarse_facet_mm
from cranktopo.bodies.undercuts import half_throw_undercuts
from cranktopo.design.goal.balance_moved import MovedBalance, balance_moved, balance_quantities
from cranktopo.design.goal.outcome import GoalOutcome, goal_outcome
from cranktopo.design.goal.scene_goal import asks_for, goal_of
from cranktopo.design.halves import difference, halves
from cranktopo.design.pitch import SAME_PITCH_MM
from cranktopo.design.schema import Scene
from cranktopo.engine.analysis import analyse
from cranktopo.engine.balance.throw import throw_balance
from cranktopo.engine.histories import HistoryKind
from cranktopo.engine.load_case import LoadCase
from cranktopo.engine.plan.effect import PhysicsPlan
from cranktopo.engine.plan.planning import plan, plan_for_stress, with_own_reasons
from cranktopo.engine.plan.simulated import strip_features
from cranktopo.engine.states import load_cases
from cranktopo.numerics.surfaces.mesh import SurfaceMesh, shell_volumes_mm3
from cranktopo.report.report_file import check_report_path, write_report
from cranktopo.report.viewer.scene3d import PARTNERS, ShownBody
from cranktopo.runs.manifest import file_hash, settings_hash, timestamp, versions
from cranktopo.tasks.bound.result import AnyBound
from cranktopo.tasks.bound.stage import bounds_for_result
from cranktopo.tasks.compare.judged import judge
from cranktopo.tasks.compare.page import ComparisonRecord, comparison_page
from cranktopo.tasks.compare.picks import with_picks
from cranktopo.tasks.compare.result import Comparison, Entry, Fillets, check_same_supports, compare
from cranktopo.tasks.compare.text import fillet_lines
from cranktopo.tasks.extraction.text import DesignUndercuts
from cranktopo.tasks.importing.imported_body import half_surfaces
from cranktopo.tasks.shaft.stage import with_throw_stiffness
from cranktopo.tasks.throw_fatigue.assessment import FatigueMethod
from cranktopo.tasks.throw_fatigue.result import FieldFatigue, JudgedAs
from cranktopo.tasks.throw_fatigue.stress_mesh import RULE_FRACTION
from cranktopo.tasks.throw_fatigue.text import FatigueComparison
from cranktopo.tasks.throw_fea.mirrored_webs import counted_alike
from cranktopo.tasks.throw_fea.quantities import BENDING, MASS, TORSION, TORSION_PER_MASS, goal_values
from cranktopo.tasks.throw_fea.stage import MeshRequest, evaluate_targets
from cranktopo.tasks.throw_fea.targets import Target, TargetLike, resolve_targets
from cranktopo.tasks.throw_fea.unit_fields import case_stress
from cranktopo.tasks.vibration.stage import first_frequency_Hz


@dataclass(frozen=True)
class ComparedTargets:
    """A comparison, its targets in the same order, and those that miss the accuracy asked for.

    Attributes:
        loaded: the baseline's scene as its fatigue was assessed; None where it was not.
    """

    comparison: Comparison
    targets: tuple[Target, ...]
    missed: tuple[str, ...] = ()
    loaded: Scene | None = None


def compare_targets(
    names: Sequence[TargetLike],
    baseline: TargetLike,
    request: MeshRequest | None = None,
    fatigue: FatigueMethod | Sequence[FatigueMethod] | None = None,
    design: str | None = None,
    align: bool = False,
    loads: HistoryKind = "extremes",
    throw: int | None = None,
    fillet_fraction: float | None = None,
) -> ComparedTargets:
    """Evaluate targets beside a baseline, and assess their fatigue where methods are given.

    Args:
        names: scenes, targets, or paths and names as the user types them, of a sweep those picked out of it;
            the baseline is put before them where it is not among them.
        fatigue: one method or several; goals and limits take the safety by the first.
        design: design for the journals of STL and STEP files.
        align: whether STL and STEP bodies that lie elsewhere are moved to where the journals are.
        loads: of the fatigue, extremes of the loads joined, or every angle of the cycle.
        throw: number of the throw taken of cranks with different ones; by default the worst loaded.
        fillet_fraction: of the fatigue, element size in a fillet over its radius.

    Raises:
        CranktopoError: no such target, different supports, a method that can judge none, or a failed solve.
    """
    picked = with_picks(names)
    every = picked if baseline in picked else [baseline, *picked]
    index = every.index(baseline)
    resolved = resolve_targets(every, design, align=align, whole=True, throw=throw)
    designed, mirrored = counted_alike(every, resolved)
    targets = _like_for_like(designed)
    check_same_supports((target.scene.supports.torsion, target.scene.supports.bending) for target in targets)
    bare = tuple(target.name for target in targets if target.run)
    pitches = tuple(pitch_lines(targets, index))
    for line in (*filter(None, [mirrored]), *fillet_lines(bare), *pitches):
        note(line)
    methods = list(dict.fromkeys([fatigue] if isinstance(fatigue, str) else fatigue or ()))
    fatigues: list[FatigueComparison] = []
    loaded = None
    if methods:
        resolved = resolve_targets(every, design, fillets=True, align=align, whole=True, throw=throw)
        designed, _ = counted_alike(every, resolved, fillets=True)
        fatigues, loaded = judge(designed, methods, index, loads, fillet_fraction or RULE_FRACTION)
    throws_alone = [replace(target, flying=()) for target in targets]  # a comparison shows no flying web
    found = evaluate_targets(throws_alone, request)
    judged = (one for by in fatigues for one in by.result.fatigue if isinstance(one, FieldFatigue))
    stresses = {one.target: one.largest_stress_MPa for one in judged}
    worlds = _both_worlds(fatigues[:1])
    entries = []
    for row, (evaluation, target) in enumerate(zip(found.evaluations, targets, strict=True)):
        printed = None if target.file else target.scene.published
        safeties = {one.result.method: one.safeties[row] for one in fatigues}
        first = safeties.pop(methods[0]) if methods else None
        others = {method: safety for method, safety in safeties.items() if safety is not None}
        fillets, stress = _fillets(target, bool(bare)), stresses.get(target.name)
        entries.append(
            Entry(evaluation, printed, first, others, fillets, stress, worlds.get(target.name, {}))
        )
    comparison = compare(entries, entries[index].name, fatigues[0] if fatigues else None, fatigues[1:])
    comparison = replace(
        comparison,
        bare=bare,
        mirrored=mirrored,
        pitch_mm=tuple(target.scene.pitch_mm for target in targets) if pitches else (),
        pitches=pitches,
        goals=_evaluated_goals(targets, designed, entries, index),
        balance=_moved_balance(targets, entries, index),
        balanced_kg_mm=balanced_kg_mm(targets[index].scene),
    )
    return ComparedTargets(comparison, tuple(targets), found.missed, loaded)


def _both_worlds(fatigues: Sequence[FatigueComparison]) -> dict[str, dict[JudgedAs, float]]:
    """Return the safety of a throw alone and in its shaft by the name of each target that has both."""
    judged = (one for by in fatigues for one in by.result.fatigue if isinstance(one, FieldFatigue))
    return {one.target: one.safety_as for one in judged if one.safety_as}


def pitch_lines(targets: Sequence[Target], baseline: int) -> list[str]:
    """Return a line for every target whose throws are farther apart, or closer, than the baseline's."""
    base, lines = targets[baseline], list[str]()
    for target in targets:
        longer = target.scene.pitch_mm - base.scene.pitch_mm
        if abs(longer) > SAME_PITCH_MM:
            own, its, change = (
                plain_number(mm, 6) for mm in (target.scene.pitch_mm, base.scene.pitch_mm, -longer)
            )
            lines.append(
                f"{target.name}: pitch {own} mm, {base.name} has {its} mm: the engine is "
                f"{'longer' if longer > 0 else 'shorter'}. To keep the pitch change "
                f"throw.main_journal.length_mm or throw.crankpin.length_mm by {change} mm."
            )
    return lines


def balanced_kg_mm(scene: Scene) -> float:
    """Return the unbalance that is wanted of a throw: with the engine's rods no counterweight is missing.

    A goal that minimises the unbalance of the throw alone wants 0.
    """
    goal, balance = goal_of(scene), throw_balance(scene)
    if goal is not None and goal.quantity == "unbalance":
        return 0.0
    return balance.throw_unbalance_kg_mm - balance.counterweight_kg_mm


def _like_for_like(targets: Sequence[Target]) -> list[Target]:
    """Return the targets without fillets where one is the surface of a run, which has none."""
    if not any(target.run for target in targets):
        return list(targets)
    return [
        target if target.file else replace(target, scene=strip_features(target.scene, "fillets"))
        for target in targets
    ]


def _fillets(target: Target, left_out: bool) -> Fillets:
    if target.file is not None:
        return "none" if target.run else "as in the file"
    return "left out" if left_out else "as designed"


def _evaluated_goals(
    targets: Sequence[Target], designed: Sequence[Target], entries: Sequence[Entry], baseline: int
) -> dict[str, GoalOutcome]:
    """Return what became of each goal, as `designed`: without fillets a design has no safety to limit."""
    own = {row: target.scene for row, target in enumerate(designed) if row != baseline}
    swings = any(asks_for(scene, "natural_frequency") for scene in own.values())
    values = [_values(*pair, swings=swings) for pair in zip(targets, entries, strict=True)]
    goals = {row: goal_of(scene) for row, scene in own.items()}
    return {
        targets[row].name: goal_outcome(goal, values[row], values[baseline])
        for row, goal in goals.items()
        if goal is not None
    }


def _moved_balance(
    targets: Sequence[Target], entries: Sequence[Entry], baseline: int
) -> dict[str, MovedBalance]:
    """Return where the balance factor of the baseline's engine went, as a run of `optimise` tells it."""
    base, original = targets[baseline], _balance(entries[baseline])
    found = {
        target.name: balance_moved(
            base.scene.model_copy(update={"goal": target.scene.goal}), _balance(entry), original, base.name
        )
        for target, entry in zip(targets, entries, strict=True)
    }
    return {name: moved for name, moved in found.items() if moved}


def _balance(entry: Entry) -> dict[str, float]:
    return balance_quantities(entry.evaluation.unbalance_kg_mm, entry.evaluation.balance_factor_percent)


def _values(target: Target, entry: Entry, *, swings: bool) -> dict[str, float]:
    """Return the quantities of a goal that are known of a target; where it `swings`, with its frequency."""
    replaced = {
        "fatigue_safety": entry.safety,
        "stress_MPa": entry.stress_MPa,
        "natural_frequency_Hz": _frequency_Hz(target) if swings else None,
    }
    return goal_values(target.scene, entry.evaluation.result.model_copy(update=replaced))


def _frequency_Hz(target: Target) -> float | None:
    """Return the first natural frequency of a target's shaft; None where the target does not tell it."""
    try:
        return first_frequency_Hz(target)
    except CranktopoError as error:
        if error.code == ExitCode.INTERRUPTED:
            raise
        note(f"{target.name}: no natural frequency: {error.message}")
        return None


def comparison_bound(compared: ComparedTargets) -> AnyBound | None:
    """Return what no web of the envelope can beat, beside the web that is stiffest in torsion per mass.

    None where the baseline is no design with an envelope, the targets have other throws or envelopes, the
    halves of one differ, or the design's effects leave the bound out.
    """
    comparison, scene = compared.comparison, compared.targets[compared.comparison.baseline].scene
    if why := _no_bound(compared):
        note(f"no bound: {why}")
        return None
    best = comparison.leading(TORSION_PER_MASS)
    reached = {quantity.key: comparison.percent(best, quantity) for quantity in (MASS, TORSION, BENDING)}
    for words in filter(None, [outside_words(outside_envelope(scene))]):
        note(f"{scene.name}: {words}")
    return bounds_for_result(scene, reached, None)


def _no_bound(compared: ComparedTargets) -> str:
    """Return why a comparison has no bound; empty where it has one.

    A run has the throw of the design that it was started with, which the planned scenes may have stripped.
    """
    base = compared.targets[compared.comparison.baseline]
    if base.file is not None:
        return f"the baseline, {base.name}, is no design with an envelope"
    own = base.design or base.scene
    for target in compared.targets:
        scene = target.design or target.scene
        for name in ("throw", "envelope"):
            if getattr(scene, name) != getattr(own, name):
                return f"{target.name} has another {name} than the baseline"
        if key := difference(target.scene):
            return f"the halves of {target.name} differ ({key})"
    effect = plan(base.scene)["bound"]
    return (effect.reason or "switched off") if effect.state == "off" else ""


def report_comparison(
    compared: ComparedTargets,
    path: Path | str,
    command: Sequence[str] = (),
    stresses: bool = False,
    bound: AnyBound | None = None,
) -> None:
    """Write the page of a comparison as HTML or Markdown, with the `bound` drawn over the mass.

    With `stresses` all are solved for the baseline's load cases, unless the halves of one differ.
    """
    path = as_path(path)
    check_report_path(path)
    scene, effects = _loaded(compared)
    effects = with_own_reasons(effects, compared.targets[compared.comparison.baseline].design)
    cases = load_cases(scene, effects.enabled)
    if compared.comparison.bare:
        effects = _without_fillets(effects)
    if bound is None and (why := _no_bound(compared)):
        effects = _with_effect(effects, "bound", {"state": "off", "reason": why})
    refused = _no_stresses(compared.targets)
    if stresses and refused:
        note(f"no stresses: {refused}")
    solved = cases if stresses and not refused else ()
    half_bodies = [half for target in compared.targets for half in half_throws(target)]
    record = ComparisonRecord(
        comparison=compared.comparison,
        bodies=tuple(_body(half, mesh, partner, solved) for half, mesh, partner in half_bodies),
        undercuts=tuple(design_undercuts(half.name, mesh, half.scene) for half, mesh, _ in half_bodies),
        effects=effects,
        cases=cases,
        loads=analyse(scene, effects.enabled) if scene.engine else None,
        hashes=_hashes(compared.targets),
        command=shlex.join(command),
        written=timestamp(),
        versions=versions(),
        bound=bound,
        no_stresses=refused,
    )
    write_report(comparison_page(record), path)


def _no_stresses(targets: Sequence[Target]) -> str:
    """Return why stresses of load cases are not solved; empty where the halves of each throw are alike."""
    unlike = [f"{one.name} are not ({key})" for one in targets if (key := difference(one.scene))]
    if not unlike:
        return ""
    return f"both halves of a throw must be alike, and those of {' and of '.join(unlike)}."


def _loaded(compared: ComparedTargets) -> tuple[Scene, PhysicsPlan]:
    """Return the baseline's scene with the stiffness that its shaft vibrates with, and its plan."""
    if compared.loaded is not None:
        return compared.loaded, plan_for_stress(compared.loaded)
    scene = with_throw_stiffness(compared.targets[compared.comparison.baseline]).scene
    return scene, plan(scene)


def _without_fillets(effects: PhysicsPlan) -> PhysicsPlan:
    """Return the plan with the fillets off, and that the comparison left them out, not the design."""
    off = {
        "state": "off",
        "reason": "left out of this comparison: the surface of a run has none",
        "estimate_percent": None,
        "changes": "mass and stiffness of the designs, which have fillets",
    }
    return _with_effect(effects, "fillets", off)


def _with_effect(effects: PhysicsPlan, name: str, changed: Mapping[str, str | None]) -> PhysicsPlan:
    """Return the plan with one effect told otherwise."""
    return PhysicsPlan(
        tuple(one.model_copy(update=changed) if one.name == name else one for one in effects.effects)
    )


def half_throws(target: Target) -> list[tuple[Target, SurfaceMesh, int]]:
    """Return half throws, surfaces and partners in the view; one half where it stands for both."""
    scene = target.scene
    meshes = half_surfaces(scene, target.file, coarse_facet_mm(scene), target.align)
    parts = [target]
    if len(meshes) > 1:
        names = (f"{target.name}, {web} web" for web in ("first", "second"))
        parts = [replace(target, name=n, scene=half) for n, half in zip(names, halves(scene), strict=True)]
    return list(zip(parts, meshes, PARTNERS[len(meshes)], strict=True))


def design_undercuts(name: str, half_throw: SurfaceMesh, scene: Scene) -> DesignUndercuts:
    """Return what would keep a design with this closed surface from being made by its process."""
    hollows = int((shell_volumes_mm3(half_throw) < 0).sum())
    return DesignUndercuts(name, hollows, half_throw_undercuts(half_throw, scene))


def _body(target: Target, mesh: SurfaceMesh, partner: int, cases: Sequence[LoadCase]) -> ShownBody:
    stress = case_stress(target, cases) if cases else None
    mesh = mesh if stress else with_bolted(mesh, target.scene)  # what is bolted on has no stress
    return ShownBody(target.name, mesh, target.scene.web_z_mm, target.scene.pitch_mm / 2, stress, partner)


def _hashes(targets: Sequence[Target]) -> dict[str, str]:
    scenes = {
        f"{target.name}, SHA-256 of the scene": settings_hash(target.scene.model_dump(mode="json"), {})
        for target in targets
    }
    return scenes | {f"{t.name}, SHA-256 of {t.file.name}": file_hash(t.file) for t in targets if t.file}
