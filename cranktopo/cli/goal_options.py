"""What is wanted, as options: the goal and its limits, the same for every command that optimises."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import click

if TYPE_CHECKING:
    from cranktopo.design.schema import Scene


def goal_options(function: Any) -> Any:
    """Add --minimise, --maximise and --limit to a command; `with_goal_options` takes what they give."""
    for option in (
        click.option(
            "--limit",
            "limits",
            metavar="LIMIT",
            multiple=True,
            help='Such as "bending >= 100 %" or "unbalance <= 40 kg mm"; repeatable. It replaces what the '
            'design, or the goal by default, says of that quantity; "bending none" takes that away.',
        ),
        click.option(
            "--maximise",
            metavar="QUANTITY",
            help="Make it as high as the limits allow, in place of the design's goal and limits.",
        ),
        click.option(
            "--minimise",
            metavar="QUANTITY",
            help="Make it as low as the limits allow, in place of the design's goal and limits.",
        ),
    ):
        function = option(function)
    return function


def with_goal_options(
    scene: Scene, minimise: str | None, maximise: str | None, limits: tuple[str, ...]
) -> Scene:
    """Return the scene with the goal that the options ask for.

    Raises:
        click.UsageError: two goals, or a limit without a goal.
        CranktopoError: a goal or limit that makes no sense.
    """
    from cranktopo.design.goal.wanted import with_goal

    if minimise is not None and maximise is not None:
        raise click.UsageError("--minimise excludes --maximise: keep one of them, limit the other quantity")
    if limits and minimise is None and maximise is None and scene.goal is None:
        raise click.UsageError("--limit needs a goal: add --minimise or --maximise, or [goal] to the design")
    return with_goal(scene, minimise=minimise, maximise=maximise, limits=limits)
