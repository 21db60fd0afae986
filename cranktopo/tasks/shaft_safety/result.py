"""The shaft on its bearings with the safety of its webs: the JSON object of `shaft --json`."""

from __future__ import annotations

from cranktopo.base.result import UNLESS_NONE, Result
from cranktopo.design.assumed import Assumption
from cranktopo.tasks.fatigue.result import CriticalPoint, JudgedQuality
from cranktopo.tasks.shaft.result import ShaftEvaluation


class WebSafety(Result):
    """Least safety of one web over the cycle and all speeds."""

    web: int
    """Its number from the free end, 1 first."""
    throw: int
    """The throw that it belongs to."""
    pin_fillet: float
    """Least safety of its pin fillet."""
    journal_fillet: float
    """Least safety of its journal fillet."""
    outlets: float | None = UNLESS_NONE
    """Least safety of its oil outlets, where it has some."""
    elsewhere: float | None = UNLESS_NONE
    """Least safety of its rounded edges and faces."""
    safety: float
    """The least of these."""
    part: str
    """Part of the web with that safety: pin_fillet, journal_fillet, outlets or elsewhere."""
    speed_rpm: float
    """Speed of the least safety."""
    over_speeds: tuple[float, ...]
    """Its least safety at each of the speeds."""


class SpeedSafety(Result):
    """Least safety of the whole shaft over the cycle at one speed."""

    speed_rpm: float
    """Speed of the shaft."""
    safety: float
    """Least safety of all webs."""
    web: int
    """The web that has it."""
    part: str
    """Its part, named as for the webs."""


class WorstPlace(Result):
    """The point of least safety of the whole shaft at all speeds."""

    web: int
    """The web on which it lies, from the free end."""
    throw: int
    """The throw of that web."""
    speed_rpm: float
    """Speed at which it has that safety."""
    highest_deg: float
    """Crank angle of its highest stress, after firing of the cylinder that fires first."""
    lowest_deg: float
    """Crank angle of its lowest stress."""
    critical: CriticalPoint
    """The point in the axes of its throw, its stress and its safety."""


class SafetySeconds(Result):
    """Time that each part of the work took."""

    mesh: float
    """Meshes that follow the fillets."""
    unit_fields: float
    """Fields of the motions of both sections and of the loads."""
    stresses: float
    """Their stresses on the surface."""
    cycles: float
    """Forces and motions of the shaft at all speeds and angles."""
    safety: float
    """Safety of every point in every state."""


class ShaftSafety(Result):
    """Safety of every part of every web over the cycle and over speed."""

    method: str
    """Method of local stresses, as in `--method`."""
    safety: float
    """Least safety of the shaft."""
    worst: WorstPlace
    """Place and moment of that safety."""
    webs: tuple[WebSafety, ...]
    """The webs from the free end."""
    speeds: tuple[SpeedSafety, ...]
    """The speeds, slowest first."""
    load_states: int
    """Number of load states of each throw: angles times speeds."""
    quality: JudgedQuality
    """The mesh of the throw with the worst point, and its checks."""
    mesh_shortfall: str | None = UNLESS_NONE
    """Checks of the rule that this mesh misses, so that the safety is not sure."""
    left_off: str | None = UNLESS_NONE
    """Loads that the safety does not count although they are above the threshold, in words."""
    seconds: SafetySeconds
    """Time taken."""
    assumed: tuple[Assumption, ...]
    """Keys that the design does not give and the safety depends on."""


class ShaftAssessment(ShaftEvaluation):
    """A whole crankshaft and the safety of its webs: the object that `shaft --json` prints."""

    safety: ShaftSafety | None = UNLESS_NONE
    """Safety of its webs, with `--method`."""
