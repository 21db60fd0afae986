"""Densities with a known shape, on the grid of a scene's envelope."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from cranktopo.bodies.cells.grid import DensityGrid
from cranktopo.design.loading import load_scene, scene_from_dict
from cranktopo.design.schema import Scene

Array = np.ndarray
Distance = Callable[[Array, Array, Array], Array]


def scene_with(name: str = "mikron-iiic-plain", **changes: Any) -> Scene:
    """A built-in design with a free topology and `a__b__c=value` changes."""
    data = load_scene(name).with_optimise(process="free", draft_deg=0.0).model_dump(exclude_none=True)
    for path, value in changes.items():
        *tables, key = path.split("__")
        table = data
        for step in tables:
            table = table[step]
        table[key] = value
    return scene_from_dict(data)


def grid_of(scene: Scene, inside_mm: Distance, cell_mm: float = 1.5, blur_mm: float = 0.6) -> DensityGrid:
    """Density 1 / (1 + exp(-d / blur)) of a signed distance (positive inside), 0 in the bores.

    The box is that of the mikron-iiic-plain envelope, whatever the envelope of the scene is.
    """
    box = load_scene("mikron-iiic-plain" if scene.throw.radius_mm == 48 else "opposed-piston").envelope
    assert box is not None
    assert box.shape == "box"
    start, end = scene.web_z_mm
    lower = np.array([-box.half_width_mm, box.y_min_mm, start])
    size = np.array([box.half_width_mm, box.y_max_mm, end]) - lower
    shape = np.ceil(size / cell_mm).astype(int)
    shape[0] += shape[0] % 2
    cell = size / shape
    axes = [lower[i] + (np.arange(shape[i]) + 0.5) * cell[i] for i in range(3)]
    x, y, z = np.meshgrid(*axes, indexing="ij")
    density = 1 / (1 + np.exp(-np.clip(inside_mm(x, y, z) / blur_mm, -500, 500)))
    throw = scene.throw
    density[np.hypot(x, y) < throw.main_journal.bore_radius_mm] = 0.0
    density[np.hypot(x, y - throw.radius_mm) < throw.crankpin.bore_radius_mm] = 0.0
    return DensityGrid(lower, cell, density)


def obround(radius_mm: float = 25.0, length_mm: float = 48.0) -> Distance:
    """Distance inside a slot outline from the crank axis to the pin axis."""
    return lambda x, y, z: radius_mm - np.hypot(x, y - np.clip(y, 0.0, length_mm))


def ball(x_mm: float, y_mm: float, z_mm: float, radius_mm: float) -> Distance:
    """Distance inside a ball."""
    return lambda x, y, z: radius_mm - np.sqrt((x - x_mm) ** 2 + (y - y_mm) ** 2 + (z - z_mm) ** 2)


def everywhere() -> Distance:
    """Solid in every cell."""
    return lambda x, y, z: np.full(x.shape, np.inf)


def united(*parts: Distance) -> Distance:
    """Distance inside any of the parts."""
    return lambda x, y, z: np.max([part(x, y, z) for part in parts], axis=0)


def without(body: Distance, hole: Distance) -> Distance:
    """Distance inside the body and outside the hole."""
    return lambda x, y, z: np.minimum(body(x, y, z), -hole(x, y, z))


def drilled_beside(scene: Scene, diameter_mm: float) -> Scene:
    """Return a forged throw without bores, with a drilling that leans through the web beside x = 0."""
    data = scene.model_dump(mode="json", exclude_none=True)
    for journal in ("main_journal", "crankpin"):
        data["throw"][journal]["bore_diameter_mm"] = 0.0
    ends = {"from": ("main_journal", 180.0), "to": ("crankpin", 50.0)}
    drilling = {key: {"on": on, "angle_deg": deg, "place_mm": 0.0} for key, (on, deg) in ends.items()}
    data["throw"]["drilling"] = [{"diameter_mm": diameter_mm, **drilling}]
    data["optimise"] |= {"process": "forged"}
    return scene_from_dict(data)
