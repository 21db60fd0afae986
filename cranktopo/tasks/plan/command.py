"""`cranktopo plan`

Which effects a design calls for, why, and what each would cost.
"""

from __future__ import annotations

import json

import click

from cranktopo.base.notes import note
from cranktopo.cli.options import DEFAULT_DESIGN, designs, goal_options, throw_option, with_goal_options
from cranktopo.cli.verbosity import verbosity_options


@click.command(name="plan")
@click.argument("design", default=DEFAULT_DESIGN, shell_complete=designs)
@throw_option
@goal_options
@click.option("--json", "as_json", is_flag=True, help="Print one JSON object.")
@verbosity_options
def command(
    design: str,
    throw: int | None,
    minimise: str | None,
    maximise: str | None,
    limits: tuple[str, ...],
    as_json: bool,
) -> None:
    """The effects of a design: state, reason, what leaving each out changes, and what it costs.

    DESIGN is a TOML file or the name of a built-in design. Costs and estimates come from closed forms;
    nothing is solved. With a goal the load cases are those of `optimise` with that goal.

    Example: cranktopo plan opposed-piston
    """
    from cranktopo.bodies.cells.outside import outside_envelope, outside_words
    from cranktopo.design.assumed import (
        ENVELOPE,
        GOAL,
        LOADS,
        SUPPORTS,
        THROW,
        VIBRATION,
        assumed_text,
        assumptions,
    )
    from cranktopo.design.checks.engine import shaft_warnings
    from cranktopo.design.goal.limit import goal_text
    from cranktopo.design.goal.outcome import stated_goal
    from cranktopo.design.goal.wanted import wanted
    from cranktopo.design.loading import load_scene
    from cranktopo.design.strength import strength_remarks
    from cranktopo.engine.one_throw import one_throw
    from cranktopo.engine.plan.cost import effort
    from cranktopo.engine.plan.planning import plan
    from cranktopo.tasks.plan.result import DesignPlan, PlannedEvaluations
    from cranktopo.tasks.plan.text import plan_text

    taken = one_throw(load_scene(design, whole=True), throw)
    scene = with_goal_options(taken, minimise, maximise, limits)
    goal = wanted(scene)
    effects = plan(scene, goal=goal)
    todo = effort(scene)
    outside = outside_envelope(scene)
    assumed = assumptions(scene, (THROW, LOADS, VIBRATION, SUPPORTS, ENVELOPE, GOAL))
    if as_json:
        found = DesignPlan(
            design=scene.name,
            goal=None if goal is None else stated_goal(goal),
            effects=effects.effects,
            evaluations=PlannedEvaluations(number=todo.evaluations, seconds=todo.evaluation_seconds),
            outside_envelope=outside,
            assumed=assumed,
        )
        click.echo(json.dumps(found.as_json(), indent=2))
    else:
        click.echo(f"{scene.name}, threshold {100 * scene.effects.threshold:g} %")
        if goal is not None:
            click.echo(goal_text(goal, "density"))
        if todo.evaluations:
            click.echo(
                f"limits by the evaluation: about {todo.evaluations} evaluations of original and surfaces, "
                f"+{todo.evaluation_seconds:.0f} s"
            )
        if outside_words(outside):
            click.echo(outside_words(outside))
        click.echo(f"\n{plan_text(effects)}")
        if assumed:
            note(assumed_text(assumed))
        for remark in strength_remarks(scene):
            note(f"warning: material: {remark}")
        for line in shaft_warnings(scene) if scene.shaft else ():
            note(f"warning: {line}")
