"""The largest radial force on the web."""

from __future__ import annotations

from cranktopo.base.near_ties import clearly_more
from cranktopo.engine.analysis import Extreme, LoadAnalysis
from cranktopo.engine.extreme_state import ExtremeState, ThrowLoads, place_of
from cranktopo.engine.forces import web_shares
from cranktopo.engine.load_case import LoadCase
from cranktopo.engine.load_type import LoadFacts, LoadType


def _states(throw: ThrowLoads) -> tuple[ExtremeState]:
    analysis = throw.analysis
    peak_force_N, cycle = analysis.engine.max_gas_force_N, analysis.cycle
    if peak_force_N is not None:
        share, source = max(web_shares(throw.scene)[0]), "engine.max_gas_force_N"
        source += f", times {share:.3g} for the web nearer to its rod" if share != 1 else ""
        case = LoadCase(name="bending", kind="bending", radial_N=peak_force_N * share, source=source)
        return (ExtremeState("max_radial", case),)
    if cycle is None:
        why = "unit load: neither engine.gas nor engine.max_gas_force_N is given"
        return (LOAD_TYPE.unit_state(why),)
    worst, at = _largest(throw, cycle.largest("web_force_N"))
    source = f"largest radial force on the web, at {place_of(at, worst)}"
    case = LoadCase(name="bending", kind="bending", radial_N=worst.value, source=source)
    return (ExtremeState("max_radial", case, worst.deg),)


def _largest(throw: ThrowLoads, rated: Extreme) -> tuple[Extreme, LoadAnalysis]:
    """Return the largest radial force with its analysis: at the engine's speed, or a push at the overspeed.

    The pull at the overspeed belongs to the state of the centrifugal load, which may have a case of its own.
    """
    top = throw.top.cycle
    push = rated if top is None else top.extreme("web_force_N")[0]
    return (push, throw.top) if clearly_more(push.value, abs(rated.value)) else (rated, throw.analysis)


def _energy_Nmm(facts: LoadFacts) -> float:
    return facts.state("bending").case.radial_N ** 2 * facts.compliance.bending_mm_per_N / 2


LOAD_TYPE = LoadType("bending", "max_radial", "radial_N", "radial force", _states, _energy_Nmm, unit_load=1e3)
