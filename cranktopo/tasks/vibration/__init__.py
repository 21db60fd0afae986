"""Torsional vibration of the whole shaft over its range of speeds."""
