"""Crank kinematics, gas and inertia forces, load cases."""

from cranktopo.loads.cases import LoadCase, LoadKind, load_cases

__all__ = ["LoadCase", "LoadKind", "load_cases"]
