"""The largest force across the throw on the crankpin."""

from __future__ import annotations

from cranktopo.base.units import NMM_PER_NM
from cranktopo.engine.analysis import Extreme
from cranktopo.engine.extreme_state import ExtremeState, ThrowLoads, place_of
from cranktopo.engine.load_case import LoadCase
from cranktopo.engine.load_type import LoadFacts, LoadType


def _states(throw: ThrowLoads) -> tuple[ExtremeState]:
    analysis = throw.analysis
    cycle, peak_torque_Nm = analysis.cycle, analysis.engine.max_torque_Nm
    if cycle is not None:
        worst = cycle.largest("tangential_force_N")
        source = f"largest tangential force, at {place_of(analysis, worst)}"
    elif peak_torque_Nm is not None:
        worst = Extreme(peak_torque_Nm * NMM_PER_NM / analysis.radius_mm, None)
        source = "engine.max_torque_Nm over the throw radius"
    else:
        why = "unit load: neither engine.gas nor engine.max_torque_Nm is given"
        return (LOAD_TYPE.unit_state(why),)
    case = LoadCase(name="tangential", kind="tangential", tangential_N=worst.value, source=source)
    return (ExtremeState("max_tangential", case, worst.deg),)


def _energy_Nmm(facts: LoadFacts) -> float:
    return facts.state("tangential").case.tangential_N ** 2 * facts.compliance.tangential_mm_per_N / 2


LOAD_TYPE = LoadType(
    "tangential",
    "max_tangential",
    "tangential_N",
    "tangential force",
    _states,
    _energy_Nmm,
    unit_load=1e3,
    odd_in_x=True,
)
