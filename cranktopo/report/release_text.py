"""What keeps a web from being made, and undercuts, in words."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from cranktopo.surface.undercuts import Undercuts


def undercut_text(found: Undercuts) -> str:
    """Whether a die that parts in x = 0 releases the web, and what it would have to leave behind."""
    if not found.caught:
        return "none: a die that parts in x = 0 releases the web"
    verdict = (
        "a die that parts in x = 0 releases the web" if found.released else "no such die releases the web"
    )
    return (
        f"{found.volume_mm3:.1f} mm3 along x, behind {found.caught} of {found.rays} rays, "
        f"{found.deepest_mm:.1f} mm deep at most: {verdict}"
    )


def obstacles(cavities: int, undercuts: Mapping[str, Any] | None) -> list[str]:
    """What keeps a web from being made; nothing where a die releases it and a cutter reaches all of it.

    Args:
        cavities: closed hollows inside.
        undercuts: with `released` and `volume_mm3`; None where no die was tried.
    """
    found = []
    if cavities:
        hollows = f"{cavities} closed hollow{'s' * (cavities > 1)} inside"
        found.append(f"{hollows}: no forging die or cutter reaches there")
    if undercuts is not None and not undercuts["released"]:
        volume = undercuts["volume_mm3"]
        found.append(f"{volume:.0f} mm3 of undercuts along x: no die that parts in x = 0 releases it")
    return found
