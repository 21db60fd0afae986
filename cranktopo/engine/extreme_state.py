"""An extreme state of the throw's loads, and the loads that such states are found in."""

from __future__ import annotations

from dataclasses import dataclass

from cranktopo.design.schema import Scene
from cranktopo.engine.analysis import Extreme, LoadAnalysis
from cranktopo.engine.load_case import LoadCase


@dataclass(frozen=True)
class ExtremeState:
    """An extreme state of the throw's loads.

    Attributes:
        name: `max_radial`, `max_torque`, `min_torque`, `max_tangential`, `overspeed_inertia` or another of
            the load cases.
        case: its loads, under the name of the load case that it would be.
        deg: crank angle from firing top dead centre; None when the scene gives only the value.
        unit: the scene does not tell its size.
        redundant: why it needs no load case of its own; empty when it is one.
    """

    name: str
    case: LoadCase
    deg: float | None = None
    unit: bool = False
    redundant: str = ""


@dataclass(frozen=True)
class ThrowLoads:
    """A throw and its loads, from which its extreme states are found.

    Attributes:
        analyses: its loads at the engine's speed, and after it at others where its torque is extreme.
        top: its loads at the highest speed: the engine's, or its overspeed.
        enabled: names of the effects that are on.
    """

    scene: Scene
    analyses: tuple[LoadAnalysis, ...]
    top: LoadAnalysis
    enabled: frozenset[str]

    @property
    def analysis(self) -> LoadAnalysis:
        """Its loads at the engine's speed."""
        return self.analyses[0]


def place_of(analysis: LoadAnalysis, extreme: Extreme) -> str:
    """Return where over the cycle an extreme is, in words; empty where the scene gives only the value."""
    if extreme.deg is None:
        return ""
    place = f", {extreme.place}" if extreme.place else ""
    return f"{extreme.deg:g} deg, {analysis.engine.speed_rpm:g} rpm{place}"
