"""Lines on what a fatigue assessment rests on: its mesh, what is not counted, stresses beyond yielding."""

from __future__ import annotations

from cranktopo.base.notes import note
from cranktopo.tasks.fatigue.criterion import larger_end_MPa
from cranktopo.tasks.fatigue.cut_outlets import judged_places
from cranktopo.tasks.fatigue.safety_field import FatigueField
from cranktopo.tasks.fatigue.stress_model import StressModel


def note_quality(field: FatigueField) -> None:
    """Tell in a line where means miss the rule's checks of a mesh, and what is not counted."""
    if missed := mesh_shortfall(field.model):
        note(f"note: {field.model.name}: {missed}; a smaller --fillet-fraction helps.")
    sharp = field.at_sharp_edges
    if sharp is not None and sharp.safety < field.critical.safety:
        note(
            f"note: {field.model.name}: {sharp.safety:.3f} at a sharp inner edge ({sharp.place}) is not "
            "counted: it falls with every finer mesh. Give the edge a radius."
        )
    note_cut_outlets(field.model)


def mesh_shortfall(model: StressModel) -> str:
    """Return the rule's checks that the mesh of a model misses, else nothing."""
    return "" if model.quality.within_limits else model.quality.shortfall


def note_cut_outlets(model: StressModel) -> None:
    """Tell in a line of outlets that are not judged because the model ends in them."""
    if model.at_cut.any():
        note(
            f"note: {model.name}: the oil outlet in the middle of the main journal is not judged: the throw "
            f"is cut there. {judged_places(model.scene, model.whole)}"
        )


def note_yielding(field: FatigueField, yield_MPa: float | None) -> None:
    """Warn of a stress that no material carries: the loads, a dimension or a unit may be wrong."""
    if line := yield_warning(field, yield_MPa):
        note(f"warning: {line}")


def yield_warning(field: FatigueField, yield_MPa: float | None) -> str:
    """Return a line on a stress above the yield strength; empty where there is none."""
    place = field.critical
    largest = larger_end_MPa(place.amplitude_MPa, place.mean_MPa)
    if yield_MPa is None or largest <= yield_MPa:
        return ""
    return (
        f"{field.model.name}: {largest:.0f} MPa by linear elasticity at {place.place}, "
        f"{largest / yield_MPa:.1f} times the yield strength of {yield_MPa:g} MPa: the material yields, "
        "and no safety here holds. Check loads, dimensions and units."
    )
