"""Scatter plot of stiffness against mass with lines of equal stiffness per mass."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import count, cycle
from typing import TYPE_CHECKING

from cranktopo.report.plot import Picture, picture
from cranktopo.tasks.throw_fea.quantities import BENDING, TORSION

if TYPE_CHECKING:
    from matplotlib.axes import Axes

LABELS = {TORSION: f"{TORSION.label} (kN m/rad)", BENDING: f"{BENDING.label} (kN/mm)"}
"""Of the axes of the stiffnesses."""
_Curves = Mapping[str, Sequence[float | None]]
"""Of a bound over the mass, by quantity and unit."""
_MARKERS = "osD^vP*X"
_CLOSEST_LINES, _MOST_LINES = 0.1, 9
"""Lines of equal stiffness per mass: least distance as a share of the baseline's, and how many."""


@dataclass(frozen=True)
class Point:
    """One design in the plot; the stiffness in the unit of the axis."""

    name: str
    mass_kg: float
    stiffness: float


@dataclass(frozen=True)
class Most:
    """Bound that no web of the envelope can beat, over the mass; the stiffness in the unit of the axis."""

    mass_kg: tuple[float, ...]
    stiffness: tuple[float, ...]


def draw_stiffness_over_mass(
    axes: Axes, points: Sequence[Point], baseline: int, label: str, most: Most | None = None
) -> None:
    """Draw stiffness over mass with lines of equal stiffness per mass.

    Args:
        baseline: number of the point that counts as 100 %.
    """
    masses = [point.mass_kg for point in points]
    stiffness = [point.stiffness for point in points]
    x_range = 0.92 * min(masses), 1.08 * max(masses)
    y_range = 0.88 * min(stiffness), 1.12 * max([*stiffness, *_at(most, masses)])
    axes.set(xlim=x_range, ylim=y_range, xlabel="mass of the throw (kg)", ylabel=label)
    ratio = stiffness[baseline] / masses[baseline]
    for factor in equal_ratio_factors([s / m / ratio for s, m in zip(stiffness, masses, strict=True)]):
        _equal_ratio(axes, factor, factor * ratio, x_range, y_range[1])
    for point, marker in zip(points, cycle(_MARKERS), strict=False):
        axes.scatter([point.mass_kg], [point.stiffness], marker=marker, label=point.name, zorder=2)
    if most is not None:
        axes.plot(most.mass_kg, most.stiffness, color="C3", label="no web of the envelope is above")
    axes.set_title(f"dashed: equal stiffness per mass, % of {points[baseline].name}", fontsize=9)


def _at(most: Most | None, masses: Sequence[float]) -> list[float]:
    if most is None:
        return []
    pairs = zip(most.mass_kg, most.stiffness, strict=True)
    return [stiffness for mass, stiffness in pairs if min(masses) <= mass <= max(masses)]


def most_by_label(curves: _Curves, baseline: Mapping[str, Point]) -> dict[str, Most]:
    """Return the curves of a bound by the label of their stiffness, over the original in each plot."""
    found = {}
    for stiffness, label in LABELS.items():
        if label in baseline and f"{stiffness.key}_percent" in curves:
            own, most = baseline[label], curves[f"{stiffness.key}_percent"]
            pairs = [(m, s) for m, s in zip(curves["mass_percent"], most, strict=True) if s is not None]
            masses, values = (tuple(row) for row in zip(*pairs, strict=True)) if pairs else ((), ())
            found[label] = Most(
                tuple(own.mass_kg * mass / 100 for mass in masses),
                tuple(own.stiffness * value / 100 for value in values),
            )
    return found


def equal_ratio_factors(ratios: Sequence[float]) -> list[float]:
    """Return the factors of the lines of equal stiffness per mass: every point between two of them."""
    steps = (round_number * _CLOSEST_LINES * 10**power for power in count() for round_number in (1, 2, 5))
    for step in steps:
        first, last = math.ceil(min(ratios) / step) - 1, math.floor(max(ratios) / step) + 1
        if last - first < _MOST_LINES:
            break
    return [number * step for number in range(max(first, 1), last + 1)]


def _equal_ratio(axes: Axes, factor: float, slope: float, x_range: tuple[float, float], top: float) -> None:
    low, high = x_range
    axes.plot([low, high], [slope * low, slope * high], "--", color="0.75", linewidth=1, zorder=1)
    x = min(high, top / slope)
    axes.annotate(
        f"{100 * factor:.0f}",
        (x, slope * x),
        (-3, -3),
        textcoords="offset points",
        color="0.45",
        fontsize=8,
        ha="right",
        va="top",
        bbox={"facecolor": "white", "edgecolor": "none", "pad": 1.0},
    )


def scatter_pictures(
    points: Mapping[str, Sequence[Point]], baseline: int, curves: _Curves
) -> tuple[Picture, ...]:
    """Stiffness over mass, one plot per stiffness.

    Args:
        points: by the label of the stiffness.
        baseline: number of the point that counts as 100 %.
        curves: of the bound, where there is one; the baseline is then the original.
    """
    most = most_by_label(curves, {label: row[baseline] for label, row in points.items()})
    return tuple(
        picture(
            f"scatter-{label.split()[0]}",
            _words(label, row),
            draw_stiffness_over_mass,
            row,
            baseline,
            label,
            most.get(label),
        )
        for label, row in points.items()
    )


def _words(label: str, points: Sequence[Point]) -> str:
    values = "; ".join(f"{p.name} {p.mass_kg:.3f} kg, {p.stiffness:.1f}" for p in points)
    return f"{label} over mass: {values}"
