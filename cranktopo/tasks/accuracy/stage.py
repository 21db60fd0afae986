"""The accuracy studies of a target, kept for later commands, and their files."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from cranktopo.base.files import write_json
from cranktopo.design.assumed import EVALUATED, filter_by_table
from cranktopo.report.report_file import write_report
from cranktopo.runs.destination import check_folder
from cranktopo.runs.directories import RUNS
from cranktopo.runs.manifest import timestamp
from cranktopo.tasks.accuracy.page import accuracy_page
from cranktopo.tasks.accuracy.pareto import pareto_front
from cranktopo.tasks.accuracy.study import run_studies
from cranktopo.tasks.fea.stage import print_assumed
from cranktopo.tasks.fea.stored_studies import key_of, store_study
from cranktopo.tasks.fea.study_result import StudyResult
from cranktopo.tasks.fea.targets import Target, resolve_target

BUDGET_S = 120.0


@dataclass(frozen=True)
class AccuracyStudy:
    """What `accuracy --json` prints, its files by kind, and where it is kept for later commands."""

    result: StudyResult
    files: dict[str, str]
    kept: Path | None


def study_accuracy(
    target: Target | str,
    budget_s: float = BUDGET_S,
    out: Path | None = None,
    design: str | None = None,
    info: Callable[[str], None] = lambda _: None,
) -> AccuracyStudy:
    """Error against seconds, from cheap levels to exact ones, until the time is used; Ctrl-C ends it early.

    Args:
        target: a design, a run or a surface file.
        out: folder for JSON, Markdown and PNG; by default runs/accuracy-DESIGN, or the run itself.
        design: design for the journals and material of an STL or STEP file.

    Raises:
        CranktopoError: no such target, or a folder that cannot be written.
    """
    resolved = resolve_target(target, design, whole=True) if isinstance(target, str) else target
    folder = out or _folder(resolved)
    check_folder(folder)
    print_assumed([resolved], EVALUATED, info)
    result = pareto_front(run_studies(resolved, budget_s, info)).result
    kept = store_study(key_of(resolved), result)
    result = result.model_copy(update={"assumed": list(filter_by_table(resolved.assumed, EVALUATED))})
    return AccuracyStudy(result, _write(result, folder), kept)


def _folder(target: Target) -> Path:
    return target.run or RUNS / f"accuracy-{target.file.stem if target.file else target.name}"


def _write(result: StudyResult, folder: Path) -> dict[str, str]:
    folder.mkdir(parents=True, exist_ok=True)
    paths = {"json": folder / "accuracy.json", "markdown": folder / "accuracy.md"}
    write_json(paths["json"], result.as_json())
    page = accuracy_page(result, timestamp()[:10])
    write_report(page, paths["markdown"])
    for picture in page.sections[0].pictures:
        paths["picture"] = folder / "accuracy-pictures" / f"{picture.name}.png"
    return {name: str(path) for name, path in paths.items()}
