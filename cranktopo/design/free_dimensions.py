"""Dimensions that the shape optimisation may change: where each stands in a scene, and its checked range."""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping, Sequence
from typing import Any, Literal, get_args

from cranktopo.base.errors import CranktopoError
from cranktopo.design.halves import has_zones
from cranktopo.design.schema import Scene
from cranktopo.throw.counterweight.table import LEAST_HALF_ANGLE_DEG
from cranktopo.throw.journal import ROUNDING_MM, Journal

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
    """Key of its range in `[shape.free]`."""
    return f"{name}_{'deg' if name == 'counterweight_angle' else 'mm'}"


def move_journals(names: Collection[DimensionName]) -> bool:
    """Tell whether some of the dimensions change more of the throw than its web's section."""
    return not all(map(is_of_counterweight, names))


def is_of_counterweight(name: DimensionName) -> bool:
    """Tell whether a dimension is one of the counterweight."""
    return name in _COUNTERWEIGHT


def _fillet_of(name: DimensionName) -> DimensionName:
    return next((fillet for fillet, axial in AXIAL.items() if axial == name), name)


def is_axial(name: DimensionName) -> bool:
    """Tell whether a dimension is the semi-axis of a fillet along the crank."""
    return name in AXIAL.values()


def with_dimensions(scene: Scene, values: Mapping[DimensionName, float]) -> Scene:
    """Return the scene with other dimensions, mm or deg, not checked; the main journal keeps the pitch."""
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


M53_FILLET = (0.03, 0.13)
"""Fillet radius over the pin's diameter for which the rule's formulas are made (IACS UR M53, section 3)."""


def check_free_dimensions(scene: Scene) -> None:
    """Check every range of `[shape.free]`."""
    for name in DIMENSIONS:
        found = free_range_mm(scene, name)
        if found is None:
            continue
        if is_of_counterweight(name):
            _check_counterweight(scene, name, found)
            continue
        _check_own(scene, name, found)
        _check_outlets(scene, name)
        if name == "web_thickness":
            if has_zones(scene):
                hint = "Leave it out, or leave the zones out."
                raise _refused(
                    scene, name, "envelope.frozen or envelope.removable hold the web's faces", hint
                )
            _check_thickness(scene, found[0])
            continue
        if name.endswith("bore"):
            _check_bore(scene, name, found)
        else:
            _check_fillet(scene, name, found)
        _check_clear(scene, name)


def _check_counterweight(scene: Scene, name: DimensionName, found: tuple[float, float]) -> None:
    """There is one to change, and its least is sound; room for its greatest is a rule of the search."""
    weight = scene.web.counterweight
    if weight is None:
        hint = "Add [web.counterweight], or leave it out."
        raise _refused(scene, name, "the design has no counterweight", hint)
    if weight.bolted:
        allowed = "the counterweight is a part of its own (density_kg_m3), which no shape changes"
        raise _refused(scene, name, allowed, "Leave it out, or leave the density out.")
    _check_own(scene, name, found)
    if name == "counterweight_angle" and found[0] < LEAST_HALF_ANGLE_DEG:
        allowed = f"the least must be at least {LEAST_HALF_ANGLE_DEG:g} deg"
        raise _refused(scene, name, allowed, "Narrow the range.")
    least = with_dimensions(scene, {name: found[0]})
    assert least.web.counterweight is not None
    try:
        least.web.counterweight.check_alone(least, "web.counterweight")
    except CranktopoError as error:
        raise _refused(scene, name, f"its least gives {str(error).rstrip('.')}", "Narrow it.") from None


_STEP = 0.01
"""To which the ranges of another web are found, mm or degrees."""


def with_counterweight_ranges(scene: Scene, of: Scene, webs: Sequence[Scene] = ()) -> Scene:
    """Return a scene with the free ranges of another's counterweight, each begun where it is sound here.

    Another web of the same throw may be so wide that a counterweight of the least radius lies within it.

    Args:
        webs: scenes of the webs that the scene has; by default its own. What does not serve all is left out.
    """
    ranges = {name: found for name in _COUNTERWEIGHT if (found := free_range_mm(of, name))}
    if not ranges:
        return scene
    sound = {free_key(name): _sound_range(webs or (scene,), name, found) for name, found in ranges.items()}
    free = scene.shape.free.model_copy(update=sound)
    return scene.model_copy(update={"shape": scene.shape.model_copy(update={"free": free})})


def _sound_range(
    webs: Sequence[Scene], name: DimensionName, free: tuple[float, float]
) -> tuple[float, float] | None:
    least = max(_sound_least(web, name, free) for web in webs)
    return (least, free[1]) if least <= min(own_dimension_mm(web, name) for web in webs) else None


def moved_ranges_text(scene: Scene, before: Scene) -> str:
    """Say which free ranges of the counterweight begin later than before, and why; empty for none."""
    found = [
        f"shape.free.{free_key(name)} begins at {now[0]:g} instead of {then[0]:g}"
        for name in _COUNTERWEIGHT
        if (now := free_range_mm(scene, name)) and (then := free_range_mm(before, name)) and now != then
    ]
    return f"{'; '.join(found)}: below, the new web leaves the counterweight nothing" if found else ""


COUNTERWEIGHT_RANGES = {free_key(name) for name in _COUNTERWEIGHT}
"""Keys of `[shape.free]` for the counterweight."""


def _sound_least(scene: Scene, name: DimensionName, free: tuple[float, float]) -> float:
    """Return the least of a range, or the least above it that passes its check; else the design's own."""

    def sound(least: float) -> bool:
        try:
            _check_counterweight(scene, name, (least, free[1]))
        except CranktopoError:
            return False
        return True

    if sound(free[0]):
        return free[0]
    low, high = free[0], own_dimension_mm(scene, name)
    while high - low > _STEP:
        middle = (low + high) / 2
        low, high = (low, middle) if sound(middle) else (middle, high)
    least = math.ceil(high / _STEP) * _STEP
    return min(round(least, 2), own_dimension_mm(scene, name))


def _check_outlets(scene: Scene, name: DimensionName) -> None:
    """No rounded outlet of a drilling is carried along by the journal that it is on."""
    for index, drilling in enumerate(scene.throw.drilling):
        if drilling.outlet_radius_mm:
            allowed = f"throw.drilling[{index}] has rounded outlets, which cannot move with the journals"
            raise _refused(
                scene, name, allowed, "Leave it out, or leave outlet_radius_mm of the drilling out."
            )


def _check_own(scene: Scene, name: DimensionName, found: tuple[float, float]) -> None:
    own = own_dimension_mm(scene, name)
    if not found[0] - ROUNDING_MM <= own <= found[1] + ROUNDING_MM:
        raise _refused(
            scene,
            name,
            f"the range must hold the design's own value, {key_of(name)} = {own:g}"
            f" {free_key(name).rpartition('_')[2]}",
            "Widen the range, or change the design.",
        )


def _check_fillet(scene: Scene, name: DimensionName, found: tuple[float, float]) -> None:
    """The formulas of M53 hold, and the thinnest land between two fillets stays."""
    pin = scene.throw.crankpin.outer_diameter_mm
    low, high = (share * pin for share in M53_FILLET)
    if found[0] < low - ROUNDING_MM or found[1] > high + ROUNDING_MM:
        raise _refused(
            scene,
            name,
            f"must lie within {low:.4g} and {high:.4g} mm, {M53_FILLET[0]:g} to {M53_FILLET[1]:g} of the "
            "pin's diameter (IACS UR M53)",
            "Narrow the range.",
        )
    _check_recess(scene, name, found)
    journal, room = _shortest_journal(scene, name)
    if found[1] >= room / 2 and (is_axial(name) or _stays_round(scene, name)):
        raise _refused(
            scene,
            name,
            f"the greatest must be smaller than half of throw.{journal}.length_mm, which is at least "
            f"{room:g} mm",
            "Narrow this range" + (" or that of the thickness." if journal == "main_journal" else "."),
        )


def _check_recess(scene: Scene, name: DimensionName, found: tuple[float, float]) -> None:
    """The arc of an undercut fillet is that of a circle, and goes deeper than the web's face."""
    recess = journal_of(scene, name).recess_mm
    if recess is None:
        return
    key = f"{key_of(_fillet_of(name)).removesuffix('fillet_mm')}recess_mm = {recess:g} mm"
    if is_axial(name):
        raise _refused(scene, name, f"{key}: an ellipse has no recess", "Leave one of them out.")
    if found[0] <= recess:
        raise _refused(scene, name, f"the least must be larger than {key}", "Narrow the range.")


def _stays_round(scene: Scene, name: DimensionName) -> bool:
    return free_range_mm(scene, AXIAL[name]) is None and journal_of(scene, name).fillet_axial_mm is None


def _shortest_journal(scene: Scene, name: DimensionName) -> tuple[str, float]:
    """Return the journal of a fillet, and its least length, mm, at the web's greatest thickness."""
    if _fillet_of(name) == "pin_fillet":
        return "crankpin", scene.throw.crankpin.length_mm
    thickness = free_range_mm(scene, "web_thickness")
    thickest = with_dimensions(scene, {"web_thickness": thickness[1]} if thickness else {})
    return "main_journal", thickest.throw.main_journal.length_mm


def _check_bore(scene: Scene, name: DimensionName, found: tuple[float, float]) -> None:
    outer = journal_of(scene, name).outer_diameter_mm
    if found[1] >= outer:
        key = key_of(name).replace("bore_diameter_mm", "outer_diameter_mm")
        raise _refused(
            scene, name, f"the greatest must be smaller than {key} = {outer:g} mm", "Narrow the range."
        )


def _check_clear(scene: Scene, name: DimensionName) -> None:
    """A bore that cuts the other journal's fillet leaves neither of them a shape that can change."""
    bore: DimensionName
    fillet: DimensionName
    bore, fillet = ("pin_bore", "journal_fillet")
    if _fillet_of(name) not in (bore, fillet):
        bore, fillet = ("journal_bore", "pin_fillet")
    bored, other = journal_of(scene, bore), journal_of(scene, fillet)
    reach = bored.bore_radius_mm + other.clear_radius_mm
    if bored.bore_radius_mm and reach >= scene.throw.radius_mm:
        raise _refused(
            scene,
            name,
            f"{key_of(bore)} cuts {key_of(fillet)}: with the journal they reach {reach:g} mm, and "
            f"throw.radius_mm = {scene.throw.radius_mm:g} mm",
            "Leave it out, or change the design.",
        )


def _check_thickness(scene: Scene, least: float) -> None:
    """Room for the clearances in the thinnest web, and for the bearing beside the thickest."""
    found = free_range_mm(scene, "web_thickness") or (0.0, 0.0)
    length, fillet = _shortest_journal(scene, "journal_fillet")[1], scene.throw.main_journal.fillet.axial_mm
    if length <= 2 * fillet:
        most = found[1] - (2 * fillet - length) / 2
        raise _refused(
            scene,
            "web_thickness",
            f"the pitch stays, so the main journal would keep {length:g} mm; the greatest must be smaller "
            f"than {most:.4g} mm to leave a bearing between its fillets",
            "Narrow the range.",
        )
    envelope = scene.envelope
    clearance = envelope.bearing_clearance_mm + envelope.rod_clearance_mm if envelope else 0.0
    if least <= clearance:
        raise _refused(
            scene,
            "web_thickness",
            f"the least must be larger than the clearances of the envelope, {clearance:g} mm together",
            "Narrow the range.",
        )


def _refused(scene: Scene, name: DimensionName, allowed: str, hint: str) -> CranktopoError:
    return scene.invalid(f"shape.free.{free_key(name)}", allowed, hint)
