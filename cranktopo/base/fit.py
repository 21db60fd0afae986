"""Limits of size of shafts by ISO 286: tolerance grades IT4 to IT10 and positions f to p, to 2000 mm."""

from __future__ import annotations

import re
from bisect import bisect_left

_STEPS_MM = (3, 6, 10, 18, 30, 50, 80, 120, 180, 250, 315, 400, 500, 630, 800, 1000, 1250, 1600, 2000)
"""Largest diameter of each range of sizes."""
_GRADES_UM = {
    4: (3, 4, 4, 5, 6, 7, 8, 10, 12, 14, 16, 18, 20, 22, 25, 28, 33, 39, 46),
    5: (4, 5, 6, 8, 9, 11, 13, 15, 18, 20, 23, 25, 27, 32, 36, 40, 47, 55, 65),
    6: (6, 8, 9, 11, 13, 16, 19, 22, 25, 29, 32, 36, 40, 44, 50, 56, 66, 78, 92),
    7: (10, 12, 15, 18, 21, 25, 30, 35, 40, 46, 52, 57, 63, 70, 80, 90, 105, 125, 150),
    8: (14, 18, 22, 27, 33, 39, 46, 54, 63, 72, 81, 89, 97, 110, 125, 140, 165, 195, 230),
    9: (25, 30, 36, 43, 52, 62, 74, 87, 100, 115, 130, 140, 155, 175, 200, 230, 260, 310, 370),
    10: (40, 48, 58, 70, 84, 100, 120, 140, 160, 185, 210, 230, 250, 280, 320, 360, 420, 500, 600),
}
_UPPER_UM = {
    "f": (6, 10, 13, 16, 20, 25, 30, 36, 43, 50, 56, 62, 68, 76, 80, 86, 98, 110, 120),
    "g": (2, 4, 5, 6, 7, 9, 10, 12, 14, 15, 17, 18, 20, 22, 24, 26, 28, 30, 32),
    "h": (0,) * len(_STEPS_MM),
}
"""Distance of the upper limit below the nominal size."""
_LOWER_UM = {
    "k": (0, 1, 1, 1, 2, 2, 2, 3, 3, 4, 4, 4, 5, 0, 0, 0, 0, 0, 0),
    "m": (2, 4, 6, 7, 8, 9, 11, 13, 15, 17, 20, 21, 23, 26, 30, 34, 40, 48, 58),
    "n": (4, 8, 10, 12, 15, 17, 20, 23, 27, 31, 34, 37, 40, 44, 50, 56, 66, 78, 92),
    "p": (6, 12, 15, 18, 22, 26, 32, 37, 43, 50, 56, 62, 68, 78, 88, 100, 120, 140, 170),
}
"""Distance of the lower limit above the nominal size; `k` of the grades 4 to 7, of others 0."""
HOLE = r"^H([4-9]|10)$"
FIT = r"^(f|g|h|js|k|m|n|p)([4-9]|10)$"


def tolerance_um(diameter_mm: float, grade: int) -> float:
    """Return the tolerance of a grade at a diameter, µm; beyond 2000 mm that of 2000 mm."""
    return _GRADES_UM[grade][_range(diameter_mm)]


def limits_um(diameter_mm: float, fit: str) -> tuple[float, float]:
    """Return the upper and the lower limit of a shaft such as `h6` over its nominal diameter, µm."""
    found = re.match(FIT, fit)
    assert found
    letter, grade = found[1], int(found[2])
    width, place = tolerance_um(diameter_mm, grade), _range(diameter_mm)
    if letter == "js":
        return width / 2, -width / 2
    if letter in _UPPER_UM:
        upper = -_UPPER_UM[letter][place]
        return upper, upper - width
    lower = 0 if letter == "k" and grade > 7 else _LOWER_UM[letter][place]
    return lower + width, lower


def hole_limits_text(diameter_mm: float, fit: str) -> str:
    """Return a bore of position H with its fit and limits in mm, such as `⌀46 H6 (+0.016/0)`."""
    upper = tolerance_um(diameter_mm, int(fit[1:])) / 1000
    return f"⌀{diameter_mm:g} {fit} ({upper:+.4g}/0)"


def _range(diameter_mm: float) -> int:
    return min(bisect_left(_STEPS_MM, diameter_mm), len(_STEPS_MM) - 1)


def limits_text(diameter_mm: float, fit: str) -> str:
    """Return a diameter with its fit and both limits in mm, such as `⌀42 h6 (0/-0.016)`."""
    upper, lower = (f"{um / 1000:+.4g}" if um else "0" for um in limits_um(diameter_mm, fit))
    return f"⌀{diameter_mm:g} {fit} ({upper}/{lower})"
