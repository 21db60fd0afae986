"""Writes a report in the form that its file name asks for."""

from __future__ import annotations

from pathlib import Path

from cranktopo.base.files import write_text
from cranktopo.report.html import html
from cranktopo.report.markdown_page import write_markdown
from cranktopo.report.page import Page
from cranktopo.runs.destination import check_file

REPORT = "report.html"
_SUFFIXES = (".html", ".md")


def check_report_path(path: Path) -> None:
    """Check, before long work, that a report can go there.

    Raises:
        CranktopoError: another suffix than a report has, or no such folder.
    """
    check_file(path, "report", _SUFFIXES)


def write_report(page: Page, path: Path) -> None:
    """Write a report as HTML or Markdown, by the ending of its name; replaced only when it is complete.

    Raises:
        CranktopoError: another ending, no such folder, or it cannot be written.
    """
    check_report_path(path)
    if path.suffix.lower() == ".md":
        write_markdown(page, path)
    else:
        write_text(path, html(page))
