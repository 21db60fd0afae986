"""The report of a shape optimisation as content: verdict, limits and their prices, dimensions, both webs."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from cranktopo.base.units import change_text
from cranktopo.design.goal.balance_moved import balance_words
from cranktopo.design.goal.quantities import QUANTITIES
from cranktopo.design.schema import Scene
from cranktopo.engine.judged_histories import states_words
from cranktopo.report.goal_table import limits_table
from cranktopo.report.page import (
    Fact,
    FactStatus,
    Page,
    Section,
    assumed_tables,
    left_off_first,
    origin_rows,
    pairs,
    versions_section,
)
from cranktopo.report.plot import Picture, picture, plain
from cranktopo.report.viewer.scene3d import Scene3D, ShownBody, gallery_picture
from cranktopo.runs.manifest import Manifest
from cranktopo.tasks.bound.text import bound_sections
from cranktopo.tasks.extraction.text import release_text, release_verdict
from cranktopo.tasks.throw_fea.quantities import SAFETY, STRESS
from cranktopo.tasks.throw_fea.section import clearance_sections
from cranktopo.tasks.web_shape.result import ShapeResult
from cranktopo.tasks.web_shape.shaft_text import shaft_lines
from cranktopo.tasks.web_shape.text import (
    QUANTITIES_TOLD,
    change_error_percent,
    changes_table,
    dimensions_table,
    ended_words,
    feature_trials_table,
    held_table,
    multiplier_doubt,
    multiplier_table,
    named_first,
    original_keeps,
    rounds_table,
    safety_places,
    safety_remarks,
    shape_headline,
    stress_loads,
    value_words,
    worst_case_table,
)


def shape_page(shape: ShapeResult, manifest: Manifest, scene: Scene, bodies: tuple[ShownBody, ...]) -> Page:
    """Return the report of a finished shape optimisation; half throws of result and original, its scene."""
    return Page(
        title=f"Best dimensions of the crank web of {shape.design}",
        subtitle=f"Run {manifest.run}, {manifest.started[:10]}",
        headline=page_headline(shape),
        facts=(
            *(quantity_fact(shape, key) for key in named_first(shape)),
            *_balance(shape),
            release_fact(shape),
        ),
        sections=(
            _goal_section(shape),
            *bound_sections(shape.bound, "the body-fitted evaluation"),
            _dimensions(shape),
            *clearance_sections(scene, bodies),
            _search(shape),
            _provenance(shape, manifest),
            versions_section(manifest.versions),
        ),
        scene3d=Scene3D(bodies),
        picture=gallery_picture(bodies),
    )


def quantity_fact(shape: ShapeResult, key: str) -> Fact:
    """Return the change of a quantity, by its key in shape.json; red where the web fails by fatigue."""
    quantity = QUANTITIES_TOLD[key]
    change, error = shape.change_percent[key], change_error_percent(shape, key)
    original, result, unit = value_words(shape, key)
    label, value = quantity.label.capitalize(), f"{result} {unit}".rstrip()
    note = f"{value} against the original's {f'{original} {unit}'.rstrip()}"
    if quantity is SAFETY and shape.result.fatigue_place:
        note = f"{note}; least at {shape.result.fatigue_place}"
    if quantity in (SAFETY, STRESS) and shape.loads:
        note = f"{note}; {states_words(shape.loads)}"
    change_words = change_text(change, error)
    if quantity is SAFETY and shape.values.result[key] < 1:
        return Fact(label, change_words, f"{note}; below 1: it fails", "bad")
    if abs(change) <= error:
        return Fact(label, change_words, f"{note}, less than the error estimate", "neutral")
    status: FactStatus = "good" if quantity.better * change > 0 else "bad"
    return Fact(label, change_words, note, status)


def page_headline(shape: ShapeResult) -> str:
    """Return the verdict; a balance that no limit held and loads that are left out are in front."""
    moved = f"{balance_words(*_factors(shape)).capitalize()}. " if shape.balance else ""
    return left_off_first(shape.left_off, moved + shape_headline(shape))


def _factors(shape: ShapeResult) -> tuple[float, float]:
    return shape.values.result["balance_factor"], shape.values.original["balance_factor"]


def _balance(shape: ShapeResult) -> Iterator[Fact]:
    """Yield where the balance factor went, if no limit holds it there."""
    if shape.balance is not None:
        now, before = _factors(shape)
        yield Fact("Balance factor", f"{before:z.0f} -> {now:z.0f} %", shape.balance, "bad")


def release_fact(shape: ShapeResult) -> Fact:
    """Tell whether a die or a cutter can make the web."""
    status: FactStatus = "unknown"
    if shape.undercuts is not None:
        wholly = shape.undercuts.released and not shape.undercuts.without_draft
        status = "good" if wholly else "neutral" if shape.makeable else "bad"
    return Fact("Released by a die", release_verdict(shape.undercuts), release_text(shape.undercuts), status)


def _goal_section(shape: ShapeResult) -> Section:
    goal, doubt = shape.goal, multiplier_doubt(shape)
    sense = "minimise" if goal.minimise else "maximise"
    said = [shape.stop_reason.capitalize(), safety_places(shape), stress_loads(shape), *shaft_lines(shape)]
    said += [line.removesuffix(".") for line in safety_remarks(shape)]
    said += [original_keeps(shape), ended_words(shape)]
    return Section(
        "goal",
        f"Goal: {sense} {goal.quantity.name.replace('_', ' ')}",
        f"{'; '.join(filter(None, said))}. What limits, rules and bounds cost "
        f"is in percent of the original's, to first order{'; ' * bool(doubt)}{doubt}.",
        (
            ("Original and result, fillets included", changes_table(shape)),
            ("Limits, by the body-fitted evaluation", limits_table(goal)),
            ("What limits, rules and bounds cost", multiplier_table(shape)),
        ),
    )


def _dimensions(shape: ShapeResult) -> Section:
    return Section(
        "dimensions",
        "What a millimetre is worth",
        "Change of each quantity per millimetre or degree of each dimension, in percent of the original, by "
        "exact gradients on body-fitted elements.",
        (
            ("Dimensions at the optimum", dimensions_table(shape.parameters)),
            (
                "Worst case within the tolerance, each dimension off the worst way",
                worst_case_table(shape.worst_case_percent),
            ),
            ("What holds them", held_table(shape.parameters)),
        ),
    )


def _search(shape: ShapeResult) -> Section:
    name = shape.goal_on_cells.quantity.name
    same = name == shape.goal.quantity.name
    safe = any(QUANTITIES[limit.quantity].of_stress for limit in shape.goal.limits)
    sought = f" Cells have no fillets: there the most {name} stiffness within the same limits was sought."
    kept = (
        " Cells have no fillets: there at least the same share of the stiffness stood for safety or stress."
    )
    stand_in, plots = sought if not same else kept if safe else "", curves(shape)
    ring = "; a ring marks the best" if plots else ""
    return Section(
        "search",
        "How it was found",
        f"{shape.evaluations} webs were solved. Features were tried on cells for what they gain in the "
        "goal, and kept only if they pay; the dimensions were then finished on body-fitted elements with all "
        f"limits, and each result was evaluated on the default mesh{ring}.{stand_in}",
        (("What was tried", feature_trials_table(shape)), ("Webs evaluated on the way", rounds_table(shape))),
        plots,
    )


def curves(shape: ShapeResult) -> tuple[Picture, ...]:
    """Return goal and worst limit of every web; of two the table says all."""
    if len(shape.rounds) < _FEWEST:
        return ()
    return (
        picture("convergence", "Goal of every web that was evaluated on the way", draw_goal, shape),
        picture("limits", "By how much each of them misses its worst limit", draw_worst_limit, shape),
    )


_FEWEST = 3


def _provenance(shape: ShapeResult, manifest: Manifest) -> Section:
    tables = (("Run", pairs(origin_rows(manifest))), *assumed_tables(shape.assumed))
    return Section("provenance", "Where this comes from", tables=tables)


def draw_goal(axes: Any, shape: ShapeResult) -> None:
    """Draw the goal of every web, % of the original's."""
    name, original = shape.goal.quantity.name, shape.values.original
    values = [100 * web.values[name] / original[name] for web in shape.rounds]
    _draw(axes, shape.best_round, values, f"{name.replace('_', ' ')} (% of the original)", "#1f6fb4", 0.5)


def draw_worst_limit(axes: Any, shape: ShapeResult) -> None:
    """Draw by how much every web misses its worst limit, %; 0 or less is kept."""
    values = [max(web.excess_percent, default=0.0) for web in shape.rounds]
    _draw(axes, shape.best_round, values, "worst limit missed by (%)", "#d1632a", 0.1)
    axes.axhline(0.0, color="0.4", linewidth=1, zorder=0)


def _draw(axes: Any, best: int, values: list[float], label: str, colour: str, minimum: float) -> None:
    places = range(len(values))
    axes.plot(places, values, "o-", color=colour, linewidth=1.6)
    axes.plot([best], [values[best]], "o", markersize=11, fillstyle="none", color="black")
    for place, value in zip(places, values, strict=True):
        axes.annotate(
            f"{value:.2f}", (place, value), xytext=(0, 7), textcoords="offset points", ha="center", fontsize=8
        )
    axes.set_xticks(places, ["cells", *(f"finish {number}" for number in places[1:])])
    middle, half = (max(values) + min(values)) / 2, (max(values) - min(values)) / 2
    half = max(1.35 * half, minimum)  # a settled goal is no reason to magnify its last digits
    axes.set_ylim(middle - half, middle + half)
    axes.ticklabel_format(axis="y", useOffset=False)
    axes.margins(x=0.12)
    axes.set_ylabel(label, fontsize=9)
    axes.grid(color="0.9", linewidth=0.8, axis="y")
    plain(axes)
