"""Cells of a drag: filled quickly, those of the settled web, and as stiff by fillets as elements."""

from __future__ import annotations

import pytest

from cranktopo.bodies.cells.fractions import EXACT
from cranktopo.design.edits import changed_data
from cranktopo.design.loading import design_text
from cranktopo.design.toml_text import parse_toml
from cranktopo.tasks.bench import coarse

DATA = parse_toml(design_text("mikron-iiic"), "web")


def test_quick_cells_are_as_stiff(monkeypatch: pytest.MonkeyPatch) -> None:
    """A web with bevels, whose section changes along the crank axis."""
    quick = coarse.coarse_stiffness(DATA, DATA)
    monkeypatch.setattr(coarse, "QUICK", EXACT)
    exact = coarse.coarse_stiffness(DATA, DATA)
    assert quick != exact, "they are filled otherwise"
    assert quick == pytest.approx(exact, rel=2e-5), "a thousandth of what the ring states as its error"


@pytest.mark.parametrize(
    ("key", "value", "settled"),
    [
        ("web.width_mm", 52.052, {"torsion": 5.944, "bending": 2.705, "bending_per_mass": -1.678}),
        ("throw.crankpin.fillet_mm", 3.4, {"torsion": 0.547, "bending": 1.261, "torsion_per_mass": 0.379}),
    ],
)
def test_a_move_is_told_as_elements_find_it(key: str, value: float, settled: dict[str, float]) -> None:
    """Cells that are planned anew have one more across the wider web, 0.75 % off; none has a fillet."""
    before, moved = coarse.coarse_stiffness(DATA, DATA), changed_data(DATA, {key: value})
    after = coarse.coarse_stiffness(moved, DATA)
    for name, truth in settled.items():
        assert 100 * (after[name] / before[name] - 1) == pytest.approx(truth, abs=0.25), name


@pytest.mark.slow  # its grid is compiled for it alone
def test_what_carries_nothing_changes_no_stiffness() -> None:
    """A counterweight of another radius, by elements 0.00 %; stretched cells were 2 % off."""
    first = parse_toml(design_text("car-diesel"), "web")
    lighter = changed_data(first, {"web.counterweight.outer_radius_mm": 61.053})
    before, after = (coarse.coarse_stiffness(one, first) for one in (first, lighter))
    assert after["bending"] == pytest.approx(before["bending"], rel=2e-3)
