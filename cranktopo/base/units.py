"""One internal system of units: mm, N, MPa (N/mm2), tonne, s. Conversions happen here only."""

from __future__ import annotations

import math
from decimal import Decimal

MM_PER_M = 1000.0
MM_PER_INCH = 25.4
UM_PER_MM = 1000.0
MM2_PER_M2 = MM_PER_M**2
MPA_PER_GPA = 1000.0
MPA_PER = {"bar": 0.1, "mbar": 1e-4, "hPa": 1e-4, "kPa": 1e-3, "Pa": 1e-6, "MPa": 1.0}
"""MPa of one unit of pressure."""
KG_PER_TONNE = 1000.0
NMM_PER_NM = 1000.0
N_PER_KN = 1000.0
W_PER_KW = 1000.0


def density_tonne_per_mm3(density_kg_m3: float) -> float:
    """Return the mass density in the internal system (tonne/mm3) from kg/m3."""
    return density_kg_m3 * 1e-12


def density_kg_per_mm3(density_kg_m3: float) -> float:
    """Return the mass density for reported masses (kg/mm3) from kg/m3."""
    return density_tonne_per_mm3(density_kg_m3) * KG_PER_TONNE


def angular_speed_rad_s(speed_rpm: float) -> float:
    """Return the angular speed (rad/s) from revolutions per minute."""
    return speed_rpm * 2.0 * math.pi / 60.0


def plain_number(value: float, digits: int = 4) -> str:
    """Return a number to some significant digits, without an exponent and without a negative zero."""
    text = f"{value:z.{digits}g}"
    return f"{Decimal(text):f}" if "e" in text else text


def enough_decimals(largest: float, usual: int) -> int:
    """Return the usual decimals; those of three digits where they leave one or none of the largest value."""
    if abs(largest) < _ROUNDING:
        return usual
    place = math.floor(math.log10(abs(largest)))
    return usual if usual + place >= 1 else 2 - place


_ROUNDING = 1e-6
"""In any unit that a result is told in, such values are what rounding leaves of zero."""


def signed_percent(percent: float, digits: int = 2) -> str:
    """Return a change in percent with its sign: `+170 %`, `-0.35 %`."""
    text = plain_number(percent, digits)
    return f"{'' if text.startswith('-') else '+'}{text} %"


def change_text(percent: float, error_percent: float = 0.0) -> str:
    """Return a change in percent, with its error if any, and the decimals that show its sign.

    `-4.7 %`, `-0.05 +-0.04 %`: a small change may decide, and one decimal would make it `+0.0 %`.
    """
    texts = (f"{percent:+z.{decimals}f}" for decimals in range(1, _DECIMALS))
    rounded = next(filter(float, texts), "+0.0")
    return f"{rounded} +-{error_text(error_percent)} %" if error_percent else f"{rounded} %"


def error_text(error_percent: float) -> str:
    """Return an error in percent as tables have it, with one decimal from 1 on: `2.2`, `2.0`, `0.04`."""
    return f"{error_percent:.1f}" if error_percent >= 1 else f"{error_percent:.1g}"


_DECIMALS = 5
"""A change of less than a ten-thousandth of a percent is none."""


def frequency_text(frequency_Hz: float) -> str:
    """Return a frequency with its unit, at least three digits: `3.75 Hz`, `801 Hz`."""
    return f"{frequency_Hz:.0f} Hz" if frequency_Hz >= 100 else f"{plain_number(frequency_Hz, 3)} Hz"


def number_text(value: float) -> str:
    """Return a number as tables and sentences show it: `685.7`, `68,440`."""
    return f"{value:,.0f}" if abs(value) >= _LARGE else plain_number(value)


_LARGE = 1e4
"""Such numbers are shown without decimals, in groups of three digits."""
UNITS = {
    "N_per_mm": "N/mm",
    "N_per_mm_kg": "N/mm/kg",
    "kN_per_mm": "kN/mm",
    "kN_per_mm_kg": "kN/mm/kg",
    "Nm_per_rad": "N m/rad",
    "Nm_per_rad_kg": "N m/rad/kg",
    "kNm_per_rad": "kN m/rad",
    "kNm_per_rad_kg": "kN m/rad/kg",
    "Nms_per_rad": "N m s/rad",
    "kg": "kg",
    "kg_mm": "kg mm",
    "kg_mm2": "kg mm2",
    "kg_m2": "kg m²",
    "kg_m3": "kg/m³",
    "GPa": "GPa",
    "MPa": "MPa",
    "N": "N",
    "kN": "kN",
    "Nm": "N m",
    "N_mm": "N mm",
    "kW": "kW",
    "percent": "%",
    "Hz": "Hz",
    "rpm": "rpm",
    "deg": "deg",
    "C": "°C",
    "mPas": "mPa s",
    "um": "µm",
    "mm": "mm",
    "mm3": "mm3",
    "per_mm": "1/mm",
    "s": "s",
    "h": "h",
    "HRC": "HRC",
    "HV": "HV",
    "m_per_s": "m/s",
    "m_per_s2": "m/s²",
    "MiB": "MiB",
}
"""Units by the last words of a name: of scene keys, JSON keys and columns of tables. The only such table."""
_LONGEST_FIRST = sorted(UNITS, key=len, reverse=True)


def stem_and_unit(name: str) -> tuple[str, str]:
    """Return a name without its unit, and the unit: `torsion_kNm_per_rad` gives ("torsion", "kN m/rad")."""
    suffix = next((suffix for suffix in _LONGEST_FIRST if name.endswith(f"_{suffix}")), "")
    return (name[: -len(suffix) - 1], UNITS[suffix]) if suffix else (name, "")
