"""What keeps a web from being made: closed hollows and undercuts, in words and as a table."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from cranktopo.report.tables.result_table import Column, ResultTable, tabulate
from cranktopo.surface.undercuts import Undercuts


@dataclass(frozen=True)
class DesignUndercuts:
    """What would keep a design from being made.

    Attributes:
        hollows: closed ones inside the half throw.
        undercuts: what a die that parts in x = 0 could not release.
    """

    name: str
    hollows: int
    undercuts: Undercuts

    @property
    def free(self) -> bool:
        """Whether a die releases the web, and a cutter reaches all of it."""
        return not obstacles(self.hollows, self.undercuts.as_json())


_COLUMNS: tuple[Column[DesignUndercuts], ...] = (
    Column("design", 0, lambda found: found.name),
    Column("die_releases_it", 0, lambda found: "yes" if found.free else "no"),
    Column("closed_hollows", 0, lambda found: float(found.hollows)),
    Column("undercut_volume_mm3", 1, lambda found: found.undercuts.volume_mm3),
    Column("deepest_undercut_mm", 1, lambda found: found.undercuts.deepest_mm),
)


def undercut_table(found: Sequence[DesignUndercuts]) -> ResultTable:
    """Hollows and undercuts of each design."""
    return tabulate(_COLUMNS, found)


def undercut_text(found: Undercuts) -> str:
    """Whether a die that parts in x = 0 releases the web, and what it would have to leave behind."""
    if not found.caught:
        return "none: a die that parts in x = 0 releases the web"
    verdict = (
        "a die that parts in x = 0 releases the web" if found.negligible else "no such die releases the web"
    )
    return (
        f"{found.volume_mm3:.1f} mm3 along x, behind {found.caught} of {found.rays} rays, "
        f"{found.deepest_mm:.1f} mm deep at most: {verdict}"
    )


def obstacles(cavities: int, undercuts: Mapping[str, Any] | None) -> list[str]:
    """What keeps a web from being made; nothing where a die releases it and a cutter reaches all of it.

    Args:
        cavities: closed hollows inside.
        undercuts: with `released` and `volume_mm3`; None where they were not looked for.
    """
    found = []
    if cavities:
        hollows = f"{cavities} closed hollow{'s' * (cavities > 1)} inside"
        found.append(f"{hollows}: no forging die or cutter reaches there")
    if undercuts is not None and not undercuts["released"]:
        volume = undercuts["volume_mm3"]
        found.append(f"{volume:.0f} mm3 of undercuts along x: no die that parts in x = 0 releases it")
    return found
