"""Crank kinematics, gas and inertia forces, load cases."""

from cranktopo.loads.analysis import LoadAnalysis, analyse, at_speed
from cranktopo.loads.balance import ThrowBalance, throw_balance
from cranktopo.loads.bearings import bearing_spring_N_per_mm
from cranktopo.loads.cases import LoadCase, LoadKind, load_cases
from cranktopo.loads.states import ExtremeState, extreme_states

__all__ = [
    "ExtremeState",
    "LoadAnalysis",
    "LoadCase",
    "LoadKind",
    "ThrowBalance",
    "analyse",
    "at_speed",
    "bearing_spring_N_per_mm",
    "extreme_states",
    "load_cases",
    "throw_balance",
]
