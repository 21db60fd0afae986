"""Load cases of a throw, and the one table of their kinds."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from pydantic import ConfigDict, Field

from cranktopo.base.result import Result
from cranktopo.base.units import number_text

LoadKind = Literal["bending", "torsion", "tangential", "centrifugal"]
_LoadField = Literal["radial_N", "tangential_N", "torque_Nm", "speed_rpm"]
_LARGE = 1000
"""Loads from which no decimals are told."""


@dataclass(frozen=True)
class _LoadType:
    """Properties of all load cases of one kind; its name is that of its weight and of its switch.

    Attributes:
        state: extreme load state that it comes from.
        load: field of a load case that tells its size.
        label: its load in words, as in `radial force 32,377 N`.
        main: it always counts where sizes cannot be compared, and the others are compared with it.
        unit_load: load of a scene without an engine; 0 where there is no such case then.
        odd_in_x, odd_in_z: antisymmetric about the mirror plane of the webs, about the mid-pin plane.
    """

    name: LoadKind
    state: str
    load: _LoadField
    label: str
    main: bool = False
    unit_load: float = 0.0
    odd_in_x: bool = False
    odd_in_z: bool = False


LOAD_TYPES: dict[LoadKind, _LoadType] = {
    kind.name: kind
    for kind in (
        _LoadType("bending", "max_radial", "radial_N", "radial force", main=True, unit_load=1e3),
        _LoadType(
            "torsion",
            "max_torque",
            "torque_Nm",
            "torque",
            main=True,
            unit_load=1.0,
            odd_in_x=True,
            odd_in_z=True,
        ),
        _LoadType(
            "tangential", "max_tangential", "tangential_N", "tangential force", unit_load=1e3, odd_in_x=True
        ),
        _LoadType("centrifugal", "overspeed_inertia", "speed_rpm", "centrifugal force"),
    )
}
"""The kinds of load cases in the order in which cases are listed."""
MAIN_KINDS: tuple[LoadKind, ...] = tuple(name for name, kind in LOAD_TYPES.items() if kind.main)


class LoadCase(Result):
    """One load case of a throw; forces are those of the full throw."""

    model_config = ConfigDict(extra="forbid")  # a script that misspells a load would otherwise go without it

    name: str
    kind: LoadKind
    """Which load and which mirror symmetry about the mid-pin plane."""
    radial_N: float = 0.0
    """Force on the crankpin along -y (compression of the rod), N."""
    tangential_N: float = 0.0
    """Force on the crankpin along x, N."""
    torque_Nm: float = 0.0
    """Torque at the two mid-journal planes, equal and opposite, N m."""
    speed_rpm: float = 0.0
    """Speed for body forces, rpm (0: none)."""
    source: str = Field(default="", validation_alias="from", serialization_alias="from")
    """Where the numbers come from, one sentence."""

    @property
    def label(self) -> str:
        """Name and load, as in `bending, 32,377 N`."""
        loads = (("N", self.radial_N or self.tangential_N), ("N m", self.torque_Nm), ("rpm", self.speed_rpm))
        return ", ".join([self.name, *(f"{number_text(value)} {unit}" for unit, value in loads if value)])
