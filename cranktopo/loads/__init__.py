"""Crank kinematics, gas and inertia forces, load cases."""
