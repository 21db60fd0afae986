"""The fillet of the counterweight of a parameter vector: it follows outline and angle, with derivatives."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from cranktopo.base.arrays import Array
from cranktopo.design.schema import Scene
from cranktopo.numerics.optimisers.gradient_search import central_difference
from cranktopo.tasks.refit.dimensions import scene_at
from cranktopo.tasks.refit.family import Layout, flank_of
from cranktopo.tasks.refit.model_fill import between_mm
from cranktopo.throw.counterweight.sector import Sector
from cranktopo.throw.counterweight.tangent_circle import (
    OutlineSection,
    TangentCircle,
    flank_directions,
    tangent_circle,
)
from cranktopo.throw.fitted import CLEAR_MM, Axes, Rule
from cranktopo.throw.flank import flank_half_width_mm

_STEP = 1e-6
"""Step of central differences of the half-width by its stations, mm."""
_DEPTH = 4.0
"""How far behind its arc the fillet's distance counts, over the radius; web and sector go on."""
FITS = "the flank of the counterweight holds its fillet"


@dataclass(frozen=True)
class MovedFillet:
    """The fillet at some values of the parameters.

    Attributes:
        scene: with the dimensions of these values.
    """

    scene: Scene
    layout: Layout
    values: Array

    @cached_property
    def circle(self) -> TangentCircle:
        """Its circle, on a flank without end."""
        ends = float(self.values[0]), float(self.values[1])
        outline = OutlineSection(lambda y: self._half_width_mm(self.values, y), ends)
        return tangent_circle(outline, self.sector.half_angle, self._radius_mm)

    @cached_property
    def sector(self) -> Sector:
        """The counterweight without it."""
        assert self.scene.web.counterweight is not None
        return self.scene.web.counterweight.sector(self.scene)

    @cached_property
    def gradients(self) -> Array:
        """Derivatives of its centre by the parameters, (2, parameters), mm per mm or degree.

        It stays its radius away from the flank, which turns, and from the outline, which moves at the place
        that it touches by its half-width there.
        """
        circle = self.circle
        _, across = flank_directions(self.sector.half_angle)
        normal = (np.array(circle.centre) - circle.on_outline) / circle.radius_mm
        moved = np.zeros((2, len(self.values)))
        if "counterweight_angle" in self.layout.dimensions:
            turned = self.layout.names.index("counterweight_angle")
            moved[0, turned] = circle.reach_mm * math.radians(1.0)
        at = np.array([circle.on_outline[1]])
        stations = range(self.layout.stations)
        by_values = central_difference(lambda v: self._half_width_mm(v, at)[0], self.values, _STEP, stations)
        moved[1] += normal[0] * by_values
        return np.asarray(np.linalg.solve(np.stack([across, normal]), moved))

    @property
    def rule(self) -> Rule:
        """It ends before the flank does."""
        return FITS, np.asarray(self.circle.reach_mm + CLEAR_MM - self.sector.radius_mm)

    @property
    def rule_gradients(self) -> Array:
        """Derivatives of the rule's value by the parameters, (parameters,)."""
        # The centre's place along the flank; as the flank turns about the crank axis, that across it counts.
        along, _ = flank_directions(self.sector.half_angle)
        result = along @ self.gradients
        for name, change in (
            ("counterweight_angle", self._radius_mm * math.radians(1.0)),
            ("counterweight_radius", -1.0),
        ):
            if name in self.layout.dimensions:
                result[self.layout.names.index(name)] += change
        return result

    def inside_mm(self, axes: Axes) -> Array:
        """Return signed distance of cells where the arc bounds the web, (nx, ny, nz), mm; -inf elsewhere."""
        x, y = axes[0][:, None], axes[1][None, :]
        off = self.circle.off_mm(x, y)
        flat = np.minimum(np.minimum(off, _DEPTH * self._radius_mm - off), self.sector.below_rim_mm(x, y))
        flat = np.where(self.circle.behind(x, y), flat, -np.inf)[:, :, None]
        return np.minimum(flat, between_mm(self.scene, self.sector, axes[2]))

    def vjp(self, axes: Axes, weight: Array) -> Array:
        """Return derivative of sum(weight * inside_mm) by the parameters, where the arc is the nearest."""
        x, y = axes[0][:, None], axes[1][None, :]
        off = self.circle.off_mm(x, y)[:, :, None]
        chosen = np.where(self.inside_mm(axes) == off, weight, 0.0).sum(axis=2)
        out = self.circle.outward(x, y)
        return np.asarray(-np.array([(chosen * part).sum() for part in out]) @ self.gradients)

    @property
    def _radius_mm(self) -> float:
        weight = self.scene.web.counterweight
        assert weight is not None
        assert weight.fillet_mm is not None
        return weight.fillet_mm

    def _half_width_mm(self, values: Array, y_mm: Array) -> Array:
        return flank_half_width_mm(flank_of(self.layout, values), y_mm)


def moved_fillet(scene: Scene, layout: Layout, values: Array) -> MovedFillet | None:
    """Return the fillet of a scene's counterweight; None without one.

    Args:
        scene: whose dimensions the values change.
    """
    weight = scene.web.counterweight
    if weight is None or weight.fillet_mm is None:
        return None
    return MovedFillet(scene_at(scene, layout, values), layout, values)
