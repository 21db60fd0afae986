"""A surface in words and as a table: what keeps it from being made, and the lengths that were asked for."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from cranktopo.bodies.undercuts import LATERAL_DIE, Undercuts
from cranktopo.report.result_table import Column, ResultTable, tabulate
from cranktopo.tasks.extraction.result import ShapedUndercuts, UndercutMeasures, WallMeasures

_KEPT = 0.9
"""Share of an asked length that counts as kept: cells and smoothing round the surface by about as much."""


@dataclass(frozen=True)
class DesignUndercuts:
    """Obstacles to making a design: closed hollows, and undercuts of its process."""

    name: str
    hollows: int
    undercuts: Undercuts

    @property
    def free(self) -> bool:
        """True where die, mould or mill can make the web."""
        return not manufacturing_obstacles(self.hollows, UndercutMeasures.of(self.undercuts))


_COLUMNS: tuple[Column[DesignUndercuts], ...] = (
    Column("design", 0, lambda found: found.name),
    Column("die_releases_it", 0, lambda found: "yes" if found.free else "no"),
    Column("closed_hollows", 0, lambda found: float(found.hollows)),
    Column("undercut_volume_mm3", 1, lambda found: found.undercuts.volume_mm3),
    Column("deepest_undercut_mm", 1, lambda found: found.undercuts.deepest_mm),
    Column("made_by", 0, lambda found: found.undercuts.by),
)


def undercut_table(undercuts: Sequence[DesignUndercuts]) -> ResultTable:
    """Return the hollows and undercuts of each design."""
    return tabulate(_COLUMNS, undercuts)


def undercut_text(undercuts: UndercutMeasures) -> str:
    """Tell whether a die, mould or mill leaves the web as it is, and what it would have to leave behind."""
    if not undercuts.caught_rays:
        return f"none: {released_text(undercuts.by)} the web"
    lateral = undercuts.by == LATERAL_DIE.text
    missed = "no such die releases the web" if lateral else f"{undercuts.by} misses some of it"
    verdict = f"{released_text(undercuts.by)} the web" if undercuts.released else missed
    return (
        f"{undercuts.volume_mm3:.1f} mm3{' along x' * lateral}, behind {undercuts.caught_rays} of "
        f"{undercuts.rays} rays, "
        f"{undercuts.deepest_mm:.1f} mm deep at most: {verdict}"
    )


def released_text(way: str) -> str:
    """Return what a die, mould or mill does to a web that it can make, without the object."""
    return f"{way} {'reaches all of' if way.startswith('a mill') else 'releases'}"


def manufacturing_obstacles(cavities: int, undercuts: UndercutMeasures | None) -> list[str]:
    """Return what keeps a web from being made; undercuts are None where they were not looked for."""
    found = []
    if cavities:
        hollows = f"{cavities} closed hollow{'s' * (cavities > 1)} inside"
        found.append(f"{hollows}: no forging die or cutter reaches there")
    if undercuts is not None and not undercuts.released:
        lateral = undercuts.by == LATERAL_DIE.text
        missed = "no die that parts in x = 0 releases it" if lateral else f"{undercuts.by} misses it"
        along = " along x" if lateral else ""
        found.append(f"{undercuts.volume_mm3:.0f} mm3 of undercuts{along}: {missed}")
    return found


def release_text(undercuts: ShapedUndercuts | None) -> str:
    """Tell whether the process can make the web, and the feature that is held."""
    if undercuts is None:
        return "not checked"
    obstacles = "; ".join(manufacturing_obstacles(0, undercuts))
    if not obstacles:
        return released_words(undercuts)
    held = f", held by {undercuts.held_by}" if undercuts.held_by else ""
    remark = " (the process is free)" if undercuts.process == "free" else ""
    return f"{obstacles}{held}, {undercuts.deepest_mm:.1f} mm deep at most{remark}"


def released_words(undercuts: UndercutMeasures) -> str:
    """Tell that a web is released, and what of it has less draft than asked."""
    return "; ".join(filter(None, [f"{released_text(undercuts.by)} it", without_draft_text(undercuts)]))


def without_draft_text(undercuts: UndercutMeasures) -> str:
    """Tell what has less draft than asked; empty where nothing has."""
    return f"too little draft: {', '.join(undercuts.without_draft)}" if undercuts.without_draft else ""


def release_verdict(undercuts: UndercutMeasures | None) -> str:
    """Return yes, yes with too little draft, or no; "not checked" for results of an earlier version."""
    if undercuts is None:
        return "not checked"
    if not undercuts.released:
        return "no"
    return "yes, too little draft" if undercuts.without_draft else "yes"


def required_lengths(walls: WallMeasures | None) -> dict[str, tuple[float | None, float]]:
    """Return measured and asked lengths of what was asked for, mm; None where no walls face each other."""
    if walls is None:
        return {}
    known = {
        "thinnest member": (walls.least_member_mm, walls.asked_member_mm),
        "narrowest gap": (walls.least_gap_mm, walls.asked_gap_mm),
    }
    return {
        words: (measured, required) for words, (measured, required) in known.items() if required is not None
    }


def kept(measured_mm: float | None, required_mm: float) -> bool:
    """Tell whether a measured length is the asked one, as nearly as a surface is known."""
    return measured_mm is None or measured_mm >= _KEPT * required_mm


def length_lines(walls: WallMeasures | None) -> list[str]:
    """Return one line for every length that was asked for."""
    return [
        f"{words} {length_text(measured)}, {required:g} mm asked"
        + ": NOT KEPT" * (not kept(measured, required))
        for words, (measured, required) in required_lengths(walls).items()
    ]


def length_text(measured_mm: float | None) -> str:
    """Return a measured length; none where there is nothing to measure."""
    return "none" if measured_mm is None else f"{measured_mm:.1f} mm"
