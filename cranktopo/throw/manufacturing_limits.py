"""What a die or a mill can make: the limits of the re-model, and the settings of its fit."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class ManufacturingLimits:
    """Bounds of the parametric web and settings of its fit.

    Attributes:
        min_wall_mm: least wall between bores, pockets, bevels and the outline.
        min_radius_mm: least radius of curvature of the outline, on either side of the curve.
        min_draft_deg: least slope of the walls of a side pocket, so that a die releases it sideways.
        max_stations: most stations of the profile, both round ends included; at least 5.
        least_gain_percent: least gain in overlap (IoU, percentage points) that another station or feature
            must bring.
        cell_mm: cell size at which model and body are compared in the final fit.
        starts: number of initial guesses for the final fit.
    """

    min_wall_mm: float = 3.0
    min_radius_mm: float = 6.0
    min_draft_deg: float = 3.0
    max_stations: int = 10
    least_gain_percent: float = 0.2
    cell_mm: float = 1.0
    starts: int = 3
