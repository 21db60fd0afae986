"""The properties of all load cases of one kind, and the kinds that a design may have."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cache
from importlib import import_module
from typing import Literal, Protocol

from cranktopo.design.load_kinds import LOAD_KINDS
from cranktopo.engine.extreme_state import ExtremeState, ThrowLoads
from cranktopo.engine.load_case import LoadCase
from cranktopo.engine.throw_compliance import ThrowCompliance

_LoadField = Literal["radial_N", "tangential_N", "torque_Nm", "speed_rpm"]


class LoadFacts(Protocol):
    """Facts that the strain energy of a load case is estimated from, as the physics plan knows them."""

    @property
    def compliance(self) -> ThrowCompliance:
        """Closed-form compliance of the throw."""

    @property
    def centrifugal_N(self) -> tuple[float, float]:
        """Outward force on pin and webs of cells at the top speed, rods counted, fastened masses not, N."""

    def state(self, kind: str) -> ExtremeState:
        """Return the state that would be the load case of a kind."""

    def centrifugal_Nmm(self, pin: float, webs: float, *, fastened: bool = True) -> float:
        """Energy of bending by pin and webs, N, and of webs that their counterweights stretch."""


@dataclass(frozen=True)
class LoadType:
    """Properties of all load cases of one kind; its name is that of its weight and of its switch.

    Attributes:
        state: extreme load state that it comes from.
        load: field of a load case that tells its size.
        label: its load in words, as in `radial force 32,377 N`.
        states: extreme states of a throw that are of this kind, none or several.
        energy_Nmm: strain energy that its load case causes, in closed form.
        unit_load: load of a scene without an engine; 0 where there is no such case then.
        odd_in_x, odd_in_z: antisymmetric about the mirror plane of the webs, about the mid-pin plane.
    """

    name: str
    state: str
    load: _LoadField
    label: str
    states: Callable[[ThrowLoads], Sequence[ExtremeState]]
    energy_Nmm: Callable[[LoadFacts], float]
    unit_load: float = 0.0
    odd_in_x: bool = False
    odd_in_z: bool = False

    @property
    def turns(self) -> bool:
        """True of a torque, whose work is by an angle; that of a force is by a displacement."""
        return self.load == "torque_Nm"

    def unit_state(self, why: str) -> ExtremeState:
        """Return the state of a unit load, for a scene that does not tell its size."""
        numbers = {"name": self.name, "kind": self.name, self.load: self.unit_load, "source": why}
        return ExtremeState(self.state, LoadCase.model_validate(numbers), unit=True)


@cache
def load_type(name: str) -> LoadType:
    """Return a kind of load case by its name, from the file of that name."""
    found: LoadType = import_module(f"cranktopo.engine.load_cases.{name}").LOAD_TYPE
    return found


def load_types() -> tuple[LoadType, ...]:
    """Return the kinds of load cases in the order in which cases are listed."""
    return tuple(load_type(name) for name in LOAD_KINDS)
