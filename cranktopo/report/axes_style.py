"""The look that all axes share."""

from __future__ import annotations

from typing import Any

GREY = "0.35"


def plain(axes: Any) -> None:
    """Small tick labels, and lines only at the left and below."""
    axes.tick_params(labelsize=8)
    for side in ("top", "right"):
        axes.spines[side].set_visible(False)
