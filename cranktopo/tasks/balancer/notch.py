"""Grooves and cross holes of a round shaft in bending, and the size factor of its diameter.

Sources: DIN 743-2 (concentration factors of round grooves and cross holes, stress gradients); Shigley (6-20),
size factor in bending, here over that of the specimen.
"""

from __future__ import annotations

import math

from cranktopo.design.balancer import ShaftNotch

_LARGEST_SMALL_MM = 51.0


def groove_factor(outer_mm: float, root_mm: float, radius_mm: float) -> float:
    """Return the concentration factor in bending of a round groove, for the nominal stress at its root."""
    depth, ratio = (outer_mm - root_mm) / 2, radius_mm / root_mm
    return 1 + 1 / math.sqrt(0.2 * radius_mm / depth + 5.5 * ratio * (1 + 2 * ratio) ** 2)


def hole_factor(outer_mm: float, hole_mm: float) -> float:
    """Return the concentration factor in bending of a cross hole, for the stress of the net section."""
    ratio = hole_mm / outer_mm
    return 1.4 * ratio + 3 - 2.8 * math.sqrt(ratio)


def notch_stress(notch: ShaftNotch, outer_mm: float, bore_mm: float) -> tuple[float, float, float]:
    """Return the local stress of a moment, 1/mm3, the concentration factor, and the stress gradient, 1/mm."""
    ring = math.pi / 32 * (outer_mm**4 - bore_mm**4) / outer_mm
    if notch.kind == "hole":
        factor, radius = hole_factor(outer_mm, notch.diameter_mm), notch.diameter_mm / 2
        net = ring - notch.diameter_mm * (outer_mm**3 - bore_mm**3) / (6 * outer_mm)
        return factor / net, factor, 2 / radius + 2 / outer_mm
    root = notch.diameter_mm
    factor = groove_factor(outer_mm, root, notch.radius_mm)
    net = math.pi / 32 * (root**4 - bore_mm**4) / root
    return factor / net, factor, 2 / notch.radius_mm + 2 / root


def size_factor(diameter_mm: float, specimen_mm: float) -> float:
    """Return the strength of a shaft in bending over that of a specimen, for its diameter; at most 1."""
    return min(_shigley(diameter_mm) / _shigley(specimen_mm), 1.0)


def _shigley(diameter_mm: float) -> float:
    if diameter_mm <= _LARGEST_SMALL_MM:
        return 1.24 * diameter_mm**-0.107
    return 1.51 * diameter_mm**-0.157
