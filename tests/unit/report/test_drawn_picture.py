"""A picture that another process has drawn stands on the page byte for byte."""

from __future__ import annotations

import base64
from pathlib import Path

from cranktopo.report.page import Page
from cranktopo.report.plot import DrawnPicture
from cranktopo.report.report_file import write_report

PNG = bytes(range(256))
PAGE = Page("Title", "Run", "Headline", (), (), picture=DrawnPicture("views", PNG, "Four views"))


def test_in_html(tmp_path: Path) -> None:
    write_report(PAGE, tmp_path / "page.html")
    text = (tmp_path / "page.html").read_text()
    assert f'<img src="data:image/png;base64,{base64.b64encode(PNG).decode()}" alt="Four views">' in text


def test_beside_markdown(tmp_path: Path) -> None:
    write_report(PAGE, tmp_path / "page.md")
    assert "![Four views](page-pictures/views.png)" in (tmp_path / "page.md").read_text()
    assert (tmp_path / "page-pictures" / "views.png").read_bytes() == PNG
