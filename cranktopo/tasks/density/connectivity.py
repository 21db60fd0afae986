"""Whether the solid of a design joins the main journal with the crankpin."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from cranktopo.bodies.cells.domain import Domain

SOLID = 0.5


def is_connected(domain: Domain, density: NDArray[np.float64]) -> bool:
    """Whether one face-connected body of solid cells holds both journals."""
    from scipy.ndimage import label

    first, last = domain.web_layers
    solid = domain.passive_fraction >= SOLID
    solid[:, :, first:last] |= (density >= SOLID) & (domain.design_fraction > 0)[:, :, first:last]
    labels, _ = label(solid)
    start, end = labels[:, :, 0][solid[:, :, 0]], labels[:, :, -1][solid[:, :, -1]]
    return bool(np.intersect1d(start, end).size > 0)
