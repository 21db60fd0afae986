"""The web family of the re-model: which parameters a web has, their bounds, and the scene table they make."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from cranktopo.remodel.manufacturing_limits import ManufacturingLimits
from cranktopo.scene import Scene
from cranktopo.scene.profile import Flank, flank_through, largest_half_width_mm

Array = NDArray[np.float64]
Face = Literal["journal", "pin"]
ROUNDING_MM = 0.01
"""Parameters are rounded to this in the scene; the constraints keep as much clear."""
_LEAST_MM = 3.0
"""Least size of a pocket."""
_LARGEST_DRAFT_DEG = 45.0
_BEYOND_MM = 1.0
"""How far a groove reaches beyond both ends of the outline."""


@dataclass(frozen=True)
class Bevel:
    """An end bevel of the family, by its face."""

    face: Face

    @property
    def names(self) -> tuple[str, ...]:
        """Names of its parameters, mm."""
        return ("y", "depth", "crown")


@dataclass(frozen=True)
class Pocket:
    """A pocket of the family.

    Attributes:
        shape: "side" (both lateral faces), "groove" (the same, through both ends), "cylinder" or "box".
        face: the face it starts from, or "through" or "side".
        pair: two of them, at +x and -x; otherwise one at x = 0 (or the two slots of a side pocket).
    """

    shape: Literal["side", "groove", "cylinder", "box"]
    face: Literal["journal", "pin", "through", "side"]
    pair: bool = False

    @property
    def names(self) -> tuple[str, ...]:
        """Names of its parameters: mm, draft in degrees."""
        if self.shape == "side":
            return ("y", "length", "height", "floor", "offset", "draft")
        if self.shape == "groove":
            return ("height", "floor", "offset", "draft")
        place = ("x", "y") if self.pair else ("y",)
        size = ("diameter",) if self.shape == "cylinder" else ("size_x", "size_y")
        return (*place, *size, *(() if self.face == "through" else ("depth",)))


FittedFeature = Bevel | Pocket


@dataclass(frozen=True)
class Layout:
    """Which parameters a web of the family has.

    Attributes:
        stations: points of the profile, both round ends included.
        parts: bevels and pockets.
    """

    stations: int
    parts: tuple[FittedFeature, ...] = ()

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the parameters in the order of the vector."""
        outline = ("y_low", "y_high", *(f"half_width_{i}" for i in range(1, self.stations - 1)))
        return (*outline, *(f"{label(part)}.{name}" for part in self.parts for name in part.names))

    def split(self, values: Any) -> Iterator[tuple[FittedFeature, dict[str, Any]]]:
        """Each part with its parameters by name."""
        return named_parts(self.parts, values[self.stations :])


def named_parts(
    parts: tuple[FittedFeature, ...], values: Any
) -> Iterator[tuple[FittedFeature, dict[str, Any]]]:
    """Each part with its parameters by name.

    Args:
        parts: bevels and pockets.
        values: parameters of the parts in their order, mm or degrees; those of the outline left out.
    """
    first = 0
    for part in parts:
        count = len(part.names)
        yield part, {name: values[first + i] for i, name in enumerate(part.names)}
        first += count


def label(part: FittedFeature) -> str:
    """Short name of a part, such as `bevel-journal` or `cylinder-through-pair`."""
    if isinstance(part, Bevel):
        return f"bevel-{part.face}"
    shape = part.shape if part.face == "side" else f"{part.shape}-{part.face}"
    return f"{shape}-pair" if part.pair else shape


def station_shares(stations: int) -> Array:
    """Places of the stations between both ends, 0 to 1: denser toward the ends, as Chebyshev's points."""
    return np.asarray((1 - np.cos(np.pi * np.arange(stations) / (stations - 1))) / 2)


def flank_of(xp: Any, layout: Layout, values: Any) -> Flank:
    """The outline of a parameter vector.

    Args:
        xp: numpy or jax.numpy.
        layout: which parameters there are.
        values: the parameter vector, mm or degrees; those of the parts may be missing.
    """
    n = layout.stations
    low, high = values[0], values[1]
    stations = low + (high - low) * xp.asarray(station_shares(n))
    zero = xp.zeros(1)
    return flank_through(xp, xp.concatenate([zero, values[2:n], zero]), stations, (True, True))


def bounds(layout: Layout, scene: Scene, rules: ManufacturingLimits) -> tuple[Array, Array]:
    """Lower and upper bounds of the parameters, (n,) each, mm or degrees.

    Args:
        layout: which parameters there are.
        scene: throw radius and web thickness.
        rules: least wall and least draft.
    """
    thickness, radius = scene.web.thickness_mm, scene.throw.radius_mm
    deepest, far = thickness - rules.min_wall_mm, 4 * radius
    ranges = {
        "x": (_LEAST_MM / 2, far),
        "y": (-far, far),
        "length": (_LEAST_MM, far),
        "height": (_LEAST_MM, thickness),
        "floor": (_LEAST_MM, far),
        "offset": (-thickness / 2, thickness / 2),
        "draft": (rules.min_draft_deg, _LARGEST_DRAFT_DEG),
        "diameter": (_LEAST_MM, far),
        "size_x": (_LEAST_MM, far),
        "size_y": (_LEAST_MM, far),
        "depth": (1.0, deepest),
        "crown": (0.0, thickness),
    }
    pairs = [(-far, far)] * 2 + [(_LEAST_MM / 2, far)] * (layout.stations - 2)
    pairs += [ranges[name] for part in layout.parts for name in part.names]
    low, high = np.array(pairs).T
    return low, high


def web_of(layout: Layout, values: Array, scene: Scene) -> dict[str, Any]:
    """The `[web]` table of a parameter vector, rounded to 0.01 mm, as plain data.

    Args:
        layout: which parameters there are.
        values: (n,) the parameter vector, mm or degrees.
        scene: gives the web's thickness.
    """
    flank = flank_of(np, layout, np.asarray(values, dtype=np.float64))
    parts = list(layout.split(values))
    frame = (float(flank.points_mm[0, 1]), float(flank.points_mm[-1, 1]), largest_half_width_mm(flank))
    return {
        "thickness_mm": scene.web.thickness_mm,
        "outline": "profile",
        "stations_mm": [_rounded(y) for y in flank.points_mm[:, 1]],
        "half_widths_mm": [_rounded(h) for h in flank.points_mm[:, 0]],
        "bevel": [_bevel_table(part, values) for part, values in parts if isinstance(part, Bevel)],
        "pocket": [
            table
            for part, values in parts
            if isinstance(part, Pocket)
            for table in _tables(part, values, frame)
        ],
    }


def _bevel_table(part: Bevel, values: dict[str, Any]) -> dict[str, Any]:
    return {"face": part.face, **{f"{name}_mm": _rounded(value) for name, value in values.items()}}


def _tables(
    part: Pocket, values: dict[str, Any], frame_mm: tuple[float, float, float]
) -> list[dict[str, Any]]:
    rounded = {f"{name}_mm": _rounded(value) for name, value in values.items()}
    low, high, half = frame_mm
    if part.face == "side":
        draft, floor = rounded.pop("draft_mm"), rounded.pop("floor_mm")
        if part.shape == "groove":
            through = high - low + 2 * _BEYOND_MM
            rounded |= {"y_mm": _rounded((low + high) / 2), "length_mm": _rounded(through)}
        return [{"shape": "side", **rounded, "depth_mm": _rounded(half - floor), "draft_deg": draft}]
    table = {"shape": part.shape, "face": part.face, **rounded}
    if not part.pair:
        return [{**table, "x_mm": 0.0}]
    return [{**table, "x_mm": side * rounded["x_mm"]} for side in (1, -1)]


def _rounded(value: Any) -> float:
    return round(float(value), 2) + 0.0
