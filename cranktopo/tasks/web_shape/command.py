"""`cranktopo shape`

The best dimensions of a web that can be made, for a goal and limits: scene, STEP, drawing.
"""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from cranktopo.base.errors import ExitCode
from cranktopo.cli.options import (
    DEFAULT_DESIGN,
    bound_option,
    designs_and_runs,
    goal_options,
    limit_options,
    loads_option,
    refuse_beside_resume,
    run_options,
    throw_option,
    typed,
    web_option,
    with_bound_option,
    with_goal_options,
)
from cranktopo.cli.output import tell
from cranktopo.cli.verbosity import verbosity_options

if TYPE_CHECKING:
    from cranktopo.design.halves import WebName
    from cranktopo.engine.histories import HistoryKind


@click.command("shape")
@click.argument("target", required=False, shell_complete=designs_and_runs)
@web_option
@throw_option
@goal_options
@limit_options
@loads_option
@bound_option
@click.option(
    "--each-web",
    is_flag=True,
    help="Give every distinct web of the shaft dimensions of its own, for what it carries on all bearings.",
)
@run_options("Continue an interrupted optimisation; finished searches are kept.")
@click.option("--json", "as_json", is_flag=True, help="Print shape.json.")
@verbosity_options
def command(
    target: str | None,
    web: WebName | None,
    throw: int | None,
    minimise: str | None,
    maximise: str | None,
    limits: tuple[str, ...],
    loads: HistoryKind,
    out: Path | None,
    resume: str | None,
    as_json: bool,
    no_bound: bool,
    each_web: bool,
    **rules: Any,
) -> ExitCode:
    """Optimise the dimensions of the web of TARGET: outline, bevels, groove, pockets.

    TARGET is a design, the scene of a parametric web, or a run. The search begins with the web of the design,
    or of the run: its result, the best of its steps, or its re-model, which is made first where there is
    none. Percent limits refer to the design's own web, of a run to that of its design.

    The web can be made: walls, radii and draft are kept. Limits hold by the body-fitted evaluation, fillets
    included, or the result says that they are not met. Without a goal the lightest web is sought that is no
    softer and no less safe. With --loads cycle safety and stress are those of every angle of the cycle,
    tangential forces included, as by `fatigue --loads cycle`. Writes the scene, STEP, STL, a drawing and
    shape.json.

    With --each-web the shaft stands on all its bearings, and every distinct web is searched for under what it
    carries there: mirror pairs are equal, and so are those that need the same safety, or that
    `shape.same_webs` names. One web for all is found in the same way, and both cranks are compared. Writes
    crank.toml with a file for every further throw, and each-web.json.

    Example: cranktopo shape mikron-iiic --minimise mass --limit "bending >= 95 %"
    """
    if resume:
        refuse_beside_resume()
    from cranktopo.tasks.refit.fit import usual_limits
    from cranktopo.tasks.throw_fea.mirrored_webs import next_line
    from cranktopo.tasks.web_shape.run import resume_shape, shape_design, shape_goal, shape_settings
    from cranktopo.tasks.web_shape.stage import stresses_in
    from cranktopo.tasks.web_shape.text import shape_summary

    last = ""
    if each_web or (resume and _is_of_each_web(resume)):
        goal_words = minimise, maximise, limits
        return _each_web(target, web or throw, goal_words, rules, resume, out, as_json=as_json)
    if resume:
        run = resume_shape(resume)
    else:
        from cranktopo.design.loading import design_text
        from cranktopo.tasks.designs.run_webs import web_target

        name = target or DEFAULT_DESIGN
        found = web_target(name, web, throw, worse=True)
        scene, text = found.design, design_text(name) if found.run is None else None
        if scene.goal is None and minimise is None and maximise is None:
            minimise = "mass"
        scene = with_bound_option(with_goal_options(scene, minimise, maximise, limits), no_bound)
        if "--loads" in typed() and not stresses_in(shape_goal(scene).quantities):
            raise click.UsageError("--loads is of fatigue safety and stress, and neither is wanted")
        settings = shape_settings(scene, usual_limits(scene, **rules), loads)
        line = ["cranktopo", *sys.argv[1:]]
        run = shape_design(scene, settings, out, text, line, found.begun)
        last = next_line(scene, name, run.folder) if text else ""
    tell(run.result.as_json() if as_json else shape_summary(run.result, run.folder), indent=None)
    if last and not as_json:
        tell(last, indent=None)
    return ExitCode.DONE if run.result.held and run.result.makeable else ExitCode.CRITERION_NOT_MET


def _is_of_each_web(reference: str) -> bool:
    from cranktopo.runs.directories import open_run
    from cranktopo.runs.kind import EACH_WEB, kind_of

    return kind_of(open_run(reference)) == EACH_WEB


def _each_web(
    target: str | None,
    one: str | int | None,
    goal_words: tuple[str | None, str | None, tuple[str, ...]],
    rules: dict[str, Any],
    resume: str | None,
    out: Path | None,
    *,
    as_json: bool,
) -> ExitCode:
    """Optimise every web of a shaft; `one` is what --web or --throw names."""
    from cranktopo.design.loading import design_text, load_scene
    from cranktopo.tasks.refit.fit import usual_limits
    from cranktopo.tasks.web_shape.each_web.run import resume_each_web, shape_each_web
    from cranktopo.tasks.web_shape.each_web.text import each_web_summary
    from cranktopo.tasks.web_shape.run import shape_settings

    if resume:
        run = resume_each_web(resume)
    else:
        if one is not None:
            raise click.UsageError("--each-web is of all webs: leave --web and --throw out")
        if "--loads" in typed():
            raise click.UsageError(
                "--each-web takes every angle of the cycle in the shaft: leave --loads out"
            )
        name = target or DEFAULT_DESIGN
        scene = load_scene(name, whole=True)
        minimise, maximise, limits = goal_words
        if scene.goal is None and minimise is None and maximise is None:
            minimise = "mass"
        scene = with_goal_options(scene, minimise, maximise, limits)
        settings = shape_settings(scene, usual_limits(scene, **rules))
        run = shape_each_web(scene, settings, out, design_text(name), ["cranktopo", *sys.argv[1:]])
    tell(run.result.as_json() if as_json else each_web_summary(run.result, run.folder), indent=None)
    return ExitCode.DONE if run.result.held and run.result.makeable else ExitCode.CRITERION_NOT_MET
