"""`cranktopo film`

Minimum oil film and largest film pressure of the plain bearings over the cycle.
"""

from __future__ import annotations

from pathlib import Path

import click

from cranktopo.base.notes import note
from cranktopo.cli.options import DEFAULT_DESIGN, Speeds, designs, throw_option
from cranktopo.cli.output import tell
from cranktopo.cli.verbosity import verbosity_options


@click.command(name="film")
@click.argument("design", default=DEFAULT_DESIGN, shell_complete=designs)
@click.option("--speed", "speeds", type=Speeds(), help="Speed or sweep of speeds instead of the scene's.")
@throw_option
@click.option(
    "--plot",
    "plot_path",
    type=click.Path(dir_okay=False, path_type=Path),
    help="Write a plot of the last speed.",
)
@click.option("--json", "as_json", is_flag=True, help="Print one JSON object.")
@verbosity_options
def command(
    design: str, speeds: list[float] | None, throw: int | None, plot_path: Path | None, as_json: bool
) -> None:
    """Oil film of main and big-end bearings over the cycle: minimum thickness, largest pressure, friction.

    DESIGN is a TOML file with `[bearings]` (clearance and oil), or the name of a built-in design. The
    mobility method for bearings of finite width moves the journals; films near what is permitted are
    computed once more with mass-conserving cavitation. Loads are those of throws that stand alone between
    two bearings.

    Example: cranktopo film car-diesel --speed 1000:4000:500
    """
    from cranktopo.base.formats import PLOTS
    from cranktopo.design.assumed import assumed_text
    from cranktopo.design.loading import load_scene
    from cranktopo.engine.one_throw import one_throw
    from cranktopo.runs.destination import check_file
    from cranktopo.tasks.film.plot import plot_films
    from cranktopo.tasks.film.stage import films_and_orbits
    from cranktopo.tasks.film.text import film_text

    scene = one_throw(load_scene(design, whole=True), throw, all_fire=False)
    if plot_path is not None:
        check_file(plot_path, "--plot", PLOTS)
    result, orbits = films_and_orbits(scene, speeds)
    if plot_path is not None:
        plot_films(result.design, result.speeds[-1].rpm, orbits, plot_path)
    if as_json:
        tell(result.as_json())
        return
    tell(film_text(result))
    if result.assumed:
        note(assumed_text(result.assumed))
