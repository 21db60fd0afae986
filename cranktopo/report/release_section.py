"""Whether the designs of a comparison can be made: one answer, and a table of what would hold a die."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from cranktopo.report.page import Fact, Status
from cranktopo.report.release_text import obstacles
from cranktopo.report.tables import ResultTable
from cranktopo.scene import Scene
from cranktopo.surface.undercuts import Undercuts, half_throw_undercuts
from cranktopo.triangles.shells import shell_volumes_mm3
from cranktopo.triangles.surface_mesh import SurfaceMesh

_RAYS_MM = 1.0


@dataclass(frozen=True)
class Release:
    """What would keep a design from being made.

    Attributes:
        name: of the design.
        hollows: closed ones inside the half throw.
        undercuts: what a die that parts in x = 0 could not release.
    """

    name: str
    hollows: int
    undercuts: Undercuts

    @property
    def released(self) -> bool:
        """Whether a die lets go of the web, and a cutter reaches all of it."""
        return not obstacles(self.hollows, self.undercuts.as_json())


def release_of(name: str, half_throw: SurfaceMesh, scene: Scene) -> Release:
    """What would keep a design from being made.

    Args:
        name: of the design.
        half_throw: its closed surface.
        scene: its bores and web faces.
    """
    hollows = int((shell_volumes_mm3(half_throw) < 0).sum())
    return Release(name, hollows, half_throw_undercuts(half_throw, scene, _RAYS_MM))


def release_fact(found: Sequence[Release], designs: int) -> Fact:
    """Which of the designs a die releases.

    Args:
        found: those that have a surface to look at.
        designs: how many are compared.
    """
    caught = [release.name for release in found if not release.released]
    unknown = designs - len(found)
    good = len(found) - len(caught)
    mood: Status = "bad" if caught else "unknown" if unknown else "good"
    note = f"hollows or undercuts hold {', '.join(caught)}" if caught else "by a die that parts in x = 0"
    return Fact("Releasable", f"{good} of {designs}", note + "; STEP not looked at" * bool(unknown), mood)


def release_table(found: Sequence[Release]) -> ResultTable:
    """Hollows and undercuts of each design."""
    rows = tuple(
        (
            release.name,
            "yes" if release.released else "no",
            float(release.hollows),
            release.undercuts.volume_mm3,
            release.undercuts.deepest_mm,
        )
        for release in found
    )
    columns = ("design", "releasable", "closed_hollows", "undercut_volume_mm3", "deepest_undercut_mm")
    return ResultTable(columns, rows, (0, 0, 0, 1, 1))
