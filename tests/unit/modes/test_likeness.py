"""Which mode of the body is the counterpart of a mode of disks."""

from __future__ import annotations

import numpy as np
import pytest

from cranktopo.base.arrays import Array
from cranktopo.engine.vibration.shaft_chain import ShaftChain
from cranktopo.numerics.disk_chain import DiskChain
from cranktopo.tasks.modes.likeness import counterparts, likeness, sharing
from cranktopo.tasks.modes.station import Station

NAMES = ("damper ring", "hub + pulley", "throw 1", "throw 2", "flywheel")
PARTS = ("damper ring", "damper", "pulley", "throw 1", "throw 1", "throw 2", "flywheel")
POLAR = np.array([0.5, 1.0, 2.0, 0.7, 0.9, 1.5, 30.0])
DISK_OF = np.array([0, 1, 1, 2, 2, 3, 4])


def chain() -> DiskChain:
    inertia = np.bincount(DISK_OF, POLAR)
    return DiskChain(tuple(inertia), (40.0, 900.0, 1500.0, 700.0))


def bodies_own(bent_stiffness: float, coupling: float) -> tuple[Array, Array, list[Station]]:
    """Modes of the disks with throw 1 on a spring of its own across the axis, whose motion twists it, too."""
    disks, count = chain(), 6
    stiffness = np.zeros((count, count))
    for i, k in enumerate(disks.stiffness_Nm_per_rad):
        stiffness[i : i + 2, i : i + 2] += k * np.array([[1.0, -1.0], [-1.0, 1.0]])
    stiffness[5, 5] = bent_stiffness
    mass = np.diag([*disks.inertia_kg_m2, 2.0])
    mass[2, 5] = mass[5, 2] = coupling
    root = np.linalg.inv(np.linalg.cholesky(mass))
    square, shapes = np.linalg.eigh(root @ stiffness @ root.T)
    stations = []
    for part, disk, polar in zip(PARTS, DISK_OF, POLAR, strict=True):
        motion, inertia = np.zeros((6, count)), np.zeros((6, 6))
        motion[5, disk], motion[0, 5], inertia[5, 5] = 1.0, 1.0, polar
        if part == "throw 1":
            inertia[5, 0] = inertia[0, 5] = coupling / 2
        stations.append(Station(0.0, motion, inertia, part))
    return square[1:], (root.T @ shapes)[:, 1:], stations


def alike(bent_stiffness: float, coupling: float) -> Array:
    square, shapes, stations = bodies_own(bent_stiffness, coupling)
    disks = np.stack([mode.shape for mode in chain().modes()], axis=1)
    return likeness(stations, ShaftChain(chain(), NAMES, 2, 2, 1.0), disks, shapes, square)


def test_torsion_alone_is_its_own_counterpart() -> None:
    """Without coupling each mode of the disks is one of the body, in spite of one that bends between them."""
    found = alike(700.0, 0.0)
    assert found.max(axis=1) == pytest.approx(1.0)
    bending = int(np.argmin(found.max(axis=0)))
    assert bending not in (0, 4)  # it lies between
    assert counterparts(found, 5) == {i: i + (i >= bending) for i in range(4)}
    assert sharing(found, 5, counterparts(found, 5)) == {}


def test_bending_at_the_frequency_of_a_mode_halves_it() -> None:
    """A throw that bends as fast as a mode twists it, and is coupled with it, makes two modes of one."""
    second = (2 * np.pi * chain().modes()[1].frequency_Hz) ** 2
    found = alike(2.0 * second, 0.01)
    assert found.sum(axis=1) == pytest.approx(1.0)
    assert found[1, 1:3] == pytest.approx([0.5, 0.5], abs=0.01)


def test_what_no_mode_has_by_half_is_shared() -> None:
    found = np.array([[0.0, 0.33, 0.45, 0.0, 0.14, 0.08], [0.9, 0.0, 0.0, 0.1, 0.0, 0.0]])
    pairs = counterparts(found, 5)
    assert pairs == {1: 0}
    assert sharing(found, 5, pairs) == {0: [2, 1, 4]}


def test_each_mode_is_paired_at_most_once_and_what_is_not_listed_is_left_out() -> None:
    found = np.array([[0.7, 0.2, 0.1], [0.6, 0.3, 0.1], [0.0, 0.05, 0.95]])
    pairs = counterparts(found, 2)
    assert pairs == {0: 0}
    assert sharing(found, 2, pairs) == {1: [0, 1]}


def test_an_end_turns_between_its_throw_and_its_tip() -> None:
    """A mode of the body that turns the end evenly from throw to tip is wholly the one of the disks."""
    disks = DiskChain((1.0, 3.0), (10.0,))
    mode = disks.modes()[0].shape
    places = {"throw 1": 0.0, "output end": 50.0, "flywheel": 100.0}
    stations = []
    for part, z in [*places.items(), ("output end", 100.0)]:
        motion, inertia = np.zeros((6, 2)), np.zeros((6, 6))
        motion[5], inertia[5, 5] = np.array([1 - z / 100, z / 100]), 1.0
        stations.append(Station(z, motion, inertia, part))
    other = np.array([1.0, 1.0])
    momentum = np.array([1 + 0.5, 0.5 + 2.0])
    other = other - mode * (momentum @ other) / (momentum @ mode)  # no work of the disks' inertia forces
    shaft = ShaftChain(disks, ("throw 1", "flywheel"), 0, 1, 1.0)
    found = likeness(stations, shaft, mode[:, None], np.stack([mode, other], axis=1), np.ones(2))
    assert found.sum() == pytest.approx(1.0)
    turns = np.array([mode[0], mode.mean(), mode[1], mode[1]])
    assert found[0, 0] == pytest.approx((turns @ turns) ** 2 / ((turns @ turns) ** 2 + _work(turns, other)))


def _work(turns: Array, other: Array) -> float:
    return float((turns @ [other[0], other.mean(), other[1], other[1]]) ** 2)


def test_a_stiff_mode_counts_less() -> None:
    """Two modes that the forces of a throw against a flywheel drive alike, one at twice the frequency."""
    stations = []
    for part, sense in (("throw 1", 1.0), ("flywheel", -1.0)):
        motion, inertia = np.zeros((6, 2)), np.zeros((6, 6))
        motion[5], inertia[5, 5] = sense, 1.0
        stations.append(Station(0.0, motion, inertia, part))
    shaft = ShaftChain(DiskChain((1.0, 1.0), (10.0,)), ("throw 1", "flywheel"), 0, 1, 1.0)
    found = likeness(stations, shaft, np.array([[1.0], [-1.0]]), np.eye(2), np.array([1.0, 4.0]))
    assert found == pytest.approx(np.array([[0.8, 0.2]]))
