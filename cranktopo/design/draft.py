"""The draft that the process of a scene asks for, and what of the design has less."""

from __future__ import annotations

from cranktopo.design.schema import Scene

_ROUNDED_DEG = 0.0051
"""Draft that rounding may take."""


def asks_for_draft(scene: Scene) -> bool:
    """Tell whether a die or mould asks for a draft."""
    return scene.optimise.process in ("forged", "cast") and bool(scene.optimise.draft_deg)


def least_draft_deg(scene: Scene) -> float:
    """Return the draft with which a wall has what is asked, deg."""
    return scene.optimise.draft_deg - _ROUNDED_DEG


def kept_without_draft(scene: Scene) -> tuple[str, ...]:
    """Return what no optimiser changes and has less draft than asked: the flanks of a counterweight."""
    return ("web.counterweight",) if flank_draft_words(scene) else ()


def flank_draft_words(scene: Scene) -> str:
    """Return the draft of a counterweight's flanks where it is less than asked, in words; empty else."""
    weight, settings = scene.web.counterweight, scene.optimise
    if not asks_for_draft(scene) or weight is None or weight.bolted or not weight.has_flanks(scene):
        return ""
    found_deg = 0.0 if settings.parting == "web_faces" else weight.flank_draft_deg
    if found_deg >= least_draft_deg(scene):
        return ""
    return f"its flanks have {found_deg:.3g} deg of draft, optimise.draft_deg asks for {settings.draft_deg:g}"


def largest_half_angle_deg(scene: Scene) -> float:
    """Return the half-angle of a counterweight up to which its flanks have the draft asked for, deg."""
    drafted = asks_for_draft(scene) and scene.optimise.parting == "lateral"
    return 90.0 - scene.optimise.draft_deg if drafted else 90.0
