"""From the optimiser's cells to the fields of the web region that the surface is made of."""

from __future__ import annotations

import numpy as np

from cranktopo.base.arrays import Array
from cranktopo.bodies.cells.domain import Domain
from cranktopo.bodies.density_grid import DensityGrid
from cranktopo.tasks.density.loop import WebDensities


def web_fields(domain: Domain, design: WebDensities) -> tuple[DensityGrid, Array, Array]:
    """Fields of the web's cells over the full width, for the surface.

    Returns:
        Physical density, the part of each cell that can hold material, and the filtered density. Journals
        that go on through a clearance count as solid.
    """
    first, last = domain.web_layers
    fixed, free = domain.passive_fraction[:, :, first:last], domain.design_fraction[:, :, first:last]
    usable = fixed + free
    share = np.divide(free, usable, out=np.zeros_like(free), where=usable > 0)
    solid = np.where(usable > 0, 1.0 - share, 0.0)
    fields = [solid + share * design.physical, usable, solid + share * design.filtered]
    x = domain.grid.x_mm
    if domain.mirrored_x:
        fields = [np.concatenate([field[::-1], field]) for field in fields]
        x = np.concatenate([-x[:0:-1], x])
    y, z = domain.grid.y_mm, domain.grid.z_mm[first : last + 1]
    origin = np.array([x[0], y[0], z[0]])
    cell = np.array([x[1] - x[0], y[1] - y[0], (z[-1] - z[0]) / (last - first)])
    density, usable, smooth = (np.clip(field, 0.0, 1.0) for field in fields)
    return DensityGrid(origin, cell, density), usable, smooth
