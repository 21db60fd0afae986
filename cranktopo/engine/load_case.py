"""Load cases of a throw."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal

from pydantic import ConfigDict, Field

from cranktopo.base.result import Result
from cranktopo.base.units import number_text
from cranktopo.design.load_kinds import LOAD_KINDS

if TYPE_CHECKING:
    LoadKind = str
else:
    LoadKind = Literal[tuple(LOAD_KINDS)]


class LoadCase(Result):
    """One load case of a throw; forces are those of the full throw."""

    model_config = ConfigDict(extra="forbid")  # a script that misspells a load would otherwise go without it

    name: str
    kind: LoadKind
    """Kind of load, and with it the mirror symmetry about the mid-pin plane."""
    radial_N: float = 0.0
    """Force on the crankpin along -y (compression of the rod), N."""
    tangential_N: float = 0.0
    """Force on the crankpin along x, N."""
    torque_Nm: float = 0.0
    """Torque at the two mid-journal planes, equal and opposite, N m."""
    speed_rpm: float = 0.0
    """Speed for body forces, rpm (0: none)."""
    source: str = Field(default="", validation_alias="from", serialization_alias="from")
    """Origin of the numbers, one sentence."""

    @property
    def label(self) -> str:
        """Name and load, as in `bending, 32,377 N`."""
        loads = (("N", self.radial_N or self.tangential_N), ("N m", self.torque_Nm), ("rpm", self.speed_rpm))
        return ", ".join([self.name, *(f"{number_text(value)} {unit}" for unit, value in loads if value)])

    @property
    def size(self) -> float:
        """Force on the pin or torque, whichever there is, N or N m."""
        return self.radial_N or self.torque_Nm or self.tangential_N

    @property
    def has_body_force(self) -> bool:
        """True where the throw's own mass loads it: no point moves by the work of such a case."""
        return self.speed_rpm != 0
