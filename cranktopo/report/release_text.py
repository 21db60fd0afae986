"""Undercuts in words."""

from __future__ import annotations

from cranktopo.surface.release import Undercuts


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
