"""First natural frequency of a shaft in torsion by stiffness and inertia of its throws, with derivatives."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from cranktopo.base.arrays import Array, Complex
from cranktopo.base.errors import CranktopoError
from cranktopo.base.units import MM2_PER_M2
from cranktopo.design.crank import Side
from cranktopo.design.crank_throws import own_throws, throw_scenes
from cranktopo.design.schema import Scene
from cranktopo.engine.balance.throw import throw_balance
from cranktopo.engine.throw_compliance import first_half_share, throw_stiffness_Nm_per_rad
from cranktopo.engine.vibration.end_chain import end_chain
from cranktopo.engine.vibration.shaft_chain import ShaftChain, lossy_factor, shaft_chain
from cranktopo.numerics.disk_chain import DampedMode


@dataclass(frozen=True)
class FirstFrequency:
    """First natural frequency of a shaft, and what a change of the design's own throws makes of it.

    Attributes:
        by_torsion: derivative by their torsional stiffness, Hz / (N m/rad).
        by_inertia: derivative by their inertia, Hz / (kg mm2).
    """

    frequency_Hz: float
    by_torsion: float
    by_inertia: float


def first_frequency(scene: Scene, torsion_Nm_per_rad: float, inertia_kg_mm2: float) -> FirstFrequency:
    """Return the first natural frequency of a scene's shaft.

    Args:
        torsion_Nm_per_rad, inertia_kg_mm2: of each of the design's own throws; those that a crank takes from
            other designs are as their closed forms have them.

    Raises:
        CranktopoError: no engine, or a shaft in which nothing swings.
    """
    _ = scene.shaft_angles_deg  # refuses a scene without an engine
    own = own_throws(scene)
    throws = [
        _Throw(torsion_Nm_per_rad, inertia_kg_mm2, first_half_share(throw))
        if mine
        else _Throw(throw_stiffness_Nm_per_rad(throw), throw_balance(throw).inertia_kg_mm2, None)
        for throw, mine in zip(throw_scenes(scene), own, strict=True)
    ]
    shaft = shaft_chain(
        scene, tuple(throw.inertia_kg_mm2 for throw in throws), tuple(throw.stiffness for throw in throws)
    )
    mode = first_mode(scene, shaft)
    by_disk, by_spring = shaft.chain.frequency_slopes(mode)
    by_torsion = _by_springs(scene, shaft, throws, by_spring) + _by_ends(scene, shaft, throws, by_disk)
    by_inertia = float(by_disk[shaft.driven][list(own)].sum()) / MM2_PER_M2
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


@dataclass(frozen=True)
class _Throw:
    """A throw of the shaft.

    Attributes:
        share: of its twist that is in its first half; None of a throw that is not the design's own.
    """

    stiffness: float
    inertia_kg_mm2: float
    share: float | None


def _by_springs(scene: Scene, shaft: ShaftChain, throws: Sequence[_Throw], by_spring: Complex) -> float:
    """Return the derivative through the springs, of which each is a series of two half throws, or of one."""
    springs = shaft.chain.section_stiffness_Nm_per_rad(np.array(0.0))
    found = 0.0
    for behind, throw in enumerate(throws, start=shaft.first):
        if throw.share is None:
            continue
        for section, share in ((behind - 1, throw.share), (behind, 1 - throw.share)):
            if 0 <= section < len(springs):
                softer = share / throw.stiffness**2 / lossy_factor(scene)
                found += float((by_spring[section] * springs[section] ** 2 * softer).real)
    return found


def _by_ends(scene: Scene, shaft: ShaftChain, throws: Sequence[_Throw], by_disk: Array) -> float:
    """Return the derivative through the ends of the crank, whose inertia is split by the lever rule."""
    first, last = shaft.driven.start, shaft.driven.stop - 1
    found = 0.0
    sides: tuple[tuple[Side, _Throw, int, int], ...] = (
        ("free", throws[0], first, first - 1),
        ("output", throws[-1], last, last + 1),
    )
    for side, throw, inner, tip in sides:
        if throw.share is None:
            continue
        share = throw.share if side == "free" else 1 - throw.share
        end = end_chain(scene, side, share / throw.stiffness)
        if end is not None:
            to_tip = -end.tip_by_before * share / throw.stiffness**2
            found += float(by_disk[tip] - by_disk[inner]) * to_tip
    return found
