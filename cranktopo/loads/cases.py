"""Load cases handed to the optimiser and the judge, derived from the engine or unit loads."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal

from cranktopo.scene import Scene

LoadKind = Literal["bending", "torsion", "tangential", "centrifugal"]


@dataclass(frozen=True)
class LoadCase:
    """One load case of a throw; forces are those of the full throw.

    Attributes:
        name: unique name, used as key in metrics.
        kind: which load and which mirror symmetry about the mid-pin plane.
        radial_N: force on the crankpin along -y (compression of the rod), N.
        tangential_N: force on the crankpin along x, N.
        torque_Nm: torque at the two mid-journal planes, equal and opposite, N m.
        speed_rpm: speed for body forces, rpm.
        source: where the numbers come from, one sentence.
    """

    name: str
    kind: LoadKind
    radial_N: float = 0.0
    tangential_N: float = 0.0
    torque_Nm: float = 0.0
    speed_rpm: float = 0.0
    source: str = ""
