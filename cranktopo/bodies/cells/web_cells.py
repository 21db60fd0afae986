"""The cells of the web's layers: where they are, and fields carried from some to others."""

from __future__ import annotations

import numpy as np

from cranktopo.base.arrays import Array
from cranktopo.bodies.cells.domain import Domain


def centres_mm(domain: Domain) -> tuple[Array, Array, Array]:
    """Centres of the cells of the web's layers along each axis, mm."""
    first, last = domain.web_layers
    x, y, z = (
        (nodes[1:] + nodes[:-1]) / 2 for nodes in (domain.grid.x_mm, domain.grid.y_mm, domain.grid.z_mm)
    )
    return x, y, z[first:last]


def on_cells(there: Domain, field: Array, here: Domain) -> Array:
    """A field on some cells (nx, ny, nw, ...) on others of the same throw, linear between their centres.

    Beyond the outermost centres the nearest value holds.
    """
    from scipy.interpolate import RegularGridInterpolator

    known, wanted = centres_mm(there), centres_mm(here)
    inside = [np.clip(at, own[0], own[-1]) for at, own in zip(wanted, known, strict=True)]
    points = np.stack(np.meshgrid(*inside, indexing="ij"), axis=-1)
    found: Array = RegularGridInterpolator(known, field)(points)
    return found
