"""Parts of features, as data: solids for the CAD kernel, strokes for the drawing; all in mm."""

from __future__ import annotations

from dataclasses import dataclass

Point = tuple[float, float, float]
_FlatPoint = tuple[float, float]


@dataclass(frozen=True)
class LineSegment:
    """A straight edge."""

    start: Point
    end: Point


@dataclass(frozen=True)
class Arc:
    """A circular edge of less than half a turn."""

    start: Point
    centre: Point
    end: Point


@dataclass(frozen=True)
class Bezier:
    """A Bezier curve through its first and last point."""

    points: tuple[Point, ...]


@dataclass(frozen=True)
class EllipseCurve:
    """A whole ellipse in a plane of constant z, its axes along x and y."""

    centre: Point
    half_x: float
    half_y: float


@dataclass(frozen=True)
class Rectangle:
    """A whole rectangle in a plane of constant z, with rounded corners."""

    low: Point
    size_x: float
    size_y: float
    corner_radius: float


Curve = LineSegment | Arc | Bezier | EllipseCurve | Rectangle


@dataclass(frozen=True)
class Cylinder:
    """A cylinder about any axis: middle of its first end, vector to that of the other, radius.

    The seam of its surface lies toward the end of the crank that `seam` is the sign of; 0 leaves it to the
    CAD kernel.
    """

    start: Point
    axis: Point
    radius: float
    seam: float = 0.0


@dataclass(frozen=True)
class Box:
    """A box along the axes: its least corner and its edges."""

    low: Point
    size: Point


@dataclass(frozen=True)
class Frustum:
    """A body between two quadrilaterals with corners in the same order; rectangles may have round corners.

    The edge of the floor may be rounded; without round corners along its first and its third side alone.
    """

    floor: tuple[Point, ...]
    mouth: tuple[Point, ...]
    corner_radii: tuple[float, float] = (0.0, 0.0)
    floor_radius: float = 0.0


@dataclass(frozen=True)
class Extrusion:
    """A closed plane contour, swept along a vector."""

    contour: tuple[Curve, ...]
    path: Point


@dataclass(frozen=True)
class Revolution:
    """A closed plane contour, turned once about an axis along z through a point."""

    contour: tuple[Curve, ...]
    on_axis: Point


@dataclass(frozen=True)
class Loft:
    """Straight lines between two closed plane contours of curves in the same order."""

    near: tuple[Curve, ...]
    far: tuple[Curve, ...]


@dataclass(frozen=True)
class RoundedOutlet:
    """Rounding of the edge at which a hole leaves a cylinder along the crank axis.

    The hole's axis meets the cylinder `at` a point and leaves it `outward`; the cylinder is called `on` in
    the scene, has its axis at `y_mm` along the throw and the radius `surface_mm`.
    """

    key: str
    on: str
    hole: Cylinder
    at: Point
    outward: Point
    y_mm: float
    surface_mm: float
    rounding_mm: float


Solid = Cylinder | Box | Frustum | Extrusion | Revolution | Loft | RoundedOutlet


@dataclass(frozen=True)
class Circle:
    """A circle of a view, with a text in its middle."""

    centre: _FlatPoint
    radius: float
    hidden: bool = False
    label: str = ""


@dataclass(frozen=True)
class Polyline:
    """A chain of straight edges of a view."""

    points: tuple[_FlatPoint, ...]
    hidden: bool = False


@dataclass(frozen=True)
class DimensionLine:
    """A dimension between two points of a view, its line moved off them by a shift along one axis."""

    start: _FlatPoint
    end: _FlatPoint
    shift: _FlatPoint
    text: str


@dataclass(frozen=True)
class FeatureDrawing:
    """A feature in the drawing of its web.

    Attributes:
        front: edges in the view along the crank axis, (x, y).
        lengthwise: dimensions in the section x = 0, (z, y).
        across: dimensions in the section across the throw at `section_y_mm`, (x, z).
        section_y_mm: where a section across the throw shows the feature best; None for no preference.
        lines: its numbers, for the table.
        added: corners (x, y) of the material that it adds to the outline in the front view.
        places: points (x, y) of the front view that are dimensioned from both axes.
        named: points (x, y) of the front view with a text beside the body about each, such as a radius.
    """

    front: tuple[Circle | Polyline, ...] = ()
    lengthwise: tuple[DimensionLine, ...] = ()
    across: tuple[DimensionLine, ...] = ()
    section_y_mm: float | None = None
    lines: tuple[str, ...] = ()
    added: tuple[_FlatPoint, ...] = ()
    places: tuple[_FlatPoint, ...] = ()
    named: tuple[tuple[_FlatPoint, str], ...] = ()


def number_lines(title: str, values: dict[str, float]) -> tuple[str, ...]:
    """Lines of the drawing's table: a title, and each number by its key without the unit."""
    lines = ["", title]
    for name, value in values.items():
        word, unit = name.rsplit("_", 1)
        lines.append(f"   {word.replace('_', ' ')} {value:.2f}{'°' if unit == 'deg' else ''}")
    return tuple(lines)
