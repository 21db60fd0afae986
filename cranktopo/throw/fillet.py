"""Section of a journal's fillet: a quarter of an ellipse, by default of a circle."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from cranktopo.base.arrays import Array

ASPECT = (0.5, 2.5)
"""Axial over radial semi-axis: beyond, one end of the arc is nearly a sharp edge."""


@dataclass(frozen=True)
class FilletSection:
    """Quarter of an ellipse that is tangent to the journal's cylinder and to the web's face.

    Attributes:
        radial_mm: semi-axis outward from the journal, the height on the web's face; 0 is a sharp edge.
        axial_mm: semi-axis along the crank, the length on the journal.
    """

    radial_mm: float
    axial_mm: float

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
        """Distance from the whole ellipse with lengths along the crank stretched till it is a circle, mm.

        Args:
            across_mm: from the centre, outward from the journal's axis.
            height_mm: from the centre, along the crank.
        """
        return np.asarray(np.hypot(across_mm, height_mm * self.flattening) - self.radial_mm)

    def __str__(self) -> str:
        if self.round:
            return f"R{self.radial_mm:g}"
        return f"ellipse {self.radial_mm:g} radial x {self.axial_mm:g} axial"
