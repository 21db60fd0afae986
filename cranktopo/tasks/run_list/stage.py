"""What the runs under a folder reached, one entry each."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from cranktopo.base.errors import CranktopoError
from cranktopo.runs.directories import RUNS, RunStore, list_runs, remove_run
from cranktopo.runs.kind import LOOP, SHAPE, SWEEP, kind_of, read_result, shown_results
from cranktopo.tasks.fea.quantities import PER_MASS, STIFFNESS
from cranktopo.tasks.iterate.result import LoopResult
from cranktopo.tasks.optimise.result import RunMetrics


def summarise_runs(root: Path = RUNS) -> list[dict[str, Any]]:
    """The entries of `runs list --json`, oldest first."""
    return [_entry(run) for run in list_runs(root)]


def clean_runs(states: tuple[str, ...], delete: bool, root: Path = RUNS) -> list[Path]:
    """Directories of the runs in one of these states; deleted where it is asked for.

    Raises:
        CranktopoError: a process works in one of them, or it cannot be deleted.
    """
    chosen = [run for run in list_runs(root) if run_status(run) in states]
    if delete:
        for run in chosen:
            remove_run(run)
    return [run.path for run in chosen]


def run_status(run: RunStore) -> str:
    """Status of a run; `unreadable` where its manifest cannot be used."""
    try:
        return str(run.manifest()["status"])
    except CranktopoError:
        return "unreadable"


def _entry(run: RunStore) -> dict[str, Any]:
    entry: dict[str, Any] = {"run": run.name, "path": str(run.path), "status": run_status(run)}
    if entry["status"] == "unreadable":
        return entry
    kind, manifest = kind_of(run), run.manifest()
    entry |= {"command": kind, "design": manifest["design"], "started": manifest["started"]}
    try:
        result = read_result(run)
        if result is None:
            return entry
        with shown_results(run):
            return entry | _RESULTS[kind](result)
    except CranktopoError:  # one damaged run does not hide the others
        return entry | {"result": "unreadable"}


def _run_result(data: Mapping[str, Any]) -> dict[str, Any]:
    metrics = RunMetrics.of_json(data, "metrics.json")
    return {
        "result": metrics.status,
        "mass_of_throw_kg": metrics.mass_kg.throw,
        "gain_of_stiffness_per_mass_percent": metrics.original_web.gain_of_stiffness_per_mass_percent,
    }


def _loop_result(data: Mapping[str, Any]) -> dict[str, Any]:
    """The best web of a loop, if it has one."""
    best = LoopResult.of_json(data, "iterate.json").best
    if best is None:
        return {"result": "no better web"}
    share = best.percent_of_original
    return {
        "result": f"best: {best.words}",
        "mass_of_throw_kg": best.throw_kg,
        "gain_of_stiffness_per_mass_percent": {
            stiffness.key: share[ratio.key] - 100
            for stiffness, ratio in zip(STIFFNESS, PER_MASS, strict=True)
        },
    }


def _shape_result(shape: Mapping[str, Any]) -> dict[str, Any]:
    return {
        "result": shape["status"],
        "mass_of_throw_kg": shape["values"]["result"]["mass"],
        "gain_of_stiffness_per_mass_percent": {
            stiffness.key: shape["change_percent"][ratio.key]
            for stiffness, ratio in zip(STIFFNESS, PER_MASS, strict=True)
        },
    }


def _sweep_result(sweep: Mapping[str, Any]) -> dict[str, Any]:
    ends = ", ".join(f"{count} {end}" for end, count in sweep["ends"].items())
    return {"result": f"{ends}; {len(sweep['front'])} on the front"}


_RESULTS = {"optimise": _run_result, LOOP: _loop_result, SHAPE: _shape_result, SWEEP: _sweep_result}
