"""Limits of a die or a mill: those of the re-model, and the settings of its fit."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from typing_extensions import override


@dataclass(frozen=True)
class Workshop:
    """Demands of a process on pockets and bevels; by default none.

    Attributes:
        opens: which way pockets may open: from web faces, from the sides, or both.
        draft_deg: draft of what opens at a web face.
        radius_mm: least radius of the corners of a pocket.
        floor_radius_mm: radius of the edge of a floor of what opens at a web face.
        side_floor_radius_mm: radius of the edge of the floor of a side pocket.
        groove_radius_mm: radius of the edges of the floor of a groove.
        depth_share: most depth of what is cut from a face, over the web's thickness.
        bevel_draft_deg: draft of bevels to both sides, where a die opens that way.
    """

    opens: Literal["faces", "sides", "both"] = "both"
    draft_deg: float = 0.0
    radius_mm: float = 0.0
    floor_radius_mm: float = 0.0
    side_floor_radius_mm: float = 0.0
    groove_radius_mm: float = 0.0
    depth_share: float = 1.0
    bevel_draft_deg: float = 0.0


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

    @property
    def workshop(self) -> Workshop:
        """Demands of a process."""
        return Workshop()

    def deepest_mm(self, thickness_mm: float) -> float:
        """Return the most depth of what is cut from a face of a web."""
        return min(thickness_mm - self.min_wall_mm, self.workshop.depth_share * thickness_mm)


@dataclass(frozen=True)
class ProcessLimits(ManufacturingLimits):
    """The same with the demands of a process, flat as a manifest keeps them.

    Attributes:
        min_wall_mm: least wall between bores, pockets, bevels and the outline.
        min_radius_mm: least radius of curvature of the outline, on either side of the curve.
        min_draft_deg: least slope of the walls of a side pocket, so that a die releases it sideways.
        max_stations: most stations of the profile, both round ends included; at least 5.
        least_gain_percent: least gain in overlap (IoU, percentage points) that another station or feature
            must bring.
        cell_mm: cell size at which model and body are compared in the final fit.
        starts: number of initial guesses for the final fit.
        opens: which way pockets may open: from web faces, from the sides, or both.
        pocket_draft_deg: draft of what opens at a web face.
        pocket_radius_mm: least radius of the corners of a pocket.
        floor_radius_mm: radius of the edge of a floor of what opens at a web face.
        side_floor_radius_mm: radius of the edge of the floor of a side pocket.
        groove_radius_mm: radius of the edges of the floor of a groove.
        depth_share: most depth of what is cut from a face, over the web's thickness.
        bevel_draft_deg: draft of bevels to both sides, where a die opens that way.
    """

    opens: Literal["faces", "sides", "both"] = "both"
    pocket_draft_deg: float = 0.0
    pocket_radius_mm: float = 0.0
    floor_radius_mm: float = 0.0
    side_floor_radius_mm: float = 0.0
    groove_radius_mm: float = 0.0
    depth_share: float = 1.0
    bevel_draft_deg: float = 0.0

    @property
    @override
    def workshop(self) -> Workshop:
        return Workshop(
            self.opens,
            self.pocket_draft_deg,
            self.pocket_radius_mm,
            self.floor_radius_mm,
            self.side_floor_radius_mm,
            self.groove_radius_mm,
            self.depth_share,
            self.bevel_draft_deg,
        )
