"""Likeness of the modes of a shaft of disks and those of the body: whose torsion is whose."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from cranktopo.base.arrays import Array
from cranktopo.engine.vibration.shaft_chain import ShaftChain
from cranktopo.numerics.tetrahedra.rigid_motions import RZ
from cranktopo.tasks.modes.station import Station

PAIRED = 0.5
"""Likeness from which two modes are a pair."""
_SHARES = 0.1
"""Likeness from which a mode is named among those that share a mode of the disks."""


def counterparts(alike: Array, listed: int) -> dict[int, int]:
    """Return the mode of the body of each mode of the disks that has one, among the first `listed`."""
    from scipy.optimize import linear_sum_assignment

    pairs = zip(*linear_sum_assignment(-alike[:, :listed]), strict=True)
    return {int(disk): int(body) for disk, body in pairs if alike[disk, body] >= PAIRED}


def sharing(alike: Array, listed: int, paired: dict[int, int]) -> dict[int, list[int]]:
    """Return the modes of the body that share each mode of the disks without counterpart, largest first.

    What lies mostly beyond the first `listed` is left out.
    """
    alone = [disk for disk, row in enumerate(alike) if disk not in paired and row[:listed].sum() >= PAIRED]
    return {
        disk: [int(i) for i in np.argsort(-alike[disk, :listed]) if alike[disk, i] >= _SHARES]
        for disk in alone
    }


def likeness(
    stations: Sequence[Station], shaft: ShaftChain, disks: Array, body: Array, square: Array
) -> Array:
    """Return which share of the swing by disks each mode of the body has, 0 to 1.

    Each piece of the shaft turns about the crank axis as its disk does; with d that motion, u a mode of the
    body and w its frequency, the inertia forces M d deflect the body by u (u' M d) / w^2, which does the work
    (u' M d)^2 / w^2 on d: the share of this work among all modes. Without w it would be the modal assurance
    in the mass, in which stiff modes count that hardly yield to such forces.

    Args:
        disks: amplitudes of every disk, (disks, modes).
        body: unknowns of all elastic modes, normalised in the mass, (unknowns, modes).
        square: of their angular frequencies, to any scale.

    Returns:
        Modes of disks by modes of the body; rows add up to 1.
    """
    turns = _followed(stations, shaft) @ disks
    momenta = np.array([station.inertia[RZ] @ station.motion @ body for station in stations])
    work = (turns.T @ momenta) ** 2 / square
    return np.asarray(work / work.sum(axis=1, keepdims=True))


def _followed(stations: Sequence[Station], shaft: ShaftChain) -> Array:
    """Return the turn of each piece by that of the disks; along an end of the crank it changes evenly."""
    disk_of = {part: i for i, name in enumerate(shaft.names) for part in name.split(" + ")}
    disk_of |= {"damper": disk_of["hub"]} if "hub" in disk_of else {}
    ends = {"free end": (shaft.first, max(shaft.first - 1, 0))}
    last = shaft.driven.stop - 1
    ends["output end"] = (last, min(last + 1, len(shaft.names) - 1))
    turns = np.zeros((len(stations), len(shaft.names)))
    for row, station in zip(turns, stations, strict=True):
        if station.part not in ends:
            row[disk_of[station.part]] = 1.0
            continue
        inner, outer = ends[station.part]
        throw = f"throw {inner - shaft.first + 1}"
        outwards = _outwards(stations, station, throw)
        row[inner] += 1 - outwards
        row[outer] += outwards
    return turns


def _outwards(stations: Sequence[Station], one: Station, throw: str) -> float:
    """Return where a piece of an end lies between the throw, 0, and the outermost piece of the end, 1."""
    start = float(np.mean([station.z_mm for station in stations if station.part == throw]))
    reach = max(abs(station.z_mm - start) for station in stations if station.part == one.part)
    return abs(one.z_mm - start) / reach
