"""The judge's error estimate against the true error, from a finer mesh, with fillets and without."""

from __future__ import annotations

import pytest

from cranktopo.evaluate.evaluation import evaluate
from cranktopo.evaluate.targets import Target
from tests.physics.judge_cases import mikron_with


@pytest.mark.slow
@pytest.mark.parametrize("fillet_mm", [0.0, 2.5])
def test_the_estimate_bounds_the_error(fillet_mm: float) -> None:
    """True within 0.1 %: the finest value is extrapolated by its own estimate, which is about that large."""
    target = Target("mikron", mikron_with(fillet_mm=fillet_mm))
    finest = evaluate(target, 2.8)
    for size in (6.3, 4.2):
        found = evaluate(target, size)
        for name, value, estimate, best in (
            ("torsion", found.torsion_Nm_per_rad, found.torsion_error_percent, finest.torsion_Nm_per_rad),
            ("bending", found.bending_N_per_mm, found.bending_error_percent, finest.bending_N_per_mm),
        ):
            true = best * (1 - getattr(finest, f"{name}_error_percent") / 100)
            error = 100 * (value / true - 1)
            assert 0 < error < 1.15 * estimate + 0.05, (name, size, error, estimate)
            assert estimate < 4 * error, (name, size, error, estimate)
