"""`cranktopo iterate`

The whole loop: remove a little, extract, re-model, evaluate, again inside the new solid.
"""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from cranktopo.base.errors import ExitCode
from cranktopo.cli.options import (
    CELL_MM,
    DEFAULT_DESIGN,
    VOLUME_FRACTION,
    Choice,
    bound_option,
    designs,
    limit_options,
    refuse_beside_resume,
    throw_option,
    web_option,
    with_bound_option,
)
from cranktopo.cli.output import tell
from cranktopo.cli.verbosity import verbosity_options

if TYPE_CHECKING:
    from cranktopo.design.halves import WebName


@click.command("iterate")
@click.argument("design", required=False, shell_complete=designs)
@web_option
@throw_option
@click.option("--steps", type=click.IntRange(1, 50), default=6, show_default=True, help="Number of removals.")
@click.option(
    "--volume-fraction",
    type=VOLUME_FRACTION,
    help="Share of the design space that the last step leaves; default: the design's.",
)
@click.option("--resolution-mm", type=CELL_MM, help="Largest cell edge of the optimiser.")
@click.option(
    "--process",
    type=Choice(["free", "forged", "cast"]),
    help="How the web is made; default: the design's, forged where it gives none.",
)
@click.option(
    "--least-transition-mm",
    type=CELL_MM,
    help="End when the web beside a journal is thinner; default: 40 % of the web's thickness.",
)
@limit_options
@click.option("--no-shape", is_flag=True, help="End with the loop: leave the shape optimisation out.")
@bound_option
@click.option("--element-size-mm", type=CELL_MM, help="Element size of the evaluation.")
@click.option("--out", type=click.Path(path_type=Path), help="Directory; default: a new one in runs/.")
@click.option("--resume", metavar="DIR", help="Continue an interrupted loop; finished steps are kept.")
@click.option("--json", "as_json", is_flag=True, help="Print the steps as one JSON object.")
@verbosity_options
def command(
    design: str | None,
    web: WebName | None,
    throw: int | None,
    steps: int,
    volume_fraction: float | None,
    resolution_mm: float | None,
    process: str | None,
    least_transition_mm: float | None,
    element_size_mm: float | None,
    no_shape: bool,
    no_bound: bool,
    out: Path | None,
    resume: str | None,
    as_json: bool,
    **limits: Any,
) -> None:
    """Remove a little of DESIGN's envelope, extract, re-model, evaluate, and go on inside the new solid.

    Every step leaves a parametric web (TOML, STEP, STL). The loop ends when a step no longer improves the
    torsional stiffness per mass, or when the web beside a journal becomes too thin.

    Then the dimensions of the best step's web are optimised, as by `cranktopo shape`: for the design's goal,
    else for the largest torsional stiffness per mass of a web that is no heavier, no softer in bending and
    no less safe. That web is the last row, "shape".

    Example: cranktopo iterate mikron-iiic --steps 6
    """
    if resume:
        refuse_beside_resume()
    from cranktopo.tasks.iterate.loop import continue_loop, loop_scene, start_loop
    from cranktopo.tasks.iterate.result import loop_settings
    from cranktopo.tasks.iterate.text import LOOP_FILES, loop_summary
    from cranktopo.tasks.refit.fit import usual_limits

    if resume:
        done = continue_loop(resume)
    else:
        from cranktopo.design.loading import design_text, load_scene, one_web
        from cranktopo.engine.one_throw import one_throw

        name = design or DEFAULT_DESIGN
        scene = one_web(one_throw(load_scene(name, whole=True), throw), web)
        scene = loop_scene(scene) if process is None else scene.with_optimise(process=process)
        scene = scene.with_optimise(volume_fraction=volume_fraction, resolution_mm=resolution_mm)
        scene = with_bound_option(scene, no_bound)
        settings = loop_settings(
            scene,
            steps,
            least_transition_mm,
            element_size_mm,
            usual_limits(scene, **limits),
            shape=not no_shape,
        )
        command_line = ["cranktopo", *sys.argv[1:]]
        done = start_loop(scene, settings, out, design_text(name), command_line)
    files = {what: str(done.folder / name) for what, name in LOOP_FILES.items()}
    printed = {**done.result.as_json(), "files": files}
    tell(printed if as_json else loop_summary(done.result, done.folder), indent=None)
    if done.result.lost_step:
        raise click.exceptions.Exit(ExitCode.NOT_CONVERGED)
