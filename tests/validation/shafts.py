"""Torsional vibration of two shafts whose disks and springs are published, with what was found for them."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from cranktopo.engine.kinematics import exact_motion
from cranktopo.engine.vibration.shaft_chain import ShaftChain
from cranktopo.engine.vibration.steady import vibration
from cranktopo.engine.vibration.torque_harmonics import TorqueHarmonics
from cranktopo.numerics.disk_chain import DiskChain
from tests.validation.table import Row

DATA = Path(__file__).parent / "data"

CBR600 = DiskChain(
    (0.0000199, 0.0016958, 0.0021595, 0.0018157, 0.0012602, 0.0000154),
    tuple(math.degrees(k) for k in (3014.0, 2562.0, 2430.0, 2636.0, 2562.0)),
)
"""Crank of a Honda CBR600 RR, kg m2 and N m/deg (P. Biedenkopf, Calculate_eigenfrequency.m, MIT licence)."""
CBR600_HZ = 1169.0, 2085.0
"""As printed in its plot of the modes; its author tells about 10 % to a modal test."""

MWM = DiskChain(
    (0.0170, 0.0090, 0.0467, 0.0327, 0.0467, 0.0467, 0.0327, 0.0487, 2.0750),
    tuple(1e6 * k for k in (1.106, 1.631, 1.253, 1.253, 1.678, 1.253, 1.253, 1.976)),
    (0.035,) * 8,
    (0.0,) * 8,
    (0.0, 0.0, *[2.0] * 6, 0.0),
)
"""Six-cylinder diesel of Mendes, Meirelles, Zampieri 2008, figure 4: pulley, gears, cylinders, flywheel;
loss factor 0.035, 2 N m s/rad at every cylinder."""
NAMES = "pulley", "gears", *(f"cylinder {i}" for i in range(1, 7)), "flywheel"
RADIUS_MM, ROD_MM, BORE_MM, OSCILLATING_KG = 68.5, 207.0, 105.0, 2.521
FIRING_DEG = 0.0, 480.0, 240.0, 600.0, 120.0, 360.0
"""Cylinders 1 to 6, order 1-5-3-6-2-4."""
SECTIONS = {"pulley - gears": ("mwm_torque_pulley", 0), "cylinder 6 - flywheel": ("mwm_torque_flywheel", 7)}
SCALED_TO_MPa = 15.2
ANGLES = 720


@dataclass(frozen=True)
class Curve:
    """Vibratory torque over the speed, printed and ours at the same speeds."""

    speed_rpm: NDArray[np.float64]
    printed_Nm: NDArray[np.float64]
    ours_Nm: NDArray[np.float64]

    def off(self, from_rpm: float = 0.0, to_rpm: float = np.inf) -> NDArray[np.float64]:
        """Difference at each speed of a range over the largest printed torque."""
        at = (self.speed_rpm >= from_rpm) & (self.speed_rpm <= to_rpm)
        return np.abs(self.ours_Nm - self.printed_Nm)[at] / self.printed_Nm.max()

    def mean_off(self, from_rpm: float = 0.0) -> float:
        """Mean difference over the largest printed torque."""
        return float(self.off(from_rpm).mean())


def chain_inputs(chain: DiskChain, names: Iterable[str], per: str = "rad") -> list[tuple[str, str]]:
    """Inertia of each disk of a chain, and the stiffness of the spring behind it."""
    turn = {"rad": 1.0, "deg": math.degrees(1.0)}[per]
    behind = [f"; spring behind it {k / turn:,.7g} N m/{per}" for k in chain.stiffness_Nm_per_rad]
    inertia = [f"{one:.7f}".rstrip("0") + " kg m2" for one in chain.inertia_kg_m2]
    return [(name, one + spring) for name, one, spring in zip(names, inertia, [*behind, ""], strict=True)]


def cbr600_inputs() -> list[tuple[str, str]]:
    return chain_inputs(CBR600, (f"disk {i}" for i in range(1, 7)), "deg")


def mwm_inputs() -> list[tuple[str, str]]:
    return [
        *chain_inputs(MWM, NAMES),
        ("loss factor of every spring", f"{MWM.loss_factor[0]:g}"),
        ("damping at every cylinder", f"{max(MWM.absolute_damping_Nms_per_rad):g} N m s/rad"),
        ("throw radius; length of the rod", f"{RADIUS_MM:g} mm; {ROD_MM:g} mm"),
        ("bore; oscillating mass of a cylinder", f"{BORE_MM:g} mm; {OSCILLATING_KG:g} kg"),
        ("firing angles of cylinders 1 to 6", ", ".join(f"{angle:g}" for angle in FIRING_DEG) + " deg"),
        (
            "pressure over the crank angle; its peak over the speed",
            "`tests/validation/data/mwm_*pressure.csv`",
        ),
    ]


def cbr600_rows() -> list[Row]:
    found = CBR600.natural_frequencies_Hz()
    return [Row(f"natural frequency {i + 1}", f, found[i], "Hz") for i, f in enumerate(CBR600_HZ)]


def mwm_rows() -> list[Row]:
    return [
        Row(f"{section}, largest torque", c.printed_Nm.max(), c.ours_Nm.max(), "N m")
        for section in SECTIONS
        for c in [mwm_curve(section)]
    ] + [
        Row(
            f"{section}, speed of it",
            float(c.speed_rpm[c.printed_Nm.argmax()]),
            float(c.speed_rpm[c.ours_Nm.argmax()]),
            "rpm",
        )
        for section in SECTIONS
        for c in [mwm_curve(section)]
    ]


@cache
def mwm_curve(section: str, pressure_share: float = 1.0) -> Curve:
    """The paper adds the magnitudes of all orders, 0.5 to 12; so does this, at a share of its pressure."""
    name, index = SECTIONS[section]
    printed = np.genfromtxt(DATA / f"{name}.csv", delimiter=",", skip_header=1)
    speeds = np.arange(1000.0, 2551.0, 12.5)
    shaft = ShaftChain(MWM, NAMES, 2, 6, 1.0)
    torque = [
        np.abs(
            vibration(shaft, mwm_harmonics(float(rpm), pressure_share), np.array([rpm])).torque_Nm[
                0, :, index
            ]
        ).sum()
        for rpm in speeds
    ]
    return Curve(printed[:, 0], printed[:, 1], np.interp(printed[:, 0], speeds, torque))


def mwm_harmonics(rpm: float, pressure_share: float = 1.0) -> TorqueHarmonics:
    """One pressure curve, scaled to the peak pressure of a speed."""
    pressure, peak = (
        np.genfromtxt(DATA / f"mwm_{name}.csv", delimiter=";") for name in ("pressure", "peak_pressure")
    )
    angle_deg = 720.0 * np.arange(ANGLES) / ANGLES
    angle = np.radians(angle_deg)
    MPa = np.interp(angle_deg, *pressure.T) * np.interp(rpm, *peak.T)
    MPa *= pressure_share / SCALED_TO_MPa
    rod = np.arcsin(RADIUS_MM / ROD_MM * np.sin(angle))
    lever_m = RADIUS_MM / 1e3 * np.sin(angle + rod) / np.cos(rod)
    acceleration = exact_motion(angle, RADIUS_MM, ROD_MM).acceleration_ratio * RADIUS_MM / 1e3
    gas, inertia = (
        _orders(force * lever_m) for force in (MPa * math.pi / 4 * BORE_MM**2, -OSCILLATING_KG * acceleration)
    )
    return TorqueHarmonics(np.arange(len(gas)) / 2, gas, inertia, FIRING_DEG, tuple(range(6)))


def _orders(curve: NDArray[np.float64]) -> NDArray[np.complex128]:
    found = np.fft.rfft(curve) / len(curve)
    return np.where(np.arange(len(found)) == 0, 1.0, 2.0)[: len(curve) // 2] * found[: len(curve) // 2]
