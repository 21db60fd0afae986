"""Closed triangle surfaces: the mesh, its files, its passage to the boolean engine."""
