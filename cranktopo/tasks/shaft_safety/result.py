"""The shaft on its bearings with the safety of its webs: the JSON object of `shaft --json`."""

from __future__ import annotations

from cranktopo.base.result import UNLESS_NONE, Result
from cranktopo.design.assumed import Assumption
from cranktopo.tasks.dynamics.result import ShaftDynamics
from cranktopo.tasks.shaft.result import ContinuousShaft, ShaftEvaluation
from cranktopo.tasks.throw_fatigue.mesh_quality import JudgedQuality
from cranktopo.tasks.throw_fatigue.result import CriticalPoint


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


class StressOverCycle(Result):
    """Stress on the surface at a point over the cycle, to 0.001 MPa, in axes that lie in the surface."""

    angle_deg: tuple[float, ...]
    """Crank angles, after firing of the cylinder that fires first."""
    signed_von_mises_MPa: tuple[float, ...]
    """Von Mises stress with the sign of the first invariant, by which the point is judged."""
    along_MPa: tuple[float, ...]
    """Normal stress along the arc of the fillet; off the fillets square to the direction around."""
    around_MPa: tuple[float, ...]
    """Normal stress around the axis of the journal or pin; off the fillets square to the crank axis."""
    shear_MPa: tuple[float, ...]
    """Shear stress between these two."""
    along: tuple[float, float, float]
    """Unit vector of the first direction in the axes of the throw."""
    around: tuple[float, float, float]
    """Unit vector of the second one."""


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
    over_cycle: StressOverCycle
    """Its stress at every crank angle of that cycle."""

    @property
    def curves(self) -> tuple[tuple[str, tuple[float, ...]], ...]:
        """Return its stresses over the cycle with their names, the one that judges it first."""
        stress = self.over_cycle
        return (
            ("signed von Mises", stress.signed_von_mises_MPa),
            ("along the fillet" if self.critical.fillet else "along the crank", stress.along_MPa),
            ("around it", stress.around_MPa),
            ("shear", stress.shear_MPa),
        )

    @property
    def stress_words(self) -> str:
        """Return in a sentence its stress where that is highest and lowest, and what it is made of."""
        at = [self.over_cycle.angle_deg.index(angle) for angle in (self.highest_deg, self.lowest_deg)]
        first, *rest = (f"{name} {' and '.join(f'{c[i]:.0f}' for i in at)}" for name, c in self.curves)
        angles = f"{self.highest_deg:g} and {self.lowest_deg:g} deg"
        return f"Stress there at {angles}, MPa: {first}; {', '.join(rest)}."


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
    not_judged: str | None = UNLESS_NONE
    """Outlets of oil bores that are not judged, and from which place on they are."""
    left_off: str | None = UNLESS_NONE
    """Loads that the safety does not count although they are above the threshold, in words."""
    seconds: SafetySeconds
    """Time taken."""
    assumed: tuple[Assumption, ...]
    """Keys that the design does not give and the safety depends on."""


class BearingAtSpeed(Result):
    """A main bearing at a speed."""

    section: int
    """Its number from the free end, 1 first."""
    max_N: float
    """Largest force on it over the cycle."""
    deg: float
    """Crank angle of that."""
    film_um: float | None = UNLESS_NONE
    """Least thickness of its oil film."""
    pressure_MPa: float | None = UNLESS_NONE
    """Largest pressure of the film."""


class WebAtSpeed(Result):
    """A web at a speed."""

    throw: int
    web: int
    """Its number from the free end, 1 first."""
    moment_range_Nm: float
    """Largest less smallest bending moment in the plane of the throw over the cycle."""
    torque_range_Nm: float
    """The same of the torque."""


class SafetyAtSpeed(Result):
    """Least safety of the shaft at a speed."""

    value: float
    place: str
    """Part of the web that has it: pin_fillet, journal_fillet, outlets or elsewhere."""
    throw: int
    web: int


class ShaftAtSpeed(Result):
    """Loads of the bearings and webs of a shaft at a speed, and the least safety there."""

    rpm: float
    bearings: tuple[BearingAtSpeed, ...]
    webs: tuple[WebAtSpeed, ...]
    safety: SafetyAtSpeed | None = UNLESS_NONE
    """With `--method`."""


class WorstAtSpeed(Result):
    """Place and moment at which the shaft is least safe, in short."""

    rpm: float
    deg: float
    """Crank angle of the highest stress there."""
    safety: float
    place: str
    """The point in words."""
    throw: int
    web: int


class ShaftAssessment(ShaftEvaluation):
    """A whole crankshaft and the safety of its webs: the object that `shaft --json` prints."""

    speeds: tuple[ShaftAtSpeed, ...] = ()
    """Loads and safety in short, by speed; `on_bearings` and `safety` have all of it."""
    worst: WorstAtSpeed | None = UNLESS_NONE
    """Its least safety at all speeds, with `--method`."""
    seconds: SafetySeconds | None = UNLESS_NONE
    """Time taken, with `--method`."""
    safety: ShaftSafety | None = UNLESS_NONE
    """Safety of its webs, with `--method`."""
    dynamics: ShaftDynamics | None = UNLESS_NONE
    """Its vibration beside that, with `--dynamic`."""
    dynamic_safety: ShaftSafety | None = UNLESS_NONE
    """Safety of the webs of the shaft that vibrates, with `--dynamic` and `--method`."""


def assessment(
    evaluation: ShaftEvaluation,
    safety: ShaftSafety | None = None,
    dynamics: ShaftDynamics | None = None,
    dynamic_safety: ShaftSafety | None = None,
) -> ShaftAssessment:
    """Return a whole shaft with the safety of its webs, if they were judged, in full and in short."""
    by_speed = {at.speed_rpm: at for at in safety.speeds} if safety else {}
    return ShaftAssessment.model_construct(
        **dict(evaluation),
        speeds=tuple(_in_short(at, by_speed.get(at.speed_rpm)) for at in evaluation.on_bearings),
        worst=_worst_in_short(safety) if safety else None,
        seconds=safety.seconds if safety else None,
        safety=safety,
        dynamics=dynamics,
        dynamic_safety=dynamic_safety,
    )


def _in_short(at: ContinuousShaft, judged: SpeedSafety | None) -> ShaftAtSpeed:
    return ShaftAtSpeed(
        rpm=at.speed_rpm,
        bearings=tuple(
            BearingAtSpeed(
                section=one.bearing,
                max_N=one.largest_N,
                deg=one.at_deg,
                film_um=one.film_um,
                pressure_MPa=one.pressure_MPa,
            )
            for one in at.main_bearings
        ),
        webs=tuple(
            WebAtSpeed(
                throw=one.throw,
                web=one.web,
                moment_range_Nm=one.range_Nm,
                torque_range_Nm=one.torque_range_Nm,
            )
            for one in at.webs
        ),
        safety=_safety_in_short(judged) if judged else None,
    )


def _safety_in_short(judged: SpeedSafety) -> SafetyAtSpeed:
    throw = (judged.web + 1) // 2
    return SafetyAtSpeed(value=judged.safety, place=judged.part, throw=throw, web=judged.web)


def _worst_in_short(shaft: ShaftSafety) -> WorstAtSpeed:
    worst = shaft.worst
    return WorstAtSpeed(
        rpm=worst.speed_rpm,
        deg=worst.highest_deg,
        safety=shaft.safety,
        place=worst.critical.place,
        throw=worst.throw,
        web=worst.web,
    )
