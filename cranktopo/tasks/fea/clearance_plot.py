"""Plot of the section in which a web turns: its silhouettes, and what piston skirt and crankcase leave."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from cranktopo.base.arrays import Array
from cranktopo.design.clearance import ClearanceLimit
from cranktopo.report.plot import GREY, plain

_LIMITS = {"crankcase": "#7a5195", "piston skirt": "#d1632a"}
_BODIES = ("#1f6fb4", GREY)
_FAR = 1.12
"""How far it is drawn over the farthest point of the bodies."""


def draw_clearance(
    axes: Any,
    silhouettes: Mapping[str, Sequence[Array]],
    limits: Mapping[str, ClearanceLimit],
    least: ClearanceLimit | None,
) -> None:
    """Everything in the frame of the web, which turns about (0, 0) with its crankpin upward.

    Args:
        silhouettes: loops (n, 2) of each body by its name.
        limits: what is in the way, by its name.
        least: the same with the least gap.
    """
    far = _FAR * max(np.abs(loop).max() for loops in silhouettes.values() for loop in loops)
    for order, ((name, loops), colour) in enumerate(zip(silhouettes.items(), _BODIES, strict=False)):
        for number, loop in enumerate(loops):
            closed, label = np.vstack([loop, loop[:1]]), None if number else name
            axes.plot(*closed.T, color=colour, linewidth=1.4, label=label, zorder=3 - order / 2)
    for name, limit in limits.items():
        axes.plot(*_near(limit, far), color=_LIMITS[name], linewidth=1.4, label=name)
    if least is not None:
        axes.plot(*_near(least, far), color="black", linewidth=0.8, linestyle=":", label="least gap")
    axes.plot(0, 0, "+", color=GREY)
    axes.set(xlim=(-far, far), ylim=(-far, far), aspect="equal", anchor="W")
    axes.set_xlabel("x (mm)", fontsize=9)
    axes.set_ylabel("y, to the crankpin (mm)", fontsize=9)
    axes.legend(fontsize=8, loc="center left", bbox_to_anchor=(1.03, 0.5), frameon=False)
    plain(axes)


def _near(limit: ClearanceLimit, far: float) -> Array:
    """Its contour, x and y, left out far beyond the plot."""
    radius = np.where(limit.radius_mm < 2 * far, limit.radius_mm, np.nan)
    angle = np.concatenate([-limit.angle_rad[::-1], limit.angle_rad])
    both = np.concatenate([radius[::-1], radius])
    return np.stack([both * np.sin(angle), both * np.cos(angle)])
