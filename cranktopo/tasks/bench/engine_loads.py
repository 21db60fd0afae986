"""Loads of an engine that several gauges and plots of one answer ask for, each computed once."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

from cranktopo.design.schema import Scene
from cranktopo.engine.analysis import LoadAnalysis, analyse
from cranktopo.engine.balance.free_forces import TurningMasses, turning_masses
from cranktopo.engine.balance.whole_engine import LoadedMainBearings, main_bearings


@dataclass(frozen=True)
class EngineLoads:
    """Loads of a design; each raises CranktopoError where the design does not tell it."""

    scene: Scene

    @property
    def turns(self) -> bool:
        """Tell whether there is an engine with a speed."""
        return self.scene.engine is not None and bool(self.scene.engine.speed_rpm)

    @cached_property
    def analysis(self) -> LoadAnalysis:
        """Cycle of the engine."""
        return analyse(self.scene)

    @cached_property
    def masses(self) -> TurningMasses:
        """Masses that turn and oscillate."""
        return turning_masses(self.scene)

    @cached_property
    def bearings(self) -> LoadedMainBearings:
        """Forces on the main bearings."""
        return main_bearings(self.scene, self.masses)
