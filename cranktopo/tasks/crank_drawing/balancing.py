"""Notes of the drawing on balancing: what the machine can be asked for, and with which bob weights."""

from __future__ import annotations

import math

from cranktopo.base.units import plain_number
from cranktopo.bodies.crank_ends import main_journal_places_mm
from cranktopo.design.crank_throws import is_split, throw_scenes
from cranktopo.design.halves import halves
from cranktopo.design.schema import Scene
from cranktopo.engine.balance.crank import drawn_crank_mass
from cranktopo.engine.balance.throw import throw_balance

_G_PER_KG, _ALIKE_KG = 1000.0, 5e-4


def balancing_notes(scene: Scene, mass_kg: float) -> list[str]:
    """Return the lines on the balance quality of a crank, which it can only have where its design has it.

    Counterweights for rods and pistons leave the crank alone unbalanced: it is balanced with bob weights on
    its pins.
    """
    grade = f"ISO 21940-11 G {scene.drawing.balance_quality:g}"
    engine = scene.engine
    if engine is None:
        return [f"Balanced to {grade}."]
    speed = max(engine.own_speeds_rpm)
    permitted_g_mm = _G_PER_KG * scene.drawing.balance_quality / (2 * math.pi * speed / 60) * mass_kg
    permitted = f"{plain_number(permitted_g_mm, 3)} g mm"
    residual = f"residual unbalance at most {permitted}, half of it in each end plane."
    total_g_mm, plane_g_mm = _by_design_g_mm(scene)
    if max(total_g_mm, 2 * plane_g_mm) <= permitted_g_mm:
        return [f"Balanced to {grade} at {speed:g} rpm:", residual]
    in_plane = f"up to {plain_number(plane_g_mm, 3)} g mm in an end plane"
    own = f"Unbalance by design {plain_number(total_g_mm, 3)} g mm, {in_plane}:"
    weights = _bob_weights_kg(scene)
    if min(weights) <= 0:
        return [own, f"{_lacking(scene)} it cannot be balanced to {grade}."]
    alike = max(weights) - min(weights) < _ALIKE_KG
    each = ", ".join(f"{weight:.3f}" for weight in (weights[:1] if alike else weights))
    pins = "on the half pins of each throw, half on either" if is_split(scene) else "on the crankpins"
    bob = f"balanced with bob weights of {each} kg {pins}"
    return [own, bob, f"to {grade} at {speed:g} rpm:", residual]


def _by_design_g_mm(scene: Scene) -> tuple[float, float]:
    """Unbalance of the crank as drawn, and the most that one of the planes of its outer main journals has."""
    crank, length = drawn_crank_mass(scene), main_journal_places_mm(scene)[-1]
    total, couple = crank.unbalance_kg_mm, crank.couple_kg_mm2
    return _G_PER_KG * total, _G_PER_KG * (total / 2 + couple / length)


def _bob_weights_kg(scene: Scene) -> list[float]:
    """Masses on the crankpins with which every throw alone is balanced; negative without a counterweight."""
    throws = throw_scenes(scene)
    return [-throw_balance(one).throw_unbalance_kg_mm / one.throw.radius_mm for one in throws]


def _lacking(scene: Scene) -> str:
    weighted = any(half.web.counterweight for one in throw_scenes(scene) for half in halves(one))
    return "without heavier counterweights" if weighted else "without counterweights"
