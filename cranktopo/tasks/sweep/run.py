"""A sweep as a run directory: its points, its table, its Pareto front, its page."""

from __future__ import annotations

import sys
import time
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from cranktopo.base.errors import CranktopoError, ExitCode, invalid
from cranktopo.base.files import write_json, write_text
from cranktopo.base.notes import note
from cranktopo.design.loading import value_at
from cranktopo.design.named import DesignLike
from cranktopo.design.schema import Scene
from cranktopo.design.strength import note_strength
from cranktopo.design.writing import new_run
from cranktopo.engine.performance import note_pressure
from cranktopo.report.report_file import REPORT
from cranktopo.runs.directories import RunStore, check_destination, open_run
from cranktopo.runs.kind import RESULT_FILES, SWEEP, require_kind, working_in
from cranktopo.runs.manifest import file_hash
from cranktopo.tasks.sweep.computed import ALL_CORES, Computed, Session, Workplace
from cranktopo.tasks.sweep.executor import check_packages, check_scheduler
from cranktopo.tasks.sweep.front import OBJECTIVES, choices_of, conditions_of, front_of, picks_of
from cranktopo.tasks.sweep.job import PointFunction
from cranktopo.tasks.sweep.page import sweep_html
from cranktopo.tasks.sweep.plan import SweepPlan, sweep_plan
from cranktopo.tasks.sweep.points import (
    SweepPoint,
    balance_line,
    left_off_lines,
    original_of,
    pitch_line,
    points_of,
)
from cranktopo.tasks.sweep.result import (
    COARSE,
    DONE,
    FAILED,
    SweepFiles,
    SweepResult,
    SweepSeconds,
)
from cranktopo.tasks.sweep.text import frame_of, write_tables
from cranktopo.tasks.sweep.variation import read_entry

if TYPE_CHECKING:
    import pandas


TABLE = "table"


@dataclass(frozen=True)
class SweptRun:
    """A finished sweep in its directory."""

    folder: Path
    result: SweepResult

    @property
    def frame(self) -> pandas.DataFrame:
        """One row per point and one of the original, units in the column names."""
        return frame_of(self.result.points, self.result.original, self.result.front)

    @property
    def failed(self) -> int:
        """Points that failed, of webs that may well be possible."""
        return sum(point.status == FAILED for point in self.result.points)

    @property
    def impossible(self) -> str:
        """Reason of the first point where no web of the sweep is possible; empty where one is."""
        points = self.result.points
        return "" if any(point.status == DONE for point in points) else points[0].reason or points[0].status


def run_sweep(
    plan: SweepPlan, place: Workplace = ALL_CORES, out: Path | None = None, command: Sequence[str] = ()
) -> SweptRun:
    """Compute all points of a plan in a new run directory; nothing is written before all is checked.

    Args:
        out: run directory; by default a new one under runs/.
        command: the command line, for the manifest.

    Raises:
        CranktopoError: bad input, no point that can be, a package missing, or interruption (exit code 130).
    """
    check_packages()
    check_destination(out)
    points = points_of(plan, place.settings)
    if all(point.reason for point in points):
        raise CranktopoError(f"no point of the sweep can be: {points[0].reason}", hint="Check the values.")
    if place.function is not None and plan.refine == "front":
        raise invalid("refine", plan.refine, "a function has one accuracy alone", "Leave it out.")
    if place.scheduler is not None:
        check_scheduler(place.scheduler)
    _note_what_differs(plan, points)
    run = new_run(plan.original, (), out, None, command, {SWEEP: plan.as_json(), **place.settings})
    return _worked(run, plan, points, place)


def _note_what_differs(plan: SweepPlan, points: Sequence[SweepPoint]) -> None:
    """Tell what the table does not: throws farther apart, what strength and pressure hold for."""
    for line in filter(None, (pitch_line(plan, points), balance_line(plan, points))):
        note(f"sweep: {line}")
    for missing_loads in left_off_lines(points):
        note(f"sweep: {missing_loads}")
    if {"fatigue", "shape"} & set(plan.stages):
        note_strength(plan.original.name, plan.original)
    if {"fatigue", "shape", "optimise"} & set(plan.stages):
        note_pressure(plan.original.name, plan.original)


def resume_sweep(reference: str, place: Workplace = ALL_CORES) -> SweptRun:
    """Continue the sweep of a run directory: points that have ended are read, not repeated.

    Raises:
        CranktopoError: no sweep, a changed input, another function, or as `run_sweep`.
    """
    check_packages()
    run = open_run(reference)
    require_kind(run, SWEEP)
    run.require_same_inputs()
    options = run.manifest().options
    function = options.get("function")
    if function != place.settings.get("function"):
        hint = "Continue it in Python: resume=DIR with that function."
        raise CranktopoError(
            f"run '{run.path}': was started with {function or 'no function'}.",
            hint=hint if function else "Leave the function out.",
        )
    plan = SweepPlan.of_json(options[SWEEP], f"run '{run.path}'")
    run.resume()
    return _worked(run, plan, points_of(plan, place.settings), place)


def _worked(run: RunStore, plan: SweepPlan, points: Sequence[SweepPoint], place: Workplace) -> SweptRun:
    began, original = time.perf_counter(), original_of(plan, place.settings)
    looks = points_of(plan, place.settings, plan.fineness.first_look) if plan.refine == "front" else ()
    with working_in(run, "finished points are kept") as check:
        found = Session(str(run.path.resolve()), plan, place).computed(points, looks, original)
        check()
        result = _result(run, plan, found, points)
        write_text(run.path / REPORT, sweep_html(result, found.webs))
        seconds = SweepSeconds(total=time.perf_counter() - began)
        result = result.model_copy(update={"seconds": seconds})
        _record_picks(run, result)
        write_json(run.path / RESULT_FILES[SWEEP], result.as_json())
    run.log(", ".join(f"{count} {status}" for status, count in result.ends.items()))
    return SweptRun(run.path, result)


def _record_picks(run: RunStore, result: SweepResult) -> None:
    """Record the designs that `compare` takes; raises CranktopoError where one was changed since."""
    points = {point.id: point for point in result.points}
    picked = (points[one] for one in result.picks.values())
    names = {f"{point.run}/{target}" for point in picked if (target := point.number("target"))}
    new = [name for name in sorted(names) if (run.path / name).is_file() and not run.recorded(name)]
    run.record({name: file_hash(run.path / name) for name in new})


def _result(run: RunStore, plan: SweepPlan, computed: Computed, points: Sequence[SweepPoint]) -> SweepResult:
    """Return what `sweep.json` holds, its tables written; coarse numbers have no say in front and picks."""
    own, rows = plan.original.model_dump(mode="json"), computed.rows
    varied = {variation.key: value_at(own, variation.key) for variation in plan.vary}
    original = computed.original.model_copy(update={"varied": varied})
    full = [row for row in rows if row.status == DONE and row.number("accuracy") != COARSE]
    front, objectives = front_of(choices_of(full))
    leading = [row for row in full if row.id in set(front)]
    return SweepResult(
        run=run.name,
        design=plan.designs[0],
        varied=tuple(varied),
        sampling=plan.sampling,
        points=rows,
        ends=dict(Counter(row.status for row in rows)),
        original=original,
        objectives={name: "less" if OBJECTIVES[name] < 0 else "more" for name in objectives},
        front=tuple(front),
        picks=picks_of(leading, original if original.status == DONE else None),
        operating_conditions=tuple(conditions_of(varied)) or None,
        balance=balance_line(plan, points) or None,
        left_off=tuple(left_off_lines(points)) or None,
        undecided=computed.undecided if plan.refine == "front" else None,
        files=SweepFiles(**write_tables(frame_of(rows, original, front), run.path, TABLE), page=REPORT),
        seconds=SweepSeconds(total=0.0),
    )


def _check_main_guard() -> None:
    """Refuse a script whose import, which every worker process does, would start the sweep again."""
    script = Path(getattr(sys.modules["__main__"], "__file__", None) or "")
    if script.suffix == ".py" and script.is_file() and "__main__" not in script.read_text("utf-8", "replace"):
        raise CranktopoError(
            f"sweep: worker processes import {script.name}, which would start the sweep again.",
            hint='Put the call below `if __name__ == "__main__":`.',
            code=ExitCode.USAGE,
        )


def sweep(
    design: DesignLike | Sequence[DesignLike] = "mikron-iiic",
    vary: Mapping[str, Any] | None = None,
    stage: str = "evaluate",
    sampling: str = "grid",
    samples: int | None = None,
    element_size_mm: float | None = None,
    accuracy_percent: float | None = None,
    refine: str = "all",
    budget_s: float | None = None,
    keep: str = "journals",
    minimise: str | None = None,
    maximise: str | None = None,
    limits: Sequence[str] = (),
    workers: int | None = None,
    scheduler: str | None = None,
    out: str | Path | None = None,
    resume: str | Path | None = None,
    function: PointFunction | None = None,
) -> pandas.DataFrame:
    """Compute many variants of a design and return one row for each, and one of the original.

    In a script it stands below `if __name__ == "__main__":`, because worker processes import the script.

    Args:
        design: scene, TOML path or name of a built-in design, or several; the first is the original.
        vary: values by key of the scene: a list, or text as behind `--vary KEY=`.
        stage: how far each point goes: evaluate, fatigue, optimise, remodel or shape.
        sampling: grid for all combinations, latin or sobol for so many `samples`.
        accuracy_percent: evaluations are refined until the bound of their error is no larger.
        refine: `front` computes all points coarse first, and those alone at full accuracy that may be on the
            front, within `budget_s` where it is given.
        keep: what stays where webs or pins get longer: the `journals`, or the `pitch` of the throws.
        minimise, maximise, limits: goal of optimisations; `torsion >= 90:130:5 %` varies its limit.
        workers: processes on this machine; by default as many as cores and memory allow.
        scheduler: address of a Dask scheduler to use instead.
        out: run directory; by default a new one under runs/.
        resume: run directory to continue; `design`, `vary` and the like are then read there.
        function: called with the `Scene` of every point in place of a stage; returns numbers by name.

    Returns:
        A frame, units in the column names; its `attrs` hold the run directory, the front and the picks.

    Raises:
        CranktopoError: bad input, a package missing, or interruption.
    """
    if scheduler is None:
        _check_main_guard()
    place = Workplace(workers, scheduler, function)
    if resume is not None:
        done = resume_sweep(str(resume), place)
    else:
        designs = [design] if isinstance(design, Scene | str | Path) else list(design)
        varied = [read_entry(key, entry) for key, entry in (vary or {}).items()]
        plan = sweep_plan(
            designs,
            varied,
            minimise=minimise,
            maximise=maximise,
            limits=limits,
            sampling=sampling,
            samples=samples,
            stage=stage,
            element_size_mm=element_size_mm,
            accuracy_percent=accuracy_percent,
            refine=refine,
            budget_s=budget_s,
            keep=keep,
        )
        done = run_sweep(plan, place, None if out is None else Path(out), ("cranktopo.sweep",))
    frame = done.frame
    frame.attrs |= {"run": str(done.folder), "front": list(done.result.front), "picks": done.result.picks}
    return frame
