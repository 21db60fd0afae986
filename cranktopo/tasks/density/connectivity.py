"""Connection of the main journal with the crankpin by the solid of a design."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from cranktopo.bodies.cells.domain import Domain

SOLID = 0.5


def is_connected(domain: Domain, density: NDArray[np.float64]) -> bool:
    """Tell whether one face-connected body of solid cells holds both journals."""
    from scipy.ndimage import label

    first, last = domain.web_layers
    solid = domain.fixed >= SOLID
    solid[:, :, first:last] |= (density >= SOLID) & (domain.design > 0)[:, :, first:last]
    labels, _ = label(solid)
    start, end = labels[:, :, 0][solid[:, :, 0]], labels[:, :, -1][solid[:, :, -1]]
    return bool(np.intersect1d(start, end).size > 0)
