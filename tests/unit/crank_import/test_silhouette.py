"""How far outlines of webs are apart: a hair's fold of one is no distance."""

from __future__ import annotations

import pytest
from manifold3d import CrossSection, FillRule

from cranktopo.tasks.crank_import.silhouette import apart_mm

WIDE_MM, TALL_MM, AT_MM, LONG_MM = 60.0, 40.0, 40.15, 2.0


def rectangle(fold_mm: float = 0.0) -> CrossSection:
    """A rectangle; its lower side may go back once over LONG_MM, apart by so much, as silhouettes do."""
    fold = [(AT_MM + fold_mm, 0.0), (AT_MM - LONG_MM, fold_mm / 2), (AT_MM, fold_mm)]
    corners = [(0.0, 0.0), *(fold if fold_mm else ()), (WIDE_MM, 0.0), (WIDE_MM, TALL_MM), (0.0, TALL_MM)]
    return CrossSection([corners], FillRule.NonZero)


def test_distances_of_two_rectangles() -> None:
    most, mean = apart_mm(rectangle(), rectangle().translate((0.0, 0.5)))
    assert most == pytest.approx(0.5, abs=1e-9)
    assert 0 < mean < most


@pytest.mark.parametrize("shift_mm", [0.0, 0.02])
def test_a_fold_is_no_distance(shift_mm: float) -> None:
    """By the sides of the nearest corner alone, places beside the fold are up to 0.1 mm away."""
    folded = rectangle(1e-5)
    assert sum(map(len, folded.to_polygons())) == 7
    most, _ = apart_mm(folded, rectangle().translate((0.0, -shift_mm)))
    assert most == pytest.approx(shift_mm, abs=2e-3)
