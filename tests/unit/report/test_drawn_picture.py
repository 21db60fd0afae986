"""A picture that another process has drawn stands on the page byte for byte, and so does a plot."""

from __future__ import annotations

import base64
import os
from pathlib import Path
from typing import Any

import pytest

from cranktopo.base.companion import Companion
from cranktopo.report.page import Page, Section
from cranktopo.report.plot import DrawnPicture, picture
from cranktopo.report.report_file import drawn_plots, html, write_report

PNG = bytes(range(256))
HERE, ELSEWHERE = "#123456", "#654321"
PAGE = Page("Title", "Run", "Headline", (), (), picture=DrawnPicture("views", PNG, "Four views"))


def test_in_html(tmp_path: Path) -> None:
    write_report(PAGE, tmp_path / "page.html")
    text = (tmp_path / "page.html").read_text()
    assert f'<img src="data:image/png;base64,{base64.b64encode(PNG).decode()}" alt="Four views">' in text


def test_beside_markdown(tmp_path: Path) -> None:
    write_report(PAGE, tmp_path / "page.md")
    assert "![Four views](page-pictures/views.png)" in (tmp_path / "page.md").read_text()
    assert (tmp_path / "page-pictures" / "views.png").read_bytes() == PNG


def curve(axes: Any, process: int) -> None:
    """Draw a curve whose colour tells whether the process draws it that made the page."""
    axes.plot([0, 1], [0, 2], color=HERE if os.getpid() == process else ELSEWHERE)


def test_plots_of_a_second_process(monkeypatch: pytest.MonkeyPatch) -> None:
    """One is drawn ahead, the other with the page; both as this process draws them."""
    monkeypatch.setattr("cranktopo.base.companion.usable_cores", lambda: 2)
    monkeypatch.setattr("cranktopo.base.companion.container_memory_left_MiB", lambda: 1e6)
    plots = tuple(picture(name, name, curve, os.getpid()) for name in ("ahead", "late"))
    page = Page("Title", "Run", "Headline", (), (Section("a", "A", pictures=plots),))
    with Companion() as beside:
        text = html(page, beside, [beside.begin(drawn_plots, plots[:1])])
    assert not any("figure" in vars(plot) for plot in plots)
    assert text.count(ELSEWHERE) == 2
    assert text.replace(ELSEWHERE, HERE) == html(page)
    assert all("figure" in vars(plot) for plot in plots)
