"""Safety of a shaft over speed and by web, and the forces on its main bearings as polar diagrams."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from cranktopo.base.arrays import Array
from cranktopo.base.units import N_PER_KN
from cranktopo.report.plot import GREY, Picture, picture, plain
from cranktopo.tasks.shaft_safety.result import ShaftSafety

_BARS = 0.76
"""Width of all bars of a web together."""
_PARTS = {"pin_fillet": "C0", "journal_fillet": "C1", "outlets": "C2", "elsewhere": "C7"}
"""Parts of a web with the colour of their bars."""
_LIMIT: dict[str, Any] = {"color": GREY, "ls": "--", "lw": 1.0, "label": "safety of 1"}


@dataclass(frozen=True)
class BearingPolar:
    """Forces of the shaft on its main bearings over the cycle at one speed.

    Attributes:
        numbers: of the bearings, 1 at the free end.
        load_N: x and y in the axes of the engine, (bearings, 2, states).
    """

    speed_rpm: float
    angle_deg: Array
    numbers: tuple[int, ...]
    load_N: Array


def safety_pictures(found: ShaftSafety) -> tuple[Picture, ...]:
    """Return the least safety by web and, of several speeds, over speed."""
    worst = found.worst
    said = f"least {found.safety:.3f} at web {worst.web}, {worst.speed_rpm:,.0f} rpm"
    pictures = [picture("safety-by-web", f"Least safety of each part of each web: {said}", _by_web, found)]
    if len(found.speeds) > 1:
        pictures.append(
            picture("safety-over-speed", f"Least safety of each web over speed: {said}", _over_speed, found)
        )
    return tuple(pictures)


def bearing_pictures(loads: BearingPolar) -> tuple[Picture, ...]:
    """Return the polar diagram of each main bearing."""
    size_kN = np.hypot(loads.load_N[:, 0], loads.load_N[:, 1]) / N_PER_KN
    return tuple(
        picture(
            f"bearing-{number}",
            f"Force on main bearing {number} over the cycle at {loads.speed_rpm:,.0f} rpm: at most "
            f"{own.max():.1f} kN, at {loads.angle_deg[own.argmax()]:g} deg",
            _polar,
            number,
            force,
            float(size_kN.max()),
            polar=True,
        )
        for number, own, force in zip(loads.numbers, size_kN, loads.load_N, strict=True)
    )


def _by_web(axes: Any, found: ShaftSafety) -> None:
    webs = np.array([web.web for web in found.webs])
    judged = [part for part in _PARTS if any(getattr(web, part) is not None for web in found.webs)]
    wide = _BARS / len(judged)
    for number, part in enumerate(judged):
        values = [getattr(web, part) for web in found.webs]
        heights = [np.nan if value is None else value for value in values]
        place = webs + (number - (len(judged) - 1) / 2) * wide
        axes.bar(place, heights, wide, label=part.replace("_", " "), color=_PARTS[part])
    axes.axhline(1.0, **_LIMIT)
    axes.set_xticks(webs)
    axes.set(xlabel="web, from the free end", ylabel="least safety", ylim=(0, None))
    plain(axes)


def _over_speed(axes: Any, found: ShaftSafety) -> None:
    speeds = [at.speed_rpm for at in found.speeds]
    for web in found.webs:
        axes.plot(speeds, web.over_speeds, lw=0.9, label=f"web {web.web}")
    axes.plot(speeds, [at.safety for at in found.speeds], "k", lw=1.6, label="shaft")
    axes.axhline(1.0, **_LIMIT)
    axes.set(xlabel="speed (rpm)", ylabel="least safety", ylim=(0, None), xlim=(speeds[0], speeds[-1]))
    plain(axes)


def _polar(axes: Any, number: int, force_N: Array, most_kN: float) -> None:
    from matplotlib.ticker import MaxNLocator

    axes.set_position((0.08, 0.08, 0.84, 0.76))
    axes.set_theta_zero_location("N")
    axes.set_theta_direction(-1)
    x, y = np.hstack([force_N, force_N[:, :1]]) / N_PER_KN
    axes.plot(np.arctan2(x, y), np.hypot(x, y), "C0", lw=1.0)
    axes.set_rlim(0, 1.05 * most_kN)
    axes.yaxis.set_major_locator(MaxNLocator(3, prune="upper"))
    axes.grid(color="0.85", linewidth=0.6)
    axes.tick_params(labelsize=7, colors=GREY)
    axes.set_title(f"bearing {number} (kN)", fontsize=9, loc="left")
