"""What keeps a web from being made: closed hollows and undercuts, in words and as a table."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from cranktopo.bodies.undercuts import LATERAL_DIE, Undercuts
from cranktopo.report.result_table import Column, ResultTable, tabulate


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
    """Whether a die, mould or mill leaves the web as it is, and what it would have to leave behind."""
    if not found.caught:
        return f"none: {released_text(found.by)} the web"
    lateral = found.by == LATERAL_DIE.text
    missed = "no such die releases the web" if lateral else f"{found.by} misses some of it"
    verdict = f"{released_text(found.by)} the web" if found.negligible else missed
    return (
        f"{found.volume_mm3:.1f} mm3{' along x' * lateral}, behind {found.caught} of {found.rays} rays, "
        f"{found.deepest_mm:.1f} mm deep at most: {verdict}"
    )


def released_text(way: str) -> str:
    """What a die, mould or mill does to a web that it can make, without the object."""
    return f"{way} {'reaches all of' if way.startswith('a mill') else 'releases'}"


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
        way = undercuts.get("by", LATERAL_DIE.text)
        missed = "no die that parts in x = 0 releases it" if way == LATERAL_DIE.text else f"{way} misses it"
        along = " along x" if way == LATERAL_DIE.text else ""
        found.append(f"{volume:.0f} mm3 of undercuts{along}: {missed}")
    return found
