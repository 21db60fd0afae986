"""The page's table of nitrided fillets by a printed range of depth and hardness."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.studies import hardened_examples as study

PAGE = Path(__file__).parents[3] / "docs" / "pages" / "fatigue.md"


@pytest.mark.slow
@pytest.mark.parametrize(("depth_mm", "surface_HV"), [(0.27, 602.0), (0.70, 787.0)])
def test_the_page_has_the_corners_of_the_range(depth_mm: float, surface_HV: float) -> None:
    """Safeties to 0.01 on other machines, depths that decide to 0.05 mm."""
    found = [float(cell.removesuffix(" mm")) for cell in study.row(depth_mm, surface_HV)]
    lines = (PAGE.read_text(encoding="utf-8")).splitlines()
    (line,) = (one for one in lines if one.startswith(f"| {depth_mm:.2f} | {surface_HV:g} |"))
    told = [float(cell.strip().removesuffix(" mm")) for cell in line.strip("|").split("|")]
    assert found[::3] == pytest.approx(told[::3], abs=0.05)
    assert [found[i] for i in (1, 2, 4, 5, 7)] == pytest.approx([told[i] for i in (1, 2, 4, 5, 7)], abs=0.01)
