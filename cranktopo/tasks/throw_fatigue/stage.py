"""Fatigue safety of several targets by one method, and the files that show it."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path

from cranktopo.base.errors import CranktopoError, ExitCode
from cranktopo.base.files import as_path_if_any, json_file_text
from cranktopo.base.notes import Pace, note
from cranktopo.design.assumed import Assumption, filter_by_table
from cranktopo.design.opened_fillets import bore_remarks
from cranktopo.design.strength import note_strength
from cranktopo.engine.histories import HistoryKind
from cranktopo.engine.judged_speeds import barred_remarks
from cranktopo.engine.performance import note_pressure, pressure_words
from cranktopo.engine.plan.planning import note_left_off, plan_for_stress
from cranktopo.engine.vibration.end_chain import tip_remarks
from cranktopo.runs.destination import check_folder
from cranktopo.runs.stored import write_recorded
from cranktopo.tasks.fatigue.criteria import safety_method, strengths_of
from cranktopo.tasks.fatigue.taken_keys import assumed_by, note_unused
from cranktopo.tasks.shaft.stage import with_throw_stiffness
from cranktopo.tasks.throw_fatigue.assessment import FatigueAssessment, FatigueMethod
from cranktopo.tasks.throw_fatigue.needs import check_inputs, safety_left_off
from cranktopo.tasks.throw_fatigue.picture import save_fatigue_picture
from cranktopo.tasks.throw_fatigue.remarks import note_quality, note_yielding
from cranktopo.tasks.throw_fatigue.result import JudgedAs
from cranktopo.tasks.throw_fatigue.rule_check import check_rule
from cranktopo.tasks.throw_fatigue.safety_field import FatigueField
from cranktopo.tasks.throw_fatigue.scatter import counts_scatter
from cranktopo.tasks.throw_fatigue.shaft_stress import worst_throw
from cranktopo.tasks.throw_fatigue.spectrum import counts_lives, load_rainflow
from cranktopo.tasks.throw_fatigue.stress_mesh import RULE_FRACTION
from cranktopo.tasks.throw_fatigue.target_safety import fatigue_fields
from cranktopo.tasks.throw_fatigue.text import web_safety_words
from cranktopo.tasks.throw_fatigue.vtu import write_fatigue_vtu
from cranktopo.tasks.throw_fea.mirrored_webs import counted_alike
from cranktopo.tasks.throw_fea.stage import print_assumed
from cranktopo.tasks.throw_fea.targets import USED, Target, TargetLike, resolve_targets


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
        loads: extremes of radial force and torque joined, which bounds these over the cycle, or every angle
            of the cycle, with the tangential force too.
        baseline: position of the target that counts as 100 %.
        fillet_fraction: element size in a fillet over its radius.
        out: folder for fatigue.json, and VTU and picture of each target.
        design: design for the journals, loads and material of STEP targets.
        align: move STEP bodies that lie elsewhere to where the journals are.
        throw: of cranks with different throws, by default the worst loaded.

    Raises:
        CranktopoError: a target without fillets or strength, a failed solve, or files asked of M53.
    """
    out = as_path_if_any(out)
    if out is not None:
        _check_files(method, out)
    resolved = resolve_targets(targets, design, fillets=True, align=align, whole=True, throw=throw)
    mirrored = ""
    if baseline is not None:
        resolved, mirrored = counted_alike(targets, resolved, fillets=True)
    (found,) = assess_by_methods(resolved, (method,), loads, baseline, fillet_fraction)
    found = replace(found, mirrored=mirrored)
    if out is not None:
        for field in found.fields:
            _write_field(out, field)
        write_recorded(out / "fatigue.json", json_file_text(found.as_json(), "fatigue.json"))
    return found


def assess_by_methods(
    resolved: Sequence[Target],
    methods: Sequence[FatigueMethod],
    loads: HistoryKind = "extremes",
    baseline: int | None = None,
    fillet_fraction: float = RULE_FRACTION,
    *,
    both_worlds: bool = False,
) -> list[FatigueAssessment]:
    """Assess targets with their fillets by each method; methods of local stresses share the unit loads.

    Args:
        both_worlds: where the effect `continuous_shaft` is on, find the safety of a throw alone as well.

    Raises:
        CranktopoError: a target without fillets or strength, or a failed solve.
    """
    for target in resolved:
        for method in methods:
            check_inputs(target, method, loads)
    for target in resolved:
        for method in methods:
            _note_tables(target, method)
        note_unused(target.name, target.scene.fatigue, methods)
    print_assumed([replace(one, assumed=assumed_by(one.assumed, methods)) for one in resolved], USED)
    for target in resolved:
        note_left_off(target.name, safety_left_off(target.scene))
        note_strength(target.name, target.scene, strengths_of(methods))
        for remark in bore_remarks(target.scene):
            note(f"{target.name}: {remark}")
        note_pressure(target.name, target.scene)
        spectrum = target.scene.fatigue.spectrum
        if spectrum and (pressure := pressure_words(target.scene, [step.rpm for step in spectrum.step])):
            note(f"{target.name}: spectrum: {pressure}")
        if target.scene.fatigue.treatment:
            note(f"{target.name}: {target.scene.fatigue.treatment}")
    resolved = [with_throw_stiffness(target) for target in resolved]
    for target in resolved:
        enabled = plan_for_stress(target.scene).enabled
        tips = tip_remarks(target.scene) if "torsional_vibration" in enabled else []
        for remark in (*tips, *barred_remarks(target.scene, enabled)):
            note(f"{target.name}: {remark}")
    local = [method for method in methods if method != "m53"]
    fields_of = partial(
        _fields, methods=local, loads=loads, fillet_fraction=fillet_fraction, both_worlds=both_worlds
    )
    solved = _solved(resolved, fields_of) if local else []
    for target, own in zip(resolved, solved, strict=False):
        _note_fields(target, own)
    fields = dict(zip(local, zip(*solved, strict=True), strict=True))
    return [
        _by_rule(resolved, loads, baseline, fillet_fraction)
        if method == "m53"
        else FatigueAssessment(
            method, loads, fields[method], (), baseline, _assumed(resolved, method), tuple(resolved)
        )
        for method in methods
    ]


def _solved(
    targets: Sequence[Target], fields_of: Callable[[Target], tuple[FatigueField, ...]]
) -> list[tuple[FatigueField, ...]]:
    pace, found = Pace("fatigue", len(targets)), list[tuple[FatigueField, ...]]()
    for target in targets:
        pace.begin(target.name)
        found.append(fields_of(target))
    return found


def _assumed(targets: Sequence[Target], method: FatigueMethod) -> tuple[tuple[Assumption, ...], ...]:
    """Return what each target does not say and its safety by a method depends on."""
    return tuple(assumed_by(filter_by_table(target.assumed, USED), (method,)) for target in targets)


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
    target: Target,
    methods: Sequence[str],
    loads: HistoryKind,
    fillet_fraction: float,
    *,
    both_worlds: bool = False,
) -> tuple[FatigueField, ...]:
    """Fields of a throw alone, or where the plan has the continuous shaft on of its worst throw.

    Where the plan alone decided so, the lower safety of both is told: the shaft over the cycle is milder than
    the extreme states of a throw alone in one thing, and may be worse in another.

    Args:
        both_worlds: find both, whoever decided.
    """
    if "continuous_shaft" not in plan_for_stress(target.scene).enabled:
        return fatigue_fields(target, methods, loads, fillet_fraction)
    note(f"{target.name}: effect continuous_shaft: every angle of the cycle, throws on all main bearings")
    on_bearings = worst_throw(target, methods, fillet_fraction)
    switched_on = target.scene.effects.continuous_shaft == "on"
    if switched_on and not both_worlds:
        return on_bearings
    alone = fatigue_fields(target, methods, loads, fillet_fraction)
    return tuple(
        _of_both(target.name, *pair, switched_on=switched_on) for pair in zip(alone, on_bearings, strict=True)
    )


def _of_both(name: str, alone: FatigueField, on_bearings: FatigueField, *, switched_on: bool) -> FatigueField:
    """Return the field that is told of both, with the safety of the other one."""
    safety_as: dict[JudgedAs, float] = {
        "throw_alone": alone.critical.safety,
        "continuous_shaft": on_bearings.critical.safety,
    }
    governing = on_bearings if switched_on else min(alone, on_bearings, key=lambda one: one.critical.safety)
    safeties = f"{alone.critical.safety:.3f} of a throw alone, {on_bearings.critical.safety:.3f} in its shaft"
    reason = "the design asks for the latter" if switched_on else "the lower one is told"
    note(f"{name}: safety by {alone.method} {safeties}: {reason}")
    return replace(governing, safety_as=safety_as)


def _note_fields(target: Target, fields: Sequence[FatigueField]) -> None:
    """Say what is to be known of fields on one mesh; quality and yielding are those of the stresses."""
    note_quality(fields[0])
    note_yielding(fields[0], target.scene.material.yield_MPa)
    for field in fields:
        if field.web_safety:
            note(f"{target.name}: least safety: {web_safety_words(field.web_safety)}")


def _by_rule(
    targets: Sequence[Target],
    loads: HistoryKind,
    baseline: int | None,
    fillet_fraction: float,
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
        (assumed, target)
        for assumed, target, checks in zip(_assumed(targets, "m53"), targets, found, strict=True)
        for _ in checks
    ]
    return FatigueAssessment(
        "m53",
        loads,
        (),
        tuple(check for checks in found for check in checks),
        baseline,
        tuple(assumed for assumed, _ in each),
        tuple(target for _, target in each),
    )


def _check_files(method: FatigueMethod, out: Path) -> None:
    if method == "m53":
        raise CranktopoError(
            "--out: method 'm53' gives two numbers per throw and no field.",
            hint="Leave --out, or take another method.",
            code=ExitCode.USAGE,
        )
    check_folder(out)


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
