"""Engines drawn at random, the same for the same seed: throws of 6 to 600 mm, from model engines to ships."""

from __future__ import annotations

from typing import Any

import numpy as np

SMALLEST_MM, LARGEST_MM = 6.0, 600.0


def random_engine(seed: int) -> dict[str, Any]:
    """A scene as plain data: throw, web, engine with combustion and masses, box envelope.

    Radii are spread evenly in the logarithm; proportions are those of real engines (journals of 0.7 to 1.3
    radii, mean piston speeds of 5 to 14 m/s, peak pressures of 4 to 18 MPa).
    """
    draw = np.random.default_rng(seed)
    radius = float(np.exp(draw.uniform(np.log(SMALLEST_MM), np.log(LARGEST_MM))))
    main, pin = radius * draw.uniform(0.8, 1.3), radius * draw.uniform(0.7, 1.1)
    room = 2 * radius - 0.2 * main
    bores = [0.0 if draw.random() < 0.4 else share * draw.uniform(0.25, 0.5) for share in (main, pin)]
    bores = [bore * min(1.0, room / max(sum(bores), 1e-9)) for bore in bores]
    fillet = min(main, pin) * draw.uniform(0.04, 0.07)
    half = max(main, pin) / 2 * draw.uniform(1.2, 1.45) + fillet
    bore = 2 * radius * draw.uniform(0.8, 1.3)
    speed = draw.uniform(5.0, 14.0) * 60 / (4e-3 * radius)
    cylinders = int(draw.choice([1, 2, 3, 4, 6]))
    orders = {1: [1], 2: [1, 2], 3: [1, 3, 2], 4: [1, 3, 4, 2], 6: [1, 5, 3, 6, 2, 4]}
    piston = 0.7e-6 * bore**3 * draw.uniform(0.6, 1.4)
    data = {
        "name": f"engine-{seed}",
        "throw": {
            "radius_mm": radius,
            "main_journal": _journal(main, bores[0], main * draw.uniform(0.45, 0.8), fillet),
            "crankpin": _journal(pin, bores[1], pin * draw.uniform(0.5, 0.9), fillet),
        },
        "web": {"outline": "obround", "width_mm": 2 * half, "thickness_mm": main * draw.uniform(0.3, 0.45)},
        "material": {"name": "42CrMo4"},
        "engine": {
            "bore_mm": bore,
            "rod_length_mm": radius * draw.uniform(3.2, 4.5),
            "speed_rpm": speed,
            "strokes": 4,
            "cylinders": cylinders,
            "firing_order": orders[cylinders],
            "gas": {
                "peak_pressure_MPa": draw.uniform(4.0, 18.0),
                "peak_angle_deg": draw.uniform(6.0, 14.0),
                "compression_ratio": draw.uniform(8.0, 15.0),
            },
            "masses": {
                "piston_group_kg": piston,
                "rod_reciprocating_kg": 0.3 * piston,
                "rod_rotating_kg": 0.7 * piston,
            },
        },
        "envelope": {
            "shape": "box",
            "half_width_mm": half * draw.uniform(1.0, 1.4),
            "y_min_mm": -half * draw.uniform(1.0, 1.3),
            "y_max_mm": radius + half * draw.uniform(1.0, 1.2),
        },
    }
    return _rounded(data)


def _journal(outer: float, bore: float, length: float, fillet: float) -> dict[str, float]:
    return {
        "outer_diameter_mm": outer,
        "bore_diameter_mm": bore,
        "length_mm": length,
        "fillet_mm": fillet,
    }


def _rounded(value: Any) -> Any:
    """Floats with five digits, as a person would write them."""
    if isinstance(value, dict):
        return {key: _rounded(item) for key, item in value.items()}
    return float(f"{value:.5g}") if isinstance(value, float) else value
