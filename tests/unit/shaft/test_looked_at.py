"""Speeds at which every node of a shaft is looked at."""

from __future__ import annotations

import numpy as np

from cranktopo.tasks.throw_fatigue.least import looked_at


def test_a_resonance_between_even_speeds_is_looked_at() -> None:
    """One load of one throw swings more at one of a hundred speeds."""
    angle = np.linspace(0, 2 * np.pi, 24, endpoint=False)
    throws = np.tile(np.sin(angle)[None, :, None], (2, 100, 1, 3))
    assert set(looked_at(list(throws))) == {0, 25, 50, 74, 99}
    throws[1, 37, :, 2] *= 1.01
    assert set(looked_at(list(throws))) == {0, 25, 37, 50, 74, 99}
