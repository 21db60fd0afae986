"""The page of a finished run, written again with what was added to the run since."""

from __future__ import annotations

from pathlib import Path

from cranktopo.base.errors import CranktopoError, ExitCode
from cranktopo.base.files import as_path_if_any
from cranktopo.report.page import Page
from cranktopo.report.report_file import REPORT, write_report
from cranktopo.runs.directories import RunStore, open_run
from cranktopo.runs.kind import EACH_WEB, LOOP, SHAPE, kind_of, reading_results


def report_run(run: RunStore | str | Path, path: Path | str | None = None, stresses: bool = False) -> Path:
    """Write the report of a finished run, .html or .md, by default report.html in it, and return its file.

    Args:
        run: the run directory of an optimisation, a shape optimisation or a loop, or how the user names it.
        stresses: of an optimisation, solve those that the run does not keep yet.

    Raises:
        CranktopoError: the run is not finished, a file of it is damaged, or the report cannot be written.
    """
    path = as_path_if_any(path)
    store = run if isinstance(run, RunStore) else open_run(run)
    target = path or store.path / REPORT
    with reading_results(store):
        page = _page(store, stresses)
    write_report(page, target)
    return target


def _page(run: RunStore, stresses: bool) -> Page:
    """Return the page of a run by what made it; a sweep's own is no report of this form."""
    kind = kind_of(run)
    if stresses and kind in (SHAPE, LOOP, EACH_WEB):
        raise CranktopoError(
            f"--stress: run '{run.path}' was made by `cranktopo {kind}`, whose page shows no load cases.",
            hint="Leave --stress, or take `cranktopo fatigue`.",
            code=ExitCode.USAGE,
        )
    if kind == SHAPE:
        from cranktopo.tasks.web_shape.run import finished_page as shape_run_page

        return shape_run_page(run)
    if kind == EACH_WEB:
        from cranktopo.tasks.web_shape.each_web.run import finished_page as each_web_run_page

        return each_web_run_page(run)
    if kind == LOOP:
        from cranktopo.tasks.iterate.loop import finished_page as loop_page

        return loop_page(run)
    from cranktopo.tasks.optimise.page import run_page
    from cranktopo.tasks.optimise.run_record import read_record

    return run_page(read_record(run, stresses))
