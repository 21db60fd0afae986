"""How far a throw is from the usual size, for which lengths that nobody gave are chosen."""

from __future__ import annotations

from cranktopo.scene.schema import Scene

_USUAL_MM = (42.0, 84.0)
"""Diameters of the thinner journal between which nothing is scaled."""


def usual_scale(scene: Scene) -> float:
    """Factor that brings the thinner journal to the nearest usual diameter; 1 within their range."""
    thinner = min(journal.outer_diameter_mm for journal, _ in scene.throw.journals)
    low, high = _USUAL_MM
    return min(max(thinner, low), high) / thinner
