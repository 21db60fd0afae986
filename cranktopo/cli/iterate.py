"""`cranktopo iterate`: the whole loop from envelope to a web that can be made."""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import Any

import click

from cranktopo.cli.completion import designs
from cranktopo.cli.options import DEFAULT_DESIGN, refuse_beside_resume, rule_options
from cranktopo.cli.parameters import Choice, Number
from cranktopo.cli.verbosity import say, verbosity_options

THIN_SHARE = 0.4
_FILES = {"csv": "steps.csv", "plot": "steps.png", "json": "iterate.json", "report": "report.html"}


@click.command("iterate")
@click.argument("design", required=False, shell_complete=designs)
@click.option("--steps", type=click.IntRange(1, 50), default=6, show_default=True, help="Number of removals.")
@click.option(
    "--volume-fraction",
    type=Number("volume fraction", above=0.0, below=1.0),
    help="Share of the design space that the last step leaves; default: the design's.",
)
@click.option(
    "--resolution-mm", type=Number("resolution", above=0.0), help="Largest cell edge of the optimiser."
)
@click.option(
    "--process",
    type=Choice(["free", "forged", "cast"]),
    help="How the web is made; default: the design's, forged where it gives none.",
)
@click.option(
    "--least-transition-mm",
    type=Number("least transition", above=0.0),
    help="End when the web beside a journal is thinner; default: 40 % of the web's thickness.",
)
@rule_options
@click.option("--element-size-mm", type=Number("element size", above=0.0), help="Of the judge's mesh.")
@click.option("--out", type=click.Path(path_type=Path), help="Directory; default: a new one in runs/.")
@click.option("--resume", metavar="DIR", help="Continue an interrupted loop; finished steps are kept.")
@click.option("--json", "as_json", is_flag=True, help="Print the steps as one JSON object.")
@verbosity_options
def command(
    design: str | None,
    steps: int,
    volume_fraction: float | None,
    resolution_mm: float | None,
    process: str | None,
    least_transition_mm: float | None,
    element_size_mm: float | None,
    out: Path | None,
    resume: str | None,
    as_json: bool,
    **rules: Any,
) -> None:
    """Remove a little of DESIGN's envelope, extract, re-model, judge, and go on inside the new solid.

    Every step leaves a parametric web (TOML, STEP, STL). The loop ends when a step no longer improves the
    torsional stiffness per mass, or when the web beside a journal becomes too thin.

    Example: cranktopo iterate mikron-iiic --steps 6 --process forged
    """
    if resume:
        refuse_beside_resume()
    from cranktopo.pipeline.iterate import Settings, continue_loop, start_loop
    from cranktopo.remodel.manufacturing_limits import ManufacturingLimits

    if resume:
        outcome = continue_loop(resume, say)
    else:
        from cranktopo.scene.loading import design_text, load_scene

        name = design or DEFAULT_DESIGN
        scene, text = load_scene(name), design_text(name)
        if process is None and scene.optimise.process == "free":
            process = "forged"
        scene = scene.with_optimise(
            volume_fraction=volume_fraction, resolution_mm=resolution_mm, process=process
        )
        least_mm = least_transition_mm or THIN_SHARE * scene.web.thickness_mm
        settings = Settings(steps, least_mm, element_size_mm, ManufacturingLimits(**rules))
        outcome = start_loop(scene, text, settings, ["cranktopo", *sys.argv[1:]], out, say)
    data = outcome.as_json()
    files = _write(outcome.folder, data)
    click.echo(json.dumps({**data, "files": files}) if as_json else summary(data, outcome.folder))


def _write(folder: Path, data: dict[str, Any]) -> dict[str, str]:
    """steps.csv and steps.png beside iterate.json and report.html."""
    from cranktopo.report.iterate_report import save_steps_plot, steps_table
    from cranktopo.report.tables import comma_separated
    from cranktopo.store import write_text

    files = {name: str(folder / file) for name, file in _FILES.items()}
    write_text(Path(files["csv"]), comma_separated(steps_table(data["steps"])) + "\n")
    save_steps_plot(Path(files["plot"]), data)
    return files


def summary(data: dict[str, Any], folder: Path) -> str:
    """What a user wants to know of a finished loop, as lines of text.

    Args:
        data: content of iterate.json.
        folder: directory of the loop.
    """
    from cranktopo.report.iterate_report import best_line, steps_estimate, steps_table
    from cranktopo.report.tables import terminal

    lines = [terminal(steps_table(data["steps"])), "", steps_estimate(data["steps"])]
    lines += [f"ended: {data['stop_reason']}", best_line(data)]
    if data["best_step"] is not None:
        lines.append(str(folder / f"step-{data['best_step']:02d}" / "web.toml"))
    files = (folder / file for file in _FILES.values())
    return "\n".join([*lines, *(str(file) for file in files if file.is_file())])
