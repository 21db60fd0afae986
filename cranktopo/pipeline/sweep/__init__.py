"""Sweeps: many points of a design space on Dask, and their table, Pareto front and page."""

from cranktopo.pipeline.sweep.interface import sweep

__all__ = ["sweep"]
