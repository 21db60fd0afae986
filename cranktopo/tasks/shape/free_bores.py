"""Free dimensions of the throw on cells: what bores leave of each cell, derivatives by their diameters."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from cranktopo.base.arrays import Array
from cranktopo.bodies.cells.domain import Domain, build_domain
from cranktopo.design.free_dimensions import (
    DimensionName,
    free_range_mm,
    is_of_counterweight,
    own_dimension_mm,
    with_dimensions,
)
from cranktopo.design.schema import Scene
from cranktopo.engine.plan.simulated import Feature
from cranktopo.tasks.refit.family import Layout, free_dimensions, scene_at
from cranktopo.tasks.refit.model_fill import smooth_step


def free_bores(scene: Scene) -> tuple[DimensionName, ...]:
    """Return bores that `[shape.free]` gives a range."""
    return tuple(name for name in free_dimensions(scene) if name.endswith("bore"))


def first_on_cells(scene: Scene, begun: Mapping[DimensionName, float]) -> tuple[DimensionName, ...]:
    """Return the free dimensions to begin with that cells know: bores and those of the counterweight.

    The bore of a solid journal is tried as a feature is.

    Args:
        begun: dimensions that are not those of the scene, mm or degrees.
    """
    there = (name for name in free_bores(scene) if begun.get(name, own_dimension_mm(scene, name)))
    return (*there, *_of_counterweight(scene))


def not_on_cells(scene: Scene) -> tuple[DimensionName, ...]:
    """Return the free dimensions that cells do not know: fillets, and the thickness of their grid."""
    told = (*free_bores(scene), *_of_counterweight(scene))
    return tuple(name for name in free_dimensions(scene) if name not in told)


def _of_counterweight(scene: Scene) -> tuple[DimensionName, ...]:
    return tuple(name for name in free_dimensions(scene) if is_of_counterweight(name))


def kept_features(scene: Scene) -> tuple[Feature, ...]:
    """Return the features that the evaluation keeps, whatever the plan says: fillets, and free bores."""
    return ("bores", "fillets") if free_bores(scene) else ("fillets",)


def domain_without_free_bores(scene: Scene, resolution_mm: float) -> Domain:
    """Return the cells of the design space with free bores filled; the pin is loaded outside its own.

    A counterweight that changes is no fixed part of them.

    Raises:
        CranktopoError: no envelope, or one that does not touch a journal.
    """
    free = free_bores(scene)
    if _of_counterweight(scene):
        scene = scene.model_copy(update={"web": scene.web.model_copy(update={"counterweight": None})})
    filled = build_domain(with_dimensions(scene, dict.fromkeys(free, 0.0)), resolution_mm)
    if "pin_bore" not in free:
        return filled
    widest = with_dimensions(scene, {"pin_bore": (free_range_mm(scene, "pin_bore") or (0.0, 0.0))[1]})
    pin = build_domain(widest, resolution_mm, "envelope", filled.extent, filled.grid).pin
    return replace(filled, pin=pin)


class FreeBores:
    """The free bores of a scene on its cells; a bore runs through its journal and the web."""

    def __init__(self, scene: Scene, domain: Domain) -> None:
        self.names = free_bores(scene)
        self._scene, self._domain = scene, domain

    def left(self, layout: Layout, values: Array) -> tuple[Array, dict[str, Array]]:
        """Return the share of each cell that they leave, (nx, ny, nz), and its derivatives, 1/mm.

        A solid journal whose bore the layout lacks stays solid.
        """
        scene = scene_at(self._scene, layout, values)
        rests = {name: self._rest(scene, name) for name in self.names if own_dimension_mm(scene, name)}
        left, gradients = np.ones(self._domain.grid.cells), dict[str, Array]()
        for name, (rest, _) in rests.items():
            left *= rest
            if name in layout.dimensions:
                others = [other for key, (other, _) in rests.items() if key != name]
                gradients[name] = np.prod([rests[name][1], *others], axis=0)
        return left, gradients

    def _rest(self, scene: Scene, name: DimensionName) -> tuple[Array, Array]:
        """Return what one bore leaves of each cell, and its derivative by the diameter."""
        grid, (start, end) = self._domain.grid, self._domain.web_layers
        main = name == "journal_bore"
        journal, axis = scene.throw.journals[0 if main else 1]
        x, y = ((nodes[1:] + nodes[:-1]) / 2 for nodes in (grid.x_mm, grid.y_mm))
        step = grid.largest_edge_mm
        radius, by_radius = _stepped_radius(journal.bore_radius_mm, step)
        rest, slope = smooth_step(np.hypot(x[:, None], y[None, :] - axis) - radius, step)
        bored = np.arange(grid.cells[2]) < end if main else np.arange(grid.cells[2]) >= start
        return np.where(bored, rest[:, :, None], 1.0), np.where(
            bored, -slope[:, :, None] * by_radius / 2, 0.0
        )


def _stepped_radius(radius_mm: float, step_mm: float) -> tuple[float, float]:
    """Return the step's radius at which a hole takes its true area, and its derivative by the hole's radius.

    A step of half-width h about a circle of radius r takes pi (r2 + 0.2 h2).
    """
    square, more = radius_mm**2, 0.2 * step_mm**2
    far = np.sqrt(square + more)
    return float(square / far), float(radius_mm * (2 - square / far**2) / far)
