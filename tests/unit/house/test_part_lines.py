"""The page on extending tells how much each part beside the crank took."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from tests.studies.part_lines import PARTS, counted

PAGE = Path(__file__).parents[3] / "docs" / "pages" / "extending.md"
NAMES = {"rod": "The rod took", "bolts": "bolts", "balancer": "the balancer shaft"}


@pytest.mark.parametrize("part", PARTS)
def test_the_page_has_the_lines_of_a_part(part: str) -> None:
    """Within 5 %: `python -m tests.studies.part_lines` prints them."""
    text = PAGE.read_text(encoding="utf-8")
    told = re.search(rf"{NAMES[part]} (\d+)(?: files)? of ([\d,]+)", text)
    assert told is not None
    files, lines, _ = counted(part)
    assert int(told[1]) == pytest.approx(files, rel=0.05)
    assert int(told[2].replace(",", "")) == pytest.approx(lines, rel=0.05)
