"""SIMP density optimisation."""
