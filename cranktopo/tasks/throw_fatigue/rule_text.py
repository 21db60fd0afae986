"""Tables and remarks of checks against the crankshaft rule IACS UR M53.

`baseline` is the position of the target that counts as 100 %, if any.
"""

from __future__ import annotations

from collections.abc import Sequence

from cranktopo.report.result_table import Cell, Column, ResultTable, tabulate
from cranktopo.tasks.throw_fatigue.rule_check import RuleCheck
from cranktopo.tasks.throw_fatigue.verdicts import with_percent
from cranktopo.tasks.throw_fea.quantities import MASS, SAFETY

_RULE_COLUMNS: tuple[Column[RuleCheck], ...] = (
    Column("target", 0, lambda c: c.name),
    Column("throw_kg", MASS.digits, lambda c: c.throw_kg),
    Column("governing_Q", SAFETY.digits, lambda c: c.judged_safety),
    Column("pin_Q_rule", 3, lambda c: _by_rule(c, "pin")),
    Column("pin_Q_FE", 3, lambda c: c.fem_checks["pin"].acceptability),
    Column("journal_Q_rule", 3, lambda c: _by_rule(c, "journal")),
    Column("journal_Q_FE", 3, lambda c: c.fem_checks["journal"].acceptability),
    Column("strength_MPa", 1, lambda c: _governing_strength_MPa(c)),
    Column("verdict", 0, lambda c: c.verdict),
    Column("governed_by", 0, lambda c: _governed_by(c)),
)


def rule_table(checks: Sequence[RuleCheck], baseline: int | None) -> ResultTable:
    """Return one row per target: acceptability of both fillets by closed form and by finite elements."""
    return with_percent(tabulate(_RULE_COLUMNS, checks), checks, baseline)


def outlet_table(checks: Sequence[RuleCheck]) -> ResultTable:
    """Outlets of oil bores by the rule, one row each; no rows where there are none.

    Equivalent stresses are those with the factors that govern, FE those of elements.
    """
    rows: tuple[dict[str, Cell], ...] = tuple(
        {
            "target": check.name,
            "outlet": outlet.key,
            "angle_deg": outlet.angle_deg,
            "gamma_B": outlet.gamma_bending,
            "gamma_T": outlet.gamma_torsion,
            "gamma_B_FE": outlet.elements.gamma_bending if outlet.elements else None,
            "gamma_T_FE": outlet.elements.gamma_torsion if outlet.elements else None,
            "bending_MPa": outlet.bending_MPa,
            "torsion_MPa": outlet.torsion_MPa,
            "equivalent_MPa": outlet.decisive_check.equivalent_MPa,
            "strength_MPa": outlet.decisive_check.strength_MPa,
            "Q": outlet.acceptability,
            "Q_FE": outlet.by_elements.acceptability if outlet.by_elements else None,
            "governed_by": outlet.governed_by or "not judged",
            "not_valid": "; ".join(outlet.outside) or "-",
        }
        for check in checks
        for outlet in check.outlets
    )
    stresses = dict.fromkeys(("bending_MPa", "torsion_MPa", "equivalent_MPa", "strength_MPa"), 1)
    factors = dict.fromkeys(("gamma_B", "gamma_T", "gamma_B_FE", "gamma_T_FE"), 3)
    columns = {"target": 0, "outlet": 0, "angle_deg": 0, **factors, **stresses}
    columns |= {"Q": 3, "Q_FE": 3, "governed_by": 0, "not_valid": 0}
    return ResultTable(columns, rows)


def rule_remarks(checks: Sequence[RuleCheck]) -> list[str]:
    """Return what the tables do not say: what is not judged, factors that differ, a coarse mesh."""
    lines = [
        f"{check.name}: NOT COVERED by the rule, and not accepted: {check.not_covered}. Its numbers serve "
        "comparisons alone; `cranktopo fatigue --method lsa` or `fkm` judges this material."
        for check in checks
        if check.not_covered
    ]
    lines += [f"{check.name}: {check.process_remark}." for check in checks if check.process_remark]
    lines += [
        f"{check.name}, {place}: not judged, {why}: the rule accepts this throw only with "
        f"{_way(check, place)}; `cranktopo fatigue --method lsa` counts it."
        for check in checks
        for place, why in check.uncovered.items()
    ]
    lines += [
        f"{check.name}, {place}: not judged, {why}; a smaller --fillet-fraction of `fatigue` may help."
        for check in checks
        for place, why in check.unproven.items()
    ]
    lines += [f"{check.name}, {line}." for check in checks for line in check.departures]
    lines += [f"{check.name}, {line}." for check in checks for line in _outlet_remarks(check)]
    lines += [
        f"{check.name}, finite elements: {check.quality.shortfall}; a smaller --fillet-fraction of `fatigue` "
        "may help."
        for check in checks
        if not (check.quality.within_limits or None in check.governing.values())
    ]
    return lines + [line for check in checks for line in _rule_hardening(check)]


def _way(check: RuleCheck, place: str) -> str:
    """Return what judges an outlet that is not covered."""
    finer = any(outlet.place == place and outlet.waits_for_mesh for outlet in check.outlets)
    return "elements of a smaller --fillet-fraction" if finer else "an analysis of its own"


def _outlet_remarks(check: RuleCheck) -> list[str]:
    """Return outlets that elements judge, and lower numbers of elements that prove nothing."""
    found = []
    for outlet in check.outlets:
        elements = outlet.by_elements
        if elements is None:
            continue
        if outlet.governed_by == "elements" and outlet.outside:
            found.append(f"{outlet.place}: judged by elements, {'; '.join(outlet.outside)}")
        if outlet.governed_by == "polynomials" and elements.acceptability < outlet.check.acceptability:
            why = outlet.unproven or "fatigue.m53_factors is 'polynomials'"
            found.append(
                f"{outlet.place}: Q {outlet.check.acceptability:.3f} by polynomials govern, elements have "
                f"{elements.acceptability:.3f}: {why}"
            )
    return found


def decided_depth(depth_mm: float) -> str:
    """Return the depth that decides in words."""
    return "at the surface" if depth_mm == 0 else f"{depth_mm:.2g} mm below the surface"


def _rule_hardening(check: RuleCheck) -> list[str]:
    return [
        f"{check.name}, {place} fillet, {one.process}: decided {decided_depth(one.depth_mm)}; Q "
        f"{one.surface_acceptability:.3f} at the surface, {one.below_acceptability:.3f} in the transition "
        f"{one.transition_mm:.2g} mm below it."
        for place, found in check.places.items()
        if (one := found.hardening) is not None
    ]


def factor_table(checks: Sequence[RuleCheck]) -> ResultTable:
    """Concentration factors by closed form and by finite elements."""
    rows = tuple(
        {
            "target": check.name,
            "factor": name,
            "rule": getattr(check.scf_rule, name),
            "FE": value,
            "FE_over_rule_percent": 100 * (value / getattr(check.scf_rule, name) - 1),
        }
        for check in checks
        for name, value in vars(check.scf_fem).items()
    )
    return ResultTable({"target": 0, "factor": 0, "rule": 3, "FE": 3, "FE_over_rule_percent": 1}, rows)


def _governing_strength_MPa(check: RuleCheck) -> float:
    """Return the strength at the place that governs; without one the lower of both fillets."""
    place = check.governing_place
    fillets = [one.strength_MPa for one in check.fem_checks.values()]
    return min(fillets) if place is None else check.places[place].strength_MPa


def _governed_by(check: RuleCheck) -> str:
    """Return the place of the governing factor with its set of concentration factors."""
    place = check.governing_place
    return "not judged" if place is None else check.place_words(place)


def _by_rule(check: RuleCheck, fillet: str) -> float | None:
    return None if check.outside else check.rule_checks[fillet].acceptability
