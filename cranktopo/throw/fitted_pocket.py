"""The fits of pockets from a web face: walls, rules, tables and initial values."""

from __future__ import annotations

import math
from abc import abstractmethod
from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Any, ClassVar, Literal, Self

import numpy as np
from typing_extensions import override

from cranktopo.base.arrays import Array
from cranktopo.throw.face_pocket import FacePocket
from cranktopo.throw.feature import Feature, ThrowView, least_shoulder_mm
from cranktopo.throw.fitted import (
    CLEAR_MM,
    JOURNALS,
    LEAST_MM,
    SIZE_OVER_CORNER,
    Axes,
    Frame,
    Named,
    Region,
    Rule,
    Surroundings,
    depth_mm,
    shoulder_rule,
    wall_rule,
)
from cranktopo.throw.fitted_floor import FittedFloor
from cranktopo.throw.floor_rounding import FloorRounding, slope_of
from cranktopo.throw.hole import FACES
from cranktopo.throw.manufacturing_limits import ManufacturingLimits
from cranktopo.throw.tapered_hole import rounded_gap_mm

_TINY = 1e-12


_LEAST_DEPTH_MM = 1.0
_GIVEN = ("draft_deg", "corner_radius_mm", "floor_radius_mm")


@dataclass(frozen=True)
class FittedPocket(FittedFloor):
    """A pocket parallel to the crank axis: the face it starts from, whether there are two.

    Sizes and the radius of its corners are those of its floor; draft and radii are the workshop's, not free.
    """

    face: Literal["journal", "pin", "through"]
    pair: bool = False
    draft_deg: float = 0.0
    corner_radius_mm: float = 0.0
    floor_radius_mm: float = 0.0
    shape: ClassVar[str]
    sizes: ClassVar[tuple[str, ...]]
    """Names of its size across and along the throw."""

    @classmethod
    @abstractmethod
    def in_region(cls, region: Region) -> Self | None:
        """Return the pocket that could take out a region; None if the region does not fit the kind."""

    @abstractmethod
    def walls_mm(self, named: Named, across: Array, along: Array, growth: Any) -> list[Array]:
        """Signed distance in a section from each wall, negative in the pocket; from its centre.

        The section is wider than the floor by `growth` all around.
        """

    @abstractmethod
    def gap_mm(self, named: Named, x_mm: Any, y_mm: Any) -> Any:
        """Distance of points of the face from the pocket's mouth, negative inside."""

    def mouth_mm(self, named: Named) -> Any:
        """Return by how much its mouth is wider than its floor, all around."""
        return slope_of(self.draft_deg) * named.depth

    @override
    def slope(self, named: Named) -> float:
        return slope_of(self.draft_deg)

    @property
    @override
    def label(self) -> str:
        return f"{self.shape}-{self.face}{'-pair' if self.pair else ''}"

    @property
    @override
    def title(self) -> str:
        where = "through the web" if self.face == "through" else f"of the {self.face} face"
        return f"{self.shape} pocket {where}"

    @property
    @override
    def names(self) -> tuple[str, ...]:
        depth = () if self.face == "through" else ("depth",)
        return (*(("x", "y") if self.pair else ("y",)), *self.sizes, *depth)

    @override
    def bounds(self, scene: ThrowView, limits: ManufacturingLimits) -> list[tuple[float, float]]:
        far = 4 * scene.throw.radius_mm
        deepest = limits.deepest_mm(scene.web.thickness_mm)
        rounding = FloorRounding(self.floor_radius_mm, slope_of(self.draft_deg))
        shallowest = max(_LEAST_DEPTH_MM, rounding.top_mm + CLEAR_MM)
        ranges = {"x": (LEAST_MM / 2, far), "y": (-far, far), "depth": (shallowest, deepest)}
        smallest = max(LEAST_MM, SIZE_OVER_CORNER * max(self.corner_radius_mm, rounding.foot_mm))
        return [ranges.get(name, (smallest, far)) for name in self.names]

    @override
    def manufactured(self, limits: ManufacturingLimits) -> Self | None:
        shop = limits.workshop
        if shop.opens == "sides" or (self.face == "through" and shop.draft_deg):
            return None
        floor = 0.0 if self.face == "through" else max(self.floor_radius_mm, shop.floor_radius_mm)
        return replace(self, draft_deg=max(self.draft_deg, shop.draft_deg), floor_radius_mm=floor)

    @override
    def sharp_mm(self, named: Named, at: Axes, web_z_mm: tuple[float, float]) -> list[Array]:
        across, along = at[0] - named.x, at[1] - named.y
        if self.face == "through":
            return self.walls_mm(named, across, along, 0.0)
        floor = self.floor_mm(named, at, web_z_mm)
        if self.draft_deg:
            walls = self.walls_mm(named, across, along, -slope_of(self.draft_deg) * floor)
            steep = math.cos(math.radians(self.draft_deg))
            return [*(steep * wall for wall in walls), floor]
        return [*self.walls_mm(named, across, along, 0.0), floor]

    @override
    def floor_mm(self, named: Named, at: Axes, web_z_mm: tuple[float, float]) -> Array:
        return np.asarray(depth_mm(self.face, at[2], web_z_mm) - named.depth)

    @override
    def growth_mm(self, named: Named, at: Axes, web_z_mm: tuple[float, float]) -> Array:
        (growth,) = self.walls_mm(named, at[0] - named.x, at[1] - named.y, 0.0)
        return growth

    def rules(self, named: Named, around: Surroundings) -> Iterator[Rule]:
        """Walls toward bores and the outline, between twins, and journals out of the tool's way."""
        wall, least, throw = around.wall_mm, around.limits.min_wall_mm, around.scene.throw
        outline = self.gap_mm(named, around.points_mm[:, 0], around.points_mm[:, 1]).min()
        yield wall_rule(f"between the {self.title} and the outline", least), wall - outline
        weight = around.scene.web.counterweight
        if weight is not None and not weight.bolted:
            edge = self.gap_mm(named, *weight.edge_mm(around.scene)).min()
            yield wall_rule(f"between the {self.title} and the counterweight's edge", least), wall - edge
        if self.pair:
            between = wall_rule(f"between the {self.title} and its twin", least)
            yield between, wall / 2 + getattr(named, self.sizes[0]) / 2 + self.mouth_mm(named) - named.x
        for face, name, (journal, axis) in zip(FACES, JOURNALS, throw.journals, strict=True):
            gap = self.gap_mm(named, 0.0, axis)
            beside = wall_rule(f"between the {self.title} and the bore of the {name}", least)
            yield beside, journal.bore_radius_mm + wall - gap
            if self.face in (face, "through"):
                yield shoulder_rule(name), journal.clear_radius_mm + least_shoulder_mm(throw) - gap
            elif journal.recess_mm:
                under = named.depth + journal.recess_mm + wall - around.scene.web.thickness_mm
                away = journal.clear_radius_mm + wall - gap
                below = wall_rule(f"between the {self.title} and the recess of the {name}", least)
                yield below, np.minimum(under, away)

    @override
    def box_mm(self, named: Named, around: Surroundings) -> Array:
        thickness = around.scene.web.thickness_mm
        centre = np.array([named.x, named.y])
        half = np.array([getattr(named, self.sizes[k]) for k in (0, -1)]) / 2 + self.mouth_mm(named)
        depth = thickness if self.face == "through" else named.depth
        low = thickness - depth if self.face == "pin" else 0.0
        return np.array([[*(centre - half), low], [*(centre + half), low + depth]])

    @override
    def tables(self, named: Named, frame_mm: Frame) -> list[dict[str, Any]]:
        values = {f"{name}_mm": getattr(named, name) for name in self.names}
        table = {"shape": self.shape, "face": self.face, **values, **self._process_values}
        if not self.pair:
            return [{**table, "x_mm": 0.0}]
        return [{**table, "x_mm": side * named.x} for side in (1, -1)]

    @property
    def _process_values(self) -> dict[str, float]:
        """Draft and radii where there are some, by their keys in a table."""
        return {key: value for key in _GIVEN if (value := getattr(self, key))}

    @classmethod
    @override
    def read(cls, table: Feature, pair: bool, frame_mm: Frame) -> tuple[Self, Array] | None:
        if not isinstance(table, FacePocket) or table.shape != cls.shape:
            return None
        process_values = {name: getattr(table, name, 0.0) for name in _GIVEN}
        part = cls(table.face, pair, **process_values)
        return part, np.array([getattr(table, f"{name}_mm") for name in part.names])

    def guess(self, region: Region, web_z_mm: tuple[float, float]) -> Array:
        """Initial values of a pocket that fills a region of the volume of its bounding box."""
        low, high = np.array(region.low_mm), np.array(region.high_mm)
        centre, size = (low + high) / 2, high - low
        area = region.volume_mm3 / 2 / size[2] * (1.0 if self.pair else 2.0)
        across = size[0] if self.pair else 2 * high[0]
        values = [*([centre[0]] if self.pair else []), centre[1], *self.size_guess(area, across, size[1])]
        depth = (high[2] - web_z_mm[0]) if self.face == "journal" else (web_z_mm[1] - low[2])
        return np.array(values if self.face == "through" else [*values, depth])

    @abstractmethod
    def size_guess(self, area_mm2: float, across_mm: float, along_mm: float) -> list[float]:
        """Initial sizes from the mean section of a region and the size of its bounding box."""


class FittedBox(FittedPocket):
    """A box pocket of the re-model."""

    shape: ClassVar[str] = "box"
    sizes: ClassVar[tuple[str, ...]] = ("size_x", "size_y")

    @classmethod
    @override
    def in_region(cls, region: Region) -> Self | None:
        return None if region.kind == "window" or region.face is None else cls(region.face, region.pair)

    @override
    def manufactured(self, limits: ManufacturingLimits) -> Self | None:
        drafted = super().manufactured(limits)
        corner = max(self.corner_radius_mm, limits.workshop.radius_mm, limits.workshop.floor_radius_mm)
        return drafted and replace(drafted, corner_radius_mm=corner)

    @override
    def walls_mm(self, named: Named, across: Array, along: Array, growth: Any) -> list[Array]:
        over = np.abs(across) - named.size_x / 2, np.abs(along) - named.size_y / 2
        if not self.corner_radius_mm:
            return [side - growth for side in over]
        return [rounded_gap_mm(*over, self.corner_radius_mm) - growth]

    @override
    def gap_mm(self, named: Named, x_mm: Any, y_mm: Any) -> Any:
        growth = self.mouth_mm(named)
        over_x = np.abs(x_mm - named.x) - named.size_x / 2 - growth
        over_y = np.abs(y_mm - named.y) - named.size_y / 2 - growth
        corner = self.corner_radius_mm + growth if self.corner_radius_mm else 0.0
        return rounded_gap_mm(over_x, over_y, corner)

    @override
    def size_guess(self, area_mm2: float, across_mm: float, along_mm: float) -> list[float]:
        return [across_mm, along_mm]


class FittedCylinder(FittedPocket):
    """A cylinder pocket of the re-model."""

    shape: ClassVar[str] = "cylinder"
    sizes: ClassVar[tuple[str, ...]] = ("diameter",)

    @classmethod
    @override
    def in_region(cls, region: Region) -> Self | None:
        if region.kind == "window":
            return cls("through", region.pair)
        return None if region.face is None else cls(region.face, region.pair)

    @override
    def walls_mm(self, named: Named, across: Array, along: Array, growth: Any) -> list[Array]:
        return [np.sqrt(across**2 + along**2 + _TINY) - named.diameter / 2 - growth]

    @override
    def gap_mm(self, named: Named, x_mm: Any, y_mm: Any) -> Any:
        across, along = x_mm - named.x, y_mm - named.y
        return np.sqrt(across**2 + along**2 + _TINY) - named.diameter / 2 - self.mouth_mm(named)

    @override
    def size_guess(self, area_mm2: float, across_mm: float, along_mm: float) -> list[float]:
        return [2 * float(np.sqrt(area_mm2 / np.pi))]
