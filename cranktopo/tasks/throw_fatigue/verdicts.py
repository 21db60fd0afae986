"""Fatigue of several targets beside a baseline: as safe, safer or not told apart, and in percent of it.

`baseline` is the position of the target that counts as 100 %, if any.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from cranktopo.base.units import change_text, error_text
from cranktopo.report.result_table import ResultTable
from cranktopo.tasks.throw_fatigue.remarks import mesh_shortfall
from cranktopo.tasks.throw_fatigue.result import FatigueShare, JudgedAs
from cranktopo.tasks.throw_fatigue.rule_check import RuleCheck
from cranktopo.tasks.throw_fatigue.safety_field import FatigueField
from cranktopo.tasks.throw_fatigue.throw_verdict import ThrowVerdict
from cranktopo.tasks.throw_fea.quantities import MASS, SAFETY

SAME = 0.02
"""Relative difference of safety below which two variants count as equal: the scatter of the worst node."""
_SAME_IF_COARSE = 0.04
"""The same where means over elements of a mesh miss the rule's checks."""
_OTHER_LOADS = 0.002
"""Relative difference of a load's amplitude from which two variants are judged by different loads."""
FatigueOutcome = FatigueField | RuleCheck
"""Fatigue of a target by a method of local stresses, or by the rule."""
WORLDS: dict[JudgedAs, str] = {"throw_alone": "of a throw alone", "continuous_shaft": "in its shaft"}
"""Bodies that are judged, in words."""
_SAFETY_COLUMNS = (SAFETY.column, "governing_Q")
"""Mass and safety in percent stand behind the safety, whichever it is."""


@dataclass(frozen=True)
class Summary:
    """Mass and safety of a result.

    Attributes:
        coarse: by means over elements that miss the rule's checks.
        error_percent: estimate of the safety's own error by elements; 0 where none is known.
    """

    name: str
    mass_kg: float
    safety: float
    coarse: bool
    error_percent: float = 0.0


def summary(result: FatigueOutcome) -> Summary:
    """Return mass and safety of either kind of result."""
    if isinstance(result, FatigueField):
        model = result.model
        coarse = bool(mesh_shortfall(model)) and not model.fitted
        return Summary(model.name, model.throw_kg, result.critical.safety, coarse=coarse)
    judged = result.judged_safety
    unproven = judged is None or result.safety < judged
    return Summary(result.name, result.throw_kg, result.safety, unproven, result.least_error_percent)


def safety_change_error_percent(one: Summary, base: Summary) -> float:
    """Return the error of the relative difference between two safeties, %.

    At least the scatter of the worst node from mesh to mesh, and the errors of both where these are known.
    """
    scatter = _SAME_IF_COARSE if one.coarse or base.coarse else SAME
    return max(100 * scatter, one.error_percent + base.error_percent)


def verdicts(
    results: Sequence[FatigueOutcome], baseline: int, answers: Sequence[ThrowVerdict] = ()
) -> list[str]:
    """For each target but the baseline its change of mass and safety, and whether it is as safe.

    Args:
        answers: of the rule to each target; one that it does not judge is not rated.
    """
    found = [summary(result) for result in results]
    unrated = {index: one.target for index, one in enumerate(answers) if one.verdict == "not judged"}
    base = found[baseline]
    lines = []
    for index, one in enumerate(found):
        if index == baseline:
            continue
        ratio = one.safety / base.safety
        open_ones = [unrated[row] for row in (index, baseline) if row in unrated]
        rated = _not_rated(base, open_ones) if open_ones else _as_safe(ratio, one, base)
        error = ratio * safety_change_error_percent(one, base)
        lines.append(
            f"{one.name}: {change_text(100 * (one.mass_kg / base.mass_kg - 1))} mass, "
            f"{change_text(100 * (ratio - 1), error)} safety: {rated}."
        )
        lines += _other_loads(results[index], results[baseline])
        lines += _both_worlds(results[index], results[baseline])
    return lines


def _both_worlds(one: FatigueOutcome, base: FatigueOutcome) -> list[str]:
    """Return a line with the change of safety of a throw alone and in its shaft, where both are known."""
    if not (isinstance(one, FatigueField) and isinstance(base, FatigueField)):
        return []
    if not (one.safety_as and base.safety_as):
        return []
    changes = [
        f"{change_text(100 * (one.safety_as[world] / base.safety_as[world] - 1))} safety {where} "
        f"({one.safety_as[world]:.3f} against {base.safety_as[world]:.3f})"
        for world, where in WORLDS.items()
    ]
    return [f"{one.model.name}: {', '.join(changes)}."]


def _not_rated(base: Summary, open_ones: Sequence[str]) -> str:
    """Return that the least factors do not tell which is safer, as the rule leaves a place open."""
    return f"not rated against {base.name}: the rule does not judge {' and '.join(open_ones)}"


def _as_safe(ratio: float, one: Summary, base: Summary) -> str:
    """Return whether a target is as safe as the baseline, or that their errors are too large to tell."""
    error = safety_change_error_percent(one, base)
    if 100 * abs(ratio - 1) > error:
        return f"{'safer' if ratio > 1 else 'less safe'} than {base.name}"
    meshes = " and of ".join(each.name for each in (one, base) if each.coarse)
    if meshes and abs(ratio - 1) > SAME:
        return (
            f"not told apart from {base.name}: the mesh of {meshes} misses the checks of IACS UR M53, "
            f"and safeties scatter by up to {error_text(error)} % then; "
            "a smaller --fillet-fraction of `fatigue` may help"
        )
    if one.error_percent or base.error_percent:
        return f"equal to {base.name} within their error: {_error_words(one)}, {_error_words(base)}"
    return f"as safe as {base.name}"


def _error_words(one: Summary) -> str:
    """Return a safety with its error, as in `0.739 +-2.7 % by elements`."""
    error = f" +-{one.error_percent:.1f} % by elements" if one.error_percent else " by polynomials"
    return f"{one.safety:.{SAFETY.digits}f}{error}"


def _other_loads(one: FatigueOutcome, base: FatigueOutcome) -> list[str]:
    """Return a line where the rule judged a target by other loads than the baseline: masses, vibration."""
    if not (isinstance(one, RuleCheck) and isinstance(base, RuleCheck)):
        return []
    pairs = (
        ("radial force", "kN", one.loads.radial_N, base.loads.radial_N),
        ("bending moment", "kN m", one.loads.moment_Nm, base.loads.moment_Nm),
        ("torque", "kN m", one.loads.torque_Nm, base.loads.torque_Nm),
    )
    differ = [
        f"{name} {own / 1000:.4g} against {other / 1000:.4g} {unit}"
        for name, unit, own, other in pairs
        if abs(own - other) > _OTHER_LOADS * abs(other)
    ]
    return [f"{one.name}: other load amplitudes than {base.name}: {', '.join(differ)}."] if differ else []


def percent_of_baseline(results: Sequence[FatigueOutcome], baseline: int) -> tuple[FatigueShare, ...]:
    """Return safety and mass of each target in percent of the baseline."""
    found = [summary(result) for result in results]
    base = found[baseline]
    return tuple(
        FatigueShare(
            target=one.name,
            safety_percent=100 * one.safety / base.safety,
            mass_percent=100 * one.mass_kg / base.mass_kg,
        )
        for one in found
    )


def with_percent(table: ResultTable, results: Sequence[FatigueOutcome], baseline: int | None) -> ResultTable:
    """Return the table with mass and safety in percent of the baseline."""
    if baseline is None:
        return table
    found = [summary(result) for result in results]
    base = found[baseline]
    added = {MASS.percent_column: 1, SAFETY.percent_column: 1}
    rows = tuple(
        {
            **row,
            MASS.percent_column: 100 * one.mass_kg / base.mass_kg,
            SAFETY.percent_column: 100 * one.safety / base.safety,
        }
        for row, one in zip(table.rows, found, strict=True)
    )
    columns: dict[str, int] = {}
    for name, digits in table.columns.items():
        columns |= {name: digits} | (added if name in _SAFETY_COLUMNS else {})
    return ResultTable(columns, rows)
