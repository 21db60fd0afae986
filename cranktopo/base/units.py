"""One internal system of units: mm, N, MPa (N/mm2), tonne, s. Conversions happen here only."""

from __future__ import annotations

import math

MM_PER_M = 1000.0
MM_PER_INCH = 25.4
MM2_PER_M2 = MM_PER_M**2
MPA_PER_GPA = 1000.0
MPA_PER_BAR = 0.1
KG_PER_TONNE = 1000.0
NMM_PER_NM = 1000.0
N_PER_KN = 1000.0
W_PER_KW = 1000.0


def density_tonne_per_mm3(density_kg_m3: float) -> float:
    """Mass density in the internal system (tonne/mm3) from kg/m3."""
    return density_kg_m3 * 1e-12


def density_kg_per_mm3(density_kg_m3: float) -> float:
    """Mass density for reported masses (kg/mm3) from kg/m3."""
    return density_tonne_per_mm3(density_kg_m3) * KG_PER_TONNE


def angular_speed_rad_s(speed_rpm: float) -> float:
    """Angular speed (rad/s) from revolutions per minute."""
    return speed_rpm * 2.0 * math.pi / 60.0
