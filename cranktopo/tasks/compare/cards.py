"""Cards of a comparison: the best entry of each quantity; none where others are within the error estimate."""

from __future__ import annotations

from collections.abc import Sequence

from cranktopo.base.units import change_text
from cranktopo.report.page import Fact, FactStatus
from cranktopo.tasks.compare.result import Comparison
from cranktopo.tasks.optimise.text import fatigue_fact
from cranktopo.tasks.throw_fatigue.text import FatigueComparison, load_words
from cranktopo.tasks.throw_fea.quantities import (
    BENDING_PER_MASS,
    MASS,
    SAFETY,
    TORSION_PER_MASS,
    Quantity,
    quantity_text,
)

_LABELS = {
    MASS: "Lightest",
    TORSION_PER_MASS: "Stiffest in torsion per mass",
    BENDING_PER_MASS: "Stiffest in bending per mass",
    SAFETY: "Safest against fatigue",
}
"""Quantities that make the verdict, and how they read there."""


def best_facts(comparison: Comparison) -> tuple[Fact, ...]:
    """Return a card for each quantity that makes the verdict."""
    facts = tuple(_best(comparison, q, label) for q, label in _LABELS.items() if q in comparison.quantities)
    if comparison.fatigue is not None:
        return facts
    return (*facts, fatigue_fact(None, "only stiffness was compared; --fatigue adds the safety"))


def change_words(comparison: Comparison, row: int, quantity: Quantity) -> str:
    """Return the change of a quantity against the baseline, with the bound of its error where it has one."""
    percent = comparison.percent(row, quantity)
    if quantity.error is None or row == comparison.baseline:
        return change_text(percent - 100)
    error = percent / 100 * comparison.change_error_percent(row, comparison.baseline, quantity)
    return change_text(percent - 100, error)


def _best(comparison: Comparison, quantity: Quantity, label: str) -> Fact:
    """Return which entry has the best value of a quantity, or which are level."""
    if len(comparison.rated(quantity)) < 2:
        return _no_best(comparison, quantity, label)
    row, level = comparison.leading(quantity), comparison.level(quantity)
    rows = sorted((row, *level))
    failing = _failing(comparison, rows, quantity)
    if level:
        name = "no clear best"
        notes = [
            *(f"{comparison.entries[one].name} {_value_words(comparison, one, quantity)}" for one in rows),
            "they differ by less than the error estimate",
            *(f"{target} {why}" for target, why in failing.items()),
        ]
    else:
        name = comparison.entries[row].name
        notes = [_value_words(comparison, row, quantity), *failing.values()]
    if quantity is SAFETY and comparison.fatigue is not None:
        notes.append(method_words(comparison.fatigue))
    status: FactStatus = "neutral" if comparison.baseline in rows else "good"
    return Fact(label, name, "; ".join(notes), "bad" if failing else status)


def _no_best(comparison: Comparison, quantity: Quantity, label: str) -> Fact:
    """Return that none is best: the rule judges none, or one was judged alone."""
    rated = comparison.rated(quantity)
    if not rated:
        unrated = " and ".join(entry.name for entry in comparison.entries)
        return Fact(label, "none", f"the rule judges none of {unrated}", "bad")
    failing = _failing(comparison, rated, quantity)
    words = _value_words(comparison, rated[0], quantity)
    note = "; ".join((f"only {comparison.entries[rated[0]].name} was judged: {words}", *failing.values()))
    return Fact(label, "not compared", note, "bad" if failing else "unknown")


def _value_words(comparison: Comparison, row: int, quantity: Quantity) -> str:
    """Return a value of an entry, and its change against the baseline's."""
    own = quantity_text(quantity, comparison.entries[row].values[quantity.key])
    if row == comparison.baseline:
        return f"{own}, the baseline itself"
    return f"{own}, {_against_baseline(comparison, row, quantity)}"


def _failing(comparison: Comparison, rows: Sequence[int], quantity: Quantity) -> dict[str, str]:
    """Return why entries fail by fatigue, where the safety is asked for."""
    if comparison.fatigue is None or quantity is not SAFETY:
        return {}
    names, failing = [comparison.entries[row].name for row in rows], comparison.fatigue.failing
    return {name: failing[name] for name in names if name in failing}


def method_words(fatigue: FatigueComparison) -> str:
    """Return method and load states of a safety, as in `by lsa, over every angle of the cycle`."""
    return f"by {fatigue.result.method}, {load_words(fatigue.result)}"


def _against_baseline(comparison: Comparison, row: int, quantity: Quantity) -> str:
    if not comparison.has_percent(row, quantity):
        return "the baseline was not judged"
    base = quantity_text(quantity, comparison.base.values[quantity.key])
    return f"{change_words(comparison, row, quantity)} against the baseline's {base}"
