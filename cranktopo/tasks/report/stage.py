"""The page of a finished run, written again with what was added to the run since."""

from __future__ import annotations

from pathlib import Path

from cranktopo.base.files import as_path
from cranktopo.report.report_file import REPORT, write_report
from cranktopo.runs.directories import RunStore, open_run
from cranktopo.runs.kind import shown_results
from cranktopo.tasks.optimise.page import run_page
from cranktopo.tasks.optimise.run_record import read_record


def report_run(run: RunStore | str | Path, path: Path | str | None = None, stresses: bool = False) -> Path:
    """Write the report of a finished run, .html or .md, by default report.html in it, and return its file.

    Args:
        run: the run directory, or how the user names it.
        stresses: solve those that the run does not keep yet.

    Raises:
        CranktopoError: the run is not finished, a file of it is damaged, or the report cannot be written.
    """
    path = as_path(path)
    store = run if isinstance(run, RunStore) else open_run(run)
    target = path or store.path / REPORT
    with shown_results(store):
        page = run_page(read_record(store, stresses))
    write_report(page, target)
    return target
