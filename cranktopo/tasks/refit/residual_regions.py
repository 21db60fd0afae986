"""Residual regions of a fit: where and by how much a web of the family cannot follow the body."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from cranktopo.base.arrays import Array
from cranktopo.base.near_ties import best_first
from cranktopo.tasks.refit.search import FitProblem
from cranktopo.tasks.refit.voxel_fill import MOST

Mask = NDArray[np.bool_]
_LEAST_SHARE = 0.002
"""Least volume of a residual region that is reported, over that of the web."""
_DEEPER_CELLS = 1
"""Layers of cells taken off to tell a region from a thin layer along a fitted surface."""


@dataclass(frozen=True)
class ResidualRegion:
    """A connected region in which model and body differ, thicker than two cells.

    Attributes:
        kind: "window" (open at both web faces), "recess" (open at one face or the side), "hollow" (closed,
            or open into a bore only) where the body has a hole that the model lacks; "material" where the
            body has material that the model lacks.
        volume_mm3: on both sides of x = 0.
        centre_mm: centre of the part at x >= 0, (x, y, z).
        low_mm, high_mm: its bounding box, x >= 0.
        pair: it does not reach x = 0, so there is one on either side.
        face: the web face at which a recess is open, or None.
    """

    kind: Literal["window", "recess", "hollow", "material"]
    volume_mm3: float
    centre_mm: tuple[float, float, float]
    low_mm: tuple[float, float, float]
    high_mm: tuple[float, float, float]
    pair: bool
    face: Literal["journal", "pin"] | None


def residual_regions(problem: FitProblem, model: Array) -> list[ResidualRegion]:
    """Return the regions in which a model differs from the body, largest first.

    Args:
        model: (nx, ny, nz) fill of the cells by the model.
    """
    target = problem.target.filled
    found = []
    for excess, lacking in ((model - target, False), (target - model, True)):
        for region in _regions(excess > MOST):
            volume = float(2 * excess[region].sum() * np.prod(problem.target.cell_mm))
            if volume >= _LEAST_SHARE * problem.target.volume_mm3:
                found.append(_describe(problem, region, volume, lacking))
    return best_first(found, lambda region: region.volume_mm3)


def _regions(mask: Mask) -> list[Mask]:
    """Return connected parts of a mask that remain without its outer layer, each with that layer put back."""
    from scipy import ndimage

    # The mirror plane and the web faces are no surfaces of a region.
    padded = np.pad(mask, ((1, 0), (0, 0), (1, 1)), mode="edge")
    core = ndimage.binary_erosion(padded, iterations=_DEEPER_CELLS, border_value=1)[1:, :, 1:-1]
    labels, count = ndimage.label(core)
    corners = ndimage.generate_binary_structure(3, 3)
    grown = [ndimage.binary_dilation(labels == i + 1, corners, _DEEPER_CELLS) & mask for i in range(count)]
    return [region for region in grown if region.any()]


def _describe(problem: FitProblem, region: Mask, volume: float, lacking: bool) -> ResidualRegion:
    cells = problem.target
    where = np.argwhere(region)
    axes = (cells.x_mm, cells.y_mm, cells.z_mm)
    half = cells.cell_mm / 2
    low = tuple(float(axis[k] - h) for axis, k, h in zip(axes, where.min(axis=0), half, strict=True))
    high = tuple(float(axis[k] + h) for axis, k, h in zip(axes, where.max(axis=0), half, strict=True))
    centre = tuple(float(axis[where[:, i]].mean()) for i, axis in enumerate(axes))
    on_journal, on_pin = bool(region[:, :, 0].any()), bool(region[:, :, -1].any())
    kind: Literal["window", "recess", "hollow", "material"] = "hollow"
    if lacking:
        kind = "material"
    elif on_journal and on_pin:
        kind = "window"
    elif on_journal or on_pin or _open_sideways(problem, region):
        kind = "recess"
    face: Literal["journal", "pin"] | None = None
    if kind == "recess" and on_journal != on_pin:
        face = "journal" if on_journal else "pin"
    pair = bool(where[:, 0].min() > 0)
    return ResidualRegion(kind, volume, _triple(centre), _triple(low), _triple(high), pair, face)


def _open_sideways(problem: FitProblem, region: Mask) -> bool:
    """Tell whether the void reaches the outside of the body in its own plane, other than through a bore."""
    from scipy import ndimage

    void = ~problem.target.solid & (problem.free > 0.5)[:, :, None]
    labels, _ = ndimage.label(void)
    outside = set(np.unique(labels[-1])) | set(np.unique(labels[:, 0])) | set(np.unique(labels[:, -1]))
    return bool((set(np.unique(labels[region])) & outside) - {0})


def _triple(values: tuple[float, ...]) -> tuple[float, float, float]:
    x, y, z = (round(value, 2) for value in values)
    return x, y, z
