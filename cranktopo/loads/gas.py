"""Gas force on the piston."""

from __future__ import annotations

import math


def gas_force_N(pressure_MPa: float, ambient_pressure_MPa: float, bore_mm: float) -> float:
    """Force of the gas on the piston toward the crank axis, N.

    Args:
        pressure_MPa: absolute cylinder pressure, MPa.
        ambient_pressure_MPa: absolute pressure under the piston, MPa.
        bore_mm: cylinder bore, mm.
    """
    return (pressure_MPa - ambient_pressure_MPa) * math.pi / 4 * bore_mm**2
