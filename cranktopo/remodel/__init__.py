"""Parametric web model and its exact solid."""
