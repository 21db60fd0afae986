"""`cranktopo accuracy`: what accuracy costs in time, for the evaluation and for the optimiser."""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from cranktopo.cli.completion import designs
from cranktopo.cli.options import DEFAULT_DESIGN, seconds
from cranktopo.cli.verbosity import say, verbosity_options
from cranktopo.errors import ExitCode

if TYPE_CHECKING:
    from cranktopo.evaluate.targets import Target

_BUDGET_S = 120.0


@click.command("accuracy")
@click.argument("design", default=DEFAULT_DESIGN, shell_complete=designs)
@click.option(
    "--budget",
    "budget_s",
    metavar="TIME",
    callback=seconds,
    default=f"{_BUDGET_S:g}s",
    show_default=True,
    help="Time to spend, such as 90, 120s or 5min.",
)
@click.option("--design", "journals", help="Design for the journals and material of an STL or STEP file.")
@click.option(
    "--out",
    type=click.Path(path_type=Path, file_okay=False),
    help="Folder for JSON, Markdown and PNG; default: runs/accuracy-DESIGN, or the run itself.",
)
@click.option("--json", "as_json", is_flag=True, help="Print one JSON object.")
@verbosity_options
def command(design: str, budget_s: float, journals: str | None, out: Path | None, as_json: bool) -> int:
    """Solve DESIGN (or a run or surface file) on finer and finer levels until the budget is used.

    Of the body-fitted evaluation: element size, order, refined fillets. Of the optimiser: cell size,
    tolerance, precision, iterations, hexahedra; its shapes are evaluated. Where the design calls for it, the
    peak stress in the fillets. The result is kept for `--accuracy` and `--budget` of evaluate and optimise.
    Ctrl-C ends it early and keeps what is done.

    Example: cranktopo accuracy mikron-iiic --budget 120s
    """
    from cranktopo.accuracy.pareto import pareto_front
    from cranktopo.accuracy.stored_studies import key_of, store_study
    from cranktopo.accuracy.study import run_studies
    from cranktopo.evaluate.targets import resolve_target
    from cranktopo.store import check_folder

    target = resolve_target(design, journals)
    folder = out or _folder(target)
    check_folder(folder)
    result = pareto_front(run_studies(target, budget_s, say)).as_json()
    kept = store_study(key_of(target), result)
    files = _write(result, folder)
    click.echo(json.dumps({**result, "files": files}) if as_json else _text(result))
    for path in (*files.values(), *([str(kept)] if kept else [])):
        say(path)
    return ExitCode.INTERRUPTED if result["interrupted"] else ExitCode.DONE


def _folder(target: Target) -> Path:
    from cranktopo.store import RUNS

    return target.run or RUNS / f"accuracy-{target.file.stem if target.file else target.name}"


def _write(result: dict[str, Any], folder: Path) -> dict[str, str]:
    from cranktopo.report.accuracy_page import accuracy_page
    from cranktopo.report.writing import write_report
    from cranktopo.store import write_json
    from cranktopo.store.manifest import timestamp

    folder.mkdir(parents=True, exist_ok=True)
    paths = {"json": folder / "accuracy.json", "markdown": folder / "accuracy.md"}
    write_json(paths["json"], result)
    page = accuracy_page(result, timestamp()[:10])
    write_report(page, paths["markdown"])
    for picture in page.sections[0].pictures:
        paths["picture"] = folder / "accuracy-pictures" / f"{picture.name}.png"
    return {name: str(path) for name, path in paths.items()}


def _text(result: dict[str, Any]) -> str:
    from cranktopo.report.accuracy import limit_lines, recommendation_table, rung_tables
    from cranktopo.report.accuracy_page import headline
    from cranktopo.report.tables import terminal

    lines = [f"{result['design']}: {headline(result)}"]
    for ladder, table in rung_tables(result):
        lines += ["", f"{ladder} (* efficient)", terminal(table)]
    lines += ["", *limit_lines(result), "", terminal(recommendation_table(result))]
    lines += [f"no answer: {failure}" for failure in result["failures"]]
    return "\n".join(lines)
