"""A feature as the re-model fits it: parameters, signed distance, constraints, tables."""

from __future__ import annotations

import functools
from abc import ABC, abstractmethod
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any, ClassVar, Protocol, Self

import numpy as np

from cranktopo.base.arrays import Array, Mask
from cranktopo.throw.bevel_arc import BevelArc
from cranktopo.throw.feature import Face, Feature, ThrowView
from cranktopo.throw.manufacturing_limits import ManufacturingLimits

Frame = tuple[float, float, float]
"""Of an outline: least and largest y, largest half-width, mm."""
Rule = tuple[str, Any]
"""A manufacturing rule: its name in plain English with its value, and what is kept where it is <= 0.

That is a number, or an array with one for each of many places.
"""
Axes = tuple[Array, Array, Array]
"""x, y and z of the cell centres, mm; x > 0 only."""
_RESOLUTION_MM = 0.01
"""Parameters are rounded to this in the scene; the constraints keep as much clear."""
CLEAR_MM = 2 * _RESOLUTION_MM
JOURNALS = ("main journal", "crankpin")
"""Names of the journals in a sentence, in the order of the throw."""
LEAST_MM = 3.0
"""Least size of a pocket."""
SIZE_OVER_CORNER = 2.2
"""Least size of a pocket over the radius of its corners."""
_STEP = 1e-6
"""Step of the derivatives by the parameters, mm or degrees."""


@dataclass(frozen=True)
class Named:
    """Values of a feature's parameters by name, mm or degrees; 0 for those that its kind has not."""

    x: Any = 0.0
    y: Any = 0.0
    length: Any = 0.0
    height: Any = 0.0
    size_x: Any = 0.0
    size_y: Any = 0.0
    diameter: Any = 0.0
    depth: Any = 0.0
    floor: Any = 0.0
    offset: Any = 0.0
    crown: Any = 0.0
    draft: Any = 0.0


class BodyCells(Protocol):
    """Cells that the extracted body fills; x > 0 only."""

    @property
    def x_mm(self) -> Array:
        """Cell centres across the throw."""

    @property
    def y_mm(self) -> Array:
        """Cell centres along the throw."""

    @property
    def cell_mm(self) -> Array:
        """Edges of a cell, (3,)."""

    @property
    def solid(self) -> Mask:
        """Cells that are filled for the most part, (nx, ny, nz)."""


class Region(Protocol):
    """A connected region that the body lacks and the web has, its part at x >= 0."""

    @property
    def kind(self) -> str:
        """`window` where it is open at both web faces."""

    @property
    def volume_mm3(self) -> float:
        """Volume on both sides of x = 0."""

    @property
    def low_mm(self) -> tuple[float, float, float]:
        """Least corner of its bounding box."""

    @property
    def high_mm(self) -> tuple[float, float, float]:
        """Largest corner of its bounding box."""

    @property
    def pair(self) -> bool:
        """It does not reach x = 0."""

    @property
    def face(self) -> Face | None:
        """The only web face at which it is open."""


@dataclass(frozen=True)
class Surroundings:
    """Surroundings of a feature for its constraints; points (n, 2) are of the outline's right half."""

    scene: ThrowView
    limits: ManufacturingLimits
    points_mm: Array
    arcs: tuple[BevelArc, ...] = ()

    @property
    def widest_mm(self) -> float:
        """Largest half-width of the outline."""
        return float(self.points_mm[:, 0].max())

    @property
    def wall_mm(self) -> float:
        """Least wall, with what rounding may take."""
        return self.limits.min_wall_mm + CLEAR_MM


class FittedFeature(ABC):
    """A kind of feature with free parameters; compared by its label."""

    table: ClassVar[str] = "pocket"
    """Key of the web under which its tables go."""
    follows_ends: ClassVar[bool] = False
    """True if its surface moves with the ends of the outline."""

    @property
    @abstractmethod
    def label(self) -> str:
        """Short name, such as `bevel-journal` or `cylinder-through-pair`."""

    @property
    @abstractmethod
    def title(self) -> str:
        """Its name in a sentence, such as `journal bevel`."""

    @property
    def rough_on_cells(self) -> bool:
        """Tell whether cells overrate webs with it so far that only elements can say what pays beside it."""
        return False

    @property
    @abstractmethod
    def names(self) -> tuple[str, ...]:
        """Names of its parameters: mm, draft in degrees."""

    def named(self, values: Array) -> Named:
        """Return values in the order of `names`, each by its name."""
        return Named(**dict(zip(self.names, values, strict=True)))

    @abstractmethod
    def bounds(self, scene: ThrowView, limits: ManufacturingLimits) -> list[tuple[float, float]]:
        """Lower and upper bound of each parameter."""

    def possible(self, scene: ThrowView) -> bool:
        """Tell whether the web of a scene may have one, whatever its values."""
        return True

    def manufactured(self, limits: ManufacturingLimits) -> Self | None:
        """Return the kind with draft and corners of a workshop; None where it cannot open that way."""
        return self

    @abstractmethod
    def faces_mm(self, named: Named, ends: Array, at: Axes, web_z_mm: tuple[float, float]) -> list[Array]:
        """Signed distance of points from each of its faces, positive on the side of the material.

        A point is in the material where the largest is positive; a rounded edge, which is the last, is the
        whole tube. Each is smooth near its face. The ends are the least and largest y of the outline, mm; the
        points have x > 0 and are broadcastable.
        """

    def seams_mm(self, named: Named, at: Axes, web_z_mm: tuple[float, float]) -> list[Array]:
        """Return distances from surfaces that cross its last face where that leaves others as a tangent."""
        return []

    def outside_mm(self, named: Named, ends: Array, at: Axes, web_z_mm: tuple[float, float]) -> Array:
        """Signed distance of points from all of it, positive on the side of the material."""
        return functools.reduce(np.maximum, self.faces_mm(named, ends, at, web_z_mm))

    @abstractmethod
    def rules(self, named: Named, around: Surroundings) -> Iterator[Rule]:
        """Walls, shoulders and access of a tool, mm."""

    @abstractmethod
    def tables(self, named: Named, frame_mm: Frame) -> list[dict[str, Any]]:
        """Its tables in the scene."""

    @classmethod
    @abstractmethod
    def read(cls, table: Feature, pair: bool, frame_mm: Frame) -> tuple[Self, Array] | None:
        """Return the kind and values whose `tables` a table of the scene is; None for one of another kind.

        Args:
            pair: whether its mirror image is there as well; then it is the one at x > 0.
        """

    def box_mm(self, named: Named, around: Surroundings) -> Array | None:
        """Corners of the box around it at x > 0, (2, 3), z from the journal face; None if no wall is kept."""
        return None

    def arc(self, named: Named, ends: Array) -> BevelArc | None:
        """Return the end bevel that it is; None for others."""
        return None

    def field_mm(self, values: Array, ends: Array, axes: Axes, web_z_mm: tuple[float, float]) -> Array:
        """Signed distance of the cells for values in the order of `names`, positive in material."""
        at = axes[0][:, None, None], axes[1][None, :, None], axes[2][None, None, :]
        return self.outside_mm(self.named(values), ends, at, web_z_mm)

    def vjp(
        self, values: Array, ends: Array, axes: Axes, web_z_mm: tuple[float, float], weight: Array
    ) -> tuple[Array, Array]:
        """Derivative of sum(weight * field_mm) by the values and by the ends, by central differences.

        Only cells near its surface have a weight, and a field is asked for there alone.
        """
        both, places = np.concatenate([values, ends]), np.nonzero(weight)
        at, weights = (axes[0][places[0]], axes[1][places[1]], axes[2][places[2]]), weight[places]
        count, slopes = len(both) if self.follows_ends else len(values), np.zeros(len(both))
        for i, step in enumerate(_STEP * np.eye(len(both))[:count]):
            above, below = (
                self.outside_mm(self.named(shifted[: len(values)]), shifted[len(values) :], at, web_z_mm)
                for shifted in (both + step, both - step)
            )
            slopes[i] = float((weights * (above - below)).sum()) / (2 * _STEP)
        return slopes[: len(values)], slopes[len(values) :]


class FittedToSections(FittedFeature):
    """A kind whose initial values are read from cross-sections of the body."""

    @abstractmethod
    def guess(self, cells: BodyCells, scene: ThrowView, limits: ManufacturingLimits) -> Array | None:
        """Initial values; None where the body shows no such feature."""


def wall_rule(between: str, least_mm: float) -> str:
    """Name of the rule that keeps a wall."""
    return f"least wall {between}, {least_mm:.3g} mm"


def shoulder_rule(journal: str) -> str:
    """Name of the rule that keeps a flat shoulder beyond a journal's fillet."""
    return f"shoulder beside the fillet of the {journal}"


def depth_mm(face: str, z_mm: Any, web_z_mm: tuple[float, float]) -> Any:
    """Depth of heights below a web face."""
    return z_mm - web_z_mm[0] if face == "journal" else web_z_mm[1] - z_mm
