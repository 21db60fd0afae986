"""A shape optimisation as tables and text: the web against the original, limits, prices, dimensions."""

from __future__ import annotations

import shlex
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path

from cranktopo.base.units import change_text, plain_number
from cranktopo.design.goal.constraint import TOLERANCE, Constraint
from cranktopo.design.goal.quantities import quantity_named
from cranktopo.engine.judged_histories import states_words
from cranktopo.report.goal_table import limits_table, missed_words, short_percent, violated_limits
from cranktopo.report.result_table import Column, ResultTable, Row, tabulate, terminal
from cranktopo.tasks.bound.text import bound_lines
from cranktopo.tasks.extraction.text import release_text, release_verdict
from cranktopo.tasks.throw_fatigue.verdicts import SAME
from cranktopo.tasks.throw_fea.error_bound import difference_bound_percent
from cranktopo.tasks.throw_fea.quantities import (
    BEARING_PRESSURE,
    COMPARED,
    NATURAL_FREQUENCY,
    OIL_FILM,
    SAFETY,
    STRESS,
)
from cranktopo.tasks.web_shape.result import (
    MINIMUM_PERCENT,
    DimensionSensitivity,
    FeatureTrial,
    LimitPrice,
    SensitivityTable,
    ShapeParameter,
    ShapeResult,
    too_loose,
)
from cranktopo.tasks.web_shape.shaft_text import less_safe_in_shaft, shaft_lines

_Parameters = Sequence[DimensionSensitivity]
QUANTITIES_TOLD = {
    **{quantity.key: quantity for quantity in COMPARED},
    "natural_frequency": NATURAL_FREQUENCY,
    "fatigue_safety": SAFETY,
    "stress": STRESS,
    **{quantity.key: quantity for quantity in (OIL_FILM, BEARING_PRESSURE)},
}
"""Quantities of a shape result by their keys in shape.json."""
TOLD_FIRST = ("mass", "torsion", "bending", "natural_frequency", "fatigue_safety", "stress", "oil_film")
"""Those that a web is told by on a line."""
_KILO_UNITS = {
    "kNm_per_rad": "kN m/rad",
    "kN_per_mm": "kN/mm",
    "kNm_per_rad_kg": "kN m/(rad kg)",
    "kN_per_mm_kg": "kN/(mm kg)",
}
_MOVES = {"mm": "1 mm", "deg": "1 degree", "%": "1 %"}


def dimensions_table(parameters: _Parameters) -> ResultTable:
    """Return each dimension with its value, and the change of each quantity per mm or degree."""
    quantities = list(parameters[0].per_unit) if parameters else []
    starts = [p.start if isinstance(p, ShapeParameter) else None for p in parameters]
    start = {"start": 2} if any(value is not None for value in starts) else {}
    columns = {"dimension": 0, "unit": 0, **start, "value": 2, "at_bound": 0, **dict.fromkeys(quantities, 3)}
    rows: list[Row] = []
    for p, begun in zip(parameters, starts, strict=True):
        own: Row = {"dimension": p.name, "unit": p.unit, "start": begun, "value": p.value}
        rows.append({**own, "at_bound": p.at_bound or "", **p.per_unit})
    return ResultTable(columns, tuple(rows))


def held_table(parameters: _Parameters) -> ResultTable:
    """Return each rule, bound or limit with the dimensions that it holds."""
    held: dict[str, list[str]] = {}
    for parameter in parameters:
        for name in parameter.held_by:
            held.setdefault(name, []).append(parameter.name)
    rows = tuple({"held_by": name, "dimensions": ", ".join(found)} for name, found in held.items())
    return ResultTable({"held_by": 0, "dimensions": 0}, rows)


def worst_case_table(worst_case_percent: Mapping[str, float]) -> ResultTable:
    """Return by how much every quantity may change within the tolerance, as one row."""
    worst = {f"{name}_percent": value for name, value in worst_case_percent.items() if name != "tolerance"}
    row: Row = {"off_by": f"{worst_case_percent['tolerance']:g} mm or degrees", **worst}
    return ResultTable({"off_by": 0, **dict.fromkeys(worst, 1)}, (row,))


def sensitivity_text(sensitivities: SensitivityTable | ShapeResult, whole: str) -> list[str]:
    """Return both tables and the worst case for a terminal; percentages refer to `whole`."""
    held, worst = held_table(sensitivities.parameters), dict(sensitivities.worst_case_percent)
    tolerance = worst.pop("tolerance")
    spread = ", ".join(f"{name.replace('_', ' ')} {value:.1f} %" for name, value in worst.items())
    return [
        f"What a millimetre (degree) is worth, % of {whole}:",
        terminal(dimensions_table(sensitivities.parameters)),
        "",
        terminal(held) if held.rows else "No rule or bound holds any of them.",
        "",
        f"With every dimension off by {tolerance:g} mm or degrees in the worst way: {spread}.",
    ]


def changes_table(shape: ShapeResult) -> ResultTable:
    """Return every quantity of the original and of the result, and its change."""
    columns = {"quantity": 0, "unit": 0, "original": 0, "result": 0, "change_percent": 2}
    before, after, rows = shape.values.original, shape.values.result, list[Row]()
    for key in (key for key in QUANTITIES_TOLD if key in before and key in after):
        original, result, unit = value_words(shape, key)
        row: Row = {
            "quantity": QUANTITIES_TOLD[key].label,
            "unit": unit,
            "original": original,
            "result": result,
            "change_percent": shape.change_percent.get(key),
        }
        rows.append(row)
    return ResultTable(columns, tuple(rows))


def value_words(shape: ShapeResult, key: str) -> tuple[str, str, str]:
    """Return a quantity of original and result as text, small ones with four digits, and their unit."""
    quantity = QUANTITIES_TOLD[key]
    factor = 1e-3 if quantity.unit in _KILO_UNITS else 1.0
    values = [factor * web[key] for web in (shape.values.original, shape.values.result)]
    small = max(map(abs, values)) < 10.0 ** (2 - quantity.digits)
    original, result = (plain_number(v) if small else f"{v:.{quantity.digits}f}" for v in values)
    return original, result, _KILO_UNITS.get(quantity.unit, quantity.unit.replace("_", " "))


def feature_trials_table(shape: ShapeResult) -> ResultTable:
    """Return what was tried, what it gained, and whether it was kept."""
    columns: tuple[Column[FeatureTrial], ...] = (
        Column("step", 0, lambda trial: trial.step),
        Column("parameters", 0, lambda trial: trial.parameters),
        Column("gain_percent", 2, lambda trial: trial.gain_percent),
        Column("kept", 0, lambda trial: "yes" if trial.kept else "no"),
        Column("evaluations", 0, lambda trial: trial.evaluations),
    )
    return tabulate(columns, shape.trials)


def rounds_table(shape: ShapeResult) -> ResultTable:
    """Return every web that was evaluated on the way, against the original, and its violations."""
    before, names = shape.values.original, named_first(shape)
    limited = [price.quantity for price in shape.prices]  # one for each limit of the search
    columns = {"web": 0, **{f"{name}_percent": 2 for name in names}, "limits missed": 0}
    rows: tuple[Row, ...] = tuple(
        {
            "web": f"finish {number}" if number else "of the cells" if shape.trials else "of the start",
            **{f"{name}_percent": 100 * (web.values[name] / before[name] - 1) for name in names},
            "limits missed": missed_words(limited, web.excess_percent) or "-",
        }
        for number, web in enumerate(shape.rounds)
    )
    return ResultTable(columns, rows)


def named_first(shape: ShapeResult) -> tuple[str, ...]:
    """Return the quantities that a result is told by, that of the goal first."""
    names = (shape.goal.quantity.name, *TOLD_FIRST)
    return tuple(name for name in dict.fromkeys(names) if name in shape.change_percent)


def change_error_percent(shape: ShapeResult, key: str) -> float:
    """Return what both evaluations may be off in the change of a quantity, by its key in shape.json."""
    if QUANTITIES_TOLD[key] in (SAFETY, STRESS):
        return 100 * SAME
    kind, entries = key.removesuffix("_per_mass"), (shape.original, shape.result)
    if kind not in shape.original.error_estimate_percent:
        return 0.0
    one, other = (entry.error_estimate_percent[kind] for entry in entries)
    triangles = any(entry.mesh.triangles for entry in entries)
    return difference_bound_percent(one, other, triangles=triangles)


def _change_words(shape: ShapeResult, key: str) -> str:
    """Return a change; with its error where it is no larger than this."""
    change, error = shape.change_percent[key], change_error_percent(shape, key)
    return change_text(change, error if abs(change) <= error else 0.0)


def shape_headline(shape: ShapeResult) -> str:
    """Return the result in one sentence; what cannot be made and limits that are missed come first."""
    names = named_first(shape)
    missed = [*violated_limits(shape.goal), *_missed_in_shaft(shape)]
    said = ", ".join(f"{name.replace('_', ' ')} {_change_words(shape, name)}" for name in names)
    nearly = f" within {100 * TOLERANCE:g} %" if any(map(short_percent, shape.goal.limits)) else ""
    less_safe = less_safe_in_shaft(shape)
    holds = "Of a throw alone every limit holds" if less_safe else "Every limit holds"
    judged = f"NOT MET: {'; '.join(missed)};" if missed else f"{holds}{nearly}:"
    unmade = "" if shape.makeable else f"CANNOT BE MADE: {release_text(shape.undercuts)}. "
    first = f"{less_safe}. " if less_safe else ""
    return f"{unmade}{first}{judged} {said} against the original web.{_failing(shape)}"


def _missed_in_shaft(shape: ShapeResult) -> list[str]:
    """Return the safety that the shaft with the best web lacks, if it does."""
    one = shape.in_shaft
    if one is None or one.held:
        return []
    return [
        f"fatigue safety in the shaft >= {one.required:.3f}: reached {one.result:.3f}, web {one.web}, "
        f"{one.part.replace('_', ' ')}"
    ]


def original_keeps(shape: ShapeResult) -> str:
    """Return a sentence where a web misses a limit and the original misses none; empty else."""
    original, limits = shape.values.original, shape.goal.limits
    if not any(limit.holds is False for limit in limits):
        return ""
    kept = all(
        limit.required is not None
        and limit.quantity in original
        and Constraint(limit.quantity, limit.sense, limit.required).satisfied(original[limit.quantity], 0.0)
        for limit in limits
    )
    if not kept:
        return ""
    advice = ", no web on the way did: keep the original" if shape.unfinished is False else ""
    return f"the original web keeps every limit{advice}"


def ended_words(shape: ShapeResult) -> str:
    """Return what is left to do where a web misses a limit and no finish would help; empty else."""
    if shape.held or shape.unfinished is not False:
        return ""
    return "finishes come no nearer: loosen a limit, or widen the envelope or a range of [shape.free]"


def _failing(shape: ShapeResult) -> str:
    """Return the sentence that the web fails by fatigue, whatever its limit; empty where it does not."""
    safety, original = (of.get("fatigue_safety") for of in (shape.values.result, shape.values.original))
    if safety is None or safety >= 1:
        return ""
    alike = f", as the original does with {original:.3f}" if original is not None and original < 1 else ""
    return f" IT FAILS by fatigue: the safety of {safety:.3f} is below 1{alike}."


def safety_places(shape: ShapeResult) -> str:
    """Return the least safety of result and original with their places; empty where none is known."""
    places = [
        f"{web}{of.fatigue_safety:.{SAFETY.digits}f} at {of.fatigue_place}"
        for web, of in (("", shape.result), ("of the original ", shape.original))
        if of.fatigue_safety is not None and of.fatigue_place
    ]
    return f"least {SAFETY.label} {'; '.join(places)}" if places else ""


def safety_remarks(shape: ShapeResult) -> list[str]:
    """Return what the least safeties of result and original rest on or leave out, a sentence each."""
    result, original = (set(of.fatigue_remarks or ()) for of in (shape.result, shape.original))
    both = [line for line in shape.result.fatigue_remarks or () if line in original]
    own = [f"result: {line}" for line in shape.result.fatigue_remarks or () if line not in original]
    others = [f"original: {line}" for line in shape.original.fatigue_remarks or () if line not in result]
    return [*both, *own, *others]


def shape_summary(shape: ShapeResult, folder: Path) -> str:
    """Return what `cranktopo shape` prints of a finished optimisation."""
    lines = [
        shape_headline(shape),
        *filter(
            None,
            [
                shape.left_off,
                *shaft_lines(shape, folder),
                safety_places(shape),
                *safety_remarks(shape),
                shape.balance,
            ],
        ),
        *filter(None, [original_keeps(shape), shape.stop_reason]),
        *([judged] if (judged := stress_loads(shape)) else []),
        *filter(None, [ended_words(shape)]),
        *([f"go on from this web: {shlex.join(_going_on(shape, folder))}"] if shape.unfinished else []),
        *(
            [f"die releases it: {release_verdict(shape.undercuts)}, {release_text(shape.undercuts)}"]
            if shape.undercuts
            else []
        ),
        *bound_lines(shape.bound),
        "",
        terminal(changes_table(shape)),
        "",
        terminal(limits_table(shape.goal)),
        "",
        *multiplier_text(shape),
        "",
        *sensitivity_text(shape, "the original"),
        "",
        f"{shape.seconds['total']:.1f} s, {shape.evaluations} webs solved",
        *(str(folder / name) for name in shape.files.as_json().values()),
    ]
    return "\n".join(lines)


def stress_loads(shape: ShapeResult) -> str:
    """Return the load states of what stresses tell in words; empty where nothing of theirs is told."""
    labels = [
        QUANTITIES_TOLD[key].label for key in ("fatigue_safety", "stress") if key in shape.values.result
    ]
    if shape.loads is None or not labels:
        return ""
    shaft = shape.in_shaft
    judged = "" if shaft is None else f"; solved again the shaft has {shaft.result:.3f} (web {shaft.web})"
    return f"{' and '.join(labels)} {states_words(shape.loads)}{judged}"


def _going_on(shape: ShapeResult, folder: Path) -> list[str]:
    loads = ["--loads", shape.loads] if shape.loads == "cycle" else []
    return ["cranktopo", "shape", str(folder), *loads]


def multiplier_text(shape: ShapeResult) -> list[str]:
    """Return what one percent of each limit costs in the goal, then what a unit of each rule would give."""
    lines = [*(f"{moved} {effect}" for moved, effect in _multipliers(shape)), multiplier_doubt(shape)]
    return [line for line in lines if line]


def multiplier_table(shape: ShapeResult) -> ResultTable:
    """Return the same as a table, one row each."""
    rows = tuple({"a_move_of": moved, "the_goal": effect} for moved, effect in _multipliers(shape))
    return ResultTable({"a_move_of": 0, "the_goal": 0}, rows)


def multiplier_doubt(shape: ShapeResult) -> str:
    """Return the error where the prices do not explain the optimum; empty else."""
    rest = shape.prices_remainder_percent
    doubt = f"prices explain {100 - rest:.0f} % of what the goal still wants: it is not quite the best web"
    return doubt if too_loose(rest) else ""


def _multipliers(shape: ShapeResult) -> Iterator[tuple[str, str]]:
    name = shape.goal.quantity.name.replace("_", " ")
    for price in shape.prices:
        yield _moved(shape, price), _price_effect(shape, price, name)
    known = () if too_loose(shape.prices_remainder_percent) else shape.rule_prices
    rules = [rule for rule in known if rule.goal_percent_per_unit >= MINIMUM_PERCENT]
    better = "less" if shape.goal.minimise else "more"
    for rule in sorted(rules, key=lambda rule: (-round(rule.goal_percent_per_unit, 6), rule.name)):
        effect = f"would give {rule.goal_percent_per_unit:.2f} % {better} {name}"
        yield f"{_MOVES[rule.unit]} of '{rule.name}'", effect


def _moved(shape: ShapeResult, price: LimitPrice) -> str:
    """Return a limit that is tighter by a percent in words; more of a negative value would be lower."""
    upper, quantity = price.sense == "<=", price.quantity.replace("_", " ")
    named = f"the {price.side} {quantity}" if _other_side(shape, price) else ""
    limits = price.outcomes(shape.goal.limits)
    if quantity_named(price.quantity).unit == "%" and limits and limits[0].required:
        now = limits[0].required  # a percent of a percentage says little, the percentage does
        tighter = now - abs(now) / 100 if upper else now + abs(now) / 100
        return f"a {price.side} {quantity} of {tighter:.2f} % in place of {now:g} %"
    if any((limit.required or 0.0) < 0 for limit in limits):
        return f"{named or quantity} {'lower' if upper else 'higher'} by 1 % of its limit"
    return f"1 % {'less' if upper else 'more'} {named and 'of '}{named or quantity}"


def _price_effect(shape: ShapeResult, price: LimitPrice, name: str) -> str:
    own, rest = price.outcomes(shape.goal.limits), shape.prices_remainder_percent
    cost = price.known(shape.goal.limits, rest)
    if cost is None:
        missed = any(limit.holds is False for limit in own)
        return f"has no price known: {'this limit is missed' if missed else 'the prices explain too little'}"
    if cost >= MINIMUM_PERCENT:
        return f"costs {cost:.2f} % {name}"
    other = _other_side(shape, price)
    if other and not any(limit.active for limit in own):
        if (other.known(shape.goal.limits, rest) or 0.0) >= MINIMUM_PERCENT:
            return f"does not decide: the {other.side} does"
        if any(limit.active for limit in other.outcomes(shape.goal.limits)):
            return f"does not decide: the {other.side} is nearer"
    if any(limit.active for limit in own):
        return "costs nothing: the other limits and rules decide before it"
    return "costs nothing: this limit does not decide"


def _other_side(shape: ShapeResult, price: LimitPrice) -> LimitPrice | None:
    """Return the price of the limit on the same quantity from the other side, if there is one."""
    others = (one for one in shape.prices if one.quantity == price.quantity and one.sense != price.sense)
    return next(others, None)
