"""Holes through an envelope along the crank axis: drilled after forging or casting, as bores are."""

from __future__ import annotations

from collections.abc import Sequence
from functools import reduce

import numpy as np
from manifold3d import CrossSection, FillRule
from numpy.typing import NDArray

from cranktopo.bodies.envelope_file import section
from cranktopo.design.schema import Scene

_Contour = NDArray[np.float64]


def envelope_z_mm(scene: Scene) -> tuple[float, float]:
    """Axial range that the envelope may fill: that of the web less the clearances."""
    start, end = scene.web_z_mm
    envelope = scene.envelope
    if envelope is None:
        return start, end
    return start + envelope.bearing_clearance_mm, end - envelope.rod_clearance_mm


def through_holes(scene: Scene, heights_mm: Sequence[float]) -> list[list[_Contour]]:
    """Contours (n, 2), mm, of the holes at each height; none at heights that the envelope may not fill.

    A hole counts with all its steps and chamfers if some line along the crank axis passes through it at all
    the heights.
    """
    low, high = envelope_z_mm(scene)
    inside = [low < z < high for z in heights_mm]
    layers = [_holes(scene, z) if within else [] for z, within in zip(heights_mm, inside, strict=True)]
    regions = [_region(layer) for layer, within in zip(layers, inside, strict=True) if within]
    if not regions or any(region.is_empty() for region in regions):
        return [[] for _ in heights_mm]
    through = reduce(lambda a, b: a ^ b, regions)
    return [[c for c in layer if not (_region([c]) ^ through).is_empty()] for layer in layers]


def _holes(scene: Scene, z_mm: float) -> list[_Contour]:
    """Inner contours of the envelope's cross-section; none where its file is gone."""
    envelope = scene.envelope
    if envelope is None or envelope.stl_file is None or not envelope.stl_file.is_file():
        return []
    contours = section(envelope.stl_file, z_mm, not envelope.asymmetry)
    return [contour for contour in contours if _area(contour) < 0]


def _area(contour: _Contour) -> float:
    """Signed area, positive counter-clockwise."""
    x, y = contour.T
    return float(x @ np.roll(y, -1) - y @ np.roll(x, -1)) / 2


def _region(contours: list[_Contour]) -> CrossSection:
    return CrossSection(contours, FillRule.NonZero) if contours else CrossSection()
