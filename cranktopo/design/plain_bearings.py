"""Scene table of the plain bearings and their oil."""

from __future__ import annotations

import math
from typing import Annotated, Literal, get_args

from pydantic import Field

from cranktopo.base.table import Length, LengthOrZero, Pressure, SceneTable, SmallLength
from cranktopo.base.units import MM2_PER_M2

Oil = Literal[
    "ISO VG 22", "ISO VG 32", "ISO VG 46", "ISO VG 68", "ISO VG 100", "ISO VG 150", "ISO VG 220", "ISO VG 320"
]
_VISCOSITY_AT_40 = dict(zip(get_args(Oil), (22.0, 32.0, 46.0, 68.0, 100.0, 150.0, 220.0, 320.0), strict=True))
_VISCOSITY_AT_100 = dict(zip(get_args(Oil), (4.3, 5.4, 6.8, 8.7, 11.4, 15.0, 19.4, 24.9), strict=True))
"""Kinematic, mm2/s: at 40 degC by ISO 3448, at 100 degC typical of mineral oils (index 95 to 100)."""
_ZERO_K, _WALTHER = 273.15, 0.7
_DENSITY_KG_M3, _DENSITY_AT_C, _DENSITY_FALL = 880.0, 15.0, 0.64
"""Of a mineral oil, kg/m3 at 15 degC, and its fall per degree."""
Temperature = Annotated[float, Field(ge=-40, le=200, allow_inf_nan=False)]
Viscosity = Annotated[float, Field(ge=0.1, le=1e5, allow_inf_nan=False)]
SupplyPressure = Annotated[float, Field(ge=0.001, le=20, allow_inf_nan=False)]
Angle = Annotated[float, Field(ge=-360, le=360, allow_inf_nan=False)]
Film = Annotated[float, Field(ge=0.01, le=1000, allow_inf_nan=False)]


class PlainBearings(SceneTable):
    """Plain main and big-end bearings, and their oil: what `film` needs.

    Clearances are those of diameters: of the bearing less that of its journal.
    """

    clearance_mm: SmallLength = Field(examples=[0.05])
    """Clearance of the main bearings, of the diameters."""
    big_end_clearance_mm: SmallLength | None = Field(default=None, examples=[0.05])
    """Clearance of the big-end bearings, of the diameters; by default that of the main bearings."""
    width_mm: Length | None = Field(default=None, examples=[26.0])
    """Width of a main bearing; by default the journal's length between its fillets."""
    big_end_width_mm: Length | None = Field(default=None, examples=[24.0])
    """Width of a big-end bearing; by default that of the rod, or the pin's length between its fillets,
    over the rods on it."""
    groove_mm: LengthOrZero = 0.0
    """Width of an oil groove all around the main bearings, which parts their film; 0 for none."""
    oil: Oil = "ISO VG 46"
    """Viscosity grade of a mineral oil."""
    temperature_C: Temperature = 100.0
    """Temperature of the oil in the film."""
    viscosity_mPas: Viscosity | None = Field(default=None, examples=[8.0])
    """Dynamic viscosity of the oil in the film, in place of that of `oil` at `temperature_C`."""
    viscosity_curve_mPas: tuple[tuple[Temperature, Viscosity], ...] | None = Field(
        default=None, min_length=2, max_length=50, examples=[((40.0, 90.0), (100.0, 11.0))]
    )
    """Temperatures in degC, rising, each with the dynamic viscosity of the oil there, in place of that of
    `oil`; at `temperature_C` by Walther's equation through the two nearest."""
    supply_pressure_MPa: SupplyPressure = 0.3
    """Pressure, above that around the bearings, of the oil that feeds a mass-conserving film."""
    feed_hole_mm: Length | None = Field(default=None, examples=[5.0])
    """Diameter of the hole that feeds a main bearing without groove, and a big end whose pin has no drilling;
    in the middle of the width, by default a tenth of the journal's diameter."""
    feed_hole_deg: Angle = 90.0
    """Angle of the hole in a main bearing from the axis of the first cylinder, in the sense of rotation."""
    permitted_film_um: Film | None = Field(default=None, examples=[1.5])
    """Least permitted film thickness, as journals' roughness and deflection leave it."""
    permitted_pressure_MPa: Pressure | None = Field(default=None, examples=[45.0], le=1000)
    """Largest permitted pressure of the film, as the bearing's lining endures it."""

    @property
    def dynamic_viscosity_Pas(self) -> float:
        """Dynamic viscosity of the oil in the film, Pa s; of a grade by Walther's equation (ASTM D341)."""
        if self.viscosity_mPas is not None:
            return self.viscosity_mPas / 1e3
        density = _density_kg_m3(self.temperature_C)
        return self._kinematic_mm2_per_s / MM2_PER_M2 * density

    @property
    def takes_grade(self) -> bool:
        """Tell whether the viscosity is that of the grade."""
        return self.viscosity_mPas is None and self.viscosity_curve_mPas is None

    @property
    def _kinematic_mm2_per_s(self) -> float:
        """Kinematic viscosity at the temperature of the film, on a line through the points nearest to it."""
        points = self._points
        above = next((n for n, (at_C, _) in enumerate(points) if at_C >= self.temperature_C), len(points))
        first = min(max(above, 1), len(points) - 1) - 1
        (cold, thick), (hot, thin) = (
            (math.log10(at_C + _ZERO_K), math.log10(math.log10(viscosity + _WALTHER)))
            for at_C, viscosity in points[first : first + 2]
        )
        here = math.log10(self.temperature_C + _ZERO_K)
        return float(10**10 ** (thick + (here - cold) / (hot - cold) * (thin - thick)) - _WALTHER)

    @property
    def _points(self) -> list[tuple[float, float]]:
        """Temperatures in degC and kinematic viscosities in mm2/s that are known."""
        if self.viscosity_curve_mPas is None:
            return [(40.0, _VISCOSITY_AT_40[self.oil]), (100.0, _VISCOSITY_AT_100[self.oil])]
        return [
            (at_C, viscosity / 1e3 / _density_kg_m3(at_C) * MM2_PER_M2)
            for at_C, viscosity in self.viscosity_curve_mPas
        ]


def _density_kg_m3(temperature_C: float) -> float:
    return _DENSITY_KG_M3 - _DENSITY_FALL * (temperature_C - _DENSITY_AT_C)
