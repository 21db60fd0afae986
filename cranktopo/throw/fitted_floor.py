"""Fits of pockets with one floor, whose edge may be round."""

from __future__ import annotations

from abc import abstractmethod

from typing_extensions import override

from cranktopo.base.arrays import Array
from cranktopo.throw.fitted import Axes, FittedFeature, Named
from cranktopo.throw.floor_rounding import FloorRounding


class FittedFloor(FittedFeature):
    """A kind with a floor and walls around it; the tube of the round edge between them is its last face."""

    floor_radius_mm: float

    @abstractmethod
    def slope(self, named: Named) -> float:
        """Return by how much its walls open per mm of height."""

    @abstractmethod
    def sharp_mm(self, named: Named, at: Axes, web_z_mm: tuple[float, float]) -> list[Array]:
        """Signed distances from its floor and its walls, as of `faces_mm`."""

    @abstractmethod
    def floor_mm(self, named: Named, at: Axes, web_z_mm: tuple[float, float]) -> Array:
        """Distance of points below its floor, negative above it."""

    @abstractmethod
    def growth_mm(self, named: Named, at: Axes, web_z_mm: tuple[float, float]) -> Array:
        """Distance in its section from where the one wall would meet the floor, negative in the pocket."""

    def rounding(self, named: Named) -> FloorRounding:
        """Return the round edge of its floor."""
        return FloorRounding(self.floor_radius_mm, self.slope(named))

    @override
    def faces_mm(self, named: Named, ends: Array, at: Axes, web_z_mm: tuple[float, float]) -> list[Array]:
        plain = self.sharp_mm(named, at, web_z_mm)
        if not self.floor_radius_mm:
            return plain
        return [*plain, self.rounding(named).tube_mm(*self._edge_mm(named, at, web_z_mm))]

    @override
    def seams_mm(self, named: Named, at: Axes, web_z_mm: tuple[float, float]) -> list[Array]:
        if not self.floor_radius_mm:
            return []
        return self.rounding(named).seams_mm(*self._edge_mm(named, at, web_z_mm))

    @override
    def outside_mm(self, named: Named, ends: Array, at: Axes, web_z_mm: tuple[float, float]) -> Array:
        if not self.floor_radius_mm:
            return super().outside_mm(named, ends, at, web_z_mm)
        plain = self.sharp_mm(named, at, web_z_mm)
        return self.rounding(named).outside_mm(plain, *self._edge_mm(named, at, web_z_mm))

    def _edge_mm(self, named: Named, at: Axes, web_z_mm: tuple[float, float]) -> tuple[Array, Array]:
        return self.growth_mm(named, at, web_z_mm), self.floor_mm(named, at, web_z_mm)
