"""`cranktopo optimise`: the main job."""

from __future__ import annotations

import json
import sys
import time
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from cranktopo.cli.completion import designs, runs
from cranktopo.cli.options import DEFAULT_DESIGN, percent, refuse_beside_resume, seconds
from cranktopo.cli.parameters import Choice, Number
from cranktopo.cli.verbosity import NORMAL, QUIET, detail, level, say, verbosity_options
from cranktopo.errors import ExitCode

if TYPE_CHECKING:
    from cranktopo.optimise.loop import DensityProblem
    from cranktopo.optimise.state import State
    from cranktopo.scene import Scene

_SHOWN_FILES = ("report", "stl", "picture", "vtu", "history", "metrics")


@click.command("optimise")
@click.argument("design", required=False, shell_complete=designs)
@click.option(
    "--volume-fraction",
    type=Number("volume fraction", above=0.0, below=1.0),
    help="Share of the design space that becomes solid, 0 to 1; default: the design's.",
)
@click.option(
    "--resolution-mm",
    type=Number("resolution", above=0.0),
    help="Largest cell edge, mm; default: the design's.",
)
@click.option(
    "--process",
    type=Choice(["free", "forged", "cast"]),
    help="How the web is made: a die releases forged and cast ones along x; default: the design's.",
)
@click.option(
    "--accuracy", metavar="PERCENT", callback=percent, help="Wanted error of the stiffnesses, such as 5%."
)
@click.option("--budget", metavar="TIME", callback=seconds, help="Time for the run, such as 30s or 2min.")
@click.option("--max-iterations", type=click.IntRange(1, 10000), help="Limit on designs evaluated.")
@click.option("--out", type=click.Path(path_type=Path), help="Run directory; default: a new one in runs/.")
@click.option(
    "--resume", metavar="RUN", shell_complete=runs, help="Continue an interrupted, stopped or killed run."
)
@click.option("--json", "as_json", is_flag=True, help="Print the metrics as one JSON object.")
@verbosity_options
def command(
    design: str | None,
    volume_fraction: float | None,
    resolution_mm: float | None,
    process: str | None,
    accuracy: float | None,
    budget: float | None,
    max_iterations: int | None,
    out: Path | None,
    resume: str | None,
    as_json: bool,
) -> int:
    """Optimise the web of DESIGN under its load cases and write a run.

    Example: cranktopo optimise mikron-iiic --volume-fraction 0.3
    """
    began = time.perf_counter()
    if resume:
        refuse_beside_resume("max_iterations")
    if resolution_mm and (accuracy or budget):
        raise click.UsageError(
            "--resolution-mm excludes --accuracy and --budget: give the size, or what it should do"
        )
    from cranktopo.pipeline import optimise as pipeline

    if resume:
        run, prepared = pipeline.reopen(resume, max_iterations, say)
    else:
        from cranktopo.scene.loading import design_text, load_scene

        name = design or DEFAULT_DESIGN
        scene, text = load_scene(name), design_text(name)
        scene = scene.with_optimise(
            volume_fraction=volume_fraction,
            resolution_mm=resolution_mm,
            process=process,
            max_iterations=max_iterations,
        )
        if accuracy or budget:
            scene = _with_cells(scene, accuracy, budget)
        run, prepared = pipeline.start(scene, text, ["cranktopo", *sys.argv[1:]], out, say)
    with _Bar() as bar:
        metrics = pipeline.optimise(run, prepared, bool(resume), bar, began)
    click.echo(json.dumps(metrics) if as_json else summary(metrics, run.path))
    return _exit_code(metrics)


def _exit_code(metrics: dict[str, Any]) -> ExitCode:
    if metrics["status"] != "converged":
        return ExitCode.NOT_CONVERGED
    return ExitCode.CRITERION_NOT_MET if "refusal" in metrics["surface"] else ExitCode.DONE


def summary(metrics: dict[str, Any], folder: Path) -> str:
    """What a user wants to know of a finished run, as lines of text.

    Args:
        metrics: content of metrics.json.
        folder: run directory.
    """
    original = metrics["original_web"]
    lines = [
        f"{metrics['status']} after {metrics['iterations']} iterations: {metrics['stop_reason']}",
        "",
        f"{'':24}{'optimised':>14}{'original web':>14}{'estimate':>12}{'gain per kg':>14}",
    ]
    for name, case in metrics["load_cases"].items():
        key = next((k for k in case if k.startswith("stiffness_")), None)
        if key is None:  # a body force has no stiffness
            continue
        unit, scale = ("kN m/rad", 1e-3) if key.endswith("rad") else ("kN/mm", 1e-3)
        gain = original["gain_of_stiffness_per_mass_percent"][name]
        values = f"{case[key] * scale:14.1f}{original['load_cases'][name][key] * scale:14.1f}"
        estimate = f"+-{case['error_estimate_percent']:.2g} %" if "error_estimate_percent" in case else ""
        lines.append(f"{name + ', ' + unit:24}{values}{estimate:>12}{gain:+12.1f} %")
    for part in ("throw", "web"):
        masses = f"{metrics['mass_kg'][part]:14.3f}{original['mass_kg'][part]:14.3f}"
        lines.append(f"{'mass of ' + part + ', kg':24}{masses}")
    seconds = metrics["seconds"]
    lines += [
        "",
        f"{seconds['total']:.1f} s in all (compiling {seconds['compile']:.1f} s, "
        f"{seconds['per_iteration_median']:.2f} s per iteration{_report_time(seconds)}), "
        f"{metrics['peak_memory_MiB']:.0f} MiB",
        f"connected: {'yes' if metrics['connected'] else 'NO'}; greyness {metrics['greyness']:.3f}",
        *_surface_warning(metrics["surface"]),
        *(f"{folder / metrics['files'][name]}" for name in _SHOWN_FILES if name in metrics["files"]),
    ]
    return "\n".join(lines)


def _report_time(seconds: dict[str, float]) -> str:
    return f", report {seconds['report']:.1f} s" if "report" in seconds else ""


def _surface_warning(surface: dict[str, Any]) -> list[str]:
    if "refusal" in surface:
        return [f"no STL: {surface['refusal']}"]
    from cranktopo.report.release_text import obstacles

    return obstacles(surface["cavities"], surface.get("undercuts"))


def _with_cells(scene: Scene, accuracy: float | None, budget_s: float | None) -> Scene:
    """The scene with the cell size that an accuracy or a time asks for, said on stderr."""
    from cranktopo.accuracy.cell_choice import choose_cells
    from cranktopo.accuracy.level import OPTIMISER
    from cranktopo.accuracy.stored_studies import load_study

    choice = choose_cells(scene, accuracy, budget_s, load_study(scene.name, OPTIMISER))
    say(str(choice))
    return scene.with_optimise(resolution_mm=choice.cell_mm)


class _Bar:
    """Progress on stderr: compliances, volume, greyness, time left.

    A bar on a terminal, a line per iteration with --verbose, nothing but the solver's notices otherwise.
    """

    def __enter__(self) -> _Bar:
        from tqdm import tqdm

        hidden = level() != NORMAL or not sys.stderr.isatty()
        self._bar = tqdm(unit="it", file=sys.stderr, disable=hidden, dynamic_ncols=True)
        return self

    def __exit__(self, *_: object) -> None:
        self._bar.close()

    def __call__(self, problem: DensityProblem, state: State) -> None:
        from cranktopo.optimise.loop import iterations_left

        row = state.last
        done = len(state.history)
        self._bar.total = done + (0 if state.done else iterations_left(problem, state))
        cases = zip(problem.model.case_names, row.compliance_N_mm, strict=True)
        work = ", ".join(f"{name} {value:.4g} N mm" for name, value in cases)
        text = f"{work}, volume {row.volume_fraction:.3f}, grey {row.greyness:.3f}"
        self._bar.set_postfix_str(text, refresh=False)
        detail(f"iteration {row.iteration}: {text}, {row.cg_iterations} cycles, {row.seconds:.2f} s")
        if row.notice and level() > QUIET:
            self._bar.write(f"iteration {row.iteration}: {row.notice}", file=sys.stderr)
        self._bar.update(done - self._bar.n)
