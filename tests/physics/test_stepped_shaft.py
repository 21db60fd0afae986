"""Stress concentration of a stepped shaft in tension, bending and torsion against published closed forms."""

from __future__ import annotations

import pytest

from tests.physics.stepped_shaft import AXIAL, BENDING, TORSION, Shaft, concentration, tipton


@pytest.mark.slow
@pytest.mark.parametrize("shaft", [Shaft(60, 40, 4), Shaft(60, 40, 6)], ids=["r/d 0.10", "r/d 0.15"])
def test_factors_within_two_percent(shaft: Shaft) -> None:
    means, peaks, _ = concentration(shaft, 9.0, 0.17, (AXIAL, BENDING, TORSION))
    for load, factor in means.items():
        assert factor == pytest.approx(tipton(load, shaft), rel=0.02)
        # the worst node is the mean plus the noise of the mesh
        assert factor * 0.98 < peaks[load] < factor * 1.05
