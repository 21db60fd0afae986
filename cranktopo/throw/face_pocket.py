"""Pockets from a web face, their axis parallel to the crank axis: round and rectangular."""

from __future__ import annotations

from abc import abstractmethod
from typing import Literal, Self

from pydantic import Field
from typing_extensions import override

from cranktopo.base.table import Length, LengthOrZero, Place
from cranktopo.throw.feature import Body, Feature, ThrowView
from cranktopo.throw.floor_rounding import FloorRounding, check_floor_corners, check_floor_radius, slope_of
from cranktopo.throw.hole import (
    FACES,
    RectangularHole,
    RoundHole,
    check_corners,
    check_cut,
    check_depth,
    check_open,
    depth_range_mm,
)
from cranktopo.throw.primitives import Circle, FeatureDrawing, Polyline, number_lines
from cranktopo.throw.tapered_hole import TaperedHole

_LARGEST_DRAFT_DEG = 45.0


class FacePocket(Feature):
    """Pocket with its axis parallel to the crank axis; a kind names its shapes, faces and sizes."""

    shape: str
    face: Literal["journal", "pin", "through"]
    x_mm: Place = 0.0
    """Centre across the throw, from the crank axis."""

    @override
    def check_in_web(self, scene: ThrowView, key: str) -> None:
        for body in self.bodies(scene, key):
            check_cut(scene, body)
            check_open(scene, body, FACES if self.face == "through" else (self.face,))

    @abstractmethod
    def _edges(self, scene: ThrowView) -> tuple[Circle | Polyline, ...]:
        """Outline on the face, and that of its floor where it is smaller."""

    @override
    def drawing(self, scene: ThrowView) -> FeatureDrawing:
        numbers = self.model_dump(exclude={"shape", "face"}, exclude_none=True)
        rounded = ("draft_deg", "corner_radius_mm", "floor_radius_mm")
        unused = [name for name in rounded if numbers.get(name) == 0]
        dimensions = {name: value for name, value in numbers.items() if name not in unused}
        lines = number_lines(f"POCKET {self.shape}, {self.face}", dimensions)
        return FeatureDrawing(front=self._edges(scene), lines=lines, places=((self.x_mm, numbers["y_mm"]),))

    @override
    def mirrored(self) -> Self:
        return self.model_copy(update={"x_mm": -self.x_mm + 0.0})


class BoxPocket(FacePocket):
    """Box-shaped pocket cut from one web face; its sizes are those of its floor, its walls open outward."""

    shape: Literal["box"]
    face: Literal["journal", "pin"] = Field(examples=["pin"])
    """Web face that it starts from."""
    y_mm: Place = Field(examples=[0.0])
    """Centre along the throw, from the crank axis toward the crankpin."""
    size_x_mm: Length = Field(examples=[10.0])
    """Size across the throw."""
    size_y_mm: Length = Field(examples=[10.0])
    """Size along the throw."""
    depth_mm: Length = Field(examples=[4.0])
    """Depth below the face."""
    corner_radius_mm: LengthOrZero = 0.0
    """Radius of its corners at the floor; 0 = sharp."""
    draft_deg: float = Field(default=0.0, ge=0, le=_LARGEST_DRAFT_DEG)
    """Draft angle: the walls open outward by it."""
    floor_radius_mm: LengthOrZero = 0.0
    """Radius of the edge of its floor; 0 = sharp."""

    @override
    def bodies(self, scene: ThrowView, key: str) -> tuple[Body, ...]:
        half_x, half_y = self.size_x_mm / 2, self.size_y_mm / 2
        if self.draft_deg or self.corner_radius_mm or self.floor_radius_mm:
            return (self._tapered(scene, key),)
        low, high = (self.x_mm - half_x, self.y_mm - half_y), (self.x_mm + half_x, self.y_mm + half_y)
        return (RectangularHole(key, depth_range_mm(scene, self.face, self.depth_mm), low, high),)

    @override
    def check_alone(self, scene: ThrowView, key: str) -> None:
        check_depth(scene, f"{key}.depth_mm", self.depth_mm)
        sizes = self.size_x_mm, self.size_y_mm
        check_corners(scene, f"{key}.corner_radius_mm", self.corner_radius_mm, *sizes)
        rounding = FloorRounding(self.floor_radius_mm, slope_of(self.draft_deg))
        check_floor_radius(scene, key, rounding, self.depth_mm, *sizes)
        check_floor_corners(scene, key, rounding, self.corner_radius_mm)

    def _tapered(self, scene: ThrowView, key: str) -> TaperedHole:
        corner = (self.size_x_mm / 2, self.size_y_mm / 2, self.corner_radius_mm)
        z_mm = depth_range_mm(scene, self.face, self.depth_mm)
        floor = z_mm[self.face == "journal"]
        slope = slope_of(self.draft_deg)
        return TaperedHole(key, z_mm, floor, self.x_mm, self.y_mm, *corner, slope, self.floor_radius_mm)

    @override
    def _edges(self, scene: ThrowView) -> tuple[Polyline, ...]:
        hidden = self.face == "journal"
        return tuple(Polyline(edge, hidden) for edge in self._tapered(scene, "").edges_mm())


class CylinderPocket(FacePocket):
    """Cylindrical pocket with its axis parallel to the crank axis."""

    shape: Literal["cylinder"]
    face: Literal["through", "journal", "pin"] = "through"
    """Web face that it starts from; `through` = a hole through the web."""
    y_mm: Place = Field(examples=[24.0])
    """Centre along the throw, from the crank axis toward the crankpin."""
    diameter_mm: Length = Field(examples=[6.0])
    """Diameter."""
    depth_mm: Length | None = Field(default=None, examples=[5.0])
    """Depth below the face; needed unless it goes through."""
    draft_deg: float = Field(default=0.0, ge=0, le=_LARGEST_DRAFT_DEG)
    """Draft angle: its wall opens outward by it, the diameter is that of the floor."""
    floor_radius_mm: LengthOrZero = 0.0
    """Radius of the edge of its floor; 0 = sharp."""

    @override
    def bodies(self, scene: ThrowView, key: str) -> tuple[Body, ...]:
        z_mm = depth_range_mm(scene, self.face, self.depth_mm)
        if self.draft_deg or self.floor_radius_mm:
            at, radius = (z_mm[self.face == "journal"], self.x_mm, self.y_mm), self.diameter_mm / 2
            edges = slope_of(self.draft_deg), self.floor_radius_mm
            return (TaperedHole(key, z_mm, *at, *(radius,) * 3, *edges),)
        return (RoundHole(key, z_mm, self.x_mm, self.y_mm, self.diameter_mm / 2),)

    @override
    def check_alone(self, scene: ThrowView, key: str) -> None:
        if (self.depth_mm is None) != (self.face == "through"):
            if self.depth_mm is None:
                allowed, hint = f"is missing with face = {self.face!r}", "Give it, or face = 'through'."
            else:
                allowed, hint = "has no meaning with face = 'through'", "Remove it, or name another face."
            raise scene.invalid(f"{key}.depth_mm", allowed, hint)
        for name in ("draft_deg", "floor_radius_mm") if self.face == "through" else ():
            if getattr(self, name):
                allowed = "has no meaning with face = 'through'"
                raise scene.invalid(f"{key}.{name}", allowed, "Remove it, or name another face.")
        if self.depth_mm is not None:
            check_depth(scene, f"{key}.depth_mm", self.depth_mm)
            rounding = FloorRounding(self.floor_radius_mm, slope_of(self.draft_deg))
            check_floor_radius(scene, key, rounding, self.depth_mm)
            if self.diameter_mm / 2 < rounding.foot_mm:
                allowed = f"must be at most that of the floor, {self.diameter_mm / 2:g} mm"
                raise scene.invalid(f"{key}.floor_radius_mm", allowed)

    @override
    def _edges(self, scene: ThrowView) -> tuple[Circle, ...]:
        hidden, at, radius = self.face == "journal", (self.x_mm, self.y_mm), self.diameter_mm / 2
        floor = Circle(at, radius, hidden, f"⌀{self.diameter_mm:g}")
        wider = slope_of(self.draft_deg) * (self.depth_mm or 0.0)
        return (floor, Circle(at, radius + wider, hidden)) if wider else (floor,)
