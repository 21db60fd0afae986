"""An accuracy study as tables, plot and page: error against seconds, level by level, and which to take."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from cranktopo.base.units import plain_number
from cranktopo.numerics.extrapolation import Extrapolation
from cranktopo.report.page import Fact, FactStatus, Page, Section
from cranktopo.report.plot import Picture, name_points, picture, plain, plain_decades
from cranktopo.report.result_table import Cell, Column, ResultTable, tabulate
from cranktopo.tasks.throw_fea.quantities import BENDING, TORSION
from cranktopo.tasks.throw_fea.studies import (
    EVALUATION,
    FILLET_STRESS,
    OPTIMISER,
    TITLES,
    LevelResult,
    Recommendation,
    StudyResult,
)

_TORSION, _BENDING, _STRESS = "torsion_Nm_per_rad", "bending_N_per_mm", "fillet_stress_MPa"
_KILO = 1000.0


def _scaled(name: str) -> Callable[[LevelResult], float | None]:
    return lambda level: None if getattr(level, name) is None else getattr(level, name) / _KILO


def _of(table: str, name: str) -> Callable[[LevelResult], Cell]:
    return lambda level: getattr(level, table).get(name)


_COST: tuple[Column[LevelResult], ...] = (
    Column("level", 0, lambda level: level.name),
    Column("unknowns", 0, lambda level: float(level.unknowns)),
    Column("time_s", 1, lambda level: level.seconds),
    Column("memory_MiB", 0, lambda level: level.peak_memory_MiB),
)
_UNCERTAINTY: Column[LevelResult] = Column("uncertainty_percent", 2, lambda level: level.uncertainty_percent)
_COLUMNS: dict[str, tuple[Column[LevelResult], ...]] = {
    EVALUATION: (
        Column(TORSION.column, TORSION.digits, _scaled(_TORSION)),
        Column("torsion_error_percent", 2, _of("errors_percent", _TORSION)),
        Column(BENDING.column, BENDING.digits, _scaled(_BENDING)),
        Column("bending_error_percent", 2, _of("errors_percent", _BENDING)),
        _UNCERTAINTY,
        Column("own_bound_percent", 2, lambda level: level.own_bound_percent),
        Column("order_in_torsion", 1, _of("orders", _TORSION)),
        Column("order_in_bending", 1, _of("orders", _BENDING)),
    ),
    FILLET_STRESS: (
        Column(_STRESS, 1, lambda level: level.fillet_stress_MPa),
        Column("error_percent", 2, _of("errors_percent", _STRESS)),
        _UNCERTAINTY,
        Column("order", 1, _of("orders", _STRESS)),
    ),
    OPTIMISER: (
        Column("iterations", 0, lambda level: float(level.settings["iterations"])),
        Column(TORSION.column, TORSION.digits, _scaled(_TORSION)),
        Column("torsion_of_shape_percent", 2, _of("errors_percent", _TORSION)),
        Column("torsion_own_value_percent", 2, _of("model_errors_percent", _TORSION)),
        Column(BENDING.column, BENDING.digits, _scaled(_BENDING)),
        Column("bending_of_shape_percent", 2, _of("errors_percent", _BENDING)),
        Column("bending_own_value_percent", 2, _of("model_errors_percent", _BENDING)),
        _UNCERTAINTY,
    ),
}


def _study_name(study: str) -> str:
    """Return the name of a study as it is printed."""
    return TITLES.get(study, study)


def level_tables(result: StudyResult) -> list[tuple[str, ResultTable]]:
    """Return one table per study, by its title; a star at the levels on its Pareto front."""
    found = []
    for study, columns in _COLUMNS.items():
        levels = [level for level in result.rungs if level.ladder == study]
        if levels:
            efficient = frozenset((row, "level") for row, level in enumerate(levels) if level.efficient)
            table = tabulate((*_COST, *columns), levels, efficient)
            found.append((_study_name(study).capitalize(), table))
    return found


def recommendation_table(result: StudyResult) -> ResultTable:
    """Return the cheapest level of each study for each accuracy."""
    columns: tuple[Column[Recommendation], ...] = (
        Column("accuracy", 0, lambda r: f"{r.accuracy_percent:g} %"),
        Column("study", 0, lambda r: _study_name(r.ladder)),
        Column("cheapest_level", 0, lambda r: r.rung or "none within this budget"),
        Column("time_s", 1, lambda r: r.seconds),
    )
    return tabulate(columns, result.recommendations)


def limit_lines(result: StudyResult) -> list[str]:
    """Return the extrapolated values with their uncertainty, one line per study."""
    lines = []
    for study, limits in result.limits.items():
        values = ", ".join(_limit_text(name, limit) for name, limit in limits.items())
        lines.append(f"{_study_name(study)}, extrapolated: {values or 'nothing, fewer than two levels'}")
    return lines


def _limit_text(name: str, limit: Extrapolation) -> str:
    units = {_TORSION: ("torsion", "kN m/rad", _KILO), _BENDING: ("bending", "kN/mm", _KILO)}
    label, unit, scale = units.get(name, ("fillet stress", "MPa", 1.0))
    order = "" if limit.order is None else f", order {limit.order:.1f}"
    return f"{label} {plain_number(limit.value / scale, 5)} {unit} +-{limit.uncertainty_percent:.2g} %{order}"


_MARKERS, _COLOURS = "osD^vP*X", ("C0", "C1", "C2")


def study_pictures(result: StudyResult) -> tuple[Picture, ...]:
    """Return error against seconds where any error is known, the Pareto front of each study joined."""
    levels = [level for level in result.rungs if level.error_percent]
    words = "; ".join(f"{v.name}: {v.error_percent:.2g} % in {v.seconds:.3g} s" for v in levels)
    return (picture("accuracy", f"Error against seconds. {words}", _draw_fronts, levels),) if levels else ()


def _draw_fronts(axes: Any, levels: Sequence[LevelResult]) -> None:
    studies = dict.fromkeys(level.ladder for level in levels)
    for study, marker, colour in zip(studies, _MARKERS, _COLOURS, strict=False):
        mine = [level for level in levels if level.ladder == study]
        best = sorted((level for level in mine if level.efficient), key=lambda level: level.seconds)
        others = [level for level in mine if not level.efficient]
        axes.plot(*_points(best), marker, color=colour, ls="-", label=f"{_study_name(study)}, Pareto front")
        if others:
            label = f"{_study_name(study)}, others"
            axes.plot(*_points(others), marker, color=colour, mfc="none", ls="", label=label)
    _frame(axes)
    places = [
        [(v.seconds, v.error_percent or 0.0) for v in levels if v.efficient is known]
        for known in (True, False)
    ]
    name_points(axes, [level.name for level in levels if level.efficient], *places)


def _points(levels: Sequence[LevelResult]) -> tuple[list[float], list[float | None]]:
    return [level.seconds for level in levels], [level.error_percent for level in levels]


_NAMES = 0.7
"""Room for names left of the quickest level, over the range of times."""


def _frame(axes: Any) -> None:
    axes.set(xscale="log", yscale="log", xlabel="time (s)", ylabel="error (%)")
    plain_decades(axes.xaxis)
    plain_decades(axes.yaxis)
    low, high = np.log(axes.dataLim.intervalx)
    span = high - low or 1.0
    axes.set_xlim(np.exp(low - _NAMES * span), np.exp(high + 0.12 * span))
    axes.margins(y=0.15)
    axes.grid(color="0.9", linewidth=0.8)
    plain(axes)


_LEGEND = (
    "A star marks the Pareto front: no cheaper level has a smaller error. Errors are against the "
    "extrapolated value. Its uncertainty spans all plausible orders of convergence; where the observed order "
    "is not that of theory, it is all that the own bound of the finest level leaves. That of a level "
    "is that of `evaluate` on its mesh. Memory is the largest of the level. Time is without JAX's "
    "compilation, which is stored for the next run."
)


def accuracy_page(result: StudyResult, written: str) -> Page:
    """Return the studies of a design as content, written on a date."""
    machine = result.machine
    return Page(
        title=f"What accuracy costs in time: {result.design}",
        subtitle=f"{machine.processor}, {machine.cores} cores, {written}",
        headline=accuracy_headline(result),
        facts=tuple(
            Fact(_study_name(study).capitalize(), *_cheapest(result, study)) for study in result.limits
        ),
        sections=(
            Section(
                "levels",
                "Levels",
                " ".join([_LEGEND, *(f"{line[0].upper()}{line[1:]}." for line in limit_lines(result))]),
                tuple(level_tables(result)),
                study_pictures(result),
            ),
            Section(
                "recommendation",
                "Which level to take",
                tables=(("Cheapest level whose error is surely below", recommendation_table(result)),),
            ),
        ),
    )


def accuracy_headline(result: StudyResult) -> str:
    """Return the outcome in one sentence."""
    ended = "interrupted after" if result.interrupted else "in"
    return (
        f"{len(result.rungs)} levels {ended} {result.spent_s:.0f} of {result.budget_s:g} s; "
        f"{sum(level.efficient for level in result.rungs)} of them are on the Pareto front."
    )


def _cheapest(result: StudyResult, study: str) -> tuple[str, str, FactStatus]:
    rows = [r for r in result.recommendations if r.ladder == study and r.rung]
    if not rows:
        return "no accuracy reached", "a larger budget allows finer levels", "unknown"
    best = rows[-1]
    return f"{best.accuracy_percent:g} % in {best.seconds:.3g} s", str(best.rung), "neutral"
