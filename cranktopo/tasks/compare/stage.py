"""Several targets beside a baseline: evaluated, fatigue assessed, and everything that their page shows."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from cranktopo.base.progress import Json
from cranktopo.bodies.solid.files import coarse_facet_mm, half_surfaces, surface_of
from cranktopo.bodies.undercuts import half_throw_undercuts
from cranktopo.design.goal.outcome import GoalOutcome, goal_outcome
from cranktopo.design.goal.wanted import wanted as wanted_goal
from cranktopo.design.halves import difference, halves
from cranktopo.design.scale import usual_scale
from cranktopo.design.schema import Scene
from cranktopo.engine.analysis import analyse
from cranktopo.engine.cases import load_cases
from cranktopo.engine.load_case import LoadCase
from cranktopo.engine.plan.planning import plan
from cranktopo.numerics.surfaces.mesh import SurfaceMesh, shell_volumes_mm3
from cranktopo.report.report_file import check_report_path, write_report
from cranktopo.report.viewer.scene3d import PARTNERS, ShownBody
from cranktopo.runs.manifest import file_hash, settings_hash, timestamp, versions
from cranktopo.tasks.bound.bound_for_result import bounds_for_result
from cranktopo.tasks.compare.page import ComparisonRecord, comparison_page
from cranktopo.tasks.compare.result import Comparison, Entry, check_same_supports, compare
from cranktopo.tasks.extraction.text import DesignUndercuts
from cranktopo.tasks.fatigue.stage import FatigueMethod, assess_fatigue
from cranktopo.tasks.fea.case_stress import case_stress
from cranktopo.tasks.fea.evaluation import Info
from cranktopo.tasks.fea.goal_values import goal_values
from cranktopo.tasks.fea.quantities import BENDING, MASS, TORSION, TORSION_PER_MASS
from cranktopo.tasks.fea.stage import MeshRequest, evaluate_targets
from cranktopo.tasks.fea.targets import Target, resolve_targets
from cranktopo.tasks.importing.imported_body import half_throw_surface
from cranktopo.tasks.sweep.targets import with_picks

_RAYS_MM = 1.0
"""Of throws of usual size; others in proportion."""


@dataclass(frozen=True)
class ComparedTargets:
    """A comparison, its targets in the same order, and those that miss the accuracy asked for."""

    comparison: Comparison
    targets: tuple[Target, ...]
    missed: tuple[str, ...] = ()


def compare_targets(
    names: Sequence[str],
    baseline: str,
    wanted: MeshRequest | None = None,
    fatigue: FatigueMethod | None = None,
    design: str | None = None,
    info: Info = lambda _: None,
    align: bool = False,
) -> ComparedTargets:
    """Evaluate targets beside a baseline, and assess their fatigue where a method is given.

    Args:
        names: targets as the user types them, of a sweep those picked out of it; the baseline is put before
            them where it is not among them.
        baseline: the target that counts as 100 %.
        design: design for the journals of STL and STEP files.
        align: whether STL and STEP bodies that lie elsewhere are moved to where the journals are.

    Raises:
        CranktopoError: no such target, different supports, no fillets for the fatigue, or a failed solve.
    """
    given = with_picks(names)
    every = given if baseline in given else [baseline, *given]
    index = every.index(baseline)
    targets = resolve_targets(every, design, align=align, whole=True)
    check_same_supports((target.scene.supports.torsion, target.scene.supports.bending) for target in targets)
    safety = None
    if fatigue is not None:
        filleted = resolve_targets(every, design, fillets=True, align=align, whole=True)
        safety = assess_fatigue(filleted, fatigue, baseline=index, info=info).compared()
    found = evaluate_targets(targets, wanted, info)
    published = [None if target.file else target.scene.published for target in targets]
    safeties = iter(safety.safeties if safety else ())
    entries = [
        Entry(evaluation, printed, next(safeties, None))
        for evaluation, printed in zip(found.evaluations, published, strict=True)
    ]
    comparison = compare(entries, entries[index].name, safety)
    comparison = replace(comparison, goals=_evaluated_goals(targets, entries, index))
    return ComparedTargets(comparison, tuple(targets), found.missed)


def _evaluated_goals(
    targets: Sequence[Target], entries: Sequence[Entry], baseline: int
) -> dict[str, GoalOutcome]:
    """Return goal and limits of every target that has a goal, but for the baseline, by name of the target.

    Args:
        entries: of the targets, in their order; percent are of the baseline's values.
    """
    original = _values(targets[baseline], entries[baseline])
    found = {}
    for row, (target, entry) in enumerate(zip(targets, entries, strict=True)):
        goal = wanted_goal(target.scene)
        if goal is not None and row != baseline:
            found[target.name] = goal_outcome(goal, _values(target, entry), original)
    return found


def _values(target: Target, entry: Entry) -> dict[str, float]:
    return goal_values(
        target.scene, entry.evaluation.result.model_copy(update={"fatigue_safety": entry.safety})
    )


def comparison_bound(found: ComparedTargets, info: Info = lambda _: None) -> Json | None:
    """Return what no web of the envelope can beat, beside the web that is stiffest in torsion per mass.

    Returns:
        As `bound` of metrics.json; None where the baseline is no design with an envelope, the targets have
        other throws or envelopes, the halves of one differ, or the design's effects leave the bound out.
    """
    comparison, base = found.comparison, found.targets[found.comparison.baseline]
    scene = base.scene
    alike = all((t.scene.throw, t.scene.envelope) == (scene.throw, scene.envelope) for t in found.targets)
    alike = alike and not any(difference(t.scene) for t in found.targets)
    if base.file is not None or not alike or plan(scene)["bound"].state == "off":
        return None
    best = comparison.leading(TORSION_PER_MASS)
    reached = {quantity.key: comparison.percent(best, quantity) for quantity in (MASS, TORSION, BENDING)}
    return bounds_for_result(scene, reached, None, info).as_json()


def report_comparison(
    found: ComparedTargets,
    path: Path,
    command: Sequence[str] = (),
    stress_progress: Info | None = None,
    bound: Json | None = None,
) -> None:
    """Write the page of a comparison as HTML or Markdown.

    Args:
        path: .html or .md.
        stress_progress: where given, all targets are solved for the baseline's load cases too, unless the
            halves of one differ.
        bound: from `comparison_bound`, drawn over the mass.

    Raises:
        CranktopoError: a bad path, or a failed solve of the stresses.
    """
    check_report_path(path)
    write_report(comparison_page(_comparison_record(found, command, stress_progress, bound)), path)


def _comparison_record(
    found: ComparedTargets,
    command: Sequence[str] = (),
    stress_progress: Info | None = None,
    bound: Json | None = None,
) -> ComparisonRecord:
    """Return everything that the page of a comparison shows; arguments as `report_comparison`."""
    scene = found.targets[found.comparison.baseline].scene
    effects = plan(scene)
    cases = load_cases(scene, effects.enabled)
    stress_progress = _unless_halves_differ(found.targets, stress_progress)
    throws = [half_throws(target) for target in found.targets]
    shown = [
        (half, mesh, partner)
        for each in throws
        for (half, mesh), partner in zip(each, PARTNERS[len(each)], strict=True)
    ]
    return ComparisonRecord(
        comparison=found.comparison,
        bodies=tuple(_body(half, mesh, partner, cases, stress_progress) for half, mesh, partner in shown),
        undercuts=tuple(design_undercuts(half.name, mesh, half.scene) for half, mesh, _ in shown),
        effects=effects,
        cases=cases,
        loads=analyse(scene) if scene.engine else None,
        hashes=_hashes(found.targets),
        command=" ".join(command),
        written=timestamp(),
        versions=versions(),
        bound=bound,
    )


def _unless_halves_differ(targets: Sequence[Target], progress: Info | None) -> Info | None:
    """Return the progress of the stresses; None where they are not solved, and a line that says why."""
    lonely = [target.name for target in targets if difference(target.scene)]
    if progress is not None and lonely:
        progress(f"no stresses: the halves of {', '.join(lonely)} differ")
        return None
    return progress


def half_throws(target: Target) -> tuple[tuple[Target, SurfaceMesh], ...]:
    """Half throws and their surfaces, each in its own frame; the one that stands for both where it can."""
    scene = target.scene
    if not difference(scene):
        return ((target, _surface(target)),)
    named = (f"{target.name}, {web} web" for web in ("first", "second"))
    near, far = halves(scene)
    surfaces = half_surfaces(scene, coarse_facet_mm(near))
    return tuple(
        (replace(target, name=name, scene=half), mesh)
        for name, half, mesh in zip(named, (near, far), surfaces, strict=True)
    )


def design_undercuts(name: str, half_throw: SurfaceMesh, scene: Scene) -> DesignUndercuts:
    """Return what would keep a design with this closed surface from being made."""
    hollows = int((shell_volumes_mm3(half_throw) < 0).sum())
    step_mm = _RAYS_MM / usual_scale(scene)
    return DesignUndercuts(name, hollows, half_throw_undercuts(half_throw, scene, step_mm))


def _body(
    target: Target, mesh: SurfaceMesh, partner: int, cases: Sequence[LoadCase], stress_progress: Info | None
) -> ShownBody:
    stress = case_stress(target, cases, progress=stress_progress) if stress_progress else None
    return ShownBody(target.name, mesh, target.scene.web_z_mm, target.scene.pitch_mm / 2, stress, partner)


def _surface(target: Target) -> SurfaceMesh:
    if target.file is not None:
        return half_throw_surface(target.file, target.scene, target.align)
    return surface_of(target.scene, "half", coarse_facet_mm(target.scene))


def _hashes(targets: Sequence[Target]) -> dict[str, str]:
    scenes = {
        f"{target.name}, SHA-256 of the scene": settings_hash(target.scene.model_dump(mode="json"), {})
        for target in targets
    }
    return scenes | {f"{t.name}, SHA-256 of {t.file.name}": file_hash(t.file) for t in targets if t.file}
