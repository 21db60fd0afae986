"""Polar plots of an engine's balance: free force, free moment, load of a main bearing."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from cranktopo.base.arrays import Array, Complex
from cranktopo.base.units import number_text
from cranktopo.engine.balance.free_forces import ORDERS
from cranktopo.engine.balance.whole_engine import AS_IT_IS, COUNTERWEIGHTED, WITH_SHAFTS, EngineBalance
from cranktopo.report.plot import Picture, picture, polar_frame

_TURN_DEG: Array = np.linspace(0.0, 360.0, 361)
_STYLES = {AS_IT_IS: "-", COUNTERWEIGHTED: "--", WITH_SHAFTS: ":"}
_BREAK = "\n"
_LEAST = 0.01
"""Share of the largest order below which one would be a dot."""


@dataclass(frozen=True)
class _Curve:
    label: str
    values: Complex
    colour: str
    style: str

    @property
    def largest(self) -> float:
        return float(np.abs(self.values).max())

    def size(self, unit: str) -> str:
        return f"{number_text(self.largest)} {unit}"


def balance_pictures(balance: EngineBalance) -> tuple[Picture, ...]:
    """Free force and moment by order and state, where any is left, and the load of one main bearing."""
    plots = []
    for name, label, unit in (("force", "Free force", "N"), ("moment", "Free moment", "N m")):
        curves = _free_curves(balance, name)
        if curves:
            plots.append(_polar(name, f"{label} over a turn", curves, unit))
    return (*plots, _bearing(balance))


def _free_curves(balance: EngineBalance, name: str) -> list[_Curve]:
    """Return each order over its turn, a line, an ellipse or a circle, and again where a state changes it."""
    largest = max(getattr(part, name).largest for parts in balance.free.values() for part in parts)
    curves = []
    for index, order in enumerate(ORDERS):
        before = None
        for state, parts in balance.free.items():
            ellipse = getattr(parts[index], name)
            if ellipse != before and ellipse.largest > _LEAST * largest:
                values = ellipse.over_turn(1, _TURN_DEG)
                curves.append(_Curve(f"order {order}\n{state}", values, f"C{index}", _STYLES[state]))
            before = ellipse
    return curves


def _bearing(balance: EngineBalance) -> Picture:
    """Return the load of the bearing that carries most, over the cycle."""
    index = balance.bearings[AS_IT_IS].most_loaded
    curves = [
        _Curve(state, bearings.load_N[index], f"C{number}", _STYLES[state])
        for number, (state, bearings) in enumerate(balance.bearings.items())
    ]
    return _polar("bearing", f"Load of main bearing {index + 1} over the cycle", curves, "N")


def _polar(name: str, title: str, curves: Sequence[_Curve], unit: str) -> Picture:
    maxima = "; ".join(f"{curve.label.replace(_BREAK, ' ')}: at most {curve.size(unit)}" for curve in curves)
    return picture(f"balance-{name}", f"{title}. {maxima}", _draw, title, curves, unit, polar=True)


def _draw(axes: Any, title: str, curves: Sequence[_Curve], unit: str) -> None:
    """Directions as in the engine: its plane of symmetry upright, the crank turning clockwise."""
    largest = max(curve.largest for curve in curves)
    polar_frame(axes, np.concatenate([curve.values for curve in curves]), largest, circles=4)
    for curve in curves:
        # Smaller curves lie on top of larger ones.
        axes.plot(
            np.angle(curve.values),
            np.abs(curve.values),
            curve.style,
            color=curve.colour,
            label=f"{curve.label}\n{curve.size(unit)}",
            zorder=3 - curve.largest / largest,
        )
    axes.figure.text(0.02, 0.93, f"{title} ({unit})", fontsize=9)
    axes.legend(fontsize=7, loc="upper left", bbox_to_anchor=(1.16, 1.12), frameon=False)
