"""The end of an optimise run: what the design is worth, its surface, its files and its page."""

from __future__ import annotations

import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from cranktopo.base.errors import CranktopoError, ExitCode
from cranktopo.base.side_by_side import Ahead, side_by_side
from cranktopo.design.goal.outcome import GoalOutcome
from cranktopo.design.goal.wanted import wanted
from cranktopo.numerics.precision import CompileClock
from cranktopo.numerics.surfaces.mesh import SurfaceMesh
from cranktopo.report.report_file import REPORT, write_report
from cranktopo.runs.directories import RunStore
from cranktopo.tasks.bound.bound_for_result import Cells, model_for_result
from cranktopo.tasks.density import loop
from cranktopo.tasks.density.problem import DensityProblem
from cranktopo.tasks.density.stage import Prepared
from cranktopo.tasks.density.state import State
from cranktopo.tasks.extraction.checked_surface import CheckedSurface, checked_surface
from cranktopo.tasks.extraction.snapshots import snapshots
from cranktopo.tasks.optimise.evaluated_limits import EvaluatedGoal
from cranktopo.tasks.optimise.files import history_rows, write_run_files
from cranktopo.tasks.optimise.goal_by_evaluation import evaluation_seconds, told_by_evaluation
from cranktopo.tasks.optimise.judgement import beside_goal, judge
from cranktopo.tasks.optimise.page import run_page
from cranktopo.tasks.optimise.result import Timing, optimise_metrics, surface_metrics
from cranktopo.tasks.optimise.run_report import record_of
from cranktopo.tasks.optimise.run_stress import read_run_stress


def finisher(run: RunStore, prepared: Prepared) -> Finisher:
    """What can be had before the design is known; a thread makes the cells of the bound."""
    if prepared.plan["bound"].state != "on":
        return Finisher(run, prepared, None)
    cells = Ahead(lambda: model_for_result(prepared.scene, wanted(prepared.scene), run.log))
    cells.begin()
    return Finisher(run, prepared, cells.result)


@dataclass(frozen=True)
class Finisher:
    """Ends a run.

    Attributes:
        cells: of the bound; None where the plan leaves it out.
    """

    run: RunStore
    prepared: Prepared
    cells: Cells | None

    def finish(
        self,
        problem: DensityProblem,
        state: State,
        began: float,
        clock: CompileClock,
        case: EvaluatedGoal | None,
        failure: str,
    ) -> dict[str, Any]:
        """Judge the final design, make and measure its surface meanwhile, and write every file.

        Args:
            case: the limits that the evaluation keeps, if there are any; `failure`: why it could not.

        Returns:
            The metrics of the run.
        """
        optimised, run, prepared = time.perf_counter(), self.run, self.prepared
        scene, domain = prepared.scene, prepared.domain
        design = loop.final_design(problem, state)
        rows = history_rows(problem, state.history)
        (measured, mesh, files), judged = side_by_side(
            lambda: _shown(run, prepared, design, rows),
            lambda: judge(run, prepared, problem, state, design.physical, self.cells),
        )
        now = time.perf_counter()
        assumed = run.manifest().get("assumed", ())
        timing = Timing(now - began, now - optimised, clock.compile_s)
        metrics = optimise_metrics(
            run.name,
            prepared,
            problem,
            state,
            design.physical,
            judged.result,
            judged.original,
            measured,
            timing,
            assumed,
        )
        if case is not None:
            goal = GoalOutcome.of_json(metrics["goal"], "goal")
            metrics["goal"] = told_by_evaluation(goal, case, state, failure).as_json()
            metrics["seconds"]["evaluation"] = evaluation_seconds(case)
        if judged.bound is not None:
            metrics["bound"] = beside_goal(judged.bound, metrics.get("goal")).as_json()
            metrics["seconds"]["bound"] = judged.bound_s
        metrics["files"] = {**files, **metrics["files"], "report": REPORT}
        run.write_metrics(metrics)
        designs = snapshots(run, domain, problem.chain)
        stress = read_run_stress(run, files["stl"]) if "stl" in files else None
        record = record_of(run, metrics, rows, scene, mesh, designs, stress)
        write_report(run_page(record), run.path / REPORT)
        end = time.perf_counter()
        metrics["seconds"] |= {"total": end - began, "report": end - now}
        run.write_metrics(metrics)
        return metrics


def _shown(
    run: RunStore, prepared: Prepared, design: loop.WebDensities, rows: Sequence[Mapping[str, Any]]
) -> tuple[dict[str, Any], SurfaceMesh | None, dict[str, str]]:
    """What the surface measures, or why there is none, its half throw, and the files that show the design."""
    surface = _surface(prepared, design)
    mesh = None if isinstance(surface, str) else surface.surface.half_throw
    files = write_run_files(run, prepared.scene, prepared.domain, design, rows, mesh)
    return surface_metrics(surface, prepared.scene), mesh, files


def _surface(prepared: Prepared, design: loop.WebDensities) -> CheckedSurface | str:
    """The surface, or why there is none, as of the first designs, which are grey."""
    try:
        return checked_surface(prepared.scene, prepared.domain, design)
    except CranktopoError as error:
        if error.code != ExitCode.CRITERION_NOT_MET:
            raise
        return str(error)
