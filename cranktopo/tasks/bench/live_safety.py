"""Fatigue safety while a dimension is dragged: that of the last settled web, changed as the rule says.

The concentration factors and nominal stresses of IACS UR M53 know every dimension of a usual throw, and the
stress gradient of a fillet the strength of its points. What both say of a change is near what elements say
where each dimension has a gain of its own: the rule underrates the diameter of a journal. Without an overlap
of the journals it does not know what the throw does at the main journal.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from math import exp, inf, isfinite, log
from typing import Any

from cranktopo.tasks.bench.coarse_error import moved_dimensions

BY_RULE = {"pin_fillet_safety": "m53_pin", "journal_fillet_safety": "m53_journal"}
"""Gauge of the rule for each fillet."""
_OF_SHAPE = {"throw", "web"}
_NO_MATTER = {"name", "description", "goal", "optimise", "shape", "envelope", "drawing"}
"""Tables that no stress follows from."""
_NOT_MEASURED = {"shaft", "second_web"}
"""Tables of which nothing is known: torque of a vibrating shaft, webs that differ."""


@dataclass(frozen=True)
class _Effect:
    """Dependence of a safety on a dimension.

    Attributes:
        gain: change of its logarithm over that of the rule.
        power: of the dimension itself besides, where the rule does not know all that it does.
        by_way: error, percent for each percent of the dimension's way, besides that of all.
        helps: nothing is told where the rule says that more of it is worse: its polynomials turn there, the
            throw does not.
    """

    gain: float = 1.0
    power: float = 0.0
    by_way: float = 0.0
    helps: bool = False


_PIN, _MAIN = "throw.crankpin", "throw.main_journal"
_NONE, _UNKNOWN = _Effect(), _Effect(by_way=inf)
_COMMON = {
    f"{_PIN}.length_mm": _Effect(by_way=0.04),
    "web.counterweight.outer_radius_mm": _NONE,
    "web.counterweight.half_angle_deg": _NONE,
}
_EFFECTS = {
    "pin_fillet_safety": _COMMON
    | {
        f"{_PIN}.fillet_mm": _Effect(0.93, by_way=0.02),
        f"{_PIN}.outer_diameter_mm": _Effect(1.53, by_way=0.8),
        f"{_PIN}.bore_diameter_mm": _Effect(0.92, by_way=0.12),
        f"{_MAIN}.fillet_mm": _Effect(power=0.02, by_way=0.02),
        f"{_MAIN}.outer_diameter_mm": _Effect(0.5, by_way=0.3),
        f"{_MAIN}.bore_diameter_mm": _Effect(0.7, by_way=0.1),
        f"{_MAIN}.length_mm": _Effect(0.9, by_way=0.1),
        "throw.radius_mm": _Effect(1.05, by_way=0.3),
        "web.thickness_mm": _Effect(0.82, by_way=0.2),
        "web.width_mm": _Effect(1.0, by_way=0.05, helps=True),
    },
    "journal_fillet_safety": _COMMON
    | {
        f"{_PIN}.fillet_mm": _Effect(power=0.04, by_way=0.03),
        f"{_PIN}.outer_diameter_mm": _Effect(1.0, by_way=0.7),
        f"{_PIN}.bore_diameter_mm": _Effect(1.2, by_way=0.4),
        f"{_MAIN}.fillet_mm": _Effect(0.97, by_way=0.02),
        f"{_MAIN}.outer_diameter_mm": _Effect(2.0, by_way=0.9),
        f"{_MAIN}.bore_diameter_mm": _Effect(0.6, by_way=0.1),
        f"{_MAIN}.length_mm": _Effect(0.9, by_way=0.1),
        "throw.radius_mm": _Effect(1.0, power=-0.15, by_way=0.4),
        "web.thickness_mm": _Effect(0.87, by_way=0.3),
        "web.width_mm": _Effect(1.58, by_way=0.35),
    },
}
"""By dimension, of those that were moved.

Fitted to 83 moves of five throws, and corrected by 72 moves of 20 throws (`tests.studies.live_ring`, 20000 to
20071). A diameter does another thing to every throw: the journal fillet gains 0.1 to 1.7 % for each percent
of the main journal, the pin fillet 0.9 to 2.1 % for each of the pin. A bore that ends near the other
journal's fillet relieves or loads it as no rule knows: 2.7 % where the bore of the pin lost 9 %. Move 20180
widened the error of the web's width once more: a journal fillet was 3.4 % off. Moves 20497 to 21079 gave the
gains of the fillets with the strength of their points, and that of the main journal's bore.
"""
_LEAST_PERCENT, _SHARE = 1.8, 0.1
"""Error, percent: two meshes of a web differ by up to 1 % each; and per percent that the safety changes."""
MOST_PERCENT = 3.0
"""Error beyond which nothing is told."""
_ELSEWHERE = 1.08
"""Safety off the fillets over the least one from which its own change, which nothing tells, is no matter."""


@dataclass(frozen=True)
class SettledSafety:
    """A web whose safety has settled.

    Attributes:
        data: tables of its design.
        safety: gauges of `settled_safety`.
        elsewhere: least safety off the fillets.
        by_rule: what `rule_of_fillets` tells of it.
    """

    data: Mapping[str, Any] = field(default_factory=dict)
    safety: Mapping[str, float] = field(default_factory=dict)
    elsewhere: float = 0.0
    by_rule: Mapping[str, float] = field(default_factory=dict)


def rule_of_fillets(numbers: Mapping[str, Any]) -> dict[str, float]:
    """Return the acceptability of each fillet by the rule, times the strength of its points, by its gauge.

    Args:
        numbers: of `live_numbers`.
    """
    gauges, strengths = numbers.get("gauges", {}), numbers.get("strengths_MPa", {})
    return {name: gauges[name] * strengths.get(name, 1.0) for name in BY_RULE.values() if name in gauges}


def estimated_safety(
    settled: SettledSafety, data: Mapping[str, Any], by_rule: Mapping[str, float]
) -> dict[str, dict[str, float]]:
    """Return the safeties of a moved web and their errors in percent, as far as these are small enough.

    Nothing of a web that is too far from the settled one, or differs by more than its main dimensions, nor
    where the settled one is least safe off its fillets: there the rule does not know what loads it.

    Args:
        data: tables of the moved design.
        by_rule: what `rule_of_fillets` tells of it.
    """
    fillets = [settled.safety.get(name, inf) for name in BY_RULE]
    moved = None if settled.elsewhere < min(fillets) else _moved(settled.data, data)
    found = dict[str, tuple[float, float]]()
    for name, rule in BY_RULE.items():
        told = name in settled.safety and rule in by_rule and rule in settled.by_rule
        if moved is not None and told:
            change, error = _change(_EFFECTS[name], moved, log(by_rule[rule] / settled.by_rule[rule]))
            found[name] = settled.safety[name] * exp(change), error
    if found.keys() == BY_RULE.keys():
        found |= _least(found, settled.elsewhere)
    kept = {name: pair for name, pair in found.items() if pair[1] <= MOST_PERCENT}
    return {
        "gauges": {name: value for name, (value, _) in kept.items()},
        "error_percent": {name: error for name, (_, error) in kept.items()},
    }


def _least(found: Mapping[str, tuple[float, float]], elsewhere: float) -> dict[str, tuple[float, float]]:
    """Return the least safety of a throw, by those of both fillets; nothing where it may lie elsewhere.

    A fillet that is not less safe by all of its error adds nothing to that of the least one.
    """
    least = min(value for value, _ in found.values())
    if _ELSEWHERE * least >= elsewhere:
        return {}
    errors = [error for value, error in found.values() if value * (1 - error / 100) <= least]
    return {"fatigue_safety": (least, max(errors))}


def _moved(first: Mapping[str, Any], moved: Mapping[str, Any]) -> dict[str, float] | None:
    """Return the logarithm of what each dimension that moved is over what it was; None for another web."""
    free = _OF_SHAPE | _NO_MATTER
    others = [{name: table for name, table in data.items() if name not in free} for data in (first, moved)]
    dimensions = moved_dimensions(first, moved)
    if dimensions is None or others[0] != others[1] or _NOT_MEASURED & moved.keys():
        return None
    return {key: log(new / old) if min(old, new) > 0 else inf for key, (old, new) in dimensions.items()}


def _change(
    effects: Mapping[str, _Effect], moved: Mapping[str, float], by_rule: float
) -> tuple[float, float]:
    """Return the change of the logarithm of a safety, and its error in percent.

    Where dimensions move together, and it is not known which does what, the error has the spread of gains.
    """
    found = [(effects.get(key, _UNKNOWN) if isfinite(way) else _UNKNOWN, way) for key, way in moved.items()]
    if any(effect.helps and way * by_rule < 0 for effect, way in found):
        return 0.0, inf
    gains = [effect.gain for effect, _ in found] or [1.0]
    lowest, highest = min(gains), max(gains)
    change = (lowest + highest) / 2 * by_rule + sum(e.power * way for e, way in found if e.power)
    error = _LEAST_PERCENT + 100 * (_SHARE * abs(change) + (highest - lowest) / 2 * abs(by_rule))
    return change, error + 100 * sum(e.by_way * abs(way) for e, way in found if e.by_way)
