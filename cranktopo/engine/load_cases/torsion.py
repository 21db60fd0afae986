"""The largest torque ahead of or behind a throw, of either sign."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from cranktopo.base.units import NMM_PER_NM
from cranktopo.engine.analysis import Extreme, LoadAnalysis
from cranktopo.engine.extreme_state import ExtremeState, ThrowLoads, place_of
from cranktopo.engine.load_case import LoadCase
from cranktopo.engine.load_type import LoadFacts, LoadType

_Torque = tuple[LoadAnalysis, Extreme | None]
"""A torque and the analysis at its speed; None where the scene does not tell it."""


def _states(throw: ThrowLoads) -> tuple[ExtremeState, ...]:
    high, low = _torques(throw.analyses)
    shaft = throw.scene.shaft
    throws = "" if shaft is None or shaft.gives_stiffness else ", throws in closed form"
    largest = _state("max_torque", *high, throws)
    return (largest,) if low[1] is None else (largest, _state("min_torque", *low, throws))


def _torques(analyses: Sequence[LoadAnalysis]) -> tuple[_Torque, _Torque]:
    """Largest and smallest torque ahead of or behind a throw, each at the speed where it is that."""
    engine, found = analyses[0].engine, [(one, one.cycle.section_torque()) for one in analyses if one.cycle]
    high: _Torque = (analyses[0], None)
    low = high
    if found:
        at_high, at_low = max(found, key=lambda f: f[1][0].value), min(found, key=lambda f: f[1][1].value)
        high, low = (at_high[0], at_high[1][0]), (at_low[0], at_low[1][1])
    if engine.max_torque_Nm is not None:
        high = analyses[0], Extreme(engine.max_torque_Nm, None)
    if engine.min_torque_Nm is not None:
        low = analyses[0], Extreme(engine.min_torque_Nm, None)
    return high, low


def _state(name: str, analysis: LoadAnalysis, torque: Extreme | None, throws: str) -> ExtremeState:
    """Return an extreme of the torque; `throws` tells where the stiffness of a vibrating shaft is from."""
    if torque is None:
        return LOAD_TYPE.unit_state("unit load: neither engine.gas nor engine.max_torque_Nm is given")
    which = "largest" if name == "max_torque" else "smallest"
    vibrates = analysis.cycle is not None and analysis.cycle.torque.vibrates
    section = f"{torque.place} of the vibrating shaft{throws}" if vibrates else "behind a throw"
    source = f"{which} torque {section}, at {place_of(analysis, replace(torque, place=''))}"
    if torque.deg is None:
        source = f"engine.{name}_Nm"
    case = LoadCase(name="torsion", kind="torsion", torque_Nm=torque.value, source=source)
    return ExtremeState(name, case, torque.deg)


def _energy_Nmm(facts: LoadFacts) -> float:
    torque = facts.state("torsion").case.torque_Nm * NMM_PER_NM
    return torque**2 * facts.compliance.torsion_rad_per_Nmm / 2


LOAD_TYPE = LoadType(
    "torsion",
    "max_torque",
    "torque_Nm",
    "torque",
    _states,
    _energy_Nmm,
    unit_load=1.0,
    odd_in_x=True,
    odd_in_z=True,
)
