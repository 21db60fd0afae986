"""Side pockets of the web: where their floor and walls lie."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from cranktopo.scene.geometry import SidePocket, Web
from cranktopo.scene.outline import largest_half_width_mm

Array = NDArray[np.float64]


def side_floor_mm(web: Web, pocket: SidePocket, height_mm: float, y_mm: Array) -> Array:
    """Lateral distance |x| from which a side pocket is open; infinite where it is not.

    Args:
        web: the web, whose largest half-width the depth counts from.
        pocket: the pocket.
        height_mm: height over the journal face of the web.
        y_mm: positions along the throw.
    """
    middle = web.thickness_mm / 2 + pocket.offset_mm
    beyond = np.maximum(
        np.abs(y_mm - pocket.y_mm) - pocket.length_mm / 2, abs(height_mm - middle) - pocket.height_mm / 2
    )
    inner = largest_half_width_mm(web) - pocket.depth_mm
    if pocket.slope == 0:
        return np.where(beyond <= 0, inner, np.inf)
    return np.asarray(inner + np.maximum(beyond, 0.0) / pocket.slope)


def side_cuts_mm(web: Web, pocket: SidePocket, sections: int) -> list[float]:
    """Heights over the journal face where the pocket's section changes, mm; thin layers at sloped walls.

    Args:
        web: the web.
        pocket: one of its side pockets.
        sections: number of layers per sloped wall.
    """
    half, middle = pocket.height_mm / 2, web.thickness_mm / 2 + pocket.offset_mm
    if pocket.slope == 0:
        return [middle - half, middle + half]
    wall = np.linspace(half, half + pocket.depth_mm * pocket.slope, sections + 1)
    return [*(middle - wall), *(middle + wall)]
