"""Words for modes, and the crossings of orders with them."""

from __future__ import annotations

import numpy as np
import pytest

from cranktopo.tasks.modes.campbell import crossings
from cranktopo.tasks.modes.kinds import energy_shares, kind_of, station_motions
from cranktopo.tasks.modes.result import EnergyShares
from cranktopo.tasks.modes.station import Station


@pytest.mark.parametrize(
    ("shares", "kind"),
    [
        ((90.0, 0.0, 8.0, 0.0), "torsion"),
        ((0.0, 80.0, 0.0, 18.0), "bending in plane"),
        ((5.0, 2.0, 91.0, 0.0), "bending across"),
        ((0.0, 45.0, 50.0, 0.0), "bending oblique"),
        ((0.0, 10.0, 0.0, 85.0), "axial"),
        ((0.0, 52.0, 0.0, 46.0), "bending in plane with axial"),
        ((52.0, 0.0, 45.0, 0.0), "torsion with bending"),
        ((3.0, 8.0, 0.0, 10.0), "deformation within throws"),
    ],
)
def test_a_mode_has_a_word(shares: tuple[float, float, float, float], kind: str) -> None:
    torsion, in_plane, across, axial = shares
    rest = 100.0 - sum(shares)
    given = EnergyShares(torsion=torsion, in_plane=in_plane, across=across, axial=axial, rest=rest)
    assert kind_of(given) == kind


def test_shares_of_a_rigid_piece() -> None:
    """A disk that turns and moves along its axis: half of J w^2 and half of m v^2 of the whole."""
    inertia = np.diag([2.0, 2.0, 2.0, 30.0, 30.0, 50.0])
    piece = Station(0.0, np.eye(6), inertia)
    speed, turn = 3.0, 0.8
    shape = np.array([0.0, 0.0, speed, 0.0, 0.0, turn])
    energy = 2.0 * speed**2 + 50.0 * turn**2
    shares = energy_shares((piece,), shape / np.sqrt(energy))
    assert shares.torsion == pytest.approx(100 * 50.0 * turn**2 / energy)
    assert shares.axial == pytest.approx(100 * 2.0 * speed**2 / energy)
    assert shares.rest == pytest.approx(0.0, abs=1e-9)


def test_the_largest_motion_is_one_and_pieces_are_in_order() -> None:
    """The crank turns from y to x: a right-handed turn about z is against its sense."""
    pieces = (Station(50.0, np.eye(6), np.eye(6)), Station(-10.0, 0.5 * np.eye(6), np.eye(6)))
    first, second = station_motions(pieces, np.array([0.0, 0.0, 0.0, 0.0, 0.0, -0.02]), 40.0)
    assert (first.z_mm, second.z_mm) == (-10.0, 50.0)
    assert (first.twist, second.twist) == pytest.approx((0.5, 1.0))


def test_orders_meet_a_falling_mode() -> None:
    """f = 100 - n / 60 Hz and order 2: 2 n / 60 = 100 - n / 60 at n = 2000 rpm."""
    speeds = np.linspace(1000.0, 3000.0, 7)
    found = crossings(speeds, 100.0 - speeds / 60, np.array([0.5, 2.0]))
    assert found == [(pytest.approx(2000.0), 2.0)]
    assert crossings(speeds, np.full(7, 1e4), np.array([0.5, 2.0])) == []
