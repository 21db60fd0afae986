"""Loads over the working cycle: curves, extremes, load cases."""
