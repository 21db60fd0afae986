"""A fast V-twin with a pulley on the free end of its only throw: inertia outweighs the gas."""

from __future__ import annotations

from typing import Any

from cranktopo.design.loading import scene_from_dict
from cranktopo.design.schema import Scene

THROW_NM, PULLEY_NM, LOSS = 297e3, 160e3, 0.02
PULLEY_KG_M2, FLYWHEEL_KG_M2 = 0.0015, 0.001
ENGINE: dict[str, Any] = {
    "bore_mm": 100.0,
    "rod_length_mm": 124.0,
    "speed_rpm": 11500.0,
    "cylinders": 2,
    "firing_order": [1, 2],
    "gas": {"peak_pressure_MPa": 9.5, "peak_angle_deg": 14.0, "compression_ratio": 12.5},
    "masses": {"piston_group_kg": 0.4, "rod_reciprocating_kg": 0.13, "rod_rotating_kg": 0.3},
    "arrangement": {"layout": "V", "bank_angle_deg": 90.0, "throw_angles_deg": [0]},
}


def fast_twin(*, pulley: bool = True, **tables: Any) -> Scene:
    """Return the twin; tables replace its own."""
    shaft: dict[str, Any] = {
        "speed_min_rpm": 4000.0,
        "speed_max_rpm": 12000.0,
        "throw_stiffness_Nm_per_rad": THROW_NM,
        "throw_loss_factor": LOSS,
        "flywheel": {"inertia_kg_m2": FLYWHEEL_KG_M2},
    }
    if pulley:
        shaft["pulley"] = {
            "inertia_kg_m2": PULLEY_KG_M2,
            "stiffness_Nm_per_rad": PULLEY_NM,
            "loss_factor": LOSS,
        }
    return scene_from_dict(
        {
            "name": "twin",
            "throw": {
                "radius_mm": 33.75,
                "main_journal": {"outer_diameter_mm": 48.0, "length_mm": 30.0, "fillet_mm": 2.5},
                "crankpin": {"outer_diameter_mm": 44.0, "length_mm": 44.0, "fillet_mm": 2.5},
            },
            "web": {
                "thickness_mm": 22.0,
                "outline": "obround",
                "width_mm": 64.0,
                "counterweight": {"outer_radius_mm": 75.72, "half_angle_deg": 70.0},
            },
            "material": {"name": "42CrMo4"},
            "engine": ENGINE,
            "shaft": shaft,
            **tables,
        }
    )
