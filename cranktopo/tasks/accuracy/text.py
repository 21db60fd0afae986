"""Tables of an accuracy study: error against seconds, level by level."""

from __future__ import annotations

from collections.abc import Callable

from cranktopo.numerics.extrapolation import Extrapolation
from cranktopo.report.result_table import Cell, Column, ResultTable, tabulate
from cranktopo.tasks.fea.level import EVALUATION, FILLET_STRESS, OPTIMISER, TITLES
from cranktopo.tasks.fea.quantities import BENDING, TORSION
from cranktopo.tasks.fea.study_result import LevelResult, Recommendation, StudyResult

_TORSION, _BENDING, _STRESS = "torsion_Nm_per_rad", "bending_N_per_mm", "fillet_stress_MPa"
_KILO = 1000.0


def _scaled(name: str) -> Callable[[LevelResult], float | None]:
    """Return a stiffness in thousands of its unit."""
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


def study_name(study: str) -> str:
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
            found.append((study_name(study).capitalize(), table))
    return found


def recommendation_table(result: StudyResult) -> ResultTable:
    """Return the cheapest level of each study for each accuracy."""
    columns: tuple[Column[Recommendation], ...] = (
        Column("accuracy", 0, lambda r: f"{r.accuracy_percent:g} %"),
        Column("study", 0, lambda r: study_name(r.ladder)),
        Column("cheapest_level", 0, lambda r: r.rung or "none within this budget"),
        Column("time_s", 1, lambda r: r.seconds),
    )
    return tabulate(columns, result.recommendations)


def limit_lines(result: StudyResult) -> list[str]:
    """Return the extrapolated values with their uncertainty, one line per study."""
    lines = []
    for study, limits in result.limits.items():
        values = ", ".join(_limit_text(name, limit) for name, limit in limits.items())
        lines.append(f"{study_name(study)}, extrapolated: {values or 'nothing, fewer than two levels'}")
    return lines


def _limit_text(name: str, limit: Extrapolation) -> str:
    units = {_TORSION: ("torsion", "kN m/rad", _KILO), _BENDING: ("bending", "kN/mm", _KILO)}
    label, unit, scale = units.get(name, ("fillet stress", "MPa", 1.0))
    order = "" if limit.order is None else f", order {limit.order:.1f}"
    return f"{label} {limit.value / scale:.5g} {unit} +-{limit.uncertainty_percent:.2g} %{order}"
