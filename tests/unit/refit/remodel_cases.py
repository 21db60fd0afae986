"""Webs of the re-model's family with known parameters, and their bodies."""

from __future__ import annotations

from typing import Any

import numpy as np
from manifold3d import Manifold

from cranktopo.bodies.solid.files import surface_of
from cranktopo.design.loading import load_scene
from cranktopo.design.schema import Scene
from cranktopo.numerics.surfaces.mesh import solid_of
from cranktopo.tasks.refit.family import Layout, bounds, web_of
from cranktopo.tasks.refit.fit import fit_problem, scene_with_web
from cranktopo.tasks.refit.select import FitTask, fit_from
from cranktopo.throw.bevel import FittedBevel
from cranktopo.throw.fitted_pocket import FittedCylinder
from cranktopo.throw.fitted_slot import FittedSlot
from cranktopo.throw.manufacturing_limits import ManufacturingLimits

FINE_FACET_MM = 0.3
OUTLINE = {
    "y_low": -26.0,
    "y_high": 75.0,
    "half_width_1": 21.0,
    "half_width_2": 33.0,
    "half_width_3": 38.0,
    "half_width_4": 31.0,
    "half_width_5": 18.0,
}
JOURNAL_BEVEL = {"y": 50.0, "depth": 14.0, "crown": 1.5}
PIN_BEVEL = {"y": 9.0, "depth": 13.0, "crown": 2.0}
SIDE = {"y": 24.0, "length": 24.0, "height": 6.0, "floor": 31.0, "offset": 0.5, "draft": 12.0}
PAIR = {"x": 22.0, "y": 24.0, "diameter": 6.0}
"""Nothing here is symmetric along the throw or the crank axis."""

PLAIN = Layout(7)
PARTS = (FittedBevel("journal"), FittedBevel("pin"), FittedSlot(), FittedCylinder("through", pair=True))
WHOLE = Layout(7, PARTS)
_TABLES = (JOURNAL_BEVEL, PIN_BEVEL, SIDE, PAIR)


def values_of(layout: Layout) -> np.ndarray:
    """The known parameters of a layout whose parts are the first ones of PARTS."""
    tables = [OUTLINE, *_TABLES[: len(layout.parts)]]
    return np.array([value for table in tables for value in table.values()])


def known_scene(scene: Scene, layout: Layout) -> Scene:
    """The scene with the known web."""
    return scene_with_web(scene, web_of(layout, values_of(layout), scene))


def body_of(scene: Scene, facet_mm: float = 1.0) -> Manifold:
    """The half throw as a solid of the boolean engine."""
    mesh = surface_of(scene, "half", facet_mm)
    return solid_of(mesh, "known body")


def recovered(cell_mm: float) -> np.ndarray:
    """Parameters fitted to the known web on cells of one size, from a guess scattered by 1 mm or degree."""
    scene, true = load_scene("mikron-iiic-plain"), values_of(WHOLE)
    body = body_of(known_scene(scene, WHOLE), FINE_FACET_MM)
    guess = true + np.random.default_rng(1).normal(0, 1.0, len(true))
    limits = ManufacturingLimits()
    problem = fit_problem(body, scene, limits, cell_mm)
    known = FitTask(WHOLE, np.clip(guess, *bounds(WHOLE, scene, limits)), "known web")
    found = fit_from(problem, known)
    assert found is not None
    return found.values


def table(**changes: Any) -> dict[str, Any]:
    """The web table of the plain outline, with changes."""
    stations = [-26.0, -20.0, -3.0, 24.0, 52.0, 69.0, 75.0]
    half_widths = [0.0, 21.0, 33.0, 38.0, 31.0, 18.0, 0.0]
    web = {"thickness_mm": 19.0, "outline": "profile", "stations_mm": stations, "half_widths_mm": half_widths}
    return {**web, **changes}
