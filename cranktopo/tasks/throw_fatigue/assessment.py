"""The fatigue of targets by one method, as later stages take it and as JSON."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from cranktopo.design.assumed import Assumption
from cranktopo.design.strength import strength_remarks
from cranktopo.engine.histories import HistoryKind
from cranktopo.tasks.fatigue.criteria import strengths_of
from cranktopo.tasks.throw_fatigue.largest_stress import largest_of_field_MPa
from cranktopo.tasks.throw_fatigue.m53 import LEAST_FACTOR, FilletCheck
from cranktopo.tasks.throw_fatigue.m53_outlet import OutletCheck
from cranktopo.tasks.throw_fatigue.mesh_quality import JudgedQuality
from cranktopo.tasks.throw_fatigue.needs import safety_left_off
from cranktopo.tasks.throw_fatigue.remarks import cut_outlet_words
from cranktopo.tasks.throw_fatigue.result import (
    FatigueResult,
    FieldFatigue,
    FilletAcceptance,
    OutletAcceptance,
    OutletElementsAcceptance,
    RuleFactors,
    RuleFatigue,
    RuleFillets,
    SurfaceTreatment,
)
from cranktopo.tasks.throw_fatigue.rule_check import RuleCheck
from cranktopo.tasks.throw_fatigue.safety_field import FatigueField
from cranktopo.tasks.throw_fatigue.text import FatigueComparison, compare_fatigue
from cranktopo.tasks.throw_fatigue.throw_verdict import throw_verdict
from cranktopo.tasks.throw_fatigue.verdicts import percent_of_baseline
from cranktopo.tasks.throw_fea.targets import Target

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
        mirrored: that a web counts twice in every target, as one was found; empty where none does.
    """

    method: FatigueMethod
    loads: HistoryKind
    fields: tuple[FatigueField, ...]
    checks: tuple[RuleCheck, ...]
    baseline: int | None = None
    assumed: tuple[tuple[Assumption, ...], ...] = ()
    targets: tuple[Target, ...] = ()
    mirrored: str = ""

    @property
    def results(self) -> Sequence[FatigueField | RuleCheck]:
        """Fields, or checks by the rule, in the order of the targets."""
        return self.fields or self.checks

    def as_json(self) -> dict[str, Any]:
        """Return the object that `fatigue --json` prints."""
        return self.result().as_json()

    def result(self) -> FatigueResult:
        """Return the assessment as `fatigue --json` prints it."""
        results, baseline = self.results, self.baseline
        entries: list[FieldFatigue | RuleFatigue] = [
            _field_fatigue(one, assumed, by)
            if isinstance(one, FatigueField)
            else _rule_fatigue(one, assumed, by)
            for one, assumed, by in zip(results, self.assumed, map(_treatment, self.targets), strict=True)
        ]
        entries = [
            entry.model_copy(update=self._remarks(target))
            for entry, target in zip(entries, self.targets, strict=True)
        ]
        return FatigueResult(
            method=self.method,
            loads=self.loads,
            mirrored_web=self.mirrored or None,
            baseline=None if baseline is None else entries[baseline].target,
            fatigue=tuple(entries),
            percent_of_baseline=None if baseline is None else percent_of_baseline(results, baseline),
        )

    def _remarks(self, target: Target) -> dict[str, Any]:
        scene = target.scene
        return {
            "strength_remarks": strength_remarks(scene, strengths_of([self.method])) or None,
            "left_off": safety_left_off(scene) or None,
        }

    def compared(self) -> FatigueComparison:
        """Return its share of a comparison, of two different webs the worse one."""
        if self.fields:
            return compare_fatigue(self.fields, self.baseline, self.result())
        throws = self._throws
        base = None if self.baseline is None else self.targets[self.baseline]
        index = next((number for number, (target, _) in enumerate(throws) if target is base), None)
        answers = [throw_verdict(target.name, checks) for target, checks in throws]
        worse = [min(checks, key=lambda one: one.safety) for _, checks in throws]
        return compare_fatigue(worse, index, self.result(), answers, self.checks)

    @property
    def _throws(self) -> list[tuple[Target, list[RuleCheck]]]:
        """Targets with the checks of their webs, in their order."""
        found: dict[int, tuple[Target, list[RuleCheck]]] = {}
        for target, check in zip(self.targets, self.checks, strict=True):
            found.setdefault(id(target), (target, []))[1].append(check)
        return list(found.values())


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
        largest_stress_MPa=largest_of_field_MPa(field),
        critical=field.critical,
        at_outlet=field.at_outlet,
        at_sharp_edges=field.at_sharp_edges,
        not_judged=cut_outlet_words(model) or None,
        judged_as="continuous_shaft" if field.on_bearings else "throw_alone",
        safety_as=field.safety_as or None,
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
        not_covered=check.not_covered or None,
        process_remark=check.process_remark or None,
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
    return OutletAcceptance(
        key=outlet.key,
        angle_deg=outlet.angle_deg,
        gamma_bending=outlet.gamma_bending,
        gamma_torsion=outlet.gamma_torsion,
        bending_MPa=outlet.bending_MPa,
        torsion_MPa=outlet.torsion_MPa,
        equivalent_MPa=outlet.check.equivalent_MPa,
        strength_MPa=outlet.check.strength_MPa,
        acceptability=outlet.acceptability,
        outside_validity=outlet.outside,
        elements=_by_elements(outlet),
        governed_by=outlet.governed_by,
    )


def _by_elements(outlet: OutletCheck) -> OutletElementsAcceptance | None:
    found, check = outlet.elements, outlet.by_elements
    if found is None or check is None:
        return None
    return OutletElementsAcceptance(
        gamma_bending=found.gamma_bending,
        gamma_torsion=found.gamma_torsion,
        equivalent_MPa=check.equivalent_MPa,
        acceptability=check.acceptability,
        **vars(found.checks),
        proven=not outlet.unproven,
    )
