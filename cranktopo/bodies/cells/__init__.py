"""Structured grid of the half throw: masks, partial-volume cells, symmetry."""
