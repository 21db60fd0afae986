"""The kind of a mode: shares of kinetic energy, and a word for them."""

from __future__ import annotations

import numpy as np

from cranktopo.base.arrays import Array
from cranktopo.numerics.tetrahedra.rigid_motions import RX, RY, RZ, UX, UY, UZ
from cranktopo.tasks.modes.result import EnergyShares, StationMotion
from cranktopo.tasks.modes.station import Station

_GROUPS = {"torsion": (RZ,), "in_plane": (UY, RX), "across": (UX, RY), "axial": (UZ,)}
WITHIN = "deformation within throws"
_MOST = 60.0
"""Percent of the energy from which a kind stands alone."""
_ALSO = 25.0
_ONE_PLANE = 0.75
"""Share of the bending in a plane from which that plane is named."""


def energy_shares(stations: tuple[Station, ...], shape: Array) -> EnergyShares:
    """Return the shares of a shape (unknowns,) that is normalised in the mass.

    Where two motions of a piece have a mass in common, each has half of it.
    """
    each = np.zeros(6)
    for station in stations:
        moved = station.motion @ shape
        each += moved * (station.inertia @ moved)
    shares = {name: 100 * float(each[list(motions)].sum()) for name, motions in _GROUPS.items()}
    return EnergyShares(**shares, rest=100 - sum(shares.values()))


def kind_of(shares: EnergyShares) -> str:
    """Return a mode's kind in words."""
    bending = shares.in_plane + shares.across
    groups = {
        "torsion": shares.torsion,
        _bending(shares): bending,
        "axial": shares.axial,
        WITHIN: shares.rest,
    }
    first, second = sorted(groups, key=lambda name: -groups[name])[:2]
    if groups[first] >= _MOST or groups[second] < _ALSO:
        return first
    return f"{first} with {second.split()[0]}"


def _bending(shares: EnergyShares) -> str:
    in_plane = shares.in_plane / max(shares.in_plane + shares.across, 1e-9)
    if in_plane >= _ONE_PLANE:
        return "bending in plane"
    return "bending across" if in_plane <= 1 - _ONE_PLANE else "bending oblique"


def station_motions(
    stations: tuple[Station, ...], shape: Array, radius_mm: float
) -> tuple[StationMotion, ...]:
    """Return how pieces move, by their place; the largest displacement or twist is 1."""
    ordered = sorted(stations, key=lambda one: one.z_mm)
    moved = np.array([station.motion @ shape for station in ordered])
    axes = np.stack([moved[:, UY], moved[:, UX], moved[:, UZ], -radius_mm * moved[:, RZ]], axis=1)
    axes = axes / axes.flat[np.abs(axes).argmax()]
    return tuple(
        StationMotion(z_mm=station.z_mm, in_plane=y, across=x, axial=z, twist=turn)
        for station, (y, x, z, turn) in zip(ordered, axes.tolist(), strict=True)
    )
