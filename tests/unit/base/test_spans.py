"""What several lateral intervals leave, point by point."""

from __future__ import annotations

import numpy as np
import pytest

from cranktopo.base.spans import holds, material


@pytest.mark.parametrize("seed", range(5))
def test_material_is_what_is_added_and_not_removed(seed: int) -> None:
    """Between the tenths on which all intervals end; empty ones and ones that broadcast among them."""
    random = np.random.default_rng(seed)

    def spans(count: int) -> list[tuple[np.ndarray, np.ndarray]]:
        starts = [random.integers(-20, 20, (6, 1) if k % 2 else (6, 7)) / 10 for k in range(count)]
        return [(start, start + random.integers(-3, 30, (6, 7)) / 10) for start in starts]

    added, removed = spans(1 + seed % 3), spans(seed)
    left, right = material(added, removed)
    assert (left <= right).all()
    assert (right[:-1] <= left[1:]).all()
    for x in np.arange(-2.95, 6.0, 0.1):
        expected = holds(added, np.full((6, 7), x))
        if removed:
            expected &= ~holds(removed, np.full((6, 7), x))
        assert (holds(list(zip(left, right, strict=True)), np.full((6, 7), x)) == expected).all()
