"""By how much frequencies of disks on springs differ from those of the body, as far as it is measured."""

from __future__ import annotations

from cranktopo.design.schema import Scene

TOO_HIGH_PERCENT = 24
"""Most by which the first frequency in torsion of a shaft of few throws was above that of the body.

Of one throw; loads on its crankpin bend it between its bearings, which springs in torsion leave out. Measured
with `cranktopo modes`, as the page of torsional vibration tells.
"""
TOO_LOW_PERCENT = 22
"""Most by which it was below that of the body, of one throw whose flywheel has a mass (`mass_kg`).

That holds the end of the shaft against bending, and the web beside it stands nearly still with the flywheel,
where the disk has it swing with the crankpin.
"""
FEW_THROWS_ERROR = f"{TOO_LOW_PERCENT} % too low to {TOO_HIGH_PERCENT} % too high"
_FEW = 3
"""Throws up to which it was more than a hundredth off."""


def few_throws(scene: Scene) -> bool:
    """Tell whether a shaft is so short that its disks may swing noticeably faster or slower than its body."""
    return len(scene.shaft_angles_deg) <= _FEW
