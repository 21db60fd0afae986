"""The profile outline: half-widths at stations along the throw, joined by a spline."""

from __future__ import annotations

from functools import lru_cache
from itertools import pairwise
from typing import Literal

import numpy as np
from pydantic import Field
from typing_extensions import override

from cranktopo.base.arrays import Array
from cranktopo.base.errors import invalid
from cranktopo.base.table import LengthOrZero, Place
from cranktopo.throw.flank import Flank, flank_half_width_mm, flank_through, largest_half_width_mm
from cranktopo.throw.primitives import Bezier, Curve, LineSegment
from cranktopo.throw.web import WebTable


class ProfileWeb(WebTable):
    """Half-widths at stations along the throw, joined by a curve of continuous curvature.

    A half-width of 0 at an end closes the outline with a round end.
    """

    outline: Literal["profile"]
    stations_mm: tuple[Place, ...] = Field(
        min_length=3, examples=[(-24.0, -15.0, 5.0, 24.0, 45.0, 64.0, 72.0)]
    )
    """Places along the throw from the crank axis, increasing."""
    half_widths_mm: tuple[LengthOrZero, ...] = Field(
        min_length=3, examples=[(0.0, 19.0, 31.0, 34.0, 30.0, 19.0, 0.0)]
    )
    """Half-width at each station; 0 at an end makes that end round."""

    @property
    def round_ends(self) -> tuple[bool, bool]:
        """True if the lower and the upper end are round and not cut straight across."""
        return self.half_widths_mm[0] == 0, self.half_widths_mm[-1] == 0

    @property
    def flank(self) -> Flank:
        """Its right flank."""
        return _flank(self)

    @override
    def half_width_mm(self, throw_radius_mm: float, y_mm: Array) -> Array:
        return flank_half_width_mm(self.flank, y_mm)

    @override
    def y_range_mm(self, throw_radius_mm: float) -> tuple[float, float]:
        return self.stations_mm[0], self.stations_mm[-1]

    @property
    @override
    def largest_half_width_mm(self) -> float:
        return largest_half_width_mm(self.flank)

    @override
    def kinks_mm(self, throw_radius_mm: float) -> tuple[float, ...]:
        return self.stations_mm

    def contour(self, throw_radius_mm: float, z_mm: float) -> tuple[Curve, ...]:
        """Right flank, end, left flank, end; a flank is one Bezier cubic per station, exactly the spline.

        One B-spline over all stations would be shorter, but the CAD kernel loses 0.3 % of the volume of such
        a face.
        """
        y, half = self.stations_mm, self.half_widths_mm
        top = [(half[-1], y[-1]), (0.0, y[-1]), (-half[-1], y[-1])]
        bottom = [(-half[0], y[0]), (0.0, y[0]), (half[0], y[0])]
        over, under = (
            [LineSegment((*a, z_mm), (*b, z_mm)) for a, b in pairwise(end) if a != b] for end in (top, bottom)
        )
        return (*self._beziers(1.0, z_mm), *over, *self._beziers(-1.0, z_mm)[::-1], *under)

    def _beziers(self, side: float, z: float) -> list[Curve]:
        flank = self.flank
        curves: list[Curve] = []
        for i, length in enumerate(flank.lengths_mm):
            (x0, y0), (x1, y1) = flank.points_mm[i : i + 2].tolist()
            (dx0, dy0), (dx1, dy1) = (flank.slopes[i : i + 2] / 3 * length).tolist()
            corners = ((x0, y0), (x0 + dx0, y0 + dy0), (x1 - dx1, y1 - dy1), (x1, y1))
            curves.append(Bezier(tuple((side * x, y, z) for x, y in corners)))
        return curves

    @override
    def check_outline(self, throw_radius_mm: float) -> None:
        if len(self.stations_mm) != len(self.half_widths_mm):
            allowed = f"must have one value per station ({len(self.stations_mm)})"
            raise invalid("web.half_widths_mm", self.half_widths_mm, allowed)
        if any(b <= a for a, b in pairwise(self.stations_mm)):
            raise invalid("web.stations_mm", self.stations_mm, "must increase")
        self._check_curve()

    def _check_curve(self) -> None:
        """The curve between the stations has one half-width at each y, and stays off the mid-plane."""
        u = np.linspace(0, 1, 101)
        rise = self.flank.derivatives(u)[0][..., 1]
        turned = np.argwhere((rise < -1e-9) | (self.flank.at(u)[..., 0] < -1e-9))
        if len(turned):
            low, high = self.stations_mm[turned[0, 0] : turned[0, 0] + 2]
            raise invalid(
                "web.half_widths_mm",
                self.half_widths_mm,
                f"the curve folds back between the stations at {low:g} and {high:g} mm",
                "Add a station there, or let the half-width change less.",
            )


@lru_cache(maxsize=64)
def _flank(web: ProfileWeb) -> Flank:
    half = np.array(web.half_widths_mm, dtype=np.float64)
    return flank_through(half, np.array(web.stations_mm, dtype=np.float64), web.round_ends)
