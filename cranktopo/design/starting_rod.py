"""Starting point of a connecting rod: proportions by crankpin, cylinder and rod length, with its bolts."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from cranktopo.base.table import SMALLEST_MM
from cranktopo.design.bolt import COARSE_PITCH_MM, Bolt

_SHELL, _RING = 1.08, 1.36
"""Bore and outer diameter of the big end over the crankpin's diameter."""
_WIDTH = 0.93
"""Width of the big end over the crankpin's length between its fillets."""
_SMALL_END, _SMALL_RING = 0.28, 1.42
"""Bore of the small end over the cylinder's bore, and its outer diameter over its own bore."""
_SHARE_OF_LENGTH = 0.7
"""Most of the length beyond the big end that the radius of the small end may take."""
_BETWEEN_BOSSES, _PIN_LENGTH, _PIN_BORE = 0.31, 0.82, 0.5
"""Over the cylinder's bore, but the last one: over the pin's diameter."""
_BOLT_OF_PIN, _BOLT_OF_WIDTH = 0.2, 0.45
"""Most of a bolt's thread over the crankpin's diameter, and over the width of the big end."""
_WALL_MM = 0.7
"""Least wall of the example, a little above what a rod must have."""


def starting_rod(values: Mapping[str, Any]) -> dict[str, Any]:
    """Return the dimensions of a rod for an engine of starting values, by key path."""
    pin = values["throw.crankpin.outer_diameter_mm"]
    bore = max(_SHELL * pin, pin + 2 * _WALL_MM)
    big = max(_RING * pin, bore + 2 * _WALL_MM)
    room = values["throw.crankpin.length_mm"] - 2 * values["throw.crankpin.fillet_mm"]
    layout = values.get("engine.arrangement.layout")
    beside = {"V": 2, "W": len(values.get("engine.arrangement.bank_angles_deg", ()))}
    width = _WIDTH * room / beside.get(str(layout), 1)
    left = values["engine.rod_length_mm"] - big / 2
    ring = min(_SMALL_RING * _SMALL_END * values["engine.bore_mm"], 2 * _SHARE_OF_LENGTH * left)
    small = max(min(ring / _SMALL_RING, ring - 2 * _WALL_MM), SMALLEST_MM)
    small_width = 0.95 * _BETWEEN_BOSSES * values["engine.bore_mm"]
    rod = {
        "small_end_diameter_mm": ring,
        "small_end_bore_mm": small,
        "small_end_width_mm": small_width,
        "big_end_diameter_mm": big,
        "big_end_bore_mm": bore,
        "big_end_width_mm": width,
        **_shank(0.55 * ring, 0.4 * big, 0.5 * min(width, small_width)),
        "pin.bore_diameter_mm": max(0.0, min(_PIN_BORE * small, small - 2 * _WALL_MM)),
        "pin.length_mm": _PIN_LENGTH * values["engine.bore_mm"],
        "pin.boss_distance_mm": _BETWEEN_BOSSES * values["engine.bore_mm"],
    }
    found: dict[str, Any] = {f"rod.{key}": _rounded(value) for key, value in rod.items()}
    return found | _bolts(pin, found["rod.big_end_bore_mm"], width)


def _shank(small_mm: float, big_mm: float, width_mm: float) -> dict[str, float]:
    """Return a section of `I` that tapers to the small end; its walls also make one of `H`."""
    return {
        "shank_small_mm": small_mm,
        "shank_big_mm": big_mm,
        "shank_width_mm": width_mm,
        "flange_mm": 0.25 * min(small_mm, width_mm),
        "web_mm": 0.25 * min(small_mm, width_mm),
    }


def _bolts(pin_mm: float, bore_mm: float, width_mm: float) -> dict[str, Any]:
    """Return the largest bolts for the pin and the big end's width, in tapped holes, and their bosses."""
    largest = min(_BOLT_OF_PIN * pin_mm, _BOLT_OF_WIDTH * width_mm)
    thread = max((size for size in COARSE_PITCH_MM if size <= largest), default=min(COARSE_PITCH_MM))
    bolt = Bolt(thread=f"M{thread}", grip_mm=1.5 * thread)
    distance = _rounded(bore_mm + 1.2 * bolt.hole_mm)
    bolts = {
        "bolt_distance_mm": distance,
        "boss_width_mm": _rounded(distance + 1.5 * bolt.hole_mm + 2 * _WALL_MM),
        "boss_above_mm": _rounded(1.7 * thread),
        "boss_below_mm": bolt.grip_mm,
        "bolt.thread": bolt.thread,
        "bolt.grip_mm": bolt.grip_mm,
    }
    return {f"rod.{key}": value for key, value in bolts.items()}


def _rounded(value: float) -> float:
    return float(f"{value:.3g}")
