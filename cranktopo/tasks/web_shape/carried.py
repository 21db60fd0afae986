"""Parts fastened to a web while its parameters change: masses, and the pull that loads its mesh.

A bolted counterweight begins at the outline of its web, which takes from it what it gains.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from cranktopo.base.arrays import Array
from cranktopo.bodies.volume import bolted_mass
from cranktopo.design.schema import Scene
from cranktopo.numerics.optimisers.gradient_search import central_difference
from cranktopo.tasks.refit.family import Layout, flank_of, scene_at
from cranktopo.tasks.throw_fea.turning_load import pull_totals

_STEP = 1e-4
"""Step of the derivatives, mm or degrees: of integrals over sections with kinks."""


@dataclass(frozen=True)
class Fastened:
    """Parts fastened to one web, with derivatives by the parameters of the web (last axis).

    Attributes:
        scene: the throw with the web's own outline.
        masses: mass, kg, its moment in y, kg mm, and that of x2 + y2, kg mm2; of one web.
        totals: of `pull_totals`.
    """

    scene: Scene
    masses: Array
    mass_slopes: Array
    total_slopes: Array


def carried_at(scene: Scene, layout: Layout, values: Array) -> Fastened:
    """Return what is fastened to a web of a layout.

    Args:
        scene: has a web of the layout, whose features are none of the counterweight's business.
    """
    weight, moved = scene.web.counterweight, _moved(scene, layout, values)
    own = _own(moved)
    slopes = np.zeros((own.size, len(values)))
    if weight is not None and weight.bolted:
        count = len(values) - len(layout.dimensions)
        places = [*range(layout.stations), *range(count, len(values))]
        slopes = central_difference(lambda v: _own(_moved(scene, layout, v)), values, _STEP, places)
    return Fastened(moved, own[:3], slopes[:3], slopes[3:])


def _moved(scene: Scene, layout: Layout, values: Array) -> Scene:
    """Return the scene with the outline and the dimensions of a parameter vector, not checked."""
    weight, sized = scene.web.counterweight, scene_at(scene, layout, values)
    if weight is None or not weight.bolted:
        return sized
    points = flank_of(layout, np.asarray(values, dtype=np.float64)).points_mm
    outline = {"stations_mm": tuple(points[:, 1].tolist()), "half_widths_mm": tuple(points[:, 0].tolist())}
    return sized.model_copy(update={"web": sized.web.model_copy(update=outline)})


def _own(scene: Scene) -> Array:
    mass = bolted_mass(scene)
    return np.array([mass.volume, mass.first_y, mass.polar, *pull_totals(scene)])
