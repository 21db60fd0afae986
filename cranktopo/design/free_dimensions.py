"""Dimensions of the throw that the shape optimisation may change: where each stands in a scene."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from typing import Any, Literal, get_args

from cranktopo.design.schema import Scene
from cranktopo.throw.geometry import Journal

DimensionName = Literal[
    "pin_fillet",
    "journal_fillet",
    "pin_fillet_axial",
    "journal_fillet_axial",
    "pin_bore",
    "journal_bore",
    "web_thickness",
    "counterweight_radius",
    "counterweight_angle",
]
DIMENSIONS: tuple[DimensionName, ...] = get_args(DimensionName)
"""All of them; keys of `[shape.free]` have their unit besides."""
AXIAL: dict[DimensionName, DimensionName] = {
    "pin_fillet": "pin_fillet_axial",
    "journal_fillet": "journal_fillet_axial",
}
"""The semi-axis along the crank of each fillet."""
_COUNTERWEIGHT: dict[DimensionName, str] = {
    "counterweight_radius": "outer_radius_mm",
    "counterweight_angle": "half_angle_deg",
}
_JOURNALS = {"pin": "crankpin", "journal": "main_journal"}
_KEYS = {"fillet": "fillet_mm", "fillet_axial": "fillet_axial_mm", "bore": "bore_diameter_mm"}


def key_of(name: DimensionName) -> str:
    """Key path of a dimension in the scene."""
    if name == "web_thickness":
        return "web.thickness_mm"
    if name in _COUNTERWEIGHT:
        return f"web.counterweight.{_COUNTERWEIGHT[name]}"
    journal, _, kind = name.partition("_")
    return f"throw.{_JOURNALS[journal]}.{_KEYS[kind]}"


def journal_of(scene: Scene, name: DimensionName) -> Journal:
    """Return the journal of a fillet or bore."""
    journal: Journal = getattr(scene.throw, _JOURNALS[name.partition("_")[0]])
    return journal


def own_dimension_mm(scene: Scene, name: DimensionName) -> float:
    """Return a dimension of a scene, mm or degrees; the axial semi-axis of a round fillet is its radius."""
    if is_axial(name):
        return journal_of(scene, name).fillet.axial_mm
    value: Any = scene
    for part in key_of(name).split("."):
        value = getattr(value, part)
    return float(value)


def free_range_mm(scene: Scene, name: DimensionName) -> tuple[float, float] | None:
    """Least and greatest of a dimension in `[shape.free]`, mm or degrees; None where it is not free."""
    found: tuple[float, float] | None = getattr(scene.shape.free, free_key(name))
    return found


def free_key(name: DimensionName) -> str:
    """Key of a dimension in `[shape.free]`."""
    return f"{name}_{'deg' if name == 'counterweight_angle' else 'mm'}"


def move_journals(names: Collection[DimensionName]) -> bool:
    """Tell whether some of the dimensions change more of the throw than its web's section."""
    return not all(map(is_of_counterweight, names))


def is_of_counterweight(name: DimensionName) -> bool:
    """Tell whether a dimension is one of the counterweight."""
    return name in _COUNTERWEIGHT


def fillet_of(name: DimensionName) -> DimensionName:
    """Return the fillet that an axial semi-axis belongs to; any other dimension itself."""
    return next((fillet for fillet, axial in AXIAL.items() if axial == name), name)


def is_axial(name: DimensionName) -> bool:
    """Tell whether a dimension is the semi-axis of a fillet along the crank."""
    return name in AXIAL.values()


def with_dimensions(scene: Scene, values: Mapping[DimensionName, float]) -> Scene:
    """The scene with other dimensions, not checked; the pitch stays, the main journal gives way to the web.

    Args:
        values: mm or degrees, by name.
    """
    if not values:
        return scene
    throw, web = scene.throw, scene.web
    changes: dict[str, dict[str, float]] = {"main_journal": {}, "crankpin": {}}
    for name, value in values.items():
        if name == "web_thickness":
            longer = 2 * (web.thickness_mm - float(value))
            changes["main_journal"]["length_mm"] = throw.main_journal.length_mm + longer
            web = web.model_copy(update={"thickness_mm": float(value)})
        elif name in _COUNTERWEIGHT:
            assert web.counterweight is not None
            weight = web.counterweight.model_copy(update={_COUNTERWEIGHT[name]: float(value)})
            web = web.model_copy(update={"counterweight": weight})
        else:
            _, journal, key = key_of(name).split(".")
            changes[journal][key] = float(value)
    journals = {key: getattr(throw, key).model_copy(update=change) for key, change in changes.items()}
    return scene.model_copy(update={"throw": throw.model_copy(update=journals), "web": web})
