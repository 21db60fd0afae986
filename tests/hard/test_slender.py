"""A beam so slender that displacements in float32 would be rounded by more than its load."""

from __future__ import annotations

import jax.numpy as jnp
import pytest

from cranktopo.numerics.grid.equilibrium import METHODS
from cranktopo.tasks.density.response import compliances, solve
from tests.studies.cantilever import cantilever

LENGTH, SIDE = 512, 4


@pytest.mark.slow
def test_first_method_gets_there(float64: None) -> None:
    """Directions in float32 leave a true residual of 27 loads. Tip deflection by Euler and Bernoulli."""
    model, _ = cantilever((LENGTH, SIDE, SIDE))
    solution = solve(model, jnp.ones(model.lattice.cells), tolerance=1e-5)
    assert (solution.method, solution.notice) == (METHODS[0].name, "")
    force = SIDE + 1.0
    deflection = force * LENGTH**3 / (3 * SIDE**4 / 12)
    assert float(compliances(model, solution.displacements)[0]) == pytest.approx(force * deflection, rel=1e-3)
