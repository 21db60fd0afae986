"""Moments in the webs and forces on the main bearings of a whole shaft, as `shaft --json` has them."""

from __future__ import annotations

from cranktopo.base.result import UNLESS_NONE, Result


class WebMoment(Result):
    """Bending moment in the middle of a web, in the plane of its throw, over the cycle.

    Attributes:
        web: from the free end, 1 first.
        range_Nm: largest less smallest value in the shaft on all its bearings.
        alone_Nm: the same of a throw that stands alone between its two bearings.
    """

    web: int
    throw: int
    range_Nm: float
    alone_Nm: float
    share: float
    """The first of these over the second."""


class ShaftBearing(Result):
    """A main bearing over the cycle.

    Attributes:
        largest_N: force on it, in the shaft on all its bearings.
        at_deg: crank angle of that, after firing of the cylinder that fires first.
        halves_N: the largest force if each throw stood alone: half of either neighbour's.
        tilt_mrad: largest angle between journal and bearing axis.
        offset_um: largest distance of the journal from the bearing axis; 0 in rigid bearings.
        film_um, pressure_MPa: least thickness and largest pressure of the oil film, where the design has
            `[bearings]`.
    """

    bearing: int
    largest_N: float
    at_deg: float
    halves_N: float
    tilt_mrad: float
    offset_um: float
    film_um: float | None = UNLESS_NONE
    pressure_MPa: float | None = UNLESS_NONE


class ContinuousShaft(Result):
    """Moments and forces of the shaft on all its bearings, at one speed."""

    speed_rpm: float
    spring_N_per_mm: float | None
    """Of each bearing; none of rigid ones."""
    webs: tuple[WebMoment, ...]
    main_bearings: tuple[ShaftBearing, ...]

    @property
    def worst_web(self) -> WebMoment:
        """The web whose bending moment has the largest range."""
        return max(self.webs, key=lambda web: web.range_Nm)

    @property
    def worst_bearing(self) -> ShaftBearing:
        """The main bearing with the largest force."""
        return max(self.main_bearings, key=lambda bearing: bearing.largest_N)
