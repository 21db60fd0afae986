"""The end of an optimise run: what the design is worth, its surface, its files and its page."""

from __future__ import annotations

import time
from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

from cranktopo.base.arrays import Array
from cranktopo.base.companion import Companion, Work
from cranktopo.base.errors import CranktopoError, ExitCode
from cranktopo.base.files import write_bytes
from cranktopo.base.notes import redirected
from cranktopo.base.side_by_side import LazyFuture, side_by_side
from cranktopo.bodies.cells.domain import Domain
from cranktopo.design.assumed import stored_assumptions
from cranktopo.design.goal.outcome import GoalOutcome, goal_outcome
from cranktopo.design.goal.scene_goal import goal_of
from cranktopo.design.schema import Scene
from cranktopo.numerics.precision import CompileClock, double_precision
from cranktopo.numerics.surfaces.files import write_stl
from cranktopo.numerics.surfaces.mesh import SurfaceMesh
from cranktopo.report.report_file import REPORT, Drawn, drawn_plots, write_report
from cranktopo.report.vtu import write_density_vtu
from cranktopo.runs.directories import RunStore
from cranktopo.tasks.bound.result import BoundStatements, NoBound
from cranktopo.tasks.bound.stage import Cells, bounds_for_result, model_for_result
from cranktopo.tasks.density import loop
from cranktopo.tasks.density.assess import assess, assess_original
from cranktopo.tasks.density.problem import Assessment, DensityProblem
from cranktopo.tasks.density.stage import Prepared
from cranktopo.tasks.density.state import Record, State
from cranktopo.tasks.extraction.checked_surface import CheckedSurface, checked_surface
from cranktopo.tasks.extraction.result import NoSurface, RunSurface
from cranktopo.tasks.optimise.evaluated_goal import EvaluatedGoal, evaluation_seconds, goal_by_evaluation
from cranktopo.tasks.optimise.metrics import run_metrics, run_seconds, run_surface
from cranktopo.tasks.optimise.page import convergence_pictures, run_page
from cranktopo.tasks.optimise.picture import run_pictures
from cranktopo.tasks.optimise.result import OptimisedRun
from cranktopo.tasks.optimise.run_record import read_run_stress, record_of, snapshots

_SURFACE, _PICTURE, _DENSITY = "web.stl", "result.png", "density.vtu"


class Prefetched(NamedTuple):
    """Things that the end of a run needs and that no design decides.

    Attributes:
        cells: gives the cells of the bound; None where the plan leaves it out.
        original: gives the scene's own web as it is judged on the cells of the design.
        loads: plots of the loads.
    """

    cells: Cells | None
    original: Work[Assessment]
    loads: Work[Drawn]


def cells_of_bound(run: RunStore, prepared: Prepared) -> Cells | None:
    """Return what gives the cells of the bound, begun in a thread; None where the plan leaves it out."""
    if prepared.plan["bound"].state != "on":
        return None
    cells = LazyFuture(lambda: model_for_result(prepared.scene, goal_of(prepared.scene)))
    with redirected(run.log):
        cells.begin()
    return cells.result


def judged_original(problem: DensityProblem, prepared: Prepared, filled: Array | None) -> Work[Assessment]:
    """Return what gives the scene's own web as it is judged, begun in a thread.

    Args:
        filled: solid fractions of the web on the cells of the design, where they are known.
    """
    known = problem.original
    if known is not None:
        return lambda: known

    def judged() -> Assessment:
        with double_precision():
            return assess_original(problem.model, prepared.scene, prepared.domain, filled)

    work = LazyFuture(judged)
    work.begin()
    return work.result


def finalise_run(
    run: RunStore,
    prepared: Prepared,
    problem: DensityProblem,
    state: State,
    began: float,
    clock: CompileClock,
    case: EvaluatedGoal | None,
    failure: str,
    ahead: Prefetched,
    beside: Companion,
) -> OptimisedRun:
    """Judge the final design, make, measure and draw its surface meanwhile, and write every file.

    There is no `case` without limits that the evaluation keeps.
    """
    optimised = time.perf_counter()
    design = loop.final_design(problem, state)
    rows = _history_rows(problem, state.history)
    (surface, half_throw, views, files, curves), judged = side_by_side(
        lambda: _write_design(run, prepared, design, rows, beside),
        lambda: _judged(run, prepared, problem, state, design.physical, ahead),
    )
    now = time.perf_counter()
    times = {} if case is None else {"evaluation": evaluation_seconds(case)}
    times |= {} if judged.bound is None else {"bound": judged.bound_s}
    goal = _goal(prepared.scene, judged, case, state, failure)
    metrics = run_metrics(
        run.name,
        prepared,
        problem,
        state,
        design.physical,
        judged.result,
        judged.original,
        surface,
        half_throw,
        goal=goal,
        seconds=run_seconds(state, now - began, now - optimised, clock.compile_s, **times),
        files=files,
        assumed=stored_assumptions(run.manifest().assumed),
        bound=None if judged.bound is None else _beside_goal(judged.bound, goal),
    )
    run.write_metrics(metrics.as_json())
    stress = read_run_stress(run, files["stl"]) if "stl" in files else None
    designs = snapshots(run, prepared.domain, problem.density_chain)
    record = record_of(run, metrics, rows, prepared.scene, half_throw, designs, stress)
    write_report(run_page(record, views), run.path / REPORT, beside, (ahead.loads, curves))
    end = time.perf_counter()
    seconds = metrics.seconds.model_copy(update={"total": end - began, "report": end - now})
    metrics = metrics.model_copy(update={"seconds": seconds})
    run.write_metrics(metrics.as_json())
    run.log(f"{metrics.status}: {metrics.stop_reason}")
    return OptimisedRun(run.path, metrics, half_throw)


class _Judgement(NamedTuple):
    """The final design and the scene's own web, solved at a tight tolerance.

    The bound is None where the plan leaves it out; `bound_s` is its wall time without its cells.
    """

    result: Assessment
    original: Assessment
    bound: BoundStatements | NoBound | None
    bound_s: float


def _judged(
    run: RunStore,
    prepared: Prepared,
    problem: DensityProblem,
    state: State,
    density: Array,
    ahead: Prefetched,
) -> _Judgement:
    """Judge the physical density (nx, ny, nw) that a state ended with, in any thread."""
    scene, domain = prepared.scene, prepared.domain
    with double_precision():
        result = assess(problem, scene, domain, density)
    original = ahead.original()
    began = time.perf_counter()
    bound = None if ahead.cells is None else _bound(run, scene, state, result, original, ahead.cells)
    return _Judgement(result, original, bound, time.perf_counter() - began)


def _bound(
    run: RunStore, scene: Scene, state: State, result: Assessment, original: Assessment, cells: Cells
) -> BoundStatements | NoBound:
    """Return what no web of the envelope can beat, beside the result in percent of the original."""
    if state.status != "converged":
        return NoBound(none="the run has not converged")
    own = original.quantities
    reached = {name: 100 * value / own[name] for name, value in result.quantities.items() if own[name]}
    with redirected(run.log):
        return bounds_for_result(scene, reached, goal_of(scene), cells)


def _goal(
    scene: Scene, judged: _Judgement, case: EvaluatedGoal | None, state: State, failure: str
) -> GoalOutcome | None:
    """Return what became of the goal, by the evaluation where the run has one; None without a goal."""
    goal = goal_of(scene)
    if goal is None:
        return None
    in_cells = goal_outcome(goal, judged.result.quantities, judged.original.quantities)
    return in_cells if case is None else goal_by_evaluation(in_cells, case, state, failure)


def _beside_goal(bound: BoundStatements | NoBound, goal: GoalOutcome | None) -> BoundStatements | NoBound:
    if goal is None or isinstance(bound, NoBound):
        return bound
    return bound.with_reached(goal.reached_percent)


class _Written(NamedTuple):
    """Measures of the surface, or why there is none, its half throw, a PNG of its views, names of files.

    The curves are plots over the iterations.
    """

    surface: RunSurface | NoSurface
    half_throw: SurfaceMesh | None
    views: bytes | None
    files: dict[str, str]
    curves: Work[Drawn]


def _write_design(
    run: RunStore,
    prepared: Prepared,
    design: loop.WebDensities,
    rows: Sequence[Mapping[str, Any]],
    beside: Companion,
) -> _Written:
    """Write the files of the design, with the surface, which the second process draws."""
    surface, scene = _surface(prepared, design), prepared.scene
    half_throw = None if isinstance(surface, str) else surface.surface.half_throw
    files, views = {"vtu": _DENSITY, "history": "history.csv"}, None
    if half_throw is not None:
        drawn = beside.begin(run_pictures, half_throw, rows, _title(scene), scene.web_z_mm)
    curves = beside.begin(drawn_plots, convergence_pictures(rows))
    run.write_history(rows)
    _write_density(run, prepared.domain, design)
    measured = run_surface(surface, scene)
    if half_throw is None:
        for name in (_SURFACE, _PICTURE):  # of an earlier end of a resumed run
            (run.path / name).unlink(missing_ok=True)
    else:
        write_stl(run.path / _SURFACE, half_throw)
        picture, views = drawn()
        write_bytes(run.path / _PICTURE, picture)
        files = {"stl": _SURFACE, **files, "picture": _PICTURE}
    always = {"metrics": "metrics.json", "manifest": "manifest.json", "log": "run.log", "report": REPORT}
    return _Written(measured, half_throw, views, files | always, curves)


def _surface(prepared: Prepared, design: loop.WebDensities) -> CheckedSurface | str:
    """Return the surface, or why there is none, as of the first designs, which are grey."""
    try:
        return checked_surface(prepared.scene, prepared.domain, design)
    except CranktopoError as error:
        if error.code != ExitCode.CRITERION_NOT_MET:
            raise
        return str(error)


def _title(scene: Scene) -> str:
    goal = goal_of(scene)
    volume = f"volume fraction {scene.optimise.volume_fraction:g}"
    return f"{scene.name}, {volume if goal is None else f'{goal.sense} {goal.quantity}'}"


def _history_rows(problem: DensityProblem, history: Sequence[Record]) -> list[dict[str, Any]]:
    """Return the rows of history.csv: one per design, units in the column names."""
    case_names, responses = problem.model.case_names, problem.optimisation.responses
    return [
        {
            "iteration": row.iteration,
            "beta": row.beta,
            "objective": row.objective,
            **{
                f"{name}_compliance_N_mm": value
                for name, value in zip(case_names, row.compliance_N_mm, strict=True)
            },
            **{
                _column_name(response.name, response.unit): value
                for response, value in zip(responses, (*row.goals, *row.limits), strict=False)
            },
            "volume_fraction": row.volume_fraction,
            "greyness": row.greyness,
            "change": row.change,
            "cg_iterations": row.cg_iterations,
            "seconds": round(row.seconds, 4),
        }
        for row in history
    ]


def _column_name(name: str, unit: str) -> str:
    """Return the machine name of a quantity: `torsion` in `N m/(rad kg)` is `torsion_Nm_per_rad_kg`."""
    plain = unit.replace("N m", "Nm").replace("/", "_per_").replace("(", "").replace(")", "")
    return f"{name} {plain}".strip().replace(" ", "_")


def _write_density(run: RunStore, domain: Domain, design: loop.WebDensities) -> None:
    first, last = domain.web_layers
    physical = domain.passive_fraction.copy()
    physical[:, :, first:last] += domain.design_fraction[:, :, first:last] * design.physical
    write_density_vtu(
        run.path / _DENSITY,
        domain.grid.x_mm,
        domain.grid.y_mm,
        domain.grid.z_mm,
        {
            "density": physical,
            "designable_fraction": domain.design_fraction,
            "fixed_fraction": domain.passive_fraction,
        },
        (domain.passive_fraction + domain.design_fraction) > 0,
    )
