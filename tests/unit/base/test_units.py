"""Numbers as they are told."""

from __future__ import annotations

import pytest

from cranktopo.base.units import change_text


@pytest.mark.parametrize(
    ("percent", "error", "said"),
    [
        (-4.72, 0.0, "-4.7 %"),
        (12.34, 0.6, "+12.3 +-0.6 %"),
        (9.6, 2.19, "+9.6 +-2.2 %"),  # "+-2 %" stood beside a column with 2.2
        (-0.047, 0.04, "-0.05 +-0.04 %"),  # "+0.0 +-0.04 %" stood in red
        (0.0034, 0.0, "+0.003 %"),
        (-0.0, 0.0, "+0.0 %"),
        (-1e-9, 0.1, "+0.0 +-0.1 %"),
    ],
)
def test_a_change_has_the_sign_of_its_number(percent: float, error: float, said: str) -> None:
    assert change_text(percent, error) == said
