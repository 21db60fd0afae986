"""First natural frequency of a shaft in torsion by stiffness and inertia of its throws, with derivatives."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from cranktopo.base.arrays import Array, Complex
from cranktopo.base.errors import CranktopoError
from cranktopo.base.units import MM2_PER_M2
from cranktopo.design.crank import Side
from cranktopo.design.schema import Scene
from cranktopo.engine.throw_compliance import first_half_share
from cranktopo.engine.vibration.end_chain import end_chain
from cranktopo.engine.vibration.shaft_chain import ShaftChain, lossy_factor, shaft_chain
from cranktopo.numerics.disk_chain import DampedMode


@dataclass(frozen=True)
class FirstFrequency:
    """First natural frequency of a shaft of equal throws, and what a change of all of them makes of it.

    Attributes:
        by_torsion: derivative by the torsional stiffness of a throw, Hz / (N m/rad).
        by_inertia: derivative by the inertia of a throw, Hz / (kg mm2).
    """

    frequency_Hz: float
    by_torsion: float
    by_inertia: float


def first_frequency(scene: Scene, torsion_Nm_per_rad: float, inertia_kg_mm2: float) -> FirstFrequency:
    """Return the first natural frequency of a scene's shaft, whose throws are all alike.

    Raises:
        CranktopoError: no engine, or a shaft in which nothing swings.
    """
    throws = len(scene.shaft_angles_deg)
    shaft = shaft_chain(scene, inertia_kg_mm2, (torsion_Nm_per_rad,) * throws)
    mode = first_mode(scene, shaft)
    by_disk, by_spring = shaft.chain.frequency_slopes(mode)
    softer = 1 / torsion_Nm_per_rad**2
    by_torsion = softer * (
        _by_springs(scene, shaft, by_spring) + _by_ends(scene, shaft, torsion_Nm_per_rad, by_disk)
    )
    by_inertia = float(by_disk[shaft.driven].sum()) / MM2_PER_M2
    return FirstFrequency(mode.frequency_Hz, by_torsion, by_inertia)


def first_mode(scene: Scene, shaft: ShaftChain) -> DampedMode:
    """Return the slowest free vibration of a shaft; raises CranktopoError where none swings."""
    modes = shaft.chain.damped_modes()
    if not modes:
        raise CranktopoError(
            f"{scene.name}: nothing swings in its shaft, which has no natural frequency.",
            hint="Give what turns with it in [shaft], or less damping.",
        )
    return modes[0]


def _by_springs(scene: Scene, shaft: ShaftChain, by_spring: Complex) -> float:
    """Return what one unit less compliance of every throw does through the springs between the disks.

    Each is a series of two half throws, or of one and what joins the shaft there.
    """
    springs, share = shaft.chain.section_stiffness_Nm_per_rad(np.array(0.0)), first_half_share(scene)
    found = 0.0
    for behind in range(shaft.first, shaft.first + shaft.throws):
        for section, part in ((behind - 1, share), (behind, 1 - share)):
            if 0 <= section < len(springs):
                stiffer = springs[section] ** 2 * part / lossy_factor(scene)
                found += float((by_spring[section] * stiffer).real)
    return found


def _by_ends(scene: Scene, shaft: ShaftChain, torsion_Nm_per_rad: float, by_disk: Array) -> float:
    """Return what it does through the ends of the crank, whose inertia is split by the lever rule."""
    first, last, share = shaft.first, shaft.first + shaft.throws - 1, first_half_share(scene)
    found = 0.0
    sides: tuple[tuple[Side, float, int, int], ...] = (
        ("free", share, first, first - 1),
        ("output", 1 - share, last, last + 1),
    )
    for side, part, inner, tip in sides:
        end = end_chain(scene, side, part / torsion_Nm_per_rad)
        if end is not None:
            found -= float(by_disk[tip] - by_disk[inner]) * end.tip_by_before * part
    return found
