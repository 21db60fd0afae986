"""Tables of a check against the crankshaft rule IACS UR M53, in the order of a reviewer's questions."""

from __future__ import annotations

import math
from collections.abc import Iterator

from cranktopo.report.result_table import Cell, Column, ResultTable, tabulate
from cranktopo.tasks.throw_fatigue.m53 import Dimensions, FilletCheck, Ratio, ratios
from cranktopo.tasks.throw_fatigue.m53_outlet import OutletCheck
from cranktopo.tasks.throw_fatigue.rule_check import RuleCheck
from cranktopo.tasks.throw_fatigue.rule_text import outlet_table

_SYMBOLS = (
    ("D", "crankpin diameter", "pin"),
    ("DG", "main journal diameter", "journal"),
    ("DBH", "bore of the crankpin", "pin_bore"),
    ("DBG", "bore of the main journal", "journal_bore"),
    ("RH", "fillet radius at the crankpin", "pin_fillet"),
    ("RG", "fillet radius at the main journal", "journal_fillet"),
    ("TH", "recess at the crankpin", "pin_recess"),
    ("TG", "recess at the main journal", "journal_recess"),
    ("E", "throw radius", "throw"),
    ("W", "thickness of the web", "web_thickness"),
    ("B", "width of the web half-way between its axes", "web_width"),
)
_FACTORS = {
    "alpha_bending": ("alpha B", "bending at the crankpin fillet"),
    "alpha_torsion": ("alpha T", "torsion at the crankpin fillet"),
    "beta_bending": ("beta B", "bending at the journal fillet"),
    "beta_shear": ("beta Q", "shear at the journal fillet"),
    "beta_torsion": ("beta T", "torsion at the journal fillet"),
}
"""Symbol of the rule and meaning of each factor."""
_UNPROVEN = "elements (prove nothing here)"
"""Of elements whose mesh misses the checks of Appendix III."""
_RATIO_COLUMNS: tuple[Column[Ratio], ...] = (
    Column("ratio", 0, lambda r: r.name),
    Column("value", 3, lambda r: r.value),
    Column("valid_from", 0, lambda r: f"{r.low:g}" if math.isfinite(r.low) else "any"),
    Column("valid_to", 0, lambda r: f"{r.high:g}"),
    Column("polynomials_valid", 0, lambda r: _yes(r.valid)),
)


def size_table(check: RuleCheck) -> ResultTable:
    """Return the throw in the symbols of the rule, with the oil bores whose outlets it judges."""
    rows = [
        {"symbol": s, "dimension": name, "value_mm": getattr(check.size, key)} for s, name, key in _SYMBOLS
    ]
    for outlet in check.outlets:
        rows += [
            {"symbol": "DO", "dimension": f"oil bore, {outlet.place}", "value_mm": outlet.bore_mm},
            {"symbol": "-", "dimension": f"rounding of the {outlet.place}", "value_mm": outlet.rounding_mm},
        ]
    return ResultTable({"symbol": 0, "dimension": 0, "value_mm": 2}, tuple(rows))


def ratio_table(size: Dimensions) -> ResultTable:
    """Return the ratios that the polynomials depend on, with the range in which they are valid."""
    return tabulate(_RATIO_COLUMNS, ratios(size))


def factors_table(check: RuleCheck) -> ResultTable:
    """Return the concentration factors in the symbols of the rule, by polynomials and by elements."""
    rows: list[dict[str, Cell]] = []
    for name, (symbol, meaning) in _FACTORS.items():
        rule, elements = getattr(check.scf_rule, name), getattr(check.scf_fem, name)
        row: dict[str, Cell] = {"symbol": symbol, "of": meaning, "polynomials": rule, "elements": elements}
        rows.append({**row, "elements_over_polynomials_percent": 100 * (elements / rule - 1)})
    columns = {"symbol": 0, "of": 0, "polynomials": 3, "elements": 3, "elements_over_polynomials_percent": 1}
    return ResultTable(columns, tuple(rows))


def outlets_table(check: RuleCheck) -> ResultTable:
    """Return the outlets of oil bores of one throw."""
    found = outlet_table([check])
    return ResultTable({name: n for name, n in found.columns.items() if name != "target"}, found.rows)


def alternating_table(check: RuleCheck) -> ResultTable:
    """Alternating loads and the nominal stresses that follow."""
    loads, nominal = check.loads, check.nominal
    rows: tuple[tuple[str, float, str], ...] = (
        ("radial force on the crankpin", loads.radial_N, "N"),
        ("bending moment at the web's mid-plane", loads.moment_Nm, "N m"),
        ("torque", loads.torque_Nm, "N m"),
        ("nominal bending stress of the web", nominal.bending_MPa, "MPa"),
        ("nominal shear stress of the web", nominal.shear_MPa, "MPa"),
        ("nominal torsional stress of the crankpin", nominal.pin_torsion_MPa, "MPa"),
        ("nominal torsional stress of the main journal", nominal.journal_torsion_MPa, "MPa"),
    )
    cells: tuple[dict[str, Cell], ...] = tuple(
        {"amplitude": name, "value": value, "unit": unit} for name, value, unit in rows
    )
    return ResultTable({"amplitude": 0, "value": 1, "unit": 0}, cells)


def acceptability_table(check: RuleCheck) -> ResultTable:
    """Equivalent stress, strength and acceptability factor of each place, of fillets by both sets of factors.

    The band of an element factor is what the stress jumps between the elements at the peak.
    """
    rows: list[dict[str, Cell]] = []
    for by, checks in (("elements", check.fem_checks), ("polynomials", check.rule_checks)):
        for place, found in checks.items():
            elements = by == "elements"
            band = found.acceptability * check.quality.jump_percent / 100 if elements else None
            valid, proven = elements or not check.outside, not elements or check.quality.within_limits
            named = by if proven else _UNPROVEN
            rows.append(
                {
                    "fillet": place,
                    "factors_by": named if valid else f"{by} (not valid here)",
                    "equivalent_MPa": found.equivalent_MPa,
                    "strength_MPa": found.strength_MPa,
                    "Q": found.acceptability,
                    "plus_or_minus": band,
                    "accepted": _accepted(check, found, proven) if valid else "-",
                }
            )
    for outlet in check.outlets:
        rows += _outlet_rows(check, outlet)
    columns = {"fillet": 0, "factors_by": 0, "equivalent_MPa": 1, "strength_MPa": 1, "Q": 3}
    return ResultTable(columns | {"plus_or_minus": 3, "accepted": 0}, tuple(rows))


def _outlet_rows(judged: RuleCheck, outlet: OutletCheck) -> Iterator[dict[str, Cell]]:
    """Yield an outlet with the factors of elements, where there are any, and with those of the rule."""
    sets: list[tuple[str, FilletCheck, float | None, str]] = []
    if (found := outlet.by_elements) and outlet.elements:
        scatter = found.acceptability * outlet.elements.checks.jump_percent / 100
        by = _UNPROVEN if outlet.unproven else "elements"
        sets.append((by, found, scatter, _accepted(judged, found, not outlet.unproven)))
    by = "polynomials (not valid here)" if outlet.outside else "polynomials"
    sets.append((by, outlet.check, None, _accepted(judged, outlet.check, not outlet.outside)))
    for by, check, band, answer in sets:
        valid = by.startswith("elements") or not outlet.outside
        yield {
            "fillet": outlet.place,
            "factors_by": by,
            "equivalent_MPa": check.equivalent_MPa,
            "strength_MPa": check.strength_MPa,
            "Q": check.acceptability if valid else None,
            "plus_or_minus": band,
            "accepted": answer,
        }


def _accepted(check: RuleCheck, found: FilletCheck, proven: bool) -> str:
    """Return the rule's answer to a number, which factors give that hold there or not."""
    if not proven:
        return "not judged"
    return "not covered" if check.not_covered else _yes(found.accepted)


def quality_table(check: RuleCheck) -> ResultTable:
    """Return the mesh checks of Appendix III beside their limits."""
    cells: tuple[dict[str, Cell], ...] = tuple(
        {
            "check": one.name + " at the peak" * (one.unit == "%"),
            "value": one.value,
            "at_most": one.at_most,
            "unit": one.unit,
            "kept": _yes(one.kept),
        }
        for one in check.quality.checks
    )
    return ResultTable({"check": 0, "value": 2, "at_most": 2, "unit": 0, "kept": 0}, cells)


def _yes(answer: bool) -> str:
    return "yes" if answer else "no"
