"""The dossier of a check against the crankshaft rule IACS UR M53: what a reviewer asks, in that order."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial

from cranktopo.design.assumed import Assumption
from cranktopo.design.schema import Scene
from cranktopo.design.strength import strength_remarks, value_origin
from cranktopo.engine.analysis import LoadAnalysis
from cranktopo.engine.load_case import LoadCase
from cranktopo.engine.plan.effect import PhysicsPlan
from cranktopo.engine.plan.planning import left_off
from cranktopo.engine.vibration.barred import ranges_words, runs_barred, too_near_words
from cranktopo.engine.vibration.study import VibrationStudy
from cranktopo.report.page import (
    Fact,
    FactStatus,
    Page,
    Section,
    assumed_words,
    pairs,
    sentence,
    versions_section,
)
from cranktopo.report.plot import Picture
from cranktopo.report.result_table import ResultTable
from cranktopo.tasks.loads.section import loads_section
from cranktopo.tasks.plan.section import effects_section
from cranktopo.tasks.throw_fatigue import rule_tables as tables
from cranktopo.tasks.throw_fatigue.dossier_sections import engine_section, shaft_section, vibration_sections
from cranktopo.tasks.throw_fatigue.m53 import LEAST_FACTOR, M53, ratios
from cranktopo.tasks.throw_fatigue.rule_check import RuleCheck, Verdict
from cranktopo.tasks.throw_fatigue.throw_verdict import worst_verdict

_BLANK = "." * 24
"""Room for a name by hand."""
_ANSWERS: dict[Verdict, str] = {
    "not covered": "is NOT COVERED by the rule",
    "not accepted": "is NOT accepted",
    "not judged": "is NOT JUDGED by the rule alone",
    "accepted": "is accepted",
}
"""Words of the headline for each verdict."""


@dataclass(frozen=True)
class RuleRecord:
    """A finished check with everything that its dossier shows.

    Attributes:
        checks: of the throw, or of each of its two different webs.
        effects: which of them the loads hold, torsional vibration among them.
        cases: load cases of the plan.
        loads: None without gas and inertia forces over the cycle.
        history: how the alternating loads follow from the cycle, in words.
        assumed: what the design does not say and the rule takes, as `assumed` of the JSON.
        drawings: of the half throw, or of both; none for a body from CAD.
        scene_sha256: of the resolved scene.
        written: when, ISO 8601.
        vibration: of the shaft; None without shaft line or gas data.
    """

    name: str
    checks: tuple[RuleCheck, ...]
    scene: Scene
    effects: PhysicsPlan
    cases: tuple[LoadCase, ...]
    loads: LoadAnalysis | None
    history: str
    assumed: tuple[Assumption, ...]
    drawings: tuple[Picture, ...]
    scene_sha256: str
    command: str
    written: str
    versions: Mapping[str, str | None]
    vibration: VibrationStudy | None = None

    @property
    def document(self) -> str:
        """Number of the document: the same for the same scene."""
        return f"M53-{self.name}-{self.scene_sha256[:8]}"


def rule_page(record: RuleRecord) -> Page:
    """Return the dossier as a page."""
    checks = record.checks
    return Page(
        title=f"Crankshaft {record.name} against IACS UR M53",
        subtitle=f"Document {record.document}. Calculation of the crank throw, {record.written[:10]}",
        headline=" ".join(
            [_headline(checks), *_left_off(record), *_barred(record.vibration), *_strength(record)]
        ),
        facts=tuple(fact for check in checks for fact in _facts(check)),
        sections=(
            *_each(checks, _acceptability),
            _input(record),
            engine_section(record.scene, record.loads.cycle if record.loads else None),
            shaft_section(record.scene),
            *_each(checks, _size),
            loads_section(record.loads, record.cases, of_stresses=True),
            effects_section(record.effects.effects),
            *vibration_sections(record.vibration, checks[0].loads.torque_Nm),
            *_each(checks, lambda check: _nominal(check, record.history)),
            *_each(checks, _factors),
            *_each(checks, _mesh),
            _assumptions(record),
            versions_section(record.versions),
        ),
    )


def _each(checks: Sequence[RuleCheck], section: Callable[[RuleCheck], Section]) -> Iterator[Section]:
    """Yield a section of each check, named after its web where there are two."""
    for number, check in enumerate(checks):
        found = section(check)
        if number:
            found = replace(found, anchor=f"{found.anchor}-{number + 1}")
        yield replace(found, title=found.title + _of_web(check))


def _of_web(check: RuleCheck) -> str:
    return f", {check.web}" if check.web else ""


def _left_off(record: RuleRecord) -> list[str]:
    """Return in a sentence the loads that are off although above the threshold, if any."""
    missing = left_off(record.scene, record.effects)
    return [sentence(missing)] if missing else []


def _headline(checks: Sequence[RuleCheck]) -> str:
    worst = min(checks, key=lambda check: check.safety)
    answer = _ANSWERS[worst_verdict(checks)]
    place = worst.least_place
    uncovered = next((f" ({check.not_covered})" for check in checks if check.not_covered), "")
    return (
        f"The throw {answer}{uncovered}: least acceptability factor Q = {worst.safety:.3f} at the "
        f"{place}{_of_web(worst)}, {LEAST_FACTOR:g} asked, with {_factors_at(worst, place)}."
        + "".join(
            f" Not judged: {name}, {why}." for check in checks for name, why in check.not_judged.items()
        )
    )


def _barred(study: VibrationStudy | None) -> list[str]:
    """Return what the rule's factors do not say: speeds left out, barred ones at or near the engine's own."""
    if study is None:
        return []
    declared = study.response.barred_rpm
    ranges = sorted({*declared, *(study.barred_rpm or ())})
    faults = runs_barred(study.scene, study.barred_rpm or ()), too_near_words(study.scene, ranges)
    left_out = f"No torque of {ranges_words(declared)} is in it (shaft.barred_rpm)." if declared else ""
    return [*filter(None, [left_out]), *(f"Besides, {fault}." for fault in faults if fault)]


def _strength(record: RuleRecord) -> list[str]:
    """Return what the strength that the verdict rests on does not hold for."""
    remarks = [f"Strength of the material: {remark}." for remark in strength_remarks(record.scene, M53.needs)]
    process = dict.fromkeys(check.process_remark for check in record.checks if check.process_remark)
    return remarks + [f"Process: {remark}." for remark in process]


def _factors_at(check: RuleCheck, place: str) -> str:
    by: dict[str | None, str] = {"polynomials": "polynomials of the rule", "elements": "finite elements"}
    by[None] = "finite elements that prove nothing"
    return f"concentration factors from {by[check.governed[place]]}"


def _facts(check: RuleCheck) -> tuple[Fact, ...]:
    limit, of_web = f"at least {LEAST_FACTOR:g}", _of_web(check)
    facts = [Fact(f"Material{of_web}", "not covered", check.not_covered, "bad")] * bool(check.not_covered)
    facts += [
        Fact(
            f"Q at the {place}{of_web}",
            f"{found.acceptability:.3f}",
            limit,
            "bad" if not found.accepted else "neutral" if check.not_covered else "good",
        )
        for place, found in check.places.items()
    ]
    facts += [
        Fact(f"Q at the {place}{of_web}", "not judged", why, "bad") for place, why in check.not_judged.items()
    ]
    outside, within = len(check.outside), check.quality.within_limits
    facts.append(
        Fact(
            f"Ratios in the range of the polynomials{of_web}",
            f"{len(ratios(check.size)) - outside} of {len(ratios(check.size))}",
            "; ".join(check.outside) or "the polynomials are valid for this throw",
            "bad" if outside else "good",
        )
    )
    mesh = check.quality.kept if within else check.quality.shortfall
    return (
        *facts,
        Fact(f"Mesh checks of Appendix III{of_web}", "kept" if within else "missed", mesh, _status(within)),
    )


def _status(good: bool) -> FactStatus:
    return "good" if good else "bad"


def _acceptability(check: RuleCheck) -> Section:
    return Section(
        "acceptability",
        "Acceptability",
        "Q is the fatigue strength over the equivalent alternating stress (sections 5 and 6 of the rule). "
        f"{_governs(check)} Plus or minus: what the stress at the peak differs between neighbouring "
        "elements, an estimate and no bound.",
        (("Equivalent alternating stress, strength and acceptability", tables.acceptability_table(check)),),
    )


def _governs(check: RuleCheck) -> str:
    """Return the place that decides, which set of factors does at each place, and what the sets differ in."""
    chosen = ", ".join(
        f"{by or 'neither set'} at the {place}{' fillet' * (place in check.fem_checks)}"
        for place, by in check.governed.items()
    )
    differ = "".join(f" The sets differ at the {line}." for line in check.departures)
    place = check.governing_place
    least = f" The least is {check.judged_safety:.3f}, {check.place_words(place)}." if place else ""
    return f"Factors that govern (fatigue.m53_factors = '{check.m53_factors}'): {chosen}.{least}{differ}"


def _input(record: RuleRecord) -> Section:
    return Section(
        "input",
        "Input data",
        f"Design {record.name}, SHA-256 of the resolved scene {record.scene_sha256}.",
        (("Material and factors", pairs(_material(record.scene))),),
        record.drawings,
    )


def _size(check: RuleCheck) -> Section:
    return Section(
        "size",
        "Dimensions by the rule",
        "",
        (
            ("Throw in the symbols of the rule", tables.size_table(check)),
            ("Ratios, and where the polynomials are valid", tables.ratio_table(check.size)),
        ),
    )


def _material(scene: Scene) -> list[tuple[str, str]]:
    material, fatigue = scene.material, scene.fatigue
    origin = partial(value_origin, material)
    return [
        ("material", material.name),
        ("source of its values", material.source or "unknown"),
        *(("remark", f"{remark}.") for remark in strength_remarks(scene, (*M53.needs, "yield_MPa"))),
        ("tensile strength", f"{material.ultimate_MPa:g} MPa, {origin('ultimate_MPa')}"),
        (
            "yield strength",
            f"{material.yield_MPa:g} MPa, {origin('yield_MPa')}" if material.yield_MPa else "unknown",
        ),
        ("heat treatment", material.heat_treatment or "unknown"),
        ("Young's modulus", f"{material.E_GPa:g} GPa, {origin('E_GPa')}"),
        ("Poisson's ratio", f"{material.poisson:g}, {origin('poisson')}"),
        ("density", f"{material.density_kg_m3:g} kg/m³, {origin('density_kg_m3')}"),
        ("factor K of the forging process", f"{fatigue.process_factor:g}"),
        ("surface treatment", fatigue.treatment or "none counted"),
        ("additional bending stress", f"{fatigue.additional_stress_MPa:g} MPa"),
    ]


def _nominal(check: RuleCheck, history: str) -> Section:
    return Section(
        "nominal",
        "Alternating loads and nominal stresses",
        f"Half the range over the working cycle; {history}. Section 2 of the rule: bending and shear of the "
        "web's section B x W, torsion of the hollow pin and journal.",
        (("Amplitudes", tables.alternating_table(check)),),
    )


def _factors(check: RuleCheck) -> Section:
    outside = (
        f" Outside: {'; '.join(check.outside)}: the factors by elements decide." if check.outside else ""
    )
    outlets = (("Outlets of oil bores", tables.outlets_table(check)),) if check.outlets else ()
    return Section(
        "factors",
        "Stress concentration factors",
        "By the polynomials of section 3 and from ten-node tetrahedra by Appendix III: pure bending, "
        "three-point bending and torsion of one throw whose journals may tilt. The shear factor is what "
        "three-point bending adds to the stress of its moment; below zero the radial force relieves the "
        "fillet. Factors gamma are those at the outlet of an oil bore, B in bending and T in torsion."
        f"{outside}",
        (("Factors", tables.factors_table(check)), *outlets),
    )


def _mesh(check: RuleCheck) -> Section:
    quality = check.quality
    return Section(
        "mesh",
        "Quality of the elements",
        f"{quality.nodes} nodes, {quality.fillet_size_mm:.2f} mm in the finer fillet; checked where each "
        "unit load stresses each fillet most.",
        (("Checks of Appendix III", tables.quality_table(check)),),
    )


def _assumptions(record: RuleRecord) -> Section:
    rows = [{"assumption": entry.key, "value": assumed_words(entry)} for entry in record.assumed] + [
        {"assumption": "loads", "value": record.history},
        {"assumption": "bearings", "value": "rigid, journals free to tilt (Appendix III)"},
    ]
    signed = tuple({**row, "agreed_by": _BLANK} for row in rows)
    people = tuple(
        {"role": role, "name": _BLANK, "date": _BLANK, "signature": _BLANK}
        for role in ("calculated by", "checked by", "approved by")
    )
    return Section(
        "assumptions",
        "Assumptions and signatures",
        f"Written by `{record.command}` on {record.written[:10]} at {record.written[11:16]}."
        if record.command
        else "",
        (
            ("Assumptions", ResultTable({"assumption": 0, "value": 0, "agreed_by": 0}, signed)),
            ("Signatures", ResultTable({"role": 0, "name": 0, "date": 0, "signature": 0}, people)),
        ),
    )
