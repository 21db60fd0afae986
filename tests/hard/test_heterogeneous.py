"""Heterogeneous cantilevers of a published sweep: the first method alone solves them all."""

from __future__ import annotations

from itertools import product

import pytest

from cranktopo.numerics.grid.lattice import Cells
from cranktopo.numerics.precision import double_precision
from tests.studies.heterogeneous import CONTRASTS, LENGTHS, SIZES, answer


@pytest.mark.slow
@pytest.mark.parametrize(("cells", "contrast", "length"), tuple(product(SIZES, CONTRASTS, LENGTHS)))
def test_every_case_converges_within_the_cap(cells: Cells, contrast: float, length: float) -> None:
    with double_precision():
        found = answer(cells, contrast, length, SIZES[cells])
    assert found.converged, found
