"""By how much frequencies of disks on springs differ from those of the body, as far as it is measured."""

from __future__ import annotations

from cranktopo.design.schema import Scene

TOO_HIGH_PERCENT = 24
"""Most by which the first frequency in torsion of a shaft of few throws was above that of the body.

Of one throw; loads on its crankpin bend it between its bearings, which springs in torsion leave out. Measured
with `cranktopo modes`, as the page of torsional vibration tells.
"""
_FEW = 3
"""Throws up to which it was more than a hundredth too high."""


def few_throws(scene: Scene) -> bool:
    """Tell whether a shaft is so short that its disks may swing noticeably faster than its body."""
    return len(scene.shaft_angles_deg) <= _FEW
