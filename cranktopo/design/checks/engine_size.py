"""Proportions of an engine: bore beside stroke, piston speed, and masses beside the bore."""

from __future__ import annotations

from cranktopo.design.engine import Engine
from cranktopo.design.schema import Scene

BORE_OVER_STROKE = 0.25, 4.0
"""Engines in series have 0.3 (large two-stroke engines) to 2.2 (racing engines)."""
FASTEST_PISTON_M_PER_S = 50.0
"""Largest mean piston speed; racing engines have up to 30 m/s, engines in series up to 25 m/s."""
MASS_OVER_BORE_CUBED = 1e-8, 5e-5
"""Range of each moving mass over the cube of the bore, kg/mm3: usual piston groups and rods have 1.5e-7 to
2e-6, a piston of a large two-stroke engine with its rod and crosshead about 2.5e-5."""
_MASSES = "piston_group_kg", "rod_reciprocating_kg", "rod_rotating_kg", "rod_kg"
_G_PER_KG = 1000.0


def check_engine_size(scene: Scene, engine: Engine) -> None:
    """Refuse a bore, a speed or a mass that no engine of such a stroke and bore has."""
    _check_bore(scene, engine)
    _check_piston_speed(scene, engine)
    for name in _MASSES:
        _check_mass(scene, engine, name)


def _check_bore(scene: Scene, engine: Engine) -> None:
    stroke = 2 * scene.throw.radius_mm
    low, high = (share * stroke for share in BORE_OVER_STROKE)
    if not low <= engine.bore_mm <= high:
        raise scene.invalid(
            "engine.bore_mm",
            f"must be >= {low:.4g} and <= {high:.4g} mm for a stroke of {stroke:.4g} mm "
            f"({BORE_OVER_STROKE[0]:g} to {BORE_OVER_STROKE[1]:g} times twice the throw radius)",
            "Correct the bore or throw.radius_mm, or its unit.",
        )


def _check_piston_speed(scene: Scene, engine: Engine) -> None:
    stroke = 2 * scene.throw.radius_mm
    highest = FASTEST_PISTON_M_PER_S * 30e3 / stroke
    for name in ("speed_rpm", "overspeed_rpm"):
        rpm = getattr(engine, name) or 0.0
        if rpm > highest:
            raise scene.invalid(
                f"engine.{name}",
                f"must be <= {highest:.0f} rpm for a stroke of {stroke:.4g} mm: the mean piston speed would "
                f"be {rpm * stroke / 30e3:.3g} m/s, at most {FASTEST_PISTON_M_PER_S:g} m/s is possible",
                "Correct the speed or throw.radius_mm, or its unit.",
            )


def _check_mass(scene: Scene, engine: Engine, name: str) -> None:
    mass = getattr(engine.masses, name)
    low, high = (share * engine.bore_mm**3 for share in MASS_OVER_BORE_CUBED)
    if not mass or low <= mass <= high:  # 0 stands for no mass
        return
    grams = low <= mass / _G_PER_KG <= high
    raise scene.invalid(
        f"engine.masses.{name}",
        f"must be 0, or >= {low:.3g} and <= {high:.3g} kg for a bore of {engine.bore_mm:.4g} mm",
        f"Is it in grams? Write {mass / _G_PER_KG:g} kg." if grams else "Correct the mass or the bore.",
    )
