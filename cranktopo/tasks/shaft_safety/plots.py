"""Safety of a shaft over speed and by web, and the forces on its main bearings as polar diagrams."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np

from cranktopo.base.arrays import Array
from cranktopo.base.units import N_PER_KN
from cranktopo.design.schema import Scene
from cranktopo.report.plot import GREY, Picture, curve_style, picture, plain, polar_frame
from cranktopo.tasks.shaft.web_sections import WebSections
from cranktopo.tasks.shaft_safety.result import ShaftSafety, WorstPlace

_BARS = 0.76
"""Width of all bars of a web together."""
_PARTS = {"pin_fillet": "C0", "journal_fillet": "C1", "outlets": "C2", "elsewhere": "C7"}
"""Parts of a web with the colour of their bars."""
_EQUIVALENT: dict[str, Any] = {"color": "k", "lw": 1.6}
_LIMIT: dict[str, Any] = {"color": GREY, "ls": "--", "lw": 1.0, "label": "safety of 1"}


_VALUES = 0.42
"""Room for the numbers above and below a crank, of its height."""
_SCALES_INCHES = 1.2
"""Height of the two scales below a crank."""
_SHADES, _PLAIN = "RdYlGn", "0.9"
"""Colours of safeties, and of what has none."""


@dataclass(frozen=True)
class CrankSide:
    """Dimensions of a crank of throws that are alike, as seen from the side.

    Attributes:
        heights_mm: of the crankpins above the crank axis, by throw.
    """

    journal_mm: float
    journal_diameter_mm: float
    pin_mm: float
    pin_diameter_mm: float
    web_mm: float
    heights_mm: tuple[float, ...]

    @classmethod
    def of(cls, scene: Scene) -> CrankSide:
        """Return those of a scene, its first throw up."""
        journal, pin = scene.throw.main_journal, scene.throw.crankpin
        first, *_ = scene.shaft_angles_deg
        turn = np.radians(np.array(scene.shaft_angles_deg) - first)
        return cls(
            journal.length_mm,
            journal.outer_diameter_mm,
            pin.length_mm,
            pin.outer_diameter_mm,
            scene.web.thickness_mm,
            tuple((scene.throw.radius_mm * np.cos(turn)).tolist()),
        )


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


def safety_pictures(shaft: ShaftSafety) -> tuple[Picture, ...]:
    """Return the least safety by web and, of several speeds, over speed."""
    worst = shaft.worst
    said = f"least {shaft.safety:.3f} at web {worst.web}, {worst.speed_rpm:,.0f} rpm"
    pictures = [picture("safety-by-web", f"Least safety of each part of each web: {said}", _by_web, shaft)]
    if len(shaft.speeds) > 1:
        pictures += [
            picture("safety-over-speed", f"Least safety of each web over speed: {said}", _over_speed, shaft),
            picture("safety-map", f"Map of the least safety over webs and speeds: {said}", _map, shaft),
        ]
    return tuple(pictures)


def stress_picture(worst: WorstPlace, name: str = "stress-over-cycle") -> Picture:
    """Return the stress of the worst point over the crank angle."""
    signed = worst.over_cycle.signed_von_mises_MPa
    return picture(
        name,
        f"Stress over the crank angle at the worst point, web {worst.web} at {worst.speed_rpm:,.0f} rpm: "
        f"signed von Mises {max(signed):.0f} MPa at {worst.highest_deg:g} deg to {min(signed):.0f} MPa at "
        f"{worst.lowest_deg:g} deg",
        _stress,
        worst,
    )


def side_picture(shaft: ShaftSafety, journal_z_mm: Sequence[float], shape: CrankSide) -> Picture:
    """Return the crank from the side with the least safety of each web.

    Args:
        journal_z_mm: main journals along the shaft, one more than throws.
    """
    worst = shaft.worst
    said = f"Least safety of each web on the crank seen from the side: {shaft.safety:.3f} at web {worst.web}"
    return picture("safety-on-crank", said, _on_crank, shaft, journal_z_mm, shape)


def web_pictures(speed_rpm: float, sections: WebSections) -> tuple[Picture, ...]:
    """Return bending, torque and shear of every web over the crank angle at a speed."""
    pictures = (
        ("bending", "Bending moment in the plane of the throw", "N m", sections.bending_Nm),
        ("side-bending", "Bending moment across the throw", "N m", sections.side_bending_Nm),
        ("torque", "Torque", "N m", sections.torque_Nm),
        ("shear", "Force along the throw", "N", sections.shear_N),
    )
    return tuple(
        picture(
            f"web-{name}",
            f"{what} in each web over the cycle at {speed_rpm:,.0f} rpm: {curves.min():,.0f} to "
            f"{curves.max():,.0f} {unit}",
            _curves,
            sections.angle_deg,
            curves.reshape(-1, curves.shape[2]),
            f"{what.lower()} ({unit})",
        )
        for name, what, unit, curves in pictures
    )


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


def _by_web(axes: Any, shaft: ShaftSafety) -> None:
    webs = np.array([web.web for web in shaft.webs])
    judged = [part for part in _PARTS if any(getattr(web, part) is not None for web in shaft.webs)]
    wide = _BARS / len(judged)
    for number, part in enumerate(judged):
        values = [getattr(web, part) for web in shaft.webs]
        heights = [np.nan if value is None else value for value in values]
        place = webs + (number - (len(judged) - 1) / 2) * wide
        axes.bar(place, heights, wide, label=part.replace("_", " "), color=_PARTS[part])
    axes.axhline(1.0, **_LIMIT)
    axes.set_xticks(webs)
    axes.set(xlabel="web, from the free end", ylabel="least safety", ylim=(0, None))
    plain(axes)


def _over_speed(axes: Any, shaft: ShaftSafety) -> None:
    speeds = [at.speed_rpm for at in shaft.speeds]
    for number, web in enumerate(shaft.webs):
        axes.plot(speeds, web.over_speeds, lw=0.9, label=f"web {web.web}", **curve_style(number))
    axes.plot(speeds, [at.safety for at in shaft.speeds], "k", lw=1.6, label="shaft")
    axes.axhline(1.0, **_LIMIT)
    axes.set(xlabel="speed (rpm)", ylabel="least safety", ylim=(0, None), xlim=(speeds[0], speeds[-1]))
    plain(axes)


def _map(axes: Any, shaft: ShaftSafety) -> None:
    """Draw the least safety as a colour over web and speed; each cell reaches half way to the next speed."""
    speeds = np.array([at.speed_rpm for at in shaft.speeds])
    values = np.array([web.over_speeds for web in shaft.webs])
    middle = (speeds[1:] + speeds[:-1]) / 2
    edges = np.concatenate([[speeds[0]], middle, [speeds[-1]]])
    webs = np.arange(len(values) + 1) + 0.5
    shades = axes.pcolormesh(edges, webs, values, cmap=_SHADES)
    axes.figure.colorbar(shades, ax=axes, label="least safety").ax.tick_params(labelsize=8)
    axes.plot(shaft.worst.speed_rpm, shaft.worst.web, "kx", label="least")
    axes.set_yticks([web.web for web in shaft.webs])
    axes.set(xlabel="speed (rpm)", ylabel="web, from the free end")
    plain(axes)


def _on_crank(axes: Any, shaft: ShaftSafety, journal_z_mm: Sequence[float], shape: CrankSide) -> None:
    """Draw journals, pins and webs as rectangles; throws that point down lie below the axis."""
    from matplotlib.cm import ScalarMappable
    from matplotlib.colors import Normalize

    safeties = np.array([web.safety for web in shaft.webs])
    shades = ScalarMappable(Normalize(safeties.min(), safeties.max()), _SHADES)
    colours = shades.to_rgba(safeties)
    for place in journal_z_mm:
        _box(axes, place, shape.journal_mm, 0.0, shape.journal_diameter_mm, _PLAIN)
    middles = [(a + b) / 2 for a, b in pairwise(journal_z_mm)]
    for number, (middle, height) in enumerate(zip(middles, shape.heights_mm, strict=True)):
        _box(axes, middle, shape.pin_mm, height, shape.pin_diameter_mm, _PLAIN)
        span = abs(height) + shape.pin_diameter_mm / 2 + shape.journal_diameter_mm / 2
        centre = np.sign(height or 1.0) * (span / 2 - shape.journal_diameter_mm / 2)
        for side, web in ((-1, 2 * number), (1, 2 * number + 1)):
            place = middle + side * (shape.pin_mm + shape.web_mm) / 2
            _box(axes, place, shape.web_mm, centre, span, colours[web])
            _value(axes, safeties[web], (place, centre + np.sign(height or 1.0) * span / 2))
    beside = {"location": "bottom", "aspect": 40, "label": "least safety"}
    axes.figure.colorbar(shades, ax=axes, **beside).ax.tick_params(labelsize=8)
    axes.set_aspect("equal")
    axes.margins(0.02, _VALUES)
    axes.set(xlabel="along the shaft (mm), from the free end", yticks=[])
    plain(axes)
    width, _ = axes.figure.get_size_inches()
    axes.figure.set_size_inches(width, _SCALES_INCHES + 0.9 * width * axes.get_data_ratio())


def _value(axes: Any, safety: float, end: tuple[float, float]) -> None:
    """Write a safety upright at the outer end of its web, where many webs leave room for it."""
    up = 1 if end[1] > 0 else -1
    style = {"va": "bottom" if up > 0 else "top", "ha": "center", "rotation": 90, "fontsize": 6}
    axes.annotate(f"{safety:.2f}", end, (0, 2 * up), textcoords="offset points", **style)


def _box(axes: Any, z_mm: float, wide_mm: float, y_mm: float, high_mm: float, colour: Any) -> None:
    from matplotlib.patches import Rectangle

    corner = z_mm - wide_mm / 2, y_mm - high_mm / 2
    axes.add_patch(Rectangle(corner, wide_mm, high_mm, facecolor=colour, edgecolor=GREY, linewidth=0.5))


def _curves(axes: Any, angle_deg: Array, curves: Array, name: str) -> None:
    for number, curve in enumerate(curves):
        axes.plot(angle_deg, curve, lw=0.9, label=f"web {number + 1}", **curve_style(number))
    axes.set(xlabel="crank angle (deg)", ylabel=name, xlim=(angle_deg[0], angle_deg[-1]))
    plain(axes)


def _stress(axes: Any, worst: WorstPlace) -> None:
    angle_deg = worst.over_cycle.angle_deg
    for number, (name, curve) in enumerate(worst.curves):
        axes.plot(angle_deg, curve, label=name, **(_EQUIVALENT if not number else curve_style(number - 1)))
    for angle in (worst.highest_deg, worst.lowest_deg):
        axes.axvline(angle, color=GREY, ls=":", lw=1.0)
    axes.set(xlabel="crank angle (deg)", ylabel="stress (MPa)", xlim=(angle_deg[0], angle_deg[-1]))
    plain(axes)


def _polar(axes: Any, number: int, force_N: Array, most_kN: float) -> None:
    axes.set_position((0.08, 0.08, 0.84, 0.76))
    x, y = np.hstack([force_N, force_N[:, :1]]) / N_PER_KN
    polar_frame(axes, y + 1j * x, most_kN, circles=3)
    axes.plot(np.arctan2(x, y), np.hypot(x, y), "C0", lw=1.0)
    axes.set_title(f"bearing {number} (kN)", fontsize=9, loc="left")
