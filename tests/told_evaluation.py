"""An entry of `evaluate --json` as later stages read it, invented."""

from __future__ import annotations

from typing import Any


def told_evaluation(
    torsion: float = 150e3,
    bending: float = 230e3,
    mass_kg: float = 1.5,
    error_percent: tuple[float, float] = (0.3, 0.4),
) -> dict[str, Any]:
    """Return the entry of a target that is free in torsion and pinned in bending."""
    errors = dict(zip(("torsion", "bending"), error_percent, strict=True))
    return {
        "target": "invented",
        "mass_kg": {"throw": mass_kg, "web": mass_kg / 3},
        "inertia_kg_mm2": 5000.0,
        "unbalance_kg_mm": 50.0,
        "torsion": {"free_Nm_per_rad": torsion},
        "bending": {"pinned_N_per_mm": bending},
        "supports": {"torsion": "free", "bending": "pinned"},
        "stiffness_per_mass": {
            "torsion_Nm_per_rad_kg": torsion / mass_kg,
            "bending_N_per_mm_kg": bending / mass_kg,
        },
        "mesh": {"element_size_mm": 4.0, "nodes": 1000, "order": 2, "triangles": False},
        "error_estimate_percent": errors,
        "error_by_support_percent": {
            "torsion": {"free": errors["torsion"]},
            "bending": {"pinned": errors["bending"]},
        },
        "seconds": {"mesh": 1.0, "solve": 2.0, "total": 3.0},
        "assumed": [],
    }
