"""The scene as it is simulated: the features that the plan leaves out are taken out of it."""

from __future__ import annotations

from collections.abc import Collection
from typing import Literal

from cranktopo.design.schema import Scene
from cranktopo.engine.plan.effect import PhysicsPlan

# Effects that are features of both journals, and the dimensions of a journal that has none.
Feature = Literal["bores", "fillets"]
_WITHOUT: dict[Feature, dict[str, float | None]] = {
    "bores": {"bore_diameter_mm": 0.0},
    "fillets": {"fillet_mm": 0.0, "fillet_axial_mm": None, "recess_mm": None},
}
FEATURES = tuple(_WITHOUT)
APPLIED = frozenset({*FEATURES, "lateral_symmetry", "manufacturing_constraint"})
"""Effects that `apply_physics_plan` settles in a scene, where they look like choices of the design."""


def apply_physics_plan(scene: Scene, plan: PhysicsPlan, kept: Collection[Feature] = ()) -> Scene:
    """Return the scene that is meshed: effects that are off taken out, but for features that are `kept`.

    These are bores, fillets and the mirror; the manufacturing constraint is on where the plan has it on. It
    is the same object when nothing is left out.
    """
    for feature in FEATURES:
        if feature not in plan.enabled and feature not in kept:
            scene = strip_features(scene, feature)
    if "lateral_symmetry" not in plan.enabled:
        scene = scene.with_effect("lateral_symmetry", "off")
    if "manufacturing_constraint" in plan.enabled:
        scene = scene.with_effect("manufacturing_constraint", "on")
    return scene


def strip_features(scene: Scene, feature: Feature) -> Scene:
    """Return the scene with both journals without one feature; the same object when they have none."""
    throw, update = scene.throw, _WITHOUT[feature]
    main, pin = (j.model_copy(update=update) for j in (throw.main_journal, throw.crankpin))
    if (main, pin) == (throw.main_journal, throw.crankpin):
        return scene
    bare = throw.model_copy(update={"main_journal": main, "crankpin": pin})
    return scene.model_copy(update={"throw": bare})
