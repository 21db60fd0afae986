"""Kinds of load cases, a file each: extreme states, symmetry, strain energy, estimate."""
