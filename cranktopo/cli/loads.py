"""`cranktopo loads`: forces over the cycle, extremes, load cases."""

from __future__ import annotations

import json
from pathlib import Path

import click

from cranktopo.cli.completion import designs
from cranktopo.cli.options import DEFAULT_DESIGN
from cranktopo.errors import invalid

MOST_SPEEDS = 1000


@click.command(name="loads")
@click.argument("design", default=DEFAULT_DESIGN, shell_complete=designs)
@click.option("--speed", metavar="RPM|FROM:TO:STEP", help="Speed or sweep of speeds instead of the scene's.")
@click.option("--json", "as_json", is_flag=True, help="Print one JSON object.")
@click.option("--csv", "csv_path", type=click.Path(dir_okay=False, path_type=Path), help="Write all curves.")
@click.option("--plot", "plot_path", type=click.Path(dir_okay=False, path_type=Path), help="Write a plot.")
def command(
    design: str, speed: str | None, as_json: bool, csv_path: Path | None, plot_path: Path | None
) -> None:
    """Forces of one throw over the working cycle, their extremes and the load cases.

    DESIGN is a TOML file or the name of a built-in design. A sweep repeats the analysis with the same gas
    pressures; the plot shows its last speed.

    Example: cranktopo loads mikron-iiic --speed 1000:2800:200 --plot loads.png
    """
    from cranktopo.pipeline.loads import loads_at_speeds, plot_load_curves, write_load_curves
    from cranktopo.scene import load_scene

    scene = load_scene(design)
    speeds = None if speed is None else parse_speeds(speed)
    results = loads_at_speeds(scene, speeds)
    if plot_path is not None:
        plot_load_curves(scene, plot_path, None if speeds is None else speeds[-1])
    if csv_path is not None:
        write_load_curves(scene, csv_path, speeds)
    if as_json:
        click.echo(json.dumps(results[0] | ({"sweep": results} if len(results) > 1 else {}), indent=2))
        return
    from cranktopo.report.tables.loads_text import loads_text, sweep_text
    from cranktopo.scene.assumed import LOADS, THROW, assumed_text, assumptions

    click.echo(loads_text(results[0]) if len(results) == 1 else sweep_text(results))
    assumed = assumptions(scene, (THROW, LOADS))
    if assumed:
        click.echo(assumed_text(assumed), err=True)


def parse_speeds(text: str) -> list[float]:
    """Speeds (rpm) from `2100` or `1000:2800:200`, both ends included.

    Raises:
        CranktopoError: not numbers, negative, descending, or more than a thousand of them.
    """
    try:
        numbers = [float(part) for part in text.split(":")]
    except ValueError:
        numbers = []
    if len(numbers) == 1 and 0 <= numbers[0] < float("inf"):
        return numbers
    if len(numbers) == 3:
        start, stop, step = numbers
        if 0 <= start <= stop < float("inf") and step > 0 and (stop - start) / step < MOST_SPEEDS:
            return [start + index * step for index in range(int((stop - start) / step + 1e-9) + 1)]
    raise invalid(
        "--speed", text, f"must be RPM or FROM:TO:STEP with 0 <= FROM <= TO and at most {MOST_SPEEDS} steps"
    )
