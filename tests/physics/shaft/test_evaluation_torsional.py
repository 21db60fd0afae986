"""Torsional natural frequencies of the disk model against closed form, Holzer's table and known values."""

from __future__ import annotations

import math
from itertools import pairwise

import pytest

from cranktopo.design.loading import load_scene
from cranktopo.engine.vibration.shaft_chain import bare_chain
from cranktopo.numerics.disk_chain import DiskChain
from tests.validation.shafts import MWM

# Frequencies of MWM's undamped chain in Hz, to the digits in which they were handed down with it; Holzer's
# table below checks every one.
MOVING_KG_MM2 = (0.3254 + (0.491 + 0.1436) / 2) * 48.0**2
MWM_HZ = (216.58, 592.74, 984.92, 1171.0, 1416.0, 1660.0, 1794.4, 2993.5)


def holzer(model: DiskChain, frequency_Hz: float) -> float:
    """Torque left over at the last disk when the first swings by one radian; zero at a natural frequency."""
    square, angle, torque = (2 * math.pi * frequency_Hz) ** 2, 1.0, 0.0
    for inertia, stiffness in zip(model.inertia_kg_m2, (*model.stiffness_Nm_per_rad, math.inf), strict=True):
        torque += square * inertia * angle
        angle -= torque / stiffness
    return torque


def test_shaft_of_equal_throws() -> None:
    """n inertias in a row with springs between them: f = sqrt(k / J) sin(i pi / 2n) / pi."""
    throws, stiffness, inertia_kg_mm2 = 4, 152.5e3, 4200.0
    model = bare_chain(load_scene("mikron-iiic-plain"), inertia_kg_mm2, (stiffness,) * throws)
    root = math.sqrt(stiffness / ((inertia_kg_mm2 + MOVING_KG_MM2) * 1e-6))
    expected = [root * math.sin(i * math.pi / (2 * throws)) / math.pi for i in range(1, throws)]
    assert model.natural_frequencies_Hz() == pytest.approx(expected, rel=1e-12)


def test_diesel_engine() -> None:
    """To the five digits that are given."""
    found = MWM.natural_frequencies_Hz()
    assert tuple(float(f"{f:.5g}") for f in found) == MWM_HZ
    assert [mode.frequency_Hz for mode in MWM.modes()] == pytest.approx(found, rel=1e-12)


def test_holzer_table_changes_sign_at_each_frequency() -> None:
    found = MWM.natural_frequencies_Hz()
    for f in found:
        assert holzer(MWM, f * (1 - 1e-9)) * holzer(MWM, f * (1 + 1e-9)) < 0
    signs = [holzer(MWM, (a + b) / 2) > 0 for a, b in pairwise((0.0, *found))]
    assert all(a != b for a, b in pairwise(signs)), "a frequency is missing between two others"


def test_moving_masses_of_the_mikron() -> None:
    """Rotating rod mass and half of what reciprocates, at the throw radius of 48 mm."""
    throws = bare_chain(load_scene("mikron-iiic-plain"), 4000.0, (1.0,) * 4)
    assert throws.inertia_kg_m2 == pytest.approx([(4000.0 + MOVING_KG_MM2) * 1e-6] * 4, rel=1e-12)
    export = throws.as_opentorsion()
    assert [d["I"] for d in export["disks"]] == list(throws.inertia_kg_m2)
    assert [(s["nl"], s["nr"], s["I"]) for s in export["shafts"]] == [(i, i + 1, 0.0) for i in range(3)]
