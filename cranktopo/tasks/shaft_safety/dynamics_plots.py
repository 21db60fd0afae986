"""The shaft that vibrates beside the one without mass, over speed and by web."""

from __future__ import annotations

from typing import Any

import numpy as np

from cranktopo.report.plot import GREY, Picture, picture, plain
from cranktopo.tasks.dynamics.result import ShaftDynamics
from cranktopo.tasks.shaft_safety.result import ShaftSafety

_MOVING: dict[str, Any] = {"color": "C3", "lw": 1.6, "label": "with its mass"}
_STILL: dict[str, Any] = {"color": "k", "lw": 1.2, "ls": "--", "label": "quasi-static"}


def dynamics_pictures(shaft: ShaftDynamics) -> tuple[Picture, ...]:
    """Return the moment of the worst web over speed, and that of each web where it is largest."""
    worst = shaft.worst
    said = f"{worst.worst_web.ratio:.2f} of the quasi-static one in web {worst.worst_web.web}"
    by_web = picture(
        "dynamic-moments",
        f"Equivalent moment of each web at {worst.speed_rpm:,.0f} rpm: {said}",
        _by_web,
        shaft,
    )
    if len(shaft.speeds) == 1:
        return (by_web,)
    over = picture(
        "dynamic-moment-over-speed",
        f"Largest equivalent moment of a web over speed: most at {worst.speed_rpm:,.0f} rpm",
        _over_speed,
        shaft,
    )
    return (over, by_web)


def dynamic_safety_pictures(still: ShaftSafety, moving: ShaftSafety) -> tuple[Picture, ...]:
    """Return the least safety over several speeds with and without the mass of the shaft."""
    if len(moving.speeds) == 1:
        return ()
    said = f"{moving.safety:.3f} at {moving.worst.speed_rpm:,.0f} rpm, quasi-statically {still.safety:.3f}"
    return (
        picture(
            "dynamic-safety-over-speed",
            f"Least safety over speed with the mass of the shaft and without it: {said}",
            _safety,
            still,
            moving,
        ),
    )


def _over_speed(axes: Any, shaft: ShaftDynamics) -> None:
    speeds = [at.speed_rpm for at in shaft.speeds]
    moved = [at.worst_web.range_Nm.equivalent for at in shaft.speeds]
    still = [max(web.quasi_static_Nm.equivalent for web in at.webs) for at in shaft.speeds]
    axes.plot(speeds, moved, **_MOVING)
    axes.plot(speeds, still, **_STILL)
    for one in shaft.resonances:
        axes.axvline(one.speed_rpm, color=GREY, lw=0.6, ls=":")
    axes.set(xlabel="speed (rpm)", ylabel="largest equivalent moment (N m)", ylim=(0, None))
    axes.set_xlim(speeds[0], speeds[-1])
    plain(axes)


def _by_web(axes: Any, shaft: ShaftDynamics) -> None:
    webs, wide = np.array([web.web for web in shaft.worst.webs]), 0.38
    moved = [web.range_Nm.equivalent for web in shaft.worst.webs]
    still = [web.quasi_static_Nm.equivalent for web in shaft.worst.webs]
    axes.bar(webs - wide / 2, moved, wide, color=_MOVING["color"], label=_MOVING["label"])
    axes.bar(webs + wide / 2, still, wide, color=GREY, label=_STILL["label"])
    axes.set_xticks(webs)
    axes.set(xlabel="web, from the free end", ylabel="equivalent moment (N m)", ylim=(0, None))
    plain(axes)


def _safety(axes: Any, still: ShaftSafety, moving: ShaftSafety) -> None:
    for shaft, style in ((moving, _MOVING), (still, _STILL)):
        axes.plot([at.speed_rpm for at in shaft.speeds], [at.safety for at in shaft.speeds], **style)
    first, *_, last = moving.speeds
    axes.axhline(1.0, color=GREY, ls=":", lw=1.0, label="safety of 1")
    axes.set(xlabel="speed (rpm)", ylabel="least safety", ylim=(0, None))
    axes.set_xlim(first.speed_rpm, last.speed_rpm)
    plain(axes)
