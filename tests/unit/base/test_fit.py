"""Limits of size against the tables of ISO 286-2."""

from __future__ import annotations

import pytest

from cranktopo.base.fit import limits_text, limits_um


@pytest.mark.parametrize(
    ("diameter_mm", "fit", "limits"),
    [
        (42.0, "h6", (0, -16)),
        (50.0, "h6", (0, -16)),
        (50.001, "h6", (0, -19)),
        (60.0, "k6", (21, 2)),
        (60.0, "k8", (46, 0)),
        (30.0, "f7", (-20, -41)),
        (25.0, "js6", (6.5, -6.5)),
        (100.0, "p6", (59, 37)),
        (45.0, "m6", (25, 9)),
        (8.0, "n6", (19, 10)),
        (20.0, "g6", (-7, -20)),
        (560.0, "h7", (0, -70)),
    ],
)
def test_limits_are_those_of_the_standard(diameter_mm: float, fit: str, limits: tuple[float, float]) -> None:
    assert limits_um(diameter_mm, fit) == limits


def test_the_text_has_both_limits_in_mm() -> None:
    assert limits_text(42.0, "h6") == "⌀42 h6 (0/-0.016)"
    assert limits_text(60.0, "k6") == "⌀60 k6 (+0.021/+0.002)"
