"""What the runs under a folder reached, one entry each."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

from cranktopo.base.errors import CranktopoError
from cranktopo.base.result import Result
from cranktopo.runs.directories import RUNS, RunStore, list_runs, remove_run
from cranktopo.runs.kind import LOOP, SHAPE, SWEEP, RunKind, kind_of, read_result
from cranktopo.tasks.fea.quantities import PER_MASS, STIFFNESS
from cranktopo.tasks.iterate.result import LoopResult
from cranktopo.tasks.optimise.result import RunMetrics
from cranktopo.tasks.shape.result import ShapeResult
from cranktopo.tasks.sweep.result import SweepResult


def summarise_runs(root: Path = RUNS) -> list[dict[str, Any]]:
    """Return the entries of `runs list --json`, oldest first."""
    return [_entry(run) for run in list_runs(root)]


def clean_runs(states: tuple[str, ...], delete: bool, root: Path = RUNS) -> list[Path]:
    """Directories of the runs in one of these states; deleted where it is asked for.

    Raises:
        CranktopoError: a process works in one of them, or it cannot be deleted.
    """
    chosen = [run for run in list_runs(root) if _run_status(run) in states]
    if delete:
        for run in chosen:
            remove_run(run)
    return [run.path for run in chosen]


def _run_status(run: RunStore) -> str:
    """Status of a run; `unreadable` where its manifest cannot be used."""
    try:
        return str(run.manifest()["status"])
    except CranktopoError:
        return "unreadable"


def _entry(run: RunStore) -> dict[str, Any]:
    entry: dict[str, Any] = {"run": run.name, "path": str(run.path), "status": _run_status(run)}
    if entry["status"] == "unreadable":
        return entry
    kind, manifest = kind_of(run), run.manifest()
    entry |= {"command": kind, "design": manifest["design"], "started": manifest["started"]}
    try:
        result = run_result(run)
        return entry if result is None else entry | _ENTRIES[kind](result)
    except CranktopoError:  # one damaged run does not hide the others
        return entry | {"result": "unreadable"}


def _run_result(metrics: RunMetrics) -> dict[str, Any]:
    return {
        "result": metrics.status,
        "mass_of_throw_kg": metrics.mass_kg.throw,
        "gain_of_stiffness_per_mass_percent": metrics.original_web.gain_of_stiffness_per_mass_percent,
    }


def _loop_result(loop: LoopResult) -> dict[str, Any]:
    """Return the best web of a loop, if it has one."""
    if loop.best is None:
        return {"result": "no better web"}
    gains = {key: share - 100 for key, share in loop.best.percent_of_original.items()}
    return _web(f"best: {loop.best.words}", loop.best.throw_kg, gains)


def _shape_result(shape: ShapeResult) -> dict[str, Any]:
    return _web(shape.status, shape.values.result["mass"], shape.change_percent)


def _web(result: str, mass_kg: float, change_percent: Mapping[str, float]) -> dict[str, Any]:
    pairs = zip(STIFFNESS, PER_MASS, strict=True)
    return {
        "result": result,
        "mass_of_throw_kg": mass_kg,
        "gain_of_stiffness_per_mass_percent": {s.key: change_percent[ratio.key] for s, ratio in pairs},
    }


def _sweep_result(sweep: SweepResult) -> dict[str, Any]:
    ends = ", ".join(f"{count} {end}" for end, count in sweep.ends.items())
    return {"result": f"{ends}; {len(sweep.front)} on the front"}


_RESULTS: dict[RunKind, type[Result]] = {
    "optimise": RunMetrics,
    LOOP: LoopResult,
    SHAPE: ShapeResult,
    SWEEP: SweepResult,
}
"""What a finished run of each kind left."""
_ENTRIES: dict[RunKind, Callable[[Any], dict[str, Any]]] = {
    "optimise": _run_result,
    LOOP: _loop_result,
    SHAPE: _shape_result,
    SWEEP: _sweep_result,
}


def run_result(run: RunStore) -> Result | None:
    """Return what a run left; None where it is not finished.

    Raises:
        CranktopoError: its results are damaged.
    """
    found = read_result(run)
    where = f"run '{run.path}': its results are damaged"
    return None if found is None else _RESULTS[kind_of(run)].of_json(found, where)
