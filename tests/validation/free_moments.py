"""Free forces and moments of a V16 in six arrangements of its throws, against another published program.

https://github.com/miriam-innio/Balancing-tool-crankshaft, inputs from its `Balancing_HeatenV16.xlsm`, results
from its `Tool_Results.xlsx`. It takes the oscillating masses by a series up to the seventh power of r/l, and
the largest value over whole degrees; forces in N, moments in N mm.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from cranktopo.engine.balance.crank import JournalMass
from cranktopo.engine.balance.free_forces import (
    ORDERS,
    ForceEllipse,
    TurningMasses,
    oscillating_force,
    rotating_force,
)
from cranktopo.engine.balance.layout import EngineLayout
from cranktopo.engine.kinematics import acceleration_harmonics
from tests.validation.table import Row

SPEED_RPM, RADIUS_MM, ROD_MM, PITCH_MM = 1500.0, 60.0, 411.5, 320.0
RODS_APART_MM = 60.0
OSCILLATING_KG = 11.93, 9.86
PIN_KG, BIG_END_KG = 8.6619087, 11.33
WEB_KG, WEB_AT_MM = 14.45, 17.3
COUNTERWEIGHT_KG, COUNTERWEIGHT_AT_MM = 17.149999, 136.4
UNBALANCE_KG_MM = (
    2 * WEB_KG * WEB_AT_MM
    + (PIN_KG + 2 * BIG_END_KG) * RADIUS_MM
    - 2 * COUNTERWEIGHT_KG * COUNTERWEIGHT_AT_MM
)
"""Of a throw: two webs, crankpin and two big ends, less two counterweights."""
BANKS_DEG = 45.0, -45.0


@dataclass(frozen=True)
class Case:
    """An arrangement and what is printed of it; "across" is along the horizontal."""

    throws_deg: tuple[float, ...]
    rotating_moment: float
    first_moment: float
    second_force_across: float
    second_moments: tuple[float, float]
    fourth_moment: float


CASES = {
    8207: Case((45, 247.5, 202.5, 90, 22.5, 270, 225, 67.5), 2156752.6, 1226369.2, 34949.702,
               (1048491.0, 5591952.3), 32504.724),
    8200: Case((45, 247.5, 202.5, 90, 270, 22.5, 67.5, 225), 5834618.1, 3317603.1, 34949.702,
               (1048491.0, 0.0), 0.0),
    17118: Case((45, 202.5, 360, 247.5, 180, 67.5, 225, 22.5), 2156752.6, 1226369.2, 34949.702,
                (1048491.0, 2316262.5), 0.0),
    17485: Case((45, 225, 180, 0, 247.5, 67.5, 382.5, 202.5), 5421363.9, 3082687.1, 34949.702,
                (1048491.0, 1918854.7), 65009.448),
    7005: Case((45, 202.5, 270, 90, 22.5, 225, 247.5, 67.5), 10896221.0, 6195676.5, 34949.702,
               (1048491.0, 8023360.2), 91895.234),
    27156: Case((45, 202.5, 337.5, 157.5, 270, 90, 225, 22.5), 12311061.0, 7000296.1, 14476.640,
                (434299.22, 6270369.9), 48757.086),
}  # fmt: skip
"""Sums that are rounding of zero there (1e-9 of the others) are 0 here."""


def inputs() -> list[tuple[str, str]]:
    """Data that the results of all six arrangements are computed from, with units."""
    return [
        ("speed", f"{SPEED_RPM:g} rpm"),
        ("throw radius; length of the rod", f"{RADIUS_MM:g} mm; {ROD_MM:g} mm"),
        ("distance of two throws; of two rods on a crankpin", f"{PITCH_MM:g} mm; {RODS_APART_MM:g} mm"),
        ("axes of the two banks, from the vertical", "{:+g} and {:+g} deg".format(*BANKS_DEG)),
        ("oscillating masses of a cylinder", "{:g} and {:g} kg".format(*OSCILLATING_KG)),
        ("crankpin; turning part of a rod", f"{PIN_KG:.8g} kg; {BIG_END_KG:g} kg"),
        ("each web", f"{WEB_KG:g} kg at {WEB_AT_MM:g} mm"),
        ("each counterweight", f"{COUNTERWEIGHT_KG:.8g} kg at {COUNTERWEIGHT_AT_MM:g} mm"),
        *((f"{name}: angles of throws 1 to 8", throws(case)) for name, case in CASES.items()),
    ]


def throws(case: Case) -> str:
    return ", ".join(f"{angle:g}" for angle in case.throws_deg) + " deg"


def masses(case: Case) -> TurningMasses:
    """The engine of a case, cylinders in pairs at either side of their throw."""
    throws = len(case.throws_deg)
    cylinders = [(throw, bank) for throw in range(throws) for bank in range(2)]
    place = ((throws - 1) / 2 - np.arange(throws)) * PITCH_MM
    angle = np.array(case.throws_deg) % 360
    journals = (np.arange(throws + 1) - throws / 2) * PITCH_MM
    layout = EngineLayout(
        throw_of=tuple(throw for throw, _ in cylinders),
        throw_angle_deg=angle,
        throw_deg=angle,
        pin_deg=np.zeros(len(cylinders)),
        throw_z_mm=place,
        axis_deg=np.array([BANKS_DEG[bank] for _, bank in cylinders]),
        firing_deg=np.zeros(len(cylinders)),
        cylinder_z_mm=np.array([place[throw] + (0.5 - bank) * RODS_APART_MM for throw, bank in cylinders]),
        web_places_mm=(-1.0, 1.0),
        journal_z_mm=journals,
        bearing_z_mm=journals,
        bay_of=tuple(range(throws)),
    )
    return TurningMasses(
        layout=layout,
        throw_kg_mm=complex(UNBALANCE_KG_MM),
        couple_kg_mm2=0j,
        counterweight_couple_kg_mm2=0j,
        web_kg_mm=(0.0, 0.0),
        own_kg_mm=(0.0, 0.0),
        rod_kg_mm=0.0,
        piston_kg_mm=sum(OSCILLATING_KG) * RADIUS_MM,
        counterweight_kg_mm=0j,
        harmonics=acceleration_harmonics(RADIUS_MM, ROD_MM, ORDERS),
        w2=(SPEED_RPM * np.pi / 30) ** 2,
        journals=(JournalMass(0j, 0j),) * (throws + 1),
    )


def along(ellipse: ForceEllipse, axis_deg: float) -> float:
    """Largest part along a direction over a turn."""
    turned = np.exp(-1j * np.radians(axis_deg))
    return float(abs(ellipse.forward * turned + np.conj(ellipse.backward * turned)))


def rows(name: int) -> list[Row]:
    case, found = CASES[name], masses(CASES[name])
    first, second, fourth = (oscillating_force(found, order) for order in (1, 2, 4))
    upright, across = (1e3 * along(second.moment, axis) for axis in (0.0, 90.0))
    pairs = [
        ("rotating moment", case.rotating_moment, 1e3 * rotating_force(found).moment.largest, "N mm"),
        ("1st order, moment", case.first_moment, 1e3 * along(first.moment, 0.0), "N mm"),
        ("2nd order, force across", case.second_force_across, along(second.force, 90.0), "N"),
        ("2nd order, moment of upright forces", case.second_moments[0], upright, "N mm"),
        ("2nd order, moment of forces across", case.second_moments[1], across, "N mm"),
        ("4th order, moment of upright forces", case.fourth_moment, 1e3 * along(fourth.moment, 0.0), "N mm"),
    ]
    return [Row(f"{name}: {what}", printed, ours, unit) for what, printed, ours, unit in pairs if printed]


def largest_of_what_vanishes() -> float:
    """What we find where zero is printed, N or N mm."""
    second, fourth = (oscillating_force(masses(CASES[8200]), order) for order in (2, 4))
    of_17118 = oscillating_force(masses(CASES[17118]), 4)
    return 1e3 * max(along(second.moment, 90.0), along(fourth.moment, 0.0), along(of_17118.moment, 0.0))
