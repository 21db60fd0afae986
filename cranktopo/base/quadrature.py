"""Gauss's rule of integration, whose points take longer to find than most of what is summed over them."""

from __future__ import annotations

from functools import cache

import numpy as np

from cranktopo.base.arrays import Array


@cache
def gauss_legendre(points: int) -> tuple[Array, Array]:
    """Return points in -1 .. 1 and their weights, found once for all; neither can be written to."""
    nodes, weights = np.polynomial.legendre.leggauss(points)
    nodes.flags.writeable = weights.flags.writeable = False
    return nodes, weights
