"""What the rules look at: the scene, its extreme load states and closed-form compliances, once."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

from cranktopo.base.units import NMM_PER_NM
from cranktopo.design.goal.limit import Goal
from cranktopo.design.schema import Scene
from cranktopo.engine.balance.throw import ThrowBalance, throw_balance
from cranktopo.engine.forces import INERTIA_EFFECTS, RotatingForces, rotating_forces
from cranktopo.engine.load_case import LoadKind
from cranktopo.engine.plan.cost import Costing
from cranktopo.engine.plan.simulated import without
from cranktopo.engine.states import ExtremeState, extreme_states
from cranktopo.engine.throw_compliance import ThrowCompliance, throw_compliance


@dataclass(frozen=True)
class PlanningContext:
    """Facts of a scene that several rules share.

    Attributes:
        asymmetry: what is not its own mirror image in x; empty when all is.
        goal: None for the weighted compliance.
        vibrating: whether the torques are those of the vibrating shaft.
    """

    scene: Scene
    costing: Costing
    asymmetry: str
    goal: Goal | None = None
    vibrating: bool = False

    @cached_property
    def states(self) -> tuple[ExtremeState, ...]:
        """Extreme load states with every inertia effect."""
        vibration = {"torsional_vibration"} if self.vibrating else set()
        return extreme_states(self.scene, INERTIA_EFFECTS | vibration)

    @cached_property
    def compliance(self) -> ThrowCompliance:
        """Closed-form compliance of the throw without fillets: the optimiser's cells have none."""
        return throw_compliance(without(self.scene, "fillets"))

    @cached_property
    def balance(self) -> ThrowBalance:
        """Mass properties of the throw."""
        return throw_balance(self.scene)

    def state(self, kind: LoadKind) -> ExtremeState:
        """Return the state that would be the load case of a kind."""
        return next(state for state in self.states if state.case.kind == kind and not state.redundant)

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
    def top_speed_rpm(self) -> float:
        """Overspeed, else the engine's speed, rpm; 0 without an engine."""
        engine = self.scene.engine
        return max(engine.overspeed_rpm or 0.0, engine.speed_rpm) if engine else 0.0

    @cached_property
    def energy_Nmm(self) -> dict[LoadKind, float]:
        """Closed-form strain energy of the throw in each load case, N mm."""
        bend = self.compliance.bending_mm_per_N
        radial = self.state("bending").case.radial_N
        torque = self.state("torsion").case.torque_Nm * NMM_PER_NM
        tangential = self.state("tangential").case.tangential_N
        # What the counterweight balances still bends the throw: pin and weight pull at different places.
        spin = self.overspeed_pull_N + abs(self.rotating(self.top_speed_rpm).throw_N)
        return {
            "bending": radial**2 * bend / 2,
            "torsion": torque**2 * self.compliance.torsion_rad_per_Nmm / 2,
            "tangential": tangential**2 * self.compliance.tangential_mm_per_N / 2,
            "centrifugal": spin**2 * bend / 2,
        }
