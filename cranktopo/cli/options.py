"""Options that `evaluate` and `compare` share."""

from __future__ import annotations

from typing import Any

import click

_TIME_UNITS = {"min": 60.0, "h": 3600.0, "s": 1.0}


def percent(context: click.Context, parameter: click.Parameter, value: str | None) -> float | None:
    """The number of percent in `1%` or `1`, as an option's callback.

    Args:
        context, parameter: as click gives them, for the message.
        value: what the user wrote; None when the option is not given.

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
    """The number of seconds in `90`, `120s`, `5min` or `1h`, as an option's callback.

    Args:
        context, parameter: as click gives them, for the message.
        value: what the user wrote; None when the option is not given.

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


def mesh_options(function: Any) -> Any:
    """Add --element-size-mm, --accuracy, --budget and --design to a command."""
    for option in (
        click.option("--design", help="Design for the journals and material of STL and STEP targets."),
        click.option("--accuracy", metavar="PERCENT", callback=percent, help="Wanted error, such as 1%."),
        click.option(
            "--budget", metavar="TIME", callback=seconds, help="Time for each target, such as 30s or 2min."
        ),
        click.option(
            "--element-size-mm",
            type=click.FloatRange(min=0, min_open=True),
            help="General element size; by default a tenth of the thinner journal's diameter.",
        ),
    ):
        function = option(function)
    return function
