"""Fatigue safety of several targets by one method, and the files that show it."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import product
from pathlib import Path
from typing import Any

from cranktopo.base.errors import CranktopoError, ExitCode
from cranktopo.base.files import as_path, write_json
from cranktopo.base.notes import note
from cranktopo.design.assumed import Assumption, filter_by_table
from cranktopo.design.strength import note_strength, strength_remarks
from cranktopo.engine.gas import higher_elsewhere
from cranktopo.engine.histories import HistoryKind
from cranktopo.engine.plan.planning import note_left_off, plan_for_stress
from cranktopo.runs.destination import check_folder
from cranktopo.tasks.fatigue.criteria import safety_method
from cranktopo.tasks.fatigue.m53 import LEAST_FACTOR, FilletCheck
from cranktopo.tasks.fatigue.m53_outlet import OutletCheck
from cranktopo.tasks.fatigue.needs import check_inputs
from cranktopo.tasks.fatigue.picture import save_fatigue_picture
from cranktopo.tasks.fatigue.result import (
    FatigueResult,
    FieldFatigue,
    FilletAcceptance,
    JudgedQuality,
    OutletAcceptance,
    RuleFactors,
    RuleFatigue,
    RuleFillets,
    SurfaceTreatment,
)
from cranktopo.tasks.fatigue.rule_check import RuleCheck, check_rule
from cranktopo.tasks.fatigue.safety_field import FatigueField, fatigue_fields
from cranktopo.tasks.fatigue.scatter import counts_scatter
from cranktopo.tasks.fatigue.shaft_stress import worst_throw
from cranktopo.tasks.fatigue.spectrum import counts_lives, load_rainflow
from cranktopo.tasks.fatigue.stress_model import RULE_FRACTION, StressModel
from cranktopo.tasks.fatigue.text import FatigueComparison, compare_fatigue, percent_of_baseline
from cranktopo.tasks.fatigue.vtu import write_fatigue_vtu
from cranktopo.tasks.fea.stage import print_assumed
from cranktopo.tasks.fea.targets import USED, Target, TargetLike, resolve_targets
from cranktopo.tasks.shaft.stage import with_throw_stiffness

FatigueMethod = str
"""Name of a criterion of the registry, or "m53", the rule IACS UR M53."""


@dataclass(frozen=True)
class FatigueAssessment:
    """Fatigue of targets by one method.

    Attributes:
        loads: extremes of the loads joined, or every angle of the cycle.
        fields: fields of safety; empty for M53.
        checks: checks by the rule, of two different webs one each; empty for the other methods.
        baseline: position of the result that counts as 100 %, if any.
        assumed: what the target of each result does not say and its safety depends on.
        targets: what was assessed, for each result.
    """

    method: FatigueMethod
    loads: HistoryKind
    fields: tuple[FatigueField, ...]
    checks: tuple[RuleCheck, ...]
    baseline: int | None = None
    assumed: tuple[tuple[Assumption, ...], ...] = ()
    targets: tuple[Target, ...] = ()

    @property
    def results(self) -> Sequence[FatigueField | RuleCheck]:
        """Whichever there are, in the order of the targets."""
        return self.fields or self.checks

    def as_json(self) -> dict[str, Any]:
        """Return the object that `fatigue --json` prints."""
        return self.result().as_json()

    def result(self) -> FatigueResult:
        """Return the assessment as `fatigue --json` prints it."""
        results, baseline = self.results, self.baseline
        entries: list[FieldFatigue | RuleFatigue] = [
            _field_fatigue(one, told, by) if isinstance(one, FatigueField) else _rule_fatigue(one, told, by)
            for one, told, by in zip(results, self.assumed, map(_treatment, self.targets), strict=True)
        ]
        entries = [
            entry.model_copy(update={"strength_remarks": strength_remarks(target.scene) or None})
            for entry, target in zip(entries, self.targets, strict=True)
        ]
        return FatigueResult(
            method=self.method,
            loads=self.loads,
            baseline=None if baseline is None else entries[baseline].target,
            fatigue=tuple(entries),
            percent_of_baseline=None if baseline is None else percent_of_baseline(results, baseline),
        )

    def compared(self) -> FatigueComparison:
        """Return its share of a comparison, of two different webs the worse one."""
        if self.fields or self.baseline is None:
            return compare_fatigue(self.fields or self._worse_webs, self.baseline, self.result())
        worse, base = self._worse_webs, self.checks[self.baseline]
        index = next(number for number, check in enumerate(worse) if check is base)
        return compare_fatigue(worse, index, self.result())

    @property
    def _worse_webs(self) -> tuple[RuleCheck, ...]:
        worse: dict[int, RuleCheck] = {}
        for target, check in zip(map(id, self.targets), self.checks, strict=True):
            worse[target] = min(worse.get(target, check), check, key=lambda one: one.safety)
        return tuple(worse.values())


def assess_fatigue(
    targets: Sequence[TargetLike],
    method: FatigueMethod = "lsa",
    loads: HistoryKind = "extremes",
    baseline: int | None = None,
    fillet_fraction: float = RULE_FRACTION,
    out: Path | str | None = None,
    design: str | None = None,
    align: bool = False,
    throw: int | None = None,
) -> FatigueAssessment:
    """Fatigue safety of targets whose fillets have a radius.

    Args:
        targets: scenes, paths or names as the user types them, or targets with their fillets.
        loads: extremes of the loads joined, which bounds the cycle, or every angle of the cycle.
        baseline: position of the target that counts as 100 %.
        fillet_fraction: element size in a fillet over its radius.
        out: folder for fatigue.json, and VTU and picture of each target.
        design: design for the journals, loads and material of STEP targets.
        align: move STEP bodies that lie elsewhere to where the journals are.
        throw: of cranks with different throws, by default the worst loaded.

    Raises:
        CranktopoError: a target without fillets or strength, a failed solve, or files asked of M53.
    """
    out = as_path(out)
    if out is not None:
        _check_files(method, out)
    resolved = resolve_targets(targets, design, fillets=True, align=align, whole=True, throw=throw)
    (found,) = assess_by_methods(resolved, (method,), loads, baseline, fillet_fraction)
    if out is not None:
        for field in found.fields:
            _write_field(out, field)
        write_json(out / "fatigue.json", found.as_json())
    return found


def assess_by_methods(
    resolved: Sequence[Target],
    methods: Sequence[FatigueMethod],
    loads: HistoryKind = "extremes",
    baseline: int | None = None,
    fillet_fraction: float = RULE_FRACTION,
) -> list[FatigueAssessment]:
    """Assess targets with their fillets by each method; methods of local stresses share the unit loads.

    Raises:
        CranktopoError: a target without fillets or strength, or a failed solve.
    """
    for target in resolved:
        for method in methods:
            check_inputs(target, method, loads)
    for target, method in product(resolved, methods):
        _note_tables(target, method)
    print_assumed(resolved, USED)
    for target in resolved:
        note_left_off(target.name, target.scene, plan_for_stress(target.scene))
        note_strength(target.name, target.scene)
        higher = higher_elsewhere(target.scene)
        if higher:
            note(f"{target.name}: judged by the {higher}")
        if target.scene.fatigue.treatment:
            note(f"{target.name}: {target.scene.fatigue.treatment}")
    resolved = [with_throw_stiffness(target) for target in resolved]
    assumed = tuple(filter_by_table(target.assumed, USED) for target in resolved)
    local = [method for method in methods if method != "m53"]
    solved = [_fields(one, local, loads, fillet_fraction) for one in resolved if local]
    for target, own in zip(resolved, solved, strict=False):
        _note_fields(target, own)
    fields = dict(zip(local, zip(*solved, strict=True), strict=True))
    return [
        _by_rule(resolved, loads, baseline, fillet_fraction, assumed)
        if method == "m53"
        else FatigueAssessment(method, loads, fields[method], (), baseline, assumed, tuple(resolved))
        for method in methods
    ]


def _note_tables(target: Target, method: FatigueMethod) -> None:
    """Say which tables of a scene a method has no use for; load what the others need before any solve."""
    settings, chosen = target.scene.fatigue, safety_method(method)
    if settings.scatter is not None and not counts_scatter(target.scene, method):
        fixed = "its strengths hold at a fixed probability of survival"
        note(f"{target.name}: fatigue.scatter has no part in method '{method}': {fixed}")
    if settings.spectrum is None:
        return
    if counts_lives(target.scene, chosen) and target.scene.effects.continuous_shaft != "on":
        load_rainflow()
    else:
        note(f"{target.name}: fatigue.spectrum has no part: lsa and fkm judge it, of a throw alone")


def _fields(
    target: Target, methods: Sequence[FatigueMethod], loads: HistoryKind, fillet_fraction: float
) -> tuple[FatigueField, ...]:
    """Fields of a throw alone, or where the plan has the continuous shaft on of its worst throw.

    Where the plan alone decided so, the lower safety of both is told: the shaft over the cycle is milder than
    the extreme states of a throw alone in one thing, and may be worse in another.
    """
    if "continuous_shaft" not in plan_for_stress(target.scene).enabled:
        return fatigue_fields(target, methods, loads, fillet_fraction)
    note(f"{target.name}: effect continuous_shaft: every angle of the cycle, throws on all main bearings")
    on_bearings = worst_throw(target, methods, fillet_fraction)
    if target.scene.effects.continuous_shaft == "on":
        return on_bearings
    alone = fatigue_fields(target, methods, loads, fillet_fraction)
    for one, other in zip(alone, on_bearings, strict=True):
        safeties = f"{one.critical.safety:.3f} of a throw alone, {other.critical.safety:.3f} on all bearings"
        note(f"{target.name}: safety by {one.method} {safeties}: the lower one is told")
    pairs = zip(alone, on_bearings, strict=True)
    return tuple(min(pair, key=lambda field: field.critical.safety) for pair in pairs)


def _note_fields(target: Target, fields: Sequence[FatigueField]) -> None:
    """Say what is to be known of fields on one mesh; quality and yielding are those of the stresses."""
    note_quality(fields[0])
    note_yielding(fields[0], target.scene.material.yield_MPa)
    for field in fields:
        if field.web_safety:
            told = ", ".join(f"{web} web {safety:.3f}" for web, safety in field.web_safety.items())
            note(f"{target.name}: least safety: {told}")


def _by_rule(
    targets: Sequence[Target],
    loads: HistoryKind,
    baseline: int | None,
    fillet_fraction: float,
    assumed: Sequence[tuple[Assumption, ...]],
) -> FatigueAssessment:
    """Checks of all targets; one with two different webs has two, and as the baseline it is its worse web."""
    for target in targets:
        if "continuous_shaft" in plan_for_stress(target.scene).enabled:
            note(f"{target.name}: the rule judges a throw alone, effect continuous_shaft has no part in it")
    found = [check_rule(target, loads, fillet_fraction) for target in targets]
    if baseline is not None:
        before, own = sum(map(len, found[:baseline])), found[baseline]
        baseline = before + min(range(len(own)), key=lambda web: own[web].safety)
    each = [
        (told, target) for told, target, checks in zip(assumed, targets, found, strict=True) for _ in checks
    ]
    return FatigueAssessment(
        "m53",
        loads,
        (),
        tuple(check for checks in found for check in checks),
        baseline,
        tuple(told for told, _ in each),
        tuple(target for _, target in each),
    )


def _treatment(target: Target) -> SurfaceTreatment:
    settings = target.scene.fatigue
    return SurfaceTreatment(
        factor=settings.surface_treatment_factor, source=settings.surface_treatment_source or None
    )


def _field_fatigue(
    field: FatigueField, assumed: tuple[Assumption, ...], treatment: SurfaceTreatment
) -> FieldFatigue:
    model = field.model
    return FieldFatigue(
        target=model.name,
        throw_kg=model.throw_kg,
        safety=field.critical.safety,
        fillet_safety=field.fillet_safety,
        web_safety=field.web_safety or None,
        critical=field.critical,
        at_outlet=field.at_outlet,
        at_sharp_edges=field.at_sharp_edges,
        judged_as="continuous_shaft" if field.on_bearings else "throw_alone",
        load_states=len(field.labels),
        unit_loads=model.kinds,
        quality=JudgedQuality(**vars(model.quality), within_rule=model.quality.within_limits),
        assumed=assumed,
        surface_treatment=treatment,
        hardening=field.hardening or None,
        lives=field.lives or None,
        scatter=field.scatter or None,
    )


def _rule_fatigue(
    check: RuleCheck, assumed: tuple[Assumption, ...], treatment: SurfaceTreatment
) -> RuleFatigue:
    return RuleFatigue(
        target=check.name,
        throw_kg=check.throw_kg,
        safety=check.safety,
        accepted=check.verdict == "accepted",
        verdict=check.verdict,
        governing_factors=check.governing,
        not_judged=check.not_judged,
        least_acceptability=LEAST_FACTOR,
        alternating=check.loads,
        outside_validity=check.outside,
        factors=RuleFactors(closed_form=check.scf_rule, finite_elements=check.scf_fem),
        nominal=check.nominal,
        fillets=RuleFillets(
            closed_form=_acceptances(check.rule_checks), finite_elements=_acceptances(check.fem_checks)
        ),
        outlets=tuple(map(_outlet_acceptance, check.outlets)),
        quality=check.quality,
        assumed=assumed,
        surface_treatment=treatment,
    )


def _acceptances(checks: dict[str, FilletCheck]) -> dict[str, FilletAcceptance]:
    return {
        name: FilletAcceptance(**vars(check), acceptability=check.acceptability)
        for name, check in checks.items()
    }


def _outlet_acceptance(outlet: OutletCheck) -> OutletAcceptance:
    own = {name: value for name, value in vars(outlet).items() if name not in ("check", "outside")}
    return OutletAcceptance(
        **own,
        **vars(outlet.check),
        acceptability=outlet.acceptability,
        outside_validity=outlet.outside,
    )


def _check_files(method: FatigueMethod, out: Path) -> None:
    if method == "m53":
        raise CranktopoError(
            "--out: method 'm53' gives two numbers per throw and no field.",
            hint="Leave --out, or take another method.",
            code=ExitCode.USAGE,
        )
    check_folder(out)


def note_quality(field: FatigueField) -> None:
    """Tell in a line where means miss the rule's checks of a mesh, and what is not counted."""
    quality = field.model.quality
    if not (quality.within_limits or field.model.fitted):
        note(f"note: {field.model.name}: {quality.shortfall}; a smaller --fillet-fraction helps.")
    sharp = field.at_sharp_edges
    if sharp is not None and sharp.safety < field.critical.safety:
        note(
            f"note: {field.model.name}: {sharp.safety:.3f} at a sharp inner edge ({sharp.place}) is not "
            "counted: it falls with every finer mesh. Give the edge a radius."
        )
    note_cut_outlets(field.model)


def note_cut_outlets(model: StressModel) -> None:
    """Tell in a line of outlets that are not judged because the model ends in them."""
    if model.at_cut.any():
        note(
            f"note: {model.name}: the oil outlet in the middle of the main journal is not judged: the throw "
            "is cut there. One whose place_mm is above 1.5 times its radius and its rounding is."
        )


def note_yielding(field: FatigueField, yield_MPa: float | None) -> None:
    """Warn of a stress that no material carries: the loads, a dimension or a unit may be wrong."""
    if line := yield_warning(field, yield_MPa):
        note(f"warning: {line}")


def yield_warning(field: FatigueField, yield_MPa: float | None) -> str:
    """Return a line on a stress above the yield strength; empty where there is none."""
    place = field.critical
    largest = place.amplitude_MPa + abs(place.mean_MPa)
    if yield_MPa is None or largest <= yield_MPa:
        return ""
    return (
        f"{field.model.name}: {largest:.0f} MPa by linear elasticity at {place.place}, "
        f"{largest / yield_MPa:.1f} times the yield strength of {yield_MPa:g} MPa: the material yields, "
        "and no safety here holds. Check loads, dimensions and units."
    )


def _write_field(out: Path, field: FatigueField) -> None:
    out.mkdir(parents=True, exist_ok=True)
    writers: tuple[tuple[str, Callable[[Path, FatigueField], None]], ...] = (
        (".vtu", write_fatigue_vtu),
        (".png", save_fatigue_picture),
    )
    for suffix, write in writers:
        path = out / f"fatigue-{field.method}-{field.model.name}{suffix}"
        write(path, field)
        note(str(path))
