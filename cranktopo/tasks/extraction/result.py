"""Results of an extraction: what was measured on the surface of a density."""

from __future__ import annotations

from typing import TYPE_CHECKING, Self

from cranktopo.base.result import UNLESS_NONE, Result
from cranktopo.design.schema import Process

if TYPE_CHECKING:
    from cranktopo.bodies.undercuts import Undercuts
    from cranktopo.tasks.extraction.checked_surface import SurfaceReport
    from cranktopo.tasks.extraction.half_throw import WebSurface

LEAST_MEMBER_CELLS = 2.0
"""Members thinner than this have no bending stiffness of their own on the grid."""


class ThrowMasses(Result):
    """Masses of the full throw and of one web, kg."""

    throw: float
    web: float


class UndercutMeasures(Result):
    """Voids that a die, a mould or a mill cannot leave."""

    rays: int = 0
    caught_rays: int = 0
    deepest_mm: float = 0.0
    volume_mm3: float
    released: bool
    by: str = "a die that parts in x = 0"
    without_draft: tuple[str, ...] = ()
    """Keys of what a die or mould with a draft releases along walls that have less of it, or none."""

    @classmethod
    def of(cls, undercuts: Undercuts, without_draft: tuple[str, ...] = ()) -> Self:
        """Return what is told of undercuts."""
        return cls(
            rays=undercuts.rays,
            caught_rays=undercuts.caught,
            deepest_mm=undercuts.deepest_mm,
            volume_mm3=undercuts.volume_mm3,
            released=undercuts.negligible,
            by=undercuts.by,
            without_draft=without_draft,
        )


class ShapedUndercuts(UndercutMeasures):
    """Voids of the web that its process cannot leave, by rays through the solid that was written."""

    process: Process
    """The process of the design; for `free` a die that parts in x = 0 is checked, although not required."""
    held_by: str | None
    """Feature of the web at the deepest of them; None where none is held, or where no feature is."""

    @property
    def makeable(self) -> bool:
        """True where the process that was asked for can make the web."""
        return self.released or self.process == "free"


class SurfaceQuality(Result):
    """A surface that passed every check, and how true it is to its density."""

    iso_value: float
    web_volume_mm3: float
    web_volume_error_percent: float
    faces: int
    bodies: int
    cavities: int
    dropped_islands: int
    dropped_volume_mm3: float
    x_symmetric: bool
    fallback: str


def quality(surface: WebSurface, report: SurfaceReport) -> SurfaceQuality:
    """Return the quality of a surface and of its checks."""
    return SurfaceQuality(
        iso_value=surface.iso_value,
        web_volume_mm3=surface.volume_mm3,
        web_volume_error_percent=report.web_volume_error_percent,
        faces=report.faces,
        bodies=report.bodies,
        cavities=report.cavities,
        dropped_islands=surface.dropped_islands,
        dropped_volume_mm3=surface.dropped_volume_mm3,
        x_symmetric=surface.x_symmetric,
        fallback=surface.fallback,
    )


class WallMeasures(Result):
    """Minimum draft, member and gap of the walls that were shaped, None where there is none."""

    least_draft_deg: float | None
    least_member_mm: float | None
    least_gap_mm: float | None
    asked_member_mm: float | None = UNLESS_NONE
    asked_gap_mm: float | None = UNLESS_NONE


class RunSurface(SurfaceQuality):
    """The surface of a run's last design; undercuts are None in runs of an earlier version."""

    undercuts: UndercutMeasures | None = UNLESS_NONE
    walls: WallMeasures | None = UNLESS_NONE


class NoSurface(Result):
    """The reason why a density has no surface, as that of a first design, which is grey."""

    refusal: str


class IsoDistance(Result):
    """Distances of the smoothed density's iso-surface to the final surface, mm."""

    mean: float
    max: float


class ExtractedSurface(SurfaceQuality):
    """The surface of one design, and lengths of the walls that were shaped, None where none face."""

    vertices: int
    distance_to_iso_surface_mm: IsoDistance
    minimum_member_mm: float | None
    minimum_member_cells: float | None
    minimum_gap_mm: float | None
    minimum_gap_cells: float | None
    undercuts: UndercutMeasures


class Extraction(Result):
    """One design of a run as a surface; `extract --json` prints it."""

    schema_version: int = 1
    run: str
    design: str
    iteration: int
    mass_kg: ThrowMasses
    surface: ExtractedSurface
    files: dict[str, str]
