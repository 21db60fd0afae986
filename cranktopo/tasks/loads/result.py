"""The load analysis of a scene: the JSON object of `loads --json` and the columns of its CSV."""

from __future__ import annotations

import numpy as np
from pydantic import Field

from cranktopo.base.arrays import Array
from cranktopo.base.result import UNLESS_NONE, Result
from cranktopo.base.units import MM_PER_M
from cranktopo.design.assumed import Assumption
from cranktopo.engine.analysis import Cycle, Extreme, LoadAnalysis
from cranktopo.engine.analysis import extremes_of as extremes_of_curve
from cranktopo.engine.balance.crank import CrankMass
from cranktopo.engine.balance.throw import ThrowBalance
from cranktopo.engine.gas import STEP_DEG
from cranktopo.engine.load_case import LoadCase, LoadKind
from cranktopo.engine.performance import piston_motion
from cranktopo.engine.plan.effect import Effect
from cranktopo.engine.states import ExtremeState

_EXTREMES = (
    "gas_force_N",
    "inertia_force_N",
    "small_end_force_N",
    "rod_force_N",
    "side_force_N",
    "tangential_force_N",
    "radial_force_N",
    "torque_Nm",
    "main_journal_force_N",
    "web_force_N",
    "crankpin_force_N",
)


class At(Result):
    """A value and the crank angle where it occurs; null where the scene does not give it."""

    value: float | None = None
    deg: float | None = None


class Range(Result):
    """Largest and smallest value over the cycle."""

    max: At = At()
    min: At = At()


class EngineTorque(Result):
    """Torque of the engine without friction, N m."""

    mean: float | None = None
    max: float | None = None
    max_deg: float | None = None
    min: float | None = None
    min_deg: float | None = None


class PistonExtremes(Result):
    """Motion of the piston, positive away from the head."""

    stroke_mm: float
    mean_speed_m_per_s: float
    speed_m_per_s: Range
    acceleration_m_per_s2: Range


class SeriesDifference(Result):
    """Largest difference of the textbook series from the exact motion, percent of the peak."""

    displacement: float
    velocity: float
    acceleration: float


class ThrowMassProperties(Result):
    """Mass properties of the throw, and its balance with the rod."""

    rotating_unbalance_kg_mm: float
    inertia_kg_mm2: float
    counterweight_kg_mm: float
    """Mass times radius that counterweights of both webs need beside their own, as `balance` has it."""
    balance_factor_percent: float | None
    """Percent of the oscillating mass that the throw balances; null where nothing oscillates."""
    own_counterweight_kg_mm: float
    own_counterweight_kg: float
    own_second_counterweight_kg: float
    throw_unbalance_kg_mm: float
    lateral_unbalance_kg_mm: float
    rod_inertia_kg_mm2: float
    throw_mass_kg: float
    web_mass_kg: float
    second_web_mass_kg: float
    journal_mass_kg: float
    crankpin_mass_kg: float


class WebClearance(Result):
    """Room of web and counterweight to piston and crankcase."""

    room_mm: dict[str, float]
    told: str


class LoadState(Result):
    """An extreme load state, and why it needs no load case of its own."""

    name: str
    deg: float | None
    kind: LoadKind
    radial_N: float
    tangential_N: float
    torque_Nm: float
    speed_rpm: float
    redundant_because: str


class LoadsAtSpeed(Result):
    """The loads of a scene at one speed; values that the scene does not give are null."""

    schema_version: int = 1
    design: str
    speed_rpm: float | None
    cycle_deg: float | None
    rods_per_pin: int | None
    points: int
    pressure_source: str | None
    extremes: dict[str, Range]
    engine_torque_Nm: EngineTorque
    indicated_work_per_cylinder_J: float | None
    indicated_mean_pressure_MPa: float | None
    """Work of a cycle over the swept volume; friction is not known."""
    indicated_power_kW: float | None
    """Power of all cylinders without friction."""
    rated_power: str | None = UNLESS_NONE
    """Rated power beside the power of the cylinder pressure, where the design has one."""
    misfire: tuple[int, ...] | None = UNLESS_NONE
    """Cylinders that do not fire, where there are any; the work is that of one that fires."""
    silent: str = Field(default="", exclude=True)
    """Sentence on them."""
    pressure: str = Field(default="", exclude=True)
    """Sentence on the pressure at the speeds asked for, where none of them is the engine's own."""
    piston: PistonExtremes | None
    series_difference_percent: SeriesDifference | None
    balance: ThrowMassProperties
    crank: CrankMass | None = UNLESS_NONE
    """Mass properties of the whole crank, where the design has `[crank]`."""
    clearance: WebClearance
    load_cases: tuple[LoadCase, ...]
    extreme_states: tuple[LoadState, ...]
    effects: tuple[Effect, ...]
    warnings: tuple[str, ...]
    """Signs of a cylinder pressure that no engine has, one line each."""
    assumed: tuple[Assumption, ...]


class Loads(LoadsAtSpeed):
    """The loads of a scene at its speed, or at the first of several."""

    sweep: tuple[LoadsAtSpeed, ...] | None = UNLESS_NONE
    """The loads at every speed of a sweep, beside those at its first."""


def curve_columns(analysis: LoadAnalysis) -> dict[str, Array]:
    """Return all curves of one speed as columns with units in their names.

    Where throws or webs differ, forces without a place in their name are those of `Cycle.place`, and the
    forces of every place follow.
    """
    cycle = analysis.cycle
    if cycle is None:
        return {}
    motion = piston_motion(analysis.engine, analysis.radius_mm, cycle.forces.angle_deg)
    columns = {
        "speed_rpm": np.full_like(cycle.forces.angle_deg, analysis.engine.speed_rpm),
        "angle_deg": cycle.forces.angle_deg,
        "pressure_MPa": cycle.pressure.pressure_MPa,
        **cycle.forces.curves(),
        **{f"piston_{name}": curve for name, curve in vars(motion).items()},
    }
    for number, torque in enumerate(cycle.torque.passed_on_Nm, start=1):
        columns[f"torque_behind_throw_{number}_Nm"] = torque
    for place, forces in cycle.unlike if cycle.place else ():
        columns |= {_at_place(name, place): curve for name, curve in forces.curves().items()}
    return columns


def _at_place(name: str, place: str) -> str:
    stem, unit = name.rsplit("_", 1)
    return f"{stem}_{place.replace(' ', '_')}_{unit}"


def extremes_of(analysis: LoadAnalysis | None) -> dict[str, Range]:
    """Return the extremes of every curve; of a scene without curves the peaks that it gives."""
    result = dict.fromkeys(_EXTREMES, Range())
    if analysis is not None and analysis.cycle is not None:
        found = analysis.cycle.extremes()
        return {name: Range(max=_at(found[name][0]), min=_at(found[name][1])) for name in _EXTREMES}
    if analysis is not None:
        engine = analysis.engine
        result["gas_force_N"] = Range(max=At(value=engine.max_gas_force_N))
        result["torque_Nm"] = Range(max=At(value=engine.max_torque_Nm), min=At(value=engine.min_torque_Nm))
    return result


def piston_of(analysis: LoadAnalysis) -> PistonExtremes:
    """Return stroke, mean and largest speed of the piston, and its largest accelerations."""
    engine, radius = analysis.engine, analysis.radius_mm
    angle = np.arange(0.0, 360.0, STEP_DEG)
    motion = piston_motion(engine, radius, angle)
    speed, acceleration = (
        Range(max=_at(high), min=_at(low))
        for high, low in (
            extremes_of_curve(angle, curve) for curve in (motion.speed_m_per_s, motion.acceleration_m_per_s2)
        )
    )
    return PistonExtremes(
        stroke_mm=2 * radius,
        mean_speed_m_per_s=4 * radius / MM_PER_M * engine.speed_rpm / 60,
        speed_m_per_s=speed,
        acceleration_m_per_s2=acceleration,
    )


def engine_torque_of(cycle: Cycle | None) -> EngineTorque:
    """Return mean and extremes of the engine's torque."""
    if cycle is None:
        return EngineTorque()
    mean, high, low = cycle.engine_torque()
    return EngineTorque(mean=mean, max=high.value, max_deg=high.deg, min=low.value, min_deg=low.deg)


def balance_of(balance: ThrowBalance) -> ThrowMassProperties:
    """Return the balance of a throw with units in the names."""
    return ThrowMassProperties(
        rotating_unbalance_kg_mm=balance.rotating_unbalance_kg_mm,
        inertia_kg_mm2=balance.inertia_kg_mm2,
        counterweight_kg_mm=balance.counterweight_kg_mm,
        balance_factor_percent=balance.balance_factor_percent,
        own_counterweight_kg_mm=balance.own_counterweight_kg_mm,
        own_counterweight_kg=balance.own_counterweights_kg[0],
        own_second_counterweight_kg=balance.own_counterweights_kg[1],
        throw_unbalance_kg_mm=balance.throw_unbalance_kg_mm,
        lateral_unbalance_kg_mm=balance.lateral_unbalance_kg_mm,
        rod_inertia_kg_mm2=balance.rod_inertia_kg_mm2,
        throw_mass_kg=balance.mass_kg,
        web_mass_kg=balance.web_kg,
        second_web_mass_kg=balance.second_web_kg,
        journal_mass_kg=balance.journal_kg,
        crankpin_mass_kg=balance.crankpin_kg,
    )


def state_of(state: ExtremeState) -> LoadState:
    """Return an extreme state with its loads beside its name."""
    case = state.case
    return LoadState(
        name=state.name,
        deg=state.deg,
        kind=case.kind,
        radial_N=case.radial_N,
        tangential_N=case.tangential_N,
        torque_Nm=case.torque_Nm,
        speed_rpm=case.speed_rpm,
        redundant_because=state.redundant,
    )


def _at(extreme: Extreme) -> At:
    return At(value=extreme.value, deg=extreme.deg)
