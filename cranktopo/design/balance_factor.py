"""The balance factor of a throw: how much of the oscillating mass its counterweights balance."""

from __future__ import annotations

from cranktopo.design.schema import Scene


def rods_kg_mm(scene: Scene) -> tuple[float, float]:
    """Return the masses of a throw's rods that turn and that oscillate, times the throw radius."""
    engine = scene.engine
    if engine is None:
        return 0.0, 0.0
    arm = engine.rods_per_pin * scene.throw.radius_mm
    return engine.rod_rotating_kg * arm, engine.reciprocating_kg * arm


def balance_factor_percent(scene: Scene, unbalance_kg_mm: float) -> float | None:
    """Return what a throw of some unbalance takes of the oscillating mass, percent; None without such mass.

    0 where the rotating masses alone are balanced, negative where not even these are.
    """
    rotating, oscillating = rods_kg_mm(scene)
    return -100 * (unbalance_kg_mm + rotating) / oscillating if oscillating else None


def unbalance_at_kg_mm(scene: Scene, percent: float) -> float:
    """Return the unbalance of a throw alone that has a balance factor."""
    rotating, oscillating = rods_kg_mm(scene)
    return -rotating - percent / 100 * oscillating
