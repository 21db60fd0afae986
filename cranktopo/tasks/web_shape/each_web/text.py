"""A crank whose webs have dimensions of their own as tables and text, beside one web for all."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from cranktopo.design.goal.constraint import TOLERANCE
from cranktopo.report.result_table import ResultTable, Row, terminal
from cranktopo.tasks.web_shape.each_web.groups import WebGroup
from cranktopo.tasks.web_shape.each_web.loaded_shaft import ShaftFigures
from cranktopo.tasks.web_shape.each_web.result import CrankVariant, EachWebResult, GroupSearch, differing

_KILO = 1e-3


def crank_table(result: EachWebResult) -> ResultTable:
    """Return the cranks at equal limits: with the design's web, with one for all, with webs of their own."""
    cranks = (
        ("the design's web", result.original, ""),
        ("one web for all", result.one_web.shaft, _verdict(result.one_web)),
        ("each its own", result.each_web.shaft, _verdict(result.each_web)),
    )
    rows: tuple[Row, ...] = tuple(
        {
            "webs": name,
            "mass_kg": shaft.mass_kg,
            "change_percent": 100 * (shaft.mass_kg / result.original.mass_kg - 1),
            "end_to_end_kNm_per_rad": _KILO * shaft.torsion_end_to_end_Nm_per_rad,
            "least_safety": shaft.safety,
            "limits": limits,
        }
        for name, shaft, limits in cranks
    )
    digits = {"webs": 0, "mass_kg": 3, "change_percent": 2}
    return ResultTable({**digits, "end_to_end_kNm_per_rad": 2, "least_safety": 3, "limits": 0}, rows)


def _verdict(crank: CrankVariant) -> str:
    if not crank.makeable:
        return "cannot be made"
    return "kept" if crank.held else "missed"


def load_table(result: EachWebResult) -> ResultTable:
    """Return the moments in each web of the design's shaft, and its safety before and after."""
    one, own = (_safeties(crank.shaft) for crank in (result.one_web, result.each_web))
    rows: tuple[Row, ...] = tuple(
        {
            "web": str(web.web),
            "throw": str(web.throw),
            "bending_Nm": web.bending_range_Nm,
            "across_Nm": web.side_bending_range_Nm,
            "torque_Nm": web.torque_range_Nm,
            "safety": web.safety,
            "one_web": one[web.web],
            "own_web": own[web.web],
            "half_throw_kg": result.each_web.group_of(web.web).throw_kg / 2,
        }
        for web in result.original.webs
    )
    digits = {"web": 0, "throw": 0, "bending_Nm": 0, "across_Nm": 0, "torque_Nm": 0}
    return ResultTable({**digits, "safety": 3, "one_web": 3, "own_web": 3, "half_throw_kg": 3}, rows)


def _safeties(shaft: ShaftFigures) -> dict[int, float]:
    return {web.web: web.safety for web in shaft.webs}


def search_table(result: EachWebResult) -> ResultTable:
    """Return the searches: the safety that each kept and reached, mass and stiffness of its throw."""
    rows: tuple[Row, ...] = tuple(
        {
            "webs": name,
            "safety_kept": group.required,
            "reached": group.reached,
            "design": group.original_reached,
            "throw_kg": group.throw_kg,
            "change_percent": 100 * (group.throw_kg / group.original_throw_kg - 1),
            "torsion_percent": group.torsion_percent - 100,
            "bending_percent": group.bending_percent - 100,
        }
        for name, group in _named(result).items()
    )
    digits = {"webs": 0, "safety_kept": 3, "reached": 3, "design": 3, "throw_kg": 3, "change_percent": 2}
    return ResultTable({**digits, "torsion_percent": 2, "bending_percent": 2}, rows)


def dimension_table(result: EachWebResult) -> ResultTable:
    """Return the dimensions in which the webs differ, one column for each group."""
    named = {name: group.dimensions for name, group in _named(result).items()}
    rows: tuple[Row, ...] = tuple(
        {"dimension": key, **{name: own.get(key) for name, own in named.items()}} for key in differing(named)
    )
    return ResultTable({"dimension": 0, **dict.fromkeys(named, 2)}, rows)


def round_table(result: EachWebResult) -> ResultTable:
    """Return mass and least safety of both cranks after each round of searches."""
    rows: list[Row] = []
    for name, crank in (("one web for all", result.one_web), ("each its own", result.each_web)):
        for number, at in enumerate(crank.rounds):
            kept = "taken" if number == crank.best_round else ""
            rows.append(
                {
                    "webs": name,
                    "round": number + 1,
                    "mass_kg": at.mass_kg,
                    "safety": at.safety,
                    "result": kept,
                }
            )
    return ResultTable({"webs": 0, "round": 0, "mass_kg": 3, "safety": 3, "result": 0}, tuple(rows))


def _named(result: EachWebResult) -> Mapping[str, GroupSearch]:
    """Return the searches by the words of their webs, that for all first."""
    groups = {WebGroup(group.webs).words: group for group in result.each_web.groups}
    return {"all": result.one_web.groups[0], **groups}


def each_web_headline(result: EachWebResult) -> str:
    """Return the result in one sentence, what is missed first."""
    one, own = result.one_web, result.each_web
    if not result.safety_decides:
        return (
            f"Webs of their own gain nothing: the least safety of {result.required_safety:.3f} does not "
            "decide, stiffness or rules do, alike for all webs. One web for all gives "
            f"{one.shaft.mass_kg:.3f} kg; the design has {result.original.mass_kg:.3f} kg."
        )
    missed = "" if own.held else "NOT MET with webs of their own. "
    unmade = "" if own.makeable else "CANNOT BE MADE: a web that its process does not release. "
    beside = "" if one.held else ", which misses its limits"
    more = "less" if result.saved_percent >= 0 else "more"
    return (
        f"{unmade}{missed}With {len(own.groups)} different webs the crank has {own.shaft.mass_kg:.3f} kg, "
        f"{abs(result.saved_percent):.2f} % {more} than with one web for all "
        f"({one.shaft.mass_kg:.3f} kg{beside}); the design has {result.original.mass_kg:.3f} kg."
    )


def grouping_text(result: EachWebResult) -> str:
    """Return which webs are equal, and why."""
    same_webs = "; ".join(WebGroup(webs).words for webs in result.same_webs)
    rest = [group.webs for group in result.each_web.groups if group.webs not in result.same_webs]
    named = f"Equal by shape.same_webs: {same_webs}. " if same_webs else ""
    if not rest:
        return named.rstrip()
    pairs = "Mirror pairs are equal, and webs" if result.mirrored else "Webs are equal"
    return (
        f"{named}{pairs} whose least safeties in the design's shaft differ by less than "
        f"{result.alike_percent:g} %: {'; '.join(WebGroup(webs).words for webs in rest)}."
    )


def limits_text(result: EachWebResult) -> str:
    """Return the limits that every web keeps, in a sentence."""
    limits = ", ".join(f"{name} {condition}" for name, condition in result.limits.items())
    return (
        f"Every web keeps {limits}; safety of {result.required_safety:.3f} in the shaft, within "
        f"{100 * TOLERANCE:g} %."
    )


def _dimensions(result: EachWebResult) -> list[str]:
    table = dimension_table(result)
    if not table.rows:
        return ["No dimension of the webs differs."]
    return ["Dimensions in which the webs differ, mm or degrees:", terminal(table)]


def each_web_summary(result: EachWebResult, folder: Path) -> str:
    """Return what `cranktopo shape --each-web` prints."""
    lines = [
        each_web_headline(result),
        *filter(None, [result.left_off]),
        limits_text(result),
        grouping_text(result),
        "",
        terminal(crank_table(result)),
        "",
        "Ranges of the moments in the middle of each web of the design's shaft, and its least safety there,",
        "then with one web for all and with its own:",
        terminal(load_table(result)),
        "",
        "The searches, each for a throw of two such webs under the loads of the shaft:",
        terminal(search_table(result)),
        "",
        *_dimensions(result),
        "",
        terminal(round_table(result)),
        "",
        f"{result.seconds:.0f} s",
        *(str(folder / name) for name in result.files.values()),
    ]
    return "\n".join(lines)
