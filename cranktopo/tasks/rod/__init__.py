"""Analytic strength of the connecting rod and of the piston pin."""
