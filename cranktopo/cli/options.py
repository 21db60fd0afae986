"""Options, their types, and the values that a shell offers, shared by the commands."""

from __future__ import annotations

import math
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click
from click.core import ParameterSource

from cranktopo.base.errors import decimal_comma, quoted, suggest
from cranktopo.throw.manufacturing_limits import ManufacturingLimits

if TYPE_CHECKING:
    from click.shell_completion import CompletionItem

    from cranktopo.design.schema import Scene


def designs(context: click.Context, parameter: click.Parameter, incomplete: str) -> list[CompletionItem]:
    """Return names of built-in designs, and files, for an argument's `shell_complete`."""
    from click.shell_completion import CompletionItem

    from cranktopo.design.loading import builtin_designs

    names = [CompletionItem(name) for name in builtin_designs() if name.startswith(incomplete)]
    return [*names, CompletionItem(incomplete, type="file")]


def designs_and_runs(
    context: click.Context, parameter: click.Parameter, incomplete: str
) -> list[CompletionItem]:
    """Return both, for an argument's `shell_complete`."""
    return [*runs(context, parameter, incomplete)[:-1], *designs(context, parameter, incomplete)]


def runs(context: click.Context, parameter: click.Parameter, incomplete: str) -> list[CompletionItem]:
    """Return names of runs under runs/, and folders, for an argument's `shell_complete`."""
    from click.shell_completion import CompletionItem

    from cranktopo.runs.directories import list_runs

    names = [CompletionItem(run.name) for run in list_runs() if run.name.startswith(incomplete)]
    return [*names, CompletionItem(incomplete, type="dir")]


class Number(click.FloatRange):
    """A finite number in a closed range, which help shows."""

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> float:
        """Return the value as a float; fails with the allowed range."""
        try:
            number = float(str(value))
        except ValueError:
            number = math.nan
        if not (self.min is not None and self.max is not None and self.min <= number <= self.max):
            allowed = f"must be a number >= {self.min:g} and <= {self.max:g}"
            self.fail(f"{quoted(str(value))}: {allowed}. {decimal_comma(str(value))}".rstrip(), param, ctx)
        return number


CELL_MM = Number(1e-3, 1000)
"""Cells of the optimiser, elements, and other small lengths; memory sets the true limit."""
VOLUME_FRACTION = Number(0.01, 0.99)


class Choice(click.Choice[str]):
    """One of a few words; a misspelt one is answered by the nearest."""

    def convert(self, value: object, param: click.Parameter | None, ctx: click.Context | None) -> str:
        """Return the word itself; fails with all words and the nearest."""
        words = [str(choice) for choice in self.choices]
        if value not in words:
            allowed = f"{quoted(value)} is none of {', '.join(words)}."
            near = suggest(str(value)[:100], words)
            self.fail(f"{allowed} {near}" if near.startswith("Did") else allowed, param, ctx)
        return super().convert(value, param, ctx)


class Speeds(click.ParamType[list[float]]):
    """Speeds (rpm): one, or both ends of a sweep and its step."""

    name = "RPM|FROM:TO:STEP"
    most = 1000

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> list[float]:
        """Return the speeds, both ends of a sweep included; fails with the allowed form."""
        try:
            numbers = [float(part) for part in str(value).split(":")]
        except ValueError:
            numbers = []
        if len(numbers) == 1 and 0 <= numbers[0] < math.inf:
            return numbers
        if len(numbers) == 3:
            start, stop, step = numbers
            if 0 <= start <= stop < math.inf and step > 0 and (stop - start) / step < self.most:
                return [start + index * step for index in range(int((stop - start) / step + 1e-9) + 1)]
        form = f"must be RPM or FROM:TO:STEP with 0 <= FROM <= TO and at most {self.most} steps"
        self.fail(f"{quoted(str(value))}: {form}. {decimal_comma(str(value))}".rstrip(), param, ctx)


class SpeedRange(click.ParamType[list[float]]):
    """Speeds (rpm) at even steps: both ends and how many."""

    name = "FROM:TO:NUMBER"
    most = 1000

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> list[float]:
        """Return the speeds; fails with the allowed form."""
        low, high, number = [*str(value).split(":"), "", ""][:3]
        try:
            start, stop, count = float(low), float(high), int(number)
            if 0 < start < stop < math.inf and 2 <= count <= self.most and str(value).count(":") == 2:
                return [start + index * (stop - start) / (count - 1) for index in range(count)]
        except ValueError:
            pass
        form = f"must be FROM:TO:NUMBER with 0 < FROM < TO in rpm and 2 to {self.most} speeds"
        self.fail(f"{quoted(str(value))}: {form}. {decimal_comma(str(value))}".rstrip(), param, ctx)


class CylinderNumber(click.ParamType[int | str]):
    """Number of a cylinder, from 1; or a word in its place."""

    def __init__(self, word: str = "") -> None:
        self.word = word
        self.name = f"N|{word}" if word else "N"

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> int | str:
        """Return the number, or the word; fails with the allowed form."""
        text = str(value)
        if text == self.word or (text.isascii() and text.isdigit() and int(text[:9]) >= 1 and len(text) < 9):
            return text if text == self.word else int(text)
        word = f", or {self.word}" if self.word else ""
        self.fail(f"{quoted(text)}: must be the number of a cylinder, 1 at the free end{word}.", param, ctx)


def goal_options(function: Any) -> Any:
    """Add --minimise, --maximise and --limit to a command; `with_goal_options` takes what they give."""
    function = click.option(
        "--limit",
        "limits",
        metavar="LIMIT",
        multiple=True,
        help='Such as "bending >= 100 %" or "unbalance <= 40 kg mm"; repeatable. It replaces the '
        'limit of that quantity in the design, or the default of the goal; "bending none" removes it.',
    )(function)
    for name, end in (("--maximise", "high"), ("--minimise", "low")):
        text = f"Make it as {end} as the limits allow, in place of the design's goal and limits."
        function = click.option(name, metavar="QUANTITY", help=text)(function)
    return function


def with_goal_options(
    scene: Scene, minimise: str | None, maximise: str | None, limits: tuple[str, ...]
) -> Scene:
    """Return the scene with the goal that the options ask for."""
    from cranktopo.design.goal.scene_goal import with_goal

    if minimise is not None and maximise is not None:
        raise click.UsageError("--minimise excludes --maximise: keep one of them, limit the other quantity")
    if limits and minimise is None and maximise is None and scene.goal is None:
        raise click.UsageError("--limit needs a goal: add --minimise or --maximise, or [goal] to the design")
    return with_goal(scene, minimise=minimise, maximise=maximise, limits=limits)


DEFAULT_DESIGN = "mikron-iiic"


def bearings_option(*more: str) -> Callable[[Any], Any]:
    """Return the option of what holds the journals, with kinds that one command alone has."""
    return click.option(
        "--bearings",
        type=Choice(["rigid", "spring", "free", *more]),
        default="rigid",
        show_default=True,
        help="Radial support of every mid-journal section; all of them let it tilt.",
    )


web_option = click.option(
    "--web",
    type=Choice(["first", "second"]),
    help="Web to take where a throw has two different ones: required; shape takes the worse one by default.",
)

throw_option = click.option(
    "--throw",
    type=click.IntRange(1, 48),
    metavar="N",
    help="Throw to take where throws differ, counted from the free end.  [default: worst loaded]",
)

bound_option = click.option(
    "--no-bound", is_flag=True, help="Do not prove how far the result is from the best possible web."
)


loads_option = click.option(
    "--loads",
    type=Choice(["extremes", "cycle"]),
    default="extremes",
    show_default=True,
    help="Load states of fatigue. extremes: of radial force and torque combined, and a few states that "
    "bound the cycle where the plan has a tangential force. cycle: every angle of the cycle.",
)


def run_options(resumed: str) -> Callable[[Any], Any]:
    """Return what adds --out, for the directory of a run, and --resume with its help to a command."""
    out = click.option(
        "--out", type=click.Path(path_type=Path), help="Run directory; default: a new one in runs/."
    )
    resume = click.option("--resume", metavar="RUN", shell_complete=runs, help=resumed)
    return lambda function: out(resume(function))


def with_bound_option(scene: Scene, no_bound: bool) -> Scene:
    """Return the scene without its bound where the option leaves it out."""
    return scene.with_effect("bound", "off") if no_bound else scene


def percent(context: click.Context, parameter: click.Parameter, value: str | None) -> float | None:
    """Return the number of percent in `1%` or `1`, as an option's callback."""
    number = _number(value, {"%": 1.0}, "a percentage such as 1%")
    if number is not None and not 0 < number < 100:
        raise click.BadParameter(f"{value!r} must be above 0% and below 100%.", context, parameter)
    return number


def share_of(context: click.Context, parameter: click.Parameter, value: str | None) -> float | None:
    """Return the number of percent in `50%` or `50`, 0 and 100 among them, as an option's callback."""
    number = _number(value, {"%": 1.0}, "a percentage such as 50%")
    if number is not None and not 0 <= number <= 100:
        raise click.BadParameter(f"{value!r} must be at least 0% and at most 100%.", context, parameter)
    return number


def seconds(context: click.Context, parameter: click.Parameter, value: str | None) -> float | None:
    """Return the number of seconds in `90`, `120s`, `5min` or `1h`, as an option's callback."""
    number = _number(value, {"min": 60.0, "h": 3600.0, "s": 1.0}, "a time such as 30s or 2min")
    if number is not None and not 0 < number < math.inf:
        raise click.BadParameter(f"{value!r} must be above 0 s.", context, parameter)
    return number


def _number(value: str | None, units: dict[str, float], form: str) -> float | None:
    text = (value or "").strip().lower()
    unit = next((unit for unit in units if text.endswith(unit)), "")
    try:
        return None if value is None else float(text.removesuffix(unit)) * units.get(unit, 1.0)
    except ValueError:
        raise click.BadParameter(f"{value!r} is not {form}. {decimal_comma(text)}".rstrip()) from None


def body_options(function: Any) -> Any:
    """Add --design and --align, for targets that are bodies from CAD, to a command."""
    function = click.option(
        "--align", is_flag=True, help="Move STL and STEP bodies that lie elsewhere to where the journals are."
    )(function)
    return click.option(
        "--design", help="Design for the journals, loads and material of STL and STEP targets."
    )(function)


def mesh_options(function: Any) -> Any:
    """Add --element-size-mm, --accuracy, --budget, --design and --align to a command."""
    for option in (
        body_options,
        click.option(
            "--accuracy", metavar="PERCENT", callback=percent, help="Largest permitted error, such as 1%."
        ),
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
        (("--draft-deg", "min_draft_deg"), Number(0, 30), "Minimum draft of the walls of pockets."),
        (("--min-radius-mm",), Number(0.05, 1000), "Minimum radius of curvature of the outline."),
        (("--min-wall-mm",), Number(0.05, 1000), "Minimum wall thickness."),
    ):
        field = names[-1].removeprefix("--").replace("-", "_")
        usual = f"{getattr(ManufacturingLimits, field):g}"
        size = "" if field == "min_draft_deg" else " for journals of 42 to 84 mm, others in proportion"
        function = click.option(*names, type=bounds, help=f"{text}  [default: {usual}{size}]")(function)
    return function


def typed(*left_out: str) -> list[str]:
    """Return what the command line of the running command has, as the user writes it, but for some names."""
    context = click.get_current_context()
    return [
        parameter.opts[0] if isinstance(parameter, click.Option) else str(parameter.name).upper()
        for parameter in context.command.params
        if parameter.expose_value
        and parameter.name not in left_out
        and context.get_parameter_source(str(parameter.name)) == ParameterSource.COMMANDLINE
    ]


def refuse_beside_resume(*allowed: str) -> None:
    """Check that nothing but the `allowed` parameters is given beside --resume, as the run keeps the rest."""
    for what in typed("resume", "as_json", *allowed):
        parameters = click.get_current_context().command.params
        free = [parameter.opts[0] for parameter in parameters if parameter.name in allowed]
        but = f"; only {' and '.join(free)} may be given" if free else ""
        raise click.UsageError(
            f"--resume takes the design and its options from the run{but}: leave out {what}"
        )
