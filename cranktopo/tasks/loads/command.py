"""`cranktopo loads`

Forces over the working cycle, their extremes, and the load cases.
"""

from __future__ import annotations

from pathlib import Path

import click

from cranktopo.base.notes import note, warn
from cranktopo.cli.options import DEFAULT_DESIGN, Speeds, designs, throw_option
from cranktopo.cli.output import tell
from cranktopo.cli.verbosity import verbosity_options


@click.command(name="loads")
@click.argument("design", default=DEFAULT_DESIGN, shell_complete=designs)
@click.option("--speed", "speeds", type=Speeds(), help="Speed or sweep of speeds instead of the scene's.")
@throw_option
@click.option("--json", "as_json", is_flag=True, help="Print one JSON object.")
@click.option("--csv", "csv_path", type=click.Path(dir_okay=False, path_type=Path), help="Write all curves.")
@click.option("--plot", "plot_path", type=click.Path(dir_okay=False, path_type=Path), help="Write a plot.")
@verbosity_options
def command(
    design: str,
    speeds: list[float] | None,
    throw: int | None,
    as_json: bool,
    csv_path: Path | None,
    plot_path: Path | None,
) -> None:
    """Forces of one throw over the working cycle, their extremes and the load cases; mean pressure and power.

    DESIGN is a TOML file or the name of a built-in design. A sweep repeats the analysis with the same gas
    pressures, or with those of each speed where the design has a map; the plot shows its last speed.

    Example: cranktopo loads mikron-iiic --speed 1000:2800:200 --plot loads.png
    """
    from cranktopo.design.loading import load_scene
    from cranktopo.engine.balance.crank import crank_mass
    from cranktopo.engine.one_throw import one_throw
    from cranktopo.tasks.loads.stage import loads_at_speeds, plot_load_curves, write_load_curves

    crank = load_scene(design, whole=True)
    scene = one_throw(crank, throw, all_fire=False)
    results = loads_at_speeds(scene, speeds)
    if crank is not scene:
        results = tuple(one.model_copy(update={"crank": crank_mass(crank)}) for one in results)
    if plot_path is not None:
        plot_load_curves(scene, plot_path, None if speeds is None else speeds[-1])
    if csv_path is not None:
        write_load_curves(scene, csv_path, speeds)
    for line in dict.fromkeys(warning for loads in results for warning in loads.warnings):
        warn(f"{scene.name}: {line}")
    if as_json:
        sweep = results if len(results) > 1 else None
        found = results[0].model_copy(update={"sweep": sweep})
        tell(found.as_json())
        return
    from cranktopo.design.assumed import LOADS, THROW, VIBRATION, assumed_text, assumptions
    from cranktopo.tasks.loads.text import loads_text, sweep_text

    tell(loads_text(results[0]) if len(results) == 1 else sweep_text(results))
    assumed = assumptions(scene, (THROW, LOADS, VIBRATION))
    if assumed:
        note(assumed_text(assumed))
