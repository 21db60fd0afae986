"""`cranktopo plan`

Which effects a design calls for, why, and what each would cost.
"""

from __future__ import annotations

import click

from cranktopo.base.notes import note, warn
from cranktopo.cli.options import DEFAULT_DESIGN, designs, goal_options, throw_option, with_goal_options
from cranktopo.cli.output import tell
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
    from cranktopo.design.assumed import assumed_text
    from cranktopo.design.loading import load_scene
    from cranktopo.engine.one_throw import one_throw
    from cranktopo.tasks.plan.stage import design_plan, plan_warnings
    from cranktopo.tasks.plan.text import plan_text

    taken = one_throw(load_scene(design, whole=True), throw)
    scene = with_goal_options(taken, minimise, maximise, limits)
    found = design_plan(scene)
    if as_json:
        tell(found.as_json())
        return
    tell(plan_text(found, scene))
    if found.assumed:
        note(assumed_text(found.assumed))
    for warning in plan_warnings(scene):
        warn(warning)
