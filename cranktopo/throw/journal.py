"""Journals, and the sections of their fillets: a quarter of an ellipse, by default of a circle."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from pydantic import Field

from cranktopo.base.arrays import Array
from cranktopo.base.errors import invalid
from cranktopo.base.table import Length, LengthOrZero, SceneTable

ASPECT = (0.5, 2.5)
"""Axial over radial semi-axis: beyond, one end of the arc is nearly a sharp edge."""


@dataclass(frozen=True)
class FilletSection:
    """Quarter of an ellipse that is tangent to the journal's cylinder and to the web's face.

    Its semi-axes lie outward from the journal, where 0 is a sharp edge, and along the crank. With a recess it
    is a circle that goes on below the web's face, to that depth.
    """

    radial_mm: float
    axial_mm: float
    recess_mm: float = 0.0

    @property
    def reach_mm(self) -> float:
        """Length along the journal that it takes, from the web's face on."""
        return self.axial_mm - self.recess_mm

    @property
    def half_mouth_mm(self) -> float:
        """Half of the width of its recess at the web's face; 0 without one."""
        return math.sqrt(self.recess_mm * (2 * self.radial_mm - self.recess_mm))

    @property
    def start_rad(self) -> float:
        """Angle between the arc's lowest point and where it meets the web's face; 0 without a recess."""
        return math.acos(1 - self.recess_mm / self.radial_mm) if self.recess_mm else 0.0

    @property
    def arc_rad(self) -> float:
        """Angle from where it leaves the journal to where it meets the web's face."""
        return math.pi / 2 + self.start_rad

    @property
    def round(self) -> bool:
        """True if it is a circle."""
        return self.radial_mm == self.axial_mm

    @property
    def shorter_mm(self) -> float:
        """Shorter semi-axis, mm."""
        return min(self.radial_mm, self.axial_mm)

    @property
    def least_radius_mm(self) -> float:
        """Smallest radius of curvature, at the end of the longer semi-axis, mm."""
        longer = max(self.radial_mm, self.axial_mm)
        return self.shorter_mm * (self.shorter_mm / longer) if longer else 0.0

    @property
    def mean_mm(self) -> float:
        """Mean semi-axis, mm; the arc is within 4 % as long as that of a circle of this radius."""
        return (self.radial_mm + self.axial_mm) / 2

    @property
    def flattening(self) -> float:
        """Radial over axial semi-axis: the factor on lengths along the crank that makes it a circle."""
        return self.radial_mm / self.axial_mm if self.axial_mm else 1.0

    def off_mm(self, across_mm: Array, height_mm: Array) -> Array:
        """Distance from the whole ellipse, stretched along the crank till it is a circle, mm."""
        return np.asarray(np.hypot(across_mm, height_mm * self.flattening) - self.radial_mm)

    def __str__(self) -> str:
        if self.round:
            return f"R{self.radial_mm:g}" + (f", recess {self.recess_mm:g}" if self.recess_mm else "")
        return f"ellipse {self.radial_mm:g} radial x {self.axial_mm:g} axial"


ROUNDING_MM = 1e-9
"""The largest dimension that a message names must itself be accepted."""


class Journal(SceneTable):
    """A main journal or crankpin: a cylinder with an axial bore (0 = solid) and a fillet (0 = sharp)."""

    outer_diameter_mm: Length = Field(examples=[42.0])
    """Outer diameter."""
    bore_diameter_mm: LengthOrZero = 0.0
    """Diameter of the axial bore, which runs on through the web; 0 = solid."""
    length_mm: Length = Field(examples=[38.0])
    """Full length between the webs; the half throw has half of it."""
    fillet_mm: LengthOrZero = 0.0
    """Radius of the fillet to the web; 0 = sharp. Smaller than half the length."""
    fillet_axial_mm: Length | None = Field(default=None, examples=[4.0])
    """Makes the fillet an ellipse: its semi-axis along the crank, `fillet_mm` being that on the web's face;
    0.5 to 2.5 times `fillet_mm` and smaller than half the length. Left out, the fillet is round."""
    recess_mm: Length | None = Field(default=None, examples=[0.8])
    """Depth of an undercut fillet below the web's face, in which its arc goes on; smaller than `fillet_mm`.
    The fillet takes so much less of the journal's length. T_H and T_G of IACS UR M53."""

    @property
    def radius_mm(self) -> float:
        """Outer radius, mm."""
        return self.outer_diameter_mm / 2

    @property
    def fillet(self) -> FilletSection:
        """Section of its fillets."""
        axial = self.fillet_mm if self.fillet_axial_mm is None else self.fillet_axial_mm
        return FilletSection(self.fillet_mm, axial, self.recess_mm or 0.0)

    @property
    def clear_radius_mm(self) -> float:
        """Radius about its axis that fillet and recess take of the web's face."""
        return self.radius_mm + self.fillet_mm + self.fillet.half_mouth_mm

    @property
    def bore_radius_mm(self) -> float:
        """Bore radius, mm (0 = solid)."""
        return self.bore_diameter_mm / 2

    def check(self, key: str) -> None:
        """Refuse dimensions that give no journal."""
        if self.bore_diameter_mm >= self.outer_diameter_mm:
            raise invalid(
                f"{key}.bore_diameter_mm",
                self.bore_diameter_mm,
                f"must be smaller than {key}.outer_diameter_mm = {self.outer_diameter_mm:g} mm",
                "Use 0 for a solid journal.",
            )
        self._check_fillet(key)
        self._check_recess(key)

    def _check_recess(self, key: str) -> None:
        if self.recess_mm and self.fillet_axial_mm is not None:
            raise invalid(f"{key}.recess_mm", self.recess_mm, "an ellipse (fillet_axial_mm) has no recess")
        if self.recess_mm and self.recess_mm >= self.fillet_mm:
            allowed = f"must be smaller than {key}.fillet_mm = {self.fillet_mm:g} mm"
            raise invalid(f"{key}.recess_mm", self.recess_mm, allowed)

    def _check_fillet(self, key: str) -> None:
        fillet, axial_given = self.fillet, self.fillet_axial_mm is not None
        key = f"{key}.fillet_axial_mm" if axial_given else f"{key}.fillet_mm"
        low, high = (share * fillet.radial_mm for share in ASPECT)
        if axial_given and not fillet.radial_mm:
            raise invalid(
                key,
                fillet.axial_mm,
                "an ellipse needs both semi-axes, and fillet_mm = 0",
                "Give fillet_mm, too.",
            )
        if axial_given and not low - ROUNDING_MM <= fillet.axial_mm <= high + ROUNDING_MM:
            raise invalid(
                key,
                fillet.axial_mm,
                f"must be >= {low:.4g} and <= {high:.4g} mm, {ASPECT[0]:g} to {ASPECT[1]:g} times "
                f"fillet_mm = {fillet.radial_mm:g} mm",
            )
        if fillet.axial_mm >= self.length_mm / 2 and fillet.radial_mm:
            raise invalid(
                key,
                fillet.axial_mm,
                f"must be smaller than half the journal's length ({self.length_mm / 2:g} mm)",
            )
