"""The page's table of treatments that are worth a factor of 1.3, and its numbers by hand."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from tests.studies import factor_of_hardening as study

PAGE = Path(__file__).parents[3] / "docs" / "pages" / "fatigue.md"


def test_the_rule_by_hand() -> None:
    """400 + 0.5 (HV - 400) = 1.3 times the core's strength by M53.6, pin of 42 mm, fillet of 2.5 mm."""
    size = 0.264 + 1.073 * 42**-0.2 + (785 - 1100) / 4900 + 196 / 1100 * np.sqrt(1 / 2.5)
    core = (0.42 * 1100 + 39.3) * size
    assert study.rule_hardness_HV(1.0) == pytest.approx(2 * (1.3 * core - 400) + 400)


def test_a_depth_worth_the_factor_is_where_it_is_reached() -> None:
    assert study.shallowest_mm(lambda depth: 1 + 0.2 * depth) == pytest.approx(1.5)
    assert study.shallowest_mm(lambda depth: 1.29) is None


@pytest.mark.slow
def test_the_page_has_this_table() -> None:
    """Printed by `python -m tests.studies.factor_of_hardening`."""
    text = PAGE.read_text(encoding="utf-8")
    assert study.factor_table() in text
    assert f"surface of {study.rule_hardness_HV(1.0):.0f} HV on the Mikron" in text
    assert f"({study.rule_hardness_HV(1.05):.0f} HV for a forging" in text
