"""One load case of a throw."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Literal

LoadKind = Literal["bending", "torsion", "tangential", "centrifugal"]
_LARGE = 1000
"""Loads from which no decimals are told."""


@dataclass(frozen=True)
class LoadCase:
    """One load case of a throw; forces are those of the full throw.

    Attributes:
        kind: which load and which mirror symmetry about the mid-pin plane.
        radial_N: force on the crankpin along -y (compression of the rod), N.
        tangential_N: force on the crankpin along x, N.
        torque_Nm: torque at the two mid-journal planes, equal and opposite, N m.
        speed_rpm: speed for body forces, rpm (0: none).
        source: where the numbers come from, one sentence.
    """

    name: str
    kind: LoadKind
    radial_N: float = 0.0
    tangential_N: float = 0.0
    torque_Nm: float = 0.0
    speed_rpm: float = 0.0
    source: str = ""

    def as_json(self) -> dict[str, Any]:
        """The case as `loads --json` prints it."""
        return {
            "name": self.name,
            "kind": self.kind,
            "radial_N": self.radial_N,
            "tangential_N": self.tangential_N,
            "torque_Nm": self.torque_Nm,
            "speed_rpm": self.speed_rpm,
            "from": self.source,
        }

    @property
    def label(self) -> str:
        """Name and load, as in `bending, 32,377 N`."""
        loads = (("N", self.radial_N or self.tangential_N), ("N m", self.torque_Nm), ("rpm", self.speed_rpm))
        return ", ".join([self.name, *(f"{_rounded(value)} {unit}" for unit, value in loads if value)])


def _rounded(value: float) -> str:
    return f"{value:,.0f}" if abs(value) >= _LARGE else f"{value:.4g}"
