"""Throws of other engines than the built-in ones."""

from __future__ import annotations

from typing import Any

from cranktopo.design.loading import load_scene
from cranktopo.design.schema import Scene
from tests.physics.fea.evaluation_cases import throw_scene

# A passenger-car diesel throw: solid overlapping journals, short stroke to bore.
CAR: dict[str, Any] = {
    "name": "car-diesel",
    "throw": {
        "radius_mm": 44.0,
        "main_journal": {"outer_diameter_mm": 56.0, "length_mm": 26.0, "fillet_mm": 2.0},
        "crankpin": {"outer_diameter_mm": 48.0, "length_mm": 25.0, "fillet_mm": 2.0},
    },
    "web": {"thickness_mm": 18.0, "outline": "obround", "width_mm": 70.0},
    "material": {"name": "42CrMo4"},
    "supports": {"bearing_spring_N_per_mm": 1.5e6},
    "engine": {
        "bore_mm": 80.0,
        "rod_length_mm": 140.0,
        "speed_rpm": 2000.0,
        "overspeed_rpm": 5200.0,
        "gas": {"peak_pressure_MPa": 16.0, "peak_angle_deg": 10.0, "compression_ratio": 16.5},
        "masses": {"piston_group_kg": 0.75, "rod_reciprocating_kg": 0.2, "rod_rotating_kg": 0.5},
    },
}

# A slow industrial gas engine: long throw, heavy pistons, wide webs.
INDUSTRIAL: dict[str, Any] = {
    "name": "industrial-gas",
    "throw": {
        "radius_mm": 95.0,
        "main_journal": {"outer_diameter_mm": 130.0, "length_mm": 90.0, "fillet_mm": 6.0},
        "crankpin": {"outer_diameter_mm": 115.0, "length_mm": 85.0, "fillet_mm": 6.0},
    },
    "web": {"thickness_mm": 48.0, "outline": "obround", "width_mm": 165.0},
    "material": {"name": "42CrMo4"},
    "supports": {"bearing_spring_N_per_mm": 4e6},
    "engine": {
        "bore_mm": 170.0,
        "rod_length_mm": 380.0,
        "speed_rpm": 1500.0,
        "overspeed_rpm": 1800.0,
        "gas": {"peak_pressure_MPa": 14.0, "peak_angle_deg": 12.0, "compression_ratio": 12.0},
        "masses": {"piston_group_kg": 7.5, "rod_reciprocating_kg": 3.0, "rod_rotating_kg": 8.0},
    },
}

MARINE: dict[str, Any] = {
    "throw": {
        "radius_mm": 45.0,
        "main_journal": {"outer_diameter_mm": 70.0, "length_mm": 40.0, "fillet_mm": 3.6},
        "crankpin": {"outer_diameter_mm": 60.0, "length_mm": 40.0, "fillet_mm": 3.6},
    },
    "web": {"thickness_mm": 22.0, "outline": "obround", "width_mm": 100.0},
}


def rule_throws() -> dict[str, Scene]:
    """Throws inside the validity of IACS UR M53, by name."""
    return {
        "rule-example": throw_scene(MARINE["throw"], MARINE["web"]),
        "recessed": throw_scene(_with_recesses(MARINE["throw"], 0.8, 1.2), MARINE["web"]),
        "mikron-iiic-plain": load_scene("mikron-iiic-plain"),
        "industrial-gas": throw_scene(INDUSTRIAL["throw"], INDUSTRIAL["web"]),
    }


def _with_recesses(throw: dict[str, Any], main_mm: float, pin_mm: float) -> dict[str, Any]:
    """Return a throw whose fillets run below the faces of the web."""
    main, pin = (throw[key] for key in ("main_journal", "crankpin"))
    return {
        **throw,
        "main_journal": {**main, "recess_mm": main_mm},
        "crankpin": {**pin, "recess_mm": pin_mm},
    }
