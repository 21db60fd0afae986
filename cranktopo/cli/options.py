"""What commands share: the default design, and options."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import click
from click.core import ParameterSource

from cranktopo.cli.parameters import CELL_MM, Choice, Number
from cranktopo.design.manufacturing_limits import ManufacturingLimits

if TYPE_CHECKING:
    from cranktopo.design.schema import Scene

DEFAULT_DESIGN = "mikron-iiic"
_TIME_UNITS = {"min": 60.0, "h": 3600.0, "s": 1.0}


bearings_option = click.option(
    "--bearings",
    type=Choice(["rigid", "spring", "free"]),
    default="rigid",
    show_default=True,
    help="Radial support of every mid-journal section; all of them let it tilt.",
)

web_option = click.option(
    "--web",
    type=Choice(["first", "second"]),
    help="Of a throw with two different webs, which one to take; needed there.",
)

bound_option = click.option(
    "--no-bound", is_flag=True, help="Do not prove how far the result is from the best possible web."
)


def with_bound_option(scene: Scene, no_bound: bool) -> Scene:
    """Return the scene without its bound where the option leaves it out."""
    return scene.with_effect("bound", "off") if no_bound else scene


def percent(context: click.Context, parameter: click.Parameter, value: str | None) -> float | None:
    """Return the number of percent in `1%` or `1`, as an option's callback.

    Raises:
        click.BadParameter: not a number above 0 and below 100.
    """
    if value is None:
        return None
    try:
        number = float(value.strip().removesuffix("%"))
    except ValueError:
        raise click.BadParameter(f"{value!r} is not a percentage such as 1%.", context, parameter) from None
    if not 0 < number < 100:
        raise click.BadParameter(f"{value!r} must be above 0% and below 100%.", context, parameter)
    return number


def seconds(context: click.Context, parameter: click.Parameter, value: str | None) -> float | None:
    """Return the number of seconds in `90`, `120s`, `5min` or `1h`, as an option's callback.

    Raises:
        click.BadParameter: not a time above 0.
    """
    if value is None:
        return None
    text = value.strip().lower()
    unit = next((u for u in _TIME_UNITS if text.endswith(u)), "")
    try:
        number = float(text.removesuffix(unit)) * _TIME_UNITS.get(unit, 1.0)
    except ValueError:
        raise click.BadParameter(
            f"{value!r} is not a time such as 30s or 2min.", context, parameter
        ) from None
    if not 0 < number < float("inf"):
        raise click.BadParameter(f"{value!r} must be above 0 s.", context, parameter)
    return number


def body_options(function: Any) -> Any:
    """Add --design and --align, for targets that are bodies from CAD, to a command."""
    function = click.option(
        "--align",
        is_flag=True,
        help="Move STL and STEP bodies that lie elsewhere to where the journals are.",
    )(function)
    return click.option(
        "--design", help="Design for the journals, loads and material of STL and STEP targets."
    )(function)


def mesh_options(function: Any) -> Any:
    """Add --element-size-mm, --accuracy, --budget, --design and --align to a command."""
    for option in (
        body_options,
        click.option("--accuracy", metavar="PERCENT", callback=percent, help="Wanted error, such as 1%."),
        click.option(
            "--budget", metavar="TIME", callback=seconds, help="Time for each target, such as 30s or 2min."
        ),
        click.option(
            "--element-size-mm",
            type=CELL_MM,
            help="General element size; by default a tenth of the thinner journal's diameter.",
        ),
    ):
        function = option(function)
    return function


def limit_options(function: Any) -> Any:
    """Add --min-wall-mm, --min-radius-mm, --draft-deg and --cell-mm to a command that fits webs.

    Their parameters are named as the fields of `ManufacturingLimits`.
    """
    for names, bounds, text in (
        (
            ("--cell-mm",),
            Number(0.01, 50),
            "Cells of the final fit: half the size is closer to the body and takes eight times as long.",
        ),
        (
            ("--draft-deg", "min_draft_deg"),
            Number(0, 30),
            "Least draft of a side pocket's walls.",
        ),
        (("--min-radius-mm",), Number(0.05, 1000), "Least radius of curvature of the outline."),
        (("--min-wall-mm",), Number(0.05, 1000), "Least wall."),
    ):
        field = names[-1].removeprefix("--").replace("-", "_")
        usual = f"{getattr(ManufacturingLimits, field):g}"
        size = "" if field == "min_draft_deg" else " for journals of 42 to 84 mm, others in proportion"
        function = click.option(*names, type=bounds, help=f"{text}  [default: {usual}{size}]")(function)
    return function


def refuse_beside_resume(*allowed: str) -> None:
    """Check that nothing is given beside --resume that the run itself keeps.

    Args:
        allowed: names of the running command's parameters that may go with --resume.

    Raises:
        click.UsageError: another one was typed.
    """
    context = click.get_current_context()
    for parameter in context.command.params:
        name = str(parameter.name)
        typed = context.get_parameter_source(name) == ParameterSource.COMMANDLINE
        if typed and parameter.expose_value and name not in ("resume", "as_json", *allowed):
            what = parameter.opts[0] if isinstance(parameter, click.Option) else name.upper()
            free = [p.opts[0] for p in context.command.params if p.name in allowed]
            but = f"; only {' and '.join(free)} may be given" if free else ""
            raise click.UsageError(
                f"--resume takes the design and its options from the run{but}: leave out {what}"
            )
