"""Forging or casting constraint: density that never grows away from the die's parting plane x = 0.

The die halves leave along +x and -x. What lies outward of a void would hold them back, so each cell takes a
smooth minimum over the cells between it and the parting plane. Sums only grow outward: the result is
monotone whatever the sharpness, and stays 1 where all cells are solid.

Source of the idea: A. R. Gersborg, C. S. Andreasen, An explicit parameterization for casting constraints in
gradient driven topology optimization, SMO 44, 2011. The smooth minimum is the Kreisselmeier-Steinhauser
function (DFVLR report, 1979), shifted so that full density stays full.
"""

from __future__ import annotations

import jax
import jax.numpy as jnp
import numpy as np
from numpy.typing import NDArray

from cranktopo.domain.build import Domain
from cranktopo.domain.through_holes import through_holes
from cranktopo.scene import Scene
from cranktopo.scene.polygons import polygons

SHARPNESS = 60.0


def parting_index(domain: Domain) -> int:
    """Number of cells on the negative side of the parting plane x = 0, which is a grid plane."""
    return int(np.searchsorted(domain.grid.x_mm, -1e-6 * float(domain.grid.steps_mm[0][0])))


def open_cells(scene: Scene, domain: Domain) -> NDArray[np.bool_]:
    """Cells of the web's layers (nx, ny, nw) that are no obstacle: designable, in a bore or in a journal.

    Bores and holes through the envelope along the crank axis are drilled after forging or casting.
    """
    first, last = domain.web_layers
    x, y = ((nodes[1:] + nodes[:-1]) / 2 for nodes in (domain.grid.x_mm, domain.grid.y_mm))
    bored = np.zeros((len(x), len(y)), bool)
    for journal, centre in scene.throw.journals:
        bored |= np.hypot(x[:, None], y[None, :] - centre) < journal.bore_radius_mm
    filled = (domain.design > 0) | (domain.fixed > 0)
    z = ((domain.grid.z_mm[1:] + domain.grid.z_mm[:-1]) / 2)[first:last]
    holes = [polygons(contours)(x[:, None], y[None, :]) for contours in through_holes(scene, z.tolist())]
    return filled[:, :, first:last] | bored[:, :, None] | np.stack(holes, axis=-1)


def unreachable_share(scene: Scene, domain: Domain) -> float:
    """Share of the design space that no die half reaches past the voids of the envelope, 0 to 1."""
    first, last = domain.web_layers
    design = (domain.design * domain.volume_mm3)[:, :, first:last]
    kept = design * reachable(open_cells(scene, domain), parting_index(domain))
    return float(1 - kept.sum() / design.sum())


def reachable(open_to_die: NDArray[np.bool_], parting: int) -> NDArray[np.bool_]:
    """Cells (nx, ny, nw) with nothing but open cells between them and the parting plane."""
    left, right = open_to_die[:parting][::-1], open_to_die[parting:]
    sides = (np.logical_and.accumulate(left)[::-1], np.logical_and.accumulate(right))
    return np.concatenate(sides)


def without_undercuts(density: jax.Array, free: jax.Array, parting: int) -> jax.Array:
    """Density that never grows away from the parting plane.

    Returns:
        (nx, ny, nw) in [0, 1], at most `density` where that is designable.
    """
    full = jnp.exp(-SHARPNESS)
    gap = jnp.where(free, jnp.exp(-SHARPNESS * density) - full, 0.0)
    outward = (jnp.cumsum(gap[:parting][::-1], axis=0)[::-1], jnp.cumsum(gap[parting:], axis=0))
    return -jnp.log(jnp.minimum(jnp.concatenate(outward) + full, 1.0)) / SHARPNESS
