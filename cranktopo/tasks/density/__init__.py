"""SIMP density optimisation of the web, in memory."""
