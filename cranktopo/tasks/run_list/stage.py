"""Results of the runs under a folder, one entry each."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

from cranktopo.base.errors import CranktopoError
from cranktopo.base.files import as_path
from cranktopo.base.result import UNLESS_NONE, Result
from cranktopo.runs.directories import RUNS, RunStore, list_runs, remove_run
from cranktopo.runs.kind import EACH_WEB, LOOP, SHAPE, SWEEP, RunKind, kind_of, read_result, reading_results
from cranktopo.tasks.iterate.result import LoopResult
from cranktopo.tasks.optimise.result import RunMetrics
from cranktopo.tasks.sweep.result import SweepResult
from cranktopo.tasks.throw_fea.quantities import PER_MASS, STIFFNESS
from cranktopo.tasks.web_shape.each_web.result import EachWebResult
from cranktopo.tasks.web_shape.result import ShapeResult


class RunEntry(Result):
    """A run in the list; keys are present as far as its files contain them."""

    run: str
    path: str
    status: str
    """End of the run, or that it goes on; `unreadable` where its manifest cannot be used."""
    command: RunKind | None = UNLESS_NONE
    design: str | None = UNLESS_NONE
    started: str | None = UNLESS_NONE
    result: str | None = UNLESS_NONE
    """End of the search; `unreadable` where its results are damaged."""
    mass_of_throw_kg: float | None = UNLESS_NONE
    gain_of_stiffness_per_mass_percent: dict[str, float] | None = UNLESS_NONE
    """Against the original web."""


class RunList(Result):
    """The runs of a folder, oldest first."""

    schema_version: int = 1
    runs: tuple[RunEntry, ...]


def summarise_runs(root: Path | str = RUNS) -> list[RunEntry]:
    """Return the entries of the runs of a folder, oldest first."""
    root = as_path(root)
    return [_entry(run) for run in list_runs(root)]


def clean_runs(states: tuple[str, ...], delete: bool, root: Path | str = RUNS) -> list[Path]:
    """Return directories of runs in one of these states, deleted if asked for; raises if one is in use."""
    root = as_path(root)
    chosen = [run for run in list_runs(root) if _run_status(run) in states]
    if delete:
        for run in chosen:
            remove_run(run)
    return [run.path for run in chosen]


def _run_status(run: RunStore) -> str:
    """Return the status of a run; `unreadable` where its manifest cannot be used."""
    try:
        return run.manifest().status
    except CranktopoError:
        return "unreadable"


def _entry(run: RunStore) -> RunEntry:
    entry = RunEntry(run=run.name, path=str(run.path), status=_run_status(run))
    if entry.status == "unreadable":
        return entry
    kind, manifest = kind_of(run), run.manifest()
    known = {"command": kind, "design": manifest.design, "started": manifest.started}
    try:
        with reading_results(run):
            result = run_result(run)
            summary = {} if result is None else _KINDS[kind][1](result)
    except CranktopoError:  # one damaged run does not hide the others
        summary = {"result": "unreadable"}
    return entry.model_copy(update={**known, **summary})


def _run_summary(metrics: RunMetrics) -> dict[str, Any]:
    return _web(
        metrics.status, metrics.mass_kg.throw, metrics.original_web.gain_of_stiffness_per_mass_percent
    )


def _loop_summary(loop: LoopResult) -> dict[str, Any]:
    if loop.best is None:
        return {"result": "no better web"}
    gains = {key: share - 100 for key, share in loop.best.percent_of_original.items()}
    return _web(f"best: {loop.best.words}", loop.best.throw_kg, _per_mass(gains))


def _shape_summary(shape: ShapeResult) -> dict[str, Any]:
    return _web(shape.status, shape.values.result["mass"], _per_mass(shape.change_percent))


def _sweep_summary(sweep: SweepResult) -> dict[str, Any]:
    ends = ", ".join(f"{count} {end}" for end, count in sweep.ends.items())
    return {"result": f"{ends}; {len(sweep.front)} on the front"}


def _each_web_summary(result: EachWebResult) -> dict[str, Any]:
    kept = "limits kept" if result.held else "limits not met"
    return {"result": f"{kept}; crank {result.each_web.shaft.mass_kg:.3f} kg"}


def _web(result: str, mass_kg: float, gains: Mapping[str, float]) -> dict[str, Any]:
    return {"result": result, "mass_of_throw_kg": mass_kg, "gain_of_stiffness_per_mass_percent": gains}


def _per_mass(change_percent: Mapping[str, float]) -> dict[str, float]:
    return {s.key: change_percent[ratio.key] for s, ratio in zip(STIFFNESS, PER_MASS, strict=True)}


_KINDS: dict[RunKind, tuple[type[Result], Callable[[Any], dict[str, Any]]]] = {
    "optimise": (RunMetrics, _run_summary),
    LOOP: (LoopResult, _loop_summary),
    SHAPE: (ShapeResult, _shape_summary),
    SWEEP: (SweepResult, _sweep_summary),
    EACH_WEB: (EachWebResult, _each_web_summary),
}
"""Result of a finished run of each kind, and what the list tells of it."""


def run_result(run: RunStore) -> Result | None:
    """Return the result of a run, None where it is not finished; raises CranktopoError for a damaged one."""
    found = read_result(run)
    where = f"run '{run.path}': its results are damaged"
    return None if found is None else _KINDS[kind_of(run)][0].of_json(found, where)
