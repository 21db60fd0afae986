"""The bolted joints of a design: the JSON object of `bolts --json`."""

from __future__ import annotations

from cranktopo.base.result import Result
from cranktopo.design.assumed import Assumption
from cranktopo.tasks.bolts.joint import Shigley, Vdi


class JointCheck(Result):
    """One bolt of a joint, by VDI 2230 and by Shigley; a safety is null where nothing loads it."""

    name: str
    thread: str
    strength_class: str
    stress_area_mm2: float
    max_force_N: float
    """Largest force on one bolt along its axis; positive parts the joint."""
    min_force_N: float
    vdi_2230: Vdi
    shigley: Shigley
    smallest_safety: float
    """Smallest of VDI 2230: clamp, yield, fatigue, head pressure, thread."""
    governing: str
    """The one that is smallest."""


class BoltChecks(Result):
    """All bolted joints of a design."""

    schema_version: int = 1
    design: str
    joints: tuple[JointCheck, ...]
    assumed: tuple[Assumption, ...]
    """Diameter of the parts that the rod's bolt clamps, where the design leaves it to the boss."""
