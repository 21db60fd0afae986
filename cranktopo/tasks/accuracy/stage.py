"""An accuracy study: errors of its levels, Pareto front, cheapest levels, and the files that keep them."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path

from cranktopo.base.files import as_path_if_any, json_file_text
from cranktopo.design.assumed import EVALUATED, filter_by_table
from cranktopo.numerics.extrapolation import Extrapolation, extrapolate, observed_order
from cranktopo.report.report_file import write_report
from cranktopo.runs.destination import check_folder
from cranktopo.runs.directories import RUNS
from cranktopo.runs.manifest import timestamp
from cranktopo.runs.stored import write_recorded
from cranktopo.tasks.accuracy.page import accuracy_page
from cranktopo.tasks.accuracy.study import Study, run_studies
from cranktopo.tasks.throw_fea.stage import print_assumed
from cranktopo.tasks.throw_fea.studies import (
    EVALUATION,
    FILLET_STRESS,
    OPTIMISER,
    Level,
    LevelResult,
    Recommendation,
    StudyName,
    StudyResult,
    key_of,
    store_study,
)
from cranktopo.tasks.throw_fea.targets import Target, TargetLike, resolve_targets

_WANTED_PERCENT = (5.0, 2.0, 1.0, 0.5)
_REFERENCES: dict[StudyName, tuple[str, ...]] = {
    EVALUATION: ("graded", "uniform"),
    FILLET_STRESS: ("fillet", "coarse fillet"),
    OPTIMISER: ("cells",),
}
"""Families that the limit of a study is extrapolated from, the first one that has two levels."""
_QUADRATIC = 2.0, 4.0
"""Orders of a stiffness on quadratic elements: 4 on smooth bodies, about 2 with fillets. Coarse meshes of
curved bodies, whose elements are partly straight, show others by chance."""
_ORDERS: dict[StudyName, tuple[float, float]] = {EVALUATION: _QUADRATIC, FILLET_STRESS: _QUADRATIC}
"""Orders that theory gives; cells converge as their stairs do."""


def cheapest(levels: Iterable[LevelResult], study: StudyName, percent: float) -> LevelResult | None:
    """Return the cheapest level of a study whose error is surely below a percentage."""

    def fits(level: LevelResult) -> bool:
        bound = level.bound_percent
        return level.ladder == study and bound is not None and bound <= percent

    return min(filter(fits, levels), key=lambda found: found.seconds, default=None)


def pareto_front(study: Study) -> StudyResult:
    """Return errors, orders and the efficient levels of a study, and what each accuracy costs."""
    limits: dict[StudyName, dict[str, Extrapolation]] = {}
    found: list[LevelResult] = []
    for name in _REFERENCES:
        levels = [level for level in study.levels if level.study == name]
        if levels:
            limits[name] = _limits(name, levels)
            found += _marked([_level_result(level, levels, limits[name]) for level in levels])
    return StudyResult(
        design=study.design,
        budget_s=study.budget_s,
        spent_s=study.spent_s,
        interrupted=study.interrupted,
        machine=study.machine,
        limits=limits,
        rungs=found,
        recommendations=[_recommendation(found, name, p) for name in limits for p in _WANTED_PERCENT],
        failures=list(study.failures),
    )


def _recommendation(levels: Sequence[LevelResult], study: StudyName, percent: float) -> Recommendation:
    found = cheapest(levels, study, percent)
    return Recommendation(
        ladder=study, accuracy_percent=percent, rung=found and found.name, seconds=found and found.seconds
    )


def _limits(study: StudyName, levels: Sequence[Level]) -> dict[str, Extrapolation]:
    for family in _REFERENCES[study]:
        chosen = _family(levels, family)
        if len(chosen) > 1:
            sizes = [level.size_mm for level in chosen]
            bounds, orders = chosen[-1].own_bounds_percent, _ORDERS.get(study)
            found = {
                name: extrapolate(sizes, [r.values[name] for r in chosen], orders, bounds.get(name))
                for name in chosen[0].values
            }
            return {name: limit for name, limit in found.items() if limit is not None}
    return {}


def _family(levels: Sequence[Level], family: str) -> list[Level]:
    return sorted((r for r in levels if r.family == family and r.values), key=lambda r: -r.size_mm)


def _level_result(level: Level, levels: Sequence[Level], limits: dict[str, Extrapolation]) -> LevelResult:
    values = level.values
    errors = {name: limits[name].error_percent(v) for name, v in values.items() if name in limits}
    own = {name: 100 * (v / values[name] - 1) for name, v in level.model.items() if name in values}
    bands = [max(limits[name].uncertainty_percent, level.band_percent) for name in errors]
    return LevelResult(
        ladder=level.study,
        name=level.name,
        family=level.family,
        settings=level.settings,
        unknowns=level.unknowns,
        seconds=level.seconds,
        compile_seconds=level.compile_seconds,
        peak_memory_MiB=level.peak_memory_MiB,
        **values,
        model=level.model,
        errors_percent=errors,
        model_errors_percent=own,
        orders=_orders(level, levels),
        own_bounds_percent=level.own_bounds_percent,
        error_percent=max(abs(error) for error in (*errors.values(), *own.values())) if errors else None,
        uncertainty_percent=max(bands, default=None),
        efficient=False,
    )


def _orders(level: Level, levels: Sequence[Level]) -> dict[str, float | None]:
    row = [r for r in _family(levels, level.family) if r.size_mm >= level.size_mm][-3:]
    if len(row) < 3 or not level.values:
        return {}
    sizes = [r.size_mm for r in row]
    return {name: observed_order(sizes, [r.values[name] for r in row]) for name in level.values}


def _marked(levels: list[LevelResult]) -> list[LevelResult]:
    """Mark the levels on the Pareto front: no cheaper one has a smaller error."""

    def dominated(this: LevelResult) -> bool:
        return this.error_percent is None or any(
            other.seconds < this.seconds
            and other.error_percent is not None
            and other.error_percent <= this.error_percent
            for other in levels
        )

    return [this.model_copy(update={"efficient": not dominated(this)}) for this in levels]


BUDGET_S = 120.0


@dataclass(frozen=True)
class AccuracyStudy:
    """Result of `accuracy`, its files by kind, and where it is kept for later commands."""

    result: StudyResult
    files: dict[str, str]
    kept: Path | None


def study_accuracy(
    target: TargetLike,
    budget_s: float = BUDGET_S,
    out: Path | str | None = None,
    design: str | None = None,
    throw: int | None = None,
) -> AccuracyStudy:
    """Return error against seconds, from cheap levels to exact ones, until the time is used or Ctrl-C.

    Writes JSON, Markdown and PNG to `out`, by default runs/accuracy-DESIGN, or the run itself.

    Raises:
        CranktopoError: no such target, or a folder that cannot be written.
    """
    out = as_path_if_any(out)
    (resolved,) = resolve_targets([target], design, whole=True, throw=throw)
    folder = out or _folder(resolved)
    check_folder(folder)
    print_assumed([resolved], EVALUATED)
    result = pareto_front(run_studies(resolved, budget_s))
    kept = store_study(key_of(resolved), result)
    result = result.model_copy(update={"assumed": list(filter_by_table(resolved.assumed, EVALUATED))})
    return AccuracyStudy(result, _write(result, folder), kept)


def _folder(target: Target) -> Path:
    return target.run or RUNS / f"accuracy-{target.file.stem if target.file else target.name}"


def _write(result: StudyResult, folder: Path) -> dict[str, str]:
    folder.mkdir(parents=True, exist_ok=True)
    plain, markdown = folder / "accuracy.json", folder / "accuracy.md"
    write_recorded(plain, json_file_text(result.as_json(), plain.name))
    page = accuracy_page(result, timestamp()[:10])
    write_report(page, markdown)
    files = {"json": str(plain), "markdown": str(markdown)}
    for picture in page.sections[0].pictures:
        files["picture"] = str(folder / "accuracy-pictures" / f"{picture.name}.png")
    return files
