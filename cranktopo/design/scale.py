"""Lengths that nobody gave: how far a throw is from the usual size, and its usual elements."""

from __future__ import annotations

from cranktopo.design.halves import halves
from cranktopo.design.schema import Scene

_USUAL_MM = (42.0, 84.0)
"""Diameters of the thinner journal between which nothing is scaled."""


def usual_scale(scene: Scene) -> float:
    """Factor that brings the thinner journal to the nearest usual diameter; 1 within their range."""
    thinner = min(journal.outer_diameter_mm for journal, _ in scene.throw.journals)
    low, high = _USUAL_MM
    return min(max(thinner, low), high) / thinner


def default_element_size_mm(scene: Scene) -> float:
    """General element size by default: a tenth of the thinner journal, at most a third of a web, mm."""
    throw = scene.throw
    journal = min(throw.main_journal.outer_diameter_mm, throw.crankpin.outer_diameter_mm)
    return min(journal / 10, *(half.web.thickness_mm / 3 for half in halves(scene)))
