"""Fatigue safety has no bound by stress alone: the strength over the gradient, and the page that says so."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from cranktopo.design.loading import load_scene
from tests.studies import fatigue_bound

PAGE = Path(__file__).parents[3] / "docs" / "pages" / "bound.md"


def test_the_strength_by_lsa_rises_without_end() -> None:
    """At last as the root of the gradient: the support factor over the root in the notch ratio."""
    strength = fatigue_bound.strengths(load_scene("mikron-iiic"), np.logspace(-2, 8, 21))["lsa"]
    assert (np.diff(strength) > 0).all()
    assert strength[-1] / strength[-3] == pytest.approx(np.sqrt(10), rel=0.01)


def test_the_strength_by_the_guideline_ends() -> None:
    strength = fatigue_bound.strengths(load_scene("mikron-iiic"), np.linspace(0.0, 99.99, 200))["fkm"]
    assert strength.max() < 1.4


def test_no_section_carries_the_moment_at_less_stress() -> None:
    """Of ten thousand fields of stress in a section none with its largest value 1 has a larger moment."""
    random = np.random.default_rng(0)
    height = (np.arange(40) + 0.5) / 40 - 0.5
    stress = random.uniform(-1, 1, (10_000, 40))
    assert np.abs(stress @ height / 40).max() <= 1 / 4
    assert np.sign(height) @ height / 40 == pytest.approx(1 / 4)
    factor, wider, lost = fatigue_bound.lost_by_equilibrium(load_scene("mikron-iiic"))
    assert lost == pytest.approx(factor * wider * (1 / 4) / (1 / 6))


def test_the_page_has_these_numbers() -> None:
    """Printed by `python -m tests.studies.fatigue_bound`."""
    text = PAGE.read_text(encoding="utf-8")
    assert fatigue_bound.gradient_table() in text
    assert fatigue_bound.equilibrium_line() in text
