"""Facts that the rules look at: the scene, its extreme load states and closed-form compliances, once."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from cranktopo.base.units import MM_PER_M, angular_speed_rad_s
from cranktopo.bodies.volume import bolted_mass
from cranktopo.design.goal.limit import Goal
from cranktopo.design.halves import halves, of_halves
from cranktopo.design.misfire import all_firing
from cranktopo.design.schema import Scene
from cranktopo.engine.analysis import analyse, at_speed
from cranktopo.engine.balance.throw import ThrowBalance, throw_balance
from cranktopo.engine.extreme_state import ExtremeState
from cranktopo.engine.forces import INERTIA_EFFECTS, RotatingForces, rotating_forces
from cranktopo.engine.histories import LoadHistory, joined_extremes
from cranktopo.engine.judged_speeds import slow_speed_rpm
from cranktopo.engine.load_type import load_types
from cranktopo.engine.plan.cost import Costing
from cranktopo.engine.plan.simulated import strip_features
from cranktopo.engine.states import extreme_states, governing
from cranktopo.engine.throw_compliance import (
    ThrowCompliance,
    radial_energy_Nmm,
    throw_compliance,
    web_stretch_energy_Nmm,
)


@dataclass(frozen=True)
class PlanningContext:
    """Facts of a scene that several rules share.

    Attributes:
        asymmetry: what is not its own mirror image in x; empty when all is.
        goal: None for the weighted compliance.
        vibrating: whether the torques are those of the vibrating shaft.
        centrifugal: whether the pull at the highest speed is in a load case of its own.
        for_stress: whether loads count by the stress that they add, not by their energy in an objective.
    """

    scene: Scene
    costing: Costing
    asymmetry: str
    goal: Goal | None = None
    vibrating: bool = False
    centrifugal: bool = False
    for_stress: bool = False

    @cached_property
    def states(self) -> tuple[ExtremeState, ...]:
        """Extreme load states with every inertia effect."""
        return self.states_without()

    def states_without(self, *inertia: str) -> tuple[ExtremeState, ...]:
        """Return the extreme load states without some of the inertia effects."""
        return extreme_states(self.scene, INERTIA_EFFECTS - set(inertia) | self._decided)

    @property
    def _decided(self) -> set[str]:
        decided = {"torsional_vibration": self.vibrating, "centrifugal": self.centrifugal}
        return {name for name, is_on in decided.items() if is_on}

    @property
    def tells_stress(self) -> bool:
        """True where radial force and torque are known, so that there is a level of stress."""
        return not any(state.unit for state in self.states if state.name in ("max_radial", "max_torque"))

    @cached_property
    def amplitudes(self) -> tuple[float, float]:
        """Half the range of the radial force (N) and of the torque (N m), largest of all judged speeds."""
        history = _joined(self.scene, self.states)
        pulls = [state.case.radial_N for state in self.states if state.name == "overspeed_inertia"]
        radial, torque = [np.ptp([*history.radial_N, *pulls])], [np.ptp(history.torque_Nm)]
        if (slow := self._slow) is not None:
            radial, torque = [*radial, np.ptp(slow.radial_N)], [*torque, np.ptp(slow.torque_Nm)]
        return float(max(radial)) / 2, float(max(torque)) / 2

    @property
    def _slow(self) -> LoadHistory | None:
        """Joined extremes at `slow_speed_rpm`; torques of a vibrating shaft are those of all its speeds."""
        if self.scene.engine is None or (rpm := slow_speed_rpm(self.scene, INERTIA_EFFECTS)) is None:
            return None
        at = at_speed(self.scene, rpm)
        states = self.states if self.vibrating else extreme_states(at, INERTIA_EFFECTS | self._decided)
        return _joined(at, states)

    @cached_property
    def compliance(self) -> ThrowCompliance:
        """Closed-form compliance of the throw without fillets: the optimiser's cells have none."""
        return throw_compliance(strip_features(self.scene, "fillets"))

    @cached_property
    def balance(self) -> ThrowBalance:
        """Mass properties of the throw."""
        return throw_balance(self.scene)

    def state(self, kind: str) -> ExtremeState:
        """Return the state that would be the load case of a kind."""
        return governing(self.states, kind)

    @property
    def unit_loads(self) -> bool:
        """True if a main load is a unit load, so that sizes cannot be compared."""
        return any(state.unit and not state.redundant for state in self.states)

    def rotating(self, speed_rpm: float) -> RotatingForces:
        """Centrifugal forces at a speed; the scene must have an engine."""
        if self.scene.engine is None:
            return RotatingForces(0.0, 0.0, 0.0)
        return rotating_forces(self.scene.engine, self.balance, self.scene.throw.radius_mm, speed_rpm)

    @property
    def overspeed_pull_N(self) -> float:
        """Outward pull of piston and rod on the pin at the highest speed, N; part of the centrifugal case."""
        pulls = [state.case.radial_N for state in self.states if state.name == "overspeed_inertia"]
        return -min([0.0, *pulls])

    @property
    def centrifugal_N(self) -> tuple[float, float]:
        """Outward force on the pin at the top speed, its own and that of the rods, and of both webs, N.

        On cells, which leave out the pull of what is fastened to the webs.
        """
        pin, webs = self.own_centrifugal_N
        return self.overspeed_pull_N + pin, webs - self.fastened_N

    @property
    def fastened_N(self) -> float:
        """Outward pull of bolted counterweights and plugs on both webs at the top speed, N."""
        kg_mm = sum(of_halves(self.scene, lambda half: bolted_mass(half).first_y))
        return kg_mm / MM_PER_M * angular_speed_rad_s(self.top_speed_rpm) ** 2

    @property
    def own_centrifugal_N(self) -> tuple[float, float]:
        """The same on meshes, all of the webs' pull, without rods and pistons: theirs is a radial force."""
        throw = self.rotating(self.top_speed_rpm).throw_N
        webs = sum(self.balance.web_kg_mm) / MM_PER_M * angular_speed_rad_s(self.top_speed_rpm) ** 2
        return throw - webs, webs

    def centrifugal_Nmm(self, pin: float, webs: float, *, fastened: bool = True) -> float:
        """Energy of bending by pin and webs, N, and of webs that their counterweights stretch.

        Args:
            fastened: bolted counterweights and plugs stretch them, too.
        """
        bent = radial_energy_Nmm(strip_features(self.scene, "fillets"), pin, webs / 2)
        per_kg_mm = angular_speed_rad_s(self.top_speed_rpm) ** 2 / MM_PER_M
        own = zip(self.balance.own_counterweights_kg_mm, self.balance.own_counterweights_kg, strict=True)
        return bent + sum(
            web_stretch_energy_Nmm(
                half,
                (moment if fastened else moment + bolted_mass(half).first_y) * per_kg_mm,
                abs(moment) / kg,
            )
            for half, (moment, kg) in zip(halves(self.scene), own, strict=True)
            if kg
        )

    @property
    def top_speed_rpm(self) -> float:
        """Overspeed, else the engine's speed, rpm; 0 without an engine."""
        engine = self.scene.engine
        return max(engine.own_speeds_rpm) if engine else 0.0

    @cached_property
    def energy_Nmm(self) -> dict[str, float]:
        """Closed-form strain energy of the throw in each load case, N mm."""
        return {kind.name: kind.energy_Nmm(self) for kind in load_types()}


def _joined(scene: Scene, states: Sequence[ExtremeState]) -> LoadHistory:
    return joined_extremes(analyse(all_firing(scene), INERTIA_EFFECTS), states)
