"""Topology and shape optimisation workbench for crankshaft webs."""
