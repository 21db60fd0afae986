"""Rods drawn at random for engines drawn at random, in the proportions of real ones."""

from __future__ import annotations

from typing import Any

import numpy as np

from cranktopo.design.bolt import COARSE_PITCH_MM, HOLE_MM
from tests.random_engines import random_engine


def _room_mm(data: dict[str, Any]) -> float:
    """Length of the crankpin between its fillets that one rod has."""
    pin = data["throw"]["crankpin"]
    fillet = pin.get("fillet_axial_mm") or pin.get("fillet_mm", 0.0)
    rods = 2 if data["engine"].get("arrangement", {}).get("layout") == "V" else 1
    return float(pin["length_mm"] - 2 * fillet) / rods


def random_rod_engine(seed: int) -> dict[str, Any]:
    """A scene as plain data: a random engine with a rod, its piston pin, and bolts where a thread fits."""
    draw, data = np.random.default_rng(seed + 10_000), random_engine(seed)
    pin, bore = data["throw"]["crankpin"]["outer_diameter_mm"], data["engine"]["bore_mm"]
    big_bore = 1.06 * pin
    big, small_bore = big_bore * draw.uniform(1.25, 1.45), bore * draw.uniform(0.26, 0.32)
    small = small_bore * draw.uniform(1.35, 1.6)
    length = data["engine"]["rod_length_mm"]
    shrink = min(1.0, 0.7 * length / ((small + big) / 2))
    small, small_bore = small * shrink, small_bore * shrink
    big, big_bore = big * shrink, big_bore * shrink
    width = min(big_bore * draw.uniform(0.45, 0.65), 0.95 * _room_mm(data))
    fitting = [d for d in COARSE_PITCH_MM if d <= 0.2 * big_bore]
    hole = HOLE_MM.get(fitting[-1], 1.1 * fitting[-1]) if fitting else 0.0
    distance = big_bore + 1.3 * hole + 2
    rod = {
        "shank": str(draw.choice(["I", "H", "plain"])),
        "small_end_diameter_mm": small,
        "small_end_bore_mm": small_bore,
        "small_end_width_mm": 1.1 * width,
        "bush_thickness_mm": 0.05 * small_bore,
        "bush_interference_um": 1.0 * small_bore,
        "big_end_diameter_mm": big,
        "big_end_bore_mm": big_bore,
        "big_end_width_mm": width,
        "boss_width_mm": distance + 1.5 * hole + 1.2,
        "boss_above_mm": 0.3 * big,
        "boss_below_mm": 0.25 * big,
        "bolt_distance_mm": distance,
        "shank_small_mm": 0.6 * small,
        "shank_big_mm": 0.5 * big,
        "shank_width_mm": 0.6 * width,
        "flange_mm": 0.15 * width,
        "web_mm": 0.15 * width,
        "shank_fillet_mm": float(draw.choice([0.0, 0.2])) * small,
        "pin": {
            "bore_diameter_mm": 0.45 * small_bore,
            "length_mm": 0.8 * bore,
            "boss_distance_mm": 1.2 * width,
        },
    }
    if fitting:
        rod["bolt"] = {"thread": f"M{fitting[-1]}", "grip_mm": 0.25 * big}
    return {**data, "rod": rod}
