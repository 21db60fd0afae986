"""Stepped rotors that turn, with an overhung disk, against ROSS, another code of rotor dynamics.

Needs the test extra `oracles`. Both sides have Timoshenko beams by Cowper's shear area; the frame, the
assembly and the gyroscopic terms are each code's own.
"""

from __future__ import annotations

import math
import warnings
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from cranktopo.numerics.turning_body import TurningBody, whirling_modes
from cranktopo.numerics.turning_parts import RoundSection, beam, rigid_disk

Array = NDArray[np.float64]
YOUNGS, POISSON, DENSITY = 211e3, 0.3, 7.81e-9
STEPS = ((120.0, 40.0, 0.0, 4), (180.0, 64.0, 20.0, 6), (90.0, 52.0, 0.0, 3), (150.0, 36.0, 10.0, 5))
"""Length, diameter and bore, mm, and number of elements of each step."""
DISK_AT, MASS_KG, DIAMETRAL_KG_M2, POLAR_KG_M2 = 18, 9.0, 0.045, 0.085
BEARINGS = ((2, 4.4e7), (13, 2.1e7))
"""Node, and stiffness in every direction across the axis, N/m; the disk is beyond the second."""
FREQUENCIES = 12


@pytest.fixture(scope="module")
def ross() -> Any:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        return pytest.importorskip("ross", reason="needs ROSS: pip install cranktopo[oracles]")


def elements() -> list[tuple[float, float, float]]:
    """Length, diameter and bore of every element, mm."""
    return [(length / count, outer, bore) for length, outer, bore, count in STEPS for _ in range(count)]


def own_Hz(speed_rad_s: float) -> Array:
    """Frequencies as the bearings see them: bending, torsion and axial ones."""
    every = elements()
    count = 6 * (len(every) + 1)
    rows, body = np.eye(count), TurningBody.of_nothing(count)
    for index, (length, outer, bore) in enumerate(every):
        area, polar = math.pi * (outer**2 - bore**2) / 4, math.pi * (outer**4 - bore**4) / 32
        section = RoundSection(area, polar, polar, YOUNGS, POISSON, DENSITY)
        body += beam(section, length).over(rows[6 * index : 6 * index + 12])
    disk = rigid_disk(MASS_KG / 1e3, DIAMETRAL_KG_M2 * 1e3, POLAR_KG_M2 * 1e3)
    body += disk.over(rows[6 * DISK_AT : 6 * DISK_AT + 6])
    springs = np.zeros((count, count))
    for node, stiffness in BEARINGS:
        springs[[6 * node, 6 * node + 1], [6 * node, 6 * node + 1]] = stiffness / 1e3
    none = np.zeros_like(springs)
    found = whirling_modes(body + TurningBody(springs, none, none, none, none), speed_rad_s)
    fixed = np.abs(found.frequency_Hz + found.whirl.round() * speed_rad_s / (2 * math.pi))
    return np.sort(fixed)[:FREQUENCIES]


def ross_Hz(ross: Any, speed_rad_s: float) -> Array:
    shear = YOUNGS / (2 * (1 + POISSON))
    steel = ross.Material("shaft", rho=DENSITY * 1e12, E=YOUNGS * 1e6, G_s=shear * 1e6)
    shaft = [
        ross.ShaftElement(
            L=length / 1e3,
            idl=bore / 1e3,
            odl=outer / 1e3,
            material=steel,
            shear_effects=True,
            rotary_inertia=True,
            gyroscopic=True,
        )
        for length, outer, bore in elements()
    ]
    disk = ross.DiskElement(n=DISK_AT, m=MASS_KG, Id=DIAMETRAL_KG_M2, Ip=POLAR_KG_M2)
    bearings = [ross.BearingElement(n=node, kxx=stiffness, cxx=0.0) for node, stiffness in BEARINGS]
    modal = ross.Rotor(shaft, [disk], bearings).run_modal(
        speed_rad_s, num_modes=8 * FREQUENCIES, sparse=False
    )
    swinging = np.unique(np.round(modal.wd[modal.wd > 1.0], 6))
    return np.asarray(swinging[:FREQUENCIES] / (2 * math.pi))


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore")
@pytest.mark.parametrize("speed_rad_s", [100.0, 600.0, 1500.0])
def test_a_stepped_rotor_with_a_disk_whirls_as_by_ross(ross: Any, speed_rad_s: float) -> None:
    found, expected = own_Hz(speed_rad_s), ross_Hz(ross, speed_rad_s)
    assert found == pytest.approx(expected, rel=2e-9)
