"""`cranktopo accuracy`

What accuracy costs in time: error against seconds for evaluation and optimiser.
"""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

from cranktopo.base.errors import ExitCode
from cranktopo.base.notes import note
from cranktopo.cli.options import DEFAULT_DESIGN, designs, seconds, throw_option
from cranktopo.cli.output import tell
from cranktopo.cli.verbosity import verbosity_options

if TYPE_CHECKING:
    from cranktopo.tasks.throw_fea.studies import StudyResult

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
@throw_option
@click.option("--json", "as_json", is_flag=True, help="Print one JSON object.")
@verbosity_options
def command(
    design: str,
    budget_s: float,
    journals: str | None,
    out: Path | None,
    throw: int | None,
    as_json: bool,
) -> int:
    """Solve DESIGN (or a run or surface file) at levels from cheap to exact until the budget is used.

    Levels of the body-fitted evaluation: element size, order, refined fillets. Levels of the optimiser: cell
    size, tolerance, precision, iterations, hexahedra; its shapes are evaluated on body-fitted elements. Where
    the design calls for it, the peak stress in the fillets. The result is kept for `--accuracy` and
    `--budget` of evaluate and optimise. Ctrl-C ends it early and keeps what is done.

    Example: cranktopo accuracy mikron-iiic --budget 120s
    """
    from cranktopo.tasks.accuracy.stage import study_accuracy

    found = study_accuracy(design, budget_s, out, journals, throw)
    result = found.result.model_copy(update={"files": found.files})
    tell(result.as_json() if as_json else _text(found.result), indent=None)
    for path in (*found.files.values(), *([str(found.kept)] if found.kept else [])):
        note(path)
    return ExitCode.INTERRUPTED if found.result.interrupted else ExitCode.DONE


def _text(result: StudyResult) -> str:
    from cranktopo.report.result_table import terminal
    from cranktopo.tasks.accuracy.page import (
        accuracy_headline,
        level_tables,
        limit_lines,
        recommendation_table,
    )

    lines = [f"{result.design}: {accuracy_headline(result)}"]
    for study, table in level_tables(result):
        lines += ["", f"{study} (* on the Pareto front)", terminal(table)]
    lines += ["", *limit_lines(result), "", terminal(recommendation_table(result))]
    lines += [f"no answer: {failure}" for failure in result.failures]
    return "\n".join(lines)
