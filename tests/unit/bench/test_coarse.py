"""Cells of a drag are filled quickly: their stiffness is that of cells filled as for an optimisation."""

from __future__ import annotations

import pytest

from cranktopo.bodies.cells.fractions import EXACT
from cranktopo.design.loading import design_text
from cranktopo.design.toml_text import parse_toml
from cranktopo.tasks.bench import coarse


def test_quick_cells_are_as_stiff(monkeypatch: pytest.MonkeyPatch) -> None:
    """A web with bevels, whose section changes along the crank axis."""
    data = parse_toml(design_text("mikron-iiic"), "web")
    quick = coarse.coarse_stiffness(data)
    monkeypatch.setattr(coarse, "QUICK", EXACT)
    exact = coarse.coarse_stiffness(data)
    assert quick != exact, "they are filled otherwise"
    assert quick == pytest.approx(exact, rel=2e-5), "a thousandth of what the ring states as its error"
