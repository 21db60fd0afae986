"""`cranktopo optimise`

Optimise the web's density under bending and torsion; write a run with STL.
"""

from __future__ import annotations

import sys
import time
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from cranktopo.base.errors import ExitCode
from cranktopo.base.notes import Pace, detail, note
from cranktopo.base.units import number_text
from cranktopo.cli.options import (
    CELL_MM,
    DEFAULT_DESIGN,
    VOLUME_FRACTION,
    Choice,
    Number,
    bound_option,
    designs,
    goal_options,
    percent,
    refuse_beside_resume,
    run_options,
    seconds,
    throw_option,
    web_option,
    with_bound_option,
    with_goal_options,
)
from cranktopo.cli.output import tell
from cranktopo.cli.verbosity import NORMAL, level, verbosity_options

if TYPE_CHECKING:
    from cranktopo.design.goal.limit import GoalTable
    from cranktopo.design.halves import WebName
    from cranktopo.design.schema import Scene
    from cranktopo.tasks.density.problem import DensityProblem
    from cranktopo.tasks.density.state import State
    from cranktopo.tasks.optimise.result import RunMetrics


@click.command("optimise")
@click.argument("design", required=False, shell_complete=designs)
@web_option
@throw_option
@goal_options
@click.option("--no-goal", is_flag=True, help="Leave the design's [goal] out: a web of a volume fraction.")
@click.option(
    "--volume-fraction",
    type=VOLUME_FRACTION,
    help="Share of the design space that becomes solid, 0 to 1; default: the design's. "
    "With a goal the limits decide, and it is refused: --no-goal leaves that of the design out.",
)
@click.option("--resolution-mm", type=CELL_MM, help="Largest cell edge, mm; default: the design's.")
@click.option(
    "--process",
    type=Choice(["free", "forged", "cast", "milled"]),
    help="How the web is made: in a die, a mould, by a mill, or without their rules; default: the design's.",
)
@click.option(
    "--draft-deg", type=Number(0, 20), help="Draft of forged and cast walls, degrees; default: the design's."
)
@click.option(
    "--min-member-mm",
    type=Number(0.05, 1000),
    help="Minimum thickness of a member, mm; at least 2 cells; default: the design's.",
)
@click.option(
    "--min-gap-mm",
    type=Number(0.05, 1000),
    help="Minimum width of a gap, mm; at least 2 cells; default: the design's.",
)
@click.option(
    "--accuracy",
    metavar="PERCENT",
    callback=percent,
    help="Largest permitted error of the stiffnesses, such as 5%.",
)
@click.option("--budget", metavar="TIME", callback=seconds, help="Time for the run, such as 30s or 2min.")
@click.option(
    "--no-evaluation",
    is_flag=True,
    help="With a goal: let the limits hold in the cells, without an evaluation of the surface.",
)
@bound_option
@click.option("--max-iterations", type=click.IntRange(1, 10000), help="Limit on designs evaluated.")
@run_options("Continue an interrupted, stopped or killed run.")
@click.option("--json", "as_json", is_flag=True, help="Print the metrics as one JSON object.")
@verbosity_options
def command(design: str | None, out: Path | None, resume: str | None, as_json: bool, **options: Any) -> int:
    """Optimise the web of DESIGN under its load cases and write a run.

    Without a goal it is the stiffest web at a volume fraction. Quantities of a goal and its limits are mass,
    inertia, unbalance, balance_factor, torsion, bending, torsion_per_mass, bending_per_mass,
    pin_displacement, twist, natural_frequency and fatigue_safety, the last two left to the evaluation;
    stress, oil_film and bearing_pressure limit `cranktopo shape` alone.

    Example: cranktopo optimise mikron-iiic --volume-fraction 0.3
    """
    began = time.perf_counter()
    if resume:
        refuse_beside_resume("max_iterations")
    from cranktopo.base.companion import Companion, load_libraries

    last = ""
    with Companion() as beside, _Bar() as bar:
        from cranktopo.numerics.kernels.catalogue import keep_machine_code

        beside.begin(keep_machine_code)  # needed first: a program is traced through its kernels
        beside.begin(load_libraries, _LIBRARIES)
        from cranktopo.tasks.optimise.stage import optimise_design, resume_optimisation
        from cranktopo.tasks.optimise.text import run_summary
        from cranktopo.tasks.throw_fea.mirrored_webs import next_line

        if resume:
            run = resume_optimisation(resume, options["max_iterations"], bar, began, beside)
        else:
            from cranktopo.design.loading import design_text

            name = design or DEFAULT_DESIGN
            scene = _scene(name, **options)
            command_line = ["cranktopo", *sys.argv[1:]]
            run = optimise_design(scene, out, design_text(name), command_line, bar, began, beside)
            last = next_line(scene, name, run.folder, "cranktopo", "remodel")
    tell(run.metrics.as_json() if as_json else run_summary(run.metrics, run.folder), indent=None)
    if last and not as_json:
        tell(last, indent=None)
    return _exit_code(run.metrics)


def _scene(
    name: str,
    web: WebName | None,
    throw: int | None,
    minimise: str | None,
    maximise: str | None,
    limits: tuple[str, ...],
    no_goal: bool,
    accuracy: float | None,
    budget: float | None,
    no_evaluation: bool,
    no_bound: bool,
    **settings: Any,
) -> Scene:
    """Return the design with what the options change; `settings` are named as in `[optimise]`."""
    if settings["resolution_mm"] and (accuracy or budget):
        raise click.UsageError(
            "--resolution-mm excludes --accuracy and --budget: give the size, or what it should do"
        )
    from cranktopo.design.loading import load_scene, one_web
    from cranktopo.engine.one_throw import one_throw
    from cranktopo.tasks.optimise.stage import with_cells_for

    evaluated = False if no_evaluation else None
    scene = one_web(one_throw(load_scene(name, whole=True), throw), web)
    scene = scene.with_optimise(**settings, limits_by_evaluation=evaluated)
    if no_goal and (minimise or maximise or limits):
        raise click.UsageError("--no-goal excludes --minimise, --maximise and --limit: keep one of them")
    scene = scene.model_copy(update={"goal": None}) if no_goal else scene
    if settings["draft_deg"] is not None and scene.optimise.process in ("free", "milled"):
        raise click.UsageError(f"--draft-deg: process '{scene.optimise.process}' has no draft: leave it out")
    scene = with_bound_option(with_goal_options(scene, minimise, maximise, limits), no_bound)
    if settings["volume_fraction"] is not None and scene.goal is not None:
        raise click.UsageError(_beside_goal(scene.goal, minimise or maximise))
    if no_evaluation and scene.goal is None:
        raise click.UsageError("--no-evaluation needs a goal: only its limits are evaluated")
    return with_cells_for(scene, accuracy, budget) if accuracy or budget else scene


def _beside_goal(goal: GoalTable, goal_option: str | None) -> str:
    """Return why a goal, by an option or the design's own, leaves no place for a volume fraction."""
    if goal_option:
        return "--volume-fraction excludes a goal: limit the mass instead"
    key, word = ("minimise", goal.minimise) if goal.minimise else ("maximise", goal.maximise)
    return (
        f"--volume-fraction excludes the goal of the design, goal.{key} = '{word}': add --no-goal to leave "
        "[goal] with its limits out, or leave out --volume-fraction and limit the mass"
    )


def _exit_code(metrics: RunMetrics) -> ExitCode:
    if metrics.status == "infeasible":
        return ExitCode.CRITERION_NOT_MET
    if metrics.status != "converged":
        return ExitCode.NOT_CONVERGED
    goal = metrics.goal
    violated = goal is not None and any(limit.holds is False for limit in goal.limits)
    unmet = violated or (goal is not None and goal.not_evaluated is not None) or metrics.refusal
    return ExitCode.CRITERION_NOT_MET if unmet else ExitCode.DONE


_LIBRARIES = (
    "cranktopo.bodies.cells.domain",
    "cranktopo.tasks.optimise.picture",
    "matplotlib.backends.backend_agg",
    "matplotlib.backends.backend_svg",
)
"""Modules that the second process loads while this one loads its own, which takes a second."""
_QUIET_S = 10.0
"""Least time between lines of the pace, where there is no bar."""


class _Bar:
    """Progress on stderr: compliances, volume, greyness, time left.

    A bar on a terminal, a line per iteration with --verbose, otherwise the pace now and then.
    """

    def __enter__(self) -> _Bar:
        from tqdm import tqdm

        hidden = level() != NORMAL or not sys.stderr.isatty()
        self._bar = tqdm(unit="it", file=sys.stderr, disable=hidden, dynamic_ncols=True)
        self._pace = Pace("optimise, iterations", 1, quiet_s=_QUIET_S)
        return self

    def __exit__(self, *_: object) -> None:
        self._bar.close()

    def __call__(self, problem: DensityProblem, state: State) -> None:
        from cranktopo.tasks.density.loop import iterations_left

        row = state.last
        done = len(state.history)
        self._bar.total = done + (0 if state.done else iterations_left(problem, state))
        if self._bar.disable and not state.done:
            self._pace.begin(parts=self._bar.total)
        cases = zip(problem.model.case_names, row.compliance_N_mm, strict=True)
        work = ", ".join(f"{name} {number_text(value)} N mm" for name, value in cases)
        reached = [
            f"{response.name} {number_text(value)} {response.unit}".rstrip()
            for response, value in zip(
                problem.optimisation.responses, (*row.goals, *row.limits), strict=False
            )
        ]
        values = ", ".join(dict.fromkeys(reached)) or f"{work}, volume {row.volume_fraction:.3f}"
        text = f"{values}, grey {row.greyness:.3f}"
        self._bar.set_postfix_str(text, refresh=False)
        detail(f"iteration {row.iteration}: {text}, {row.cg_iterations} cycles, {row.seconds:.2f} s")
        if row.notice:
            note(f"iteration {row.iteration}: {row.notice}")
        self._bar.update(done - self._bar.n)
