"""Writes a report in the form that its file name asks for."""

from __future__ import annotations

from pathlib import Path

from cranktopo.domain.build import Domain
from cranktopo.evaluate.evaluation import Progress
from cranktopo.report.html import html
from cranktopo.report.markdown_page import write_markdown
from cranktopo.report.page import Page
from cranktopo.report.record import read_record
from cranktopo.report.run_page import run_page
from cranktopo.store import RunStore, check_file, write_text

REPORT = "report.html"
SUFFIXES = (".html", ".md")


def check_report_path(path: Path) -> None:
    """Check, before long work, that a report can go there.

    Raises:
        CranktopoError: another suffix than a report has, or no such folder.
    """
    check_file(path, "report", SUFFIXES)


def write_report(page: Page, path: Path) -> None:
    """Write a report as HTML or Markdown, by the ending of its name.

    Args:
        page: its content.
        path: the file; replaced only when it is complete.

    Raises:
        CranktopoError: another ending, no such folder, or it cannot be written.
    """
    check_report_path(path)
    if path.suffix.lower() == ".md":
        write_markdown(page, path)
    else:
        write_text(path, html(page))


def write_run_report(
    run: RunStore, path: Path | None = None, domain: Domain | None = None, solve: Progress | None = None
) -> Path:
    """Write the report of a finished run.

    Args:
        run: the run.
        path: the file; report.html in the run directory by default.
        domain: the run's cells, where they are at hand; built again otherwise.
        solve: solve for the judge's stresses where the run has none; called with a line of progress.

    Returns:
        The file.

    Raises:
        CranktopoError: the run is not finished, a file of it is damaged, or the report cannot be written.
    """
    target = path or run.path / REPORT
    write_report(run_page(read_record(run, domain, solve)), target)
    return target
