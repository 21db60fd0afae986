"""The error estimate of the evaluation against the true error, with fillets and without."""

from __future__ import annotations

import pytest

from cranktopo.tasks.throw_fea.evaluation import evaluate, evaluate_on_mesh
from cranktopo.tasks.throw_fea.targets import Target
from tests.physics.fea.evaluation_cases import mikron_with
from tests.physics.fea.test_evaluation_reference import BENDING, TORSION
from tests.studies.error_bounds import limit


def extrapolated(target: Target) -> tuple[float, float]:
    """Torsional and bending stiffness that two fine meshes converge to with order 1.3."""
    coarse, fine = (evaluate_on_mesh(target, size).stiffness for size in (4.2, 2.8))
    pairs = [
        (coarse.torsion["free"], fine.torsion["free"]),
        (coarse.bending["pinned"], fine.bending["pinned"]),
    ]
    torsion, bending = (limit(c, f) for c, f in pairs if c and f)
    return torsion, bending


@pytest.mark.slow
@pytest.mark.parametrize("fillet_mm", [0.0, 2.5])
def test_the_estimate_bounds_the_error(fillet_mm: float) -> None:
    """The sharp throw has a reference of another program; both truths are good to about 0.1 %."""
    target = Target("mikron", mikron_with(fillet_mm=fillet_mm))
    true = extrapolated(target) if fillet_mm else (TORSION["free"], BENDING["pinned"])
    for size in (6.3, 4.2):
        found = evaluate(target, size)
        values = found.torsion_Nm_per_rad, found.bending_N_per_mm
        estimates = found.torsion_error_percent, found.bending_error_percent
        for value, estimate, truth in zip(values, estimates, true, strict=True):
            error = 100 * (value / truth - 1)
            assert 0 < error < estimate + 0.1, (size, error, estimate)
            assert estimate < 2.5 * error + 0.1, (size, error, estimate)
