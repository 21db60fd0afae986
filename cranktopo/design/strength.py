"""Worth of the strengths of a material in a part of this size: remarks beside every safety."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass
from math import isclose

from cranktopo.base.notes import note
from cranktopo.design.halves import halves
from cranktopo.design.material import (
    LIBRARY_STRENGTHS,
    Material,
    library_section_mm,
    material_library,
    thicker_MPa,
)
from cranktopo.design.schema import Scene


@dataclass(frozen=True)
class RulingSection:
    """Thickness through which a part is hardened, and where it has it.

    Attributes:
        part: `crank` or `rod`.
        table: of the scene with the part's material.
        place: where in the part; empty where it is not told.
    """

    thickness_mm: float
    part: str
    table: str
    place: str = ""


def strength_remarks(scene: Scene, used: Collection[str] = LIBRARY_STRENGTHS) -> tuple[str, ...]:
    """Return what the library's strengths do not hold for: thicker sections, another tensile strength.

    Args:
        used: strengths beside the tensile one on which the judgement rests; others are not told.
    """
    return material_remarks(scene.material, _crank_section(scene), used)


def material_remarks(
    material: Material, section: RulingSection, used: Collection[str] = LIBRARY_STRENGTHS
) -> tuple[str, ...]:
    """Return the same of a material in any part."""
    return tuple(filter(None, (_section_remark(material, section), _proportion_remark(material, used))))


def strength_notes(scene: Scene) -> list[str]:
    """Return what a drawing says of the material beside its name; nothing where no strength is known.

    A strength of the library that holds for thinner sections is no demand that a forge can meet.
    """
    return material_notes(scene.material, _crank_section(scene))


def treatment_notes(scene: Scene) -> list[str]:
    """Return what a drawing asks of the fillets, so that they have the treatment which the safety counts."""
    settings, demands = scene.fatigue, dict[str, list[str]]()
    for fillet, one in settings.hardened.items():
        demands.setdefault(one.demand, []).append("crankpins" if fillet == "pin" else "main journals")
    if settings.surface_treatment_factor > 1.0:
        asked = settings.surface_treatment_source or "treated, as agreed with the forge"
        demands[f"{asked}; strength times {settings.surface_treatment_factor:g}"] = ["all journals"]
    return [f"Fillets of {' and '.join(places)}: {demand}." for demand, places in demands.items()]


def material_notes(material: Material, section: RulingSection) -> list[str]:
    """Return the same of a material in any part."""
    if _section_remark(material, section):
        return [
            f"{material.name}: strength to be agreed with the forge for {section.thickness_mm:.4g} mm;",
            f"Rm {material.ultimate_MPa:g} MPa of the design is that of sections to "
            f"{library_section_mm(material.name):g} mm.",
            *([f"Heat treatment: {material.heat_treatment}."] if material.heat_treatment else []),
        ]
    return _demanded_strength(material)


def value_origin(material: Material, key: str) -> str:
    """Return whether a value of a material is the design's, or that of the library, in words."""
    entry, value = material_library().get(material.name, {}), getattr(material, key)
    usual = entry.get("ultimate_MPa")
    if value is None or key not in entry:
        return "of the design"
    if value == entry[key]:
        return f"as in the library for {material.name}"
    share = material.ultimate_MPa / usual if material.ultimate_MPa and usual else 1.0
    if key in LIBRARY_STRENGTHS and isclose(value, entry[key] * share):
        return f"of the library for {material.name}, in proportion to the tensile strength"
    return "of the design"


def note_strength(name: str, scene: Scene, used: Collection[str] = LIBRARY_STRENGTHS) -> None:
    """Tell the remarks of a design that is judged by its strength."""
    for remark in strength_remarks(scene, used):
        note(f"{name}: material: {remark}")


def ruling_section_mm(scene: Scene) -> float:
    """Return the thickness through which the crank is hardened: of a solid journal its diameter, of a bored
    one its wall, or that of a web."""
    parts = halves(scene)
    journals = [
        through_mm(journal.outer_diameter_mm, journal.bore_diameter_mm)
        for half in parts
        for journal, _ in half.throw.journals
    ]
    return max(*journals, *(half.web.thickness_mm for half in parts))


def through_mm(diameter_mm: float, bore_mm: float) -> float:
    """Return the thickness through which a cylinder is hardened: its diameter, or its wall if bored."""
    return (diameter_mm - bore_mm) / 2 if bore_mm else diameter_mm


def _demanded_strength(material: Material) -> list[str]:
    """Return the note on the strength that a material must have; nothing where none is known."""
    strengths = (("Rm", material.ultimate_MPa), ("Re", material.yield_MPa))
    demands = [f"{name} at least {value:g} MPa" for name, value in strengths if value]
    demands += [material.heat_treatment] if material.heat_treatment else []
    return [f"{material.name}: {', '.join(demands)}."] if demands else []


def _crank_section(scene: Scene) -> RulingSection:
    return RulingSection(ruling_section_mm(scene), "crank", "material")


def _section_remark(material: Material, ruling: RulingSection) -> str:
    entry, most_mm = material_library().get(material.name, {}), library_section_mm(material.name)
    section = ruling.thickness_mm
    if most_mm is None or section <= most_mm or material.ultimate_MPa != entry["ultimate_MPa"]:
        return ""
    thicker = thicker_MPa(material.name, section)
    less = "less" if thicker is None else "{:g} and a yield strength of {:g} MPa".format(*thicker)
    place = f" in its {ruling.place}" if ruling.place else ""
    return (
        f"ultimate_MPa = {material.ultimate_MPa:g} of {material.name} is that of sections to {most_mm:g} mm "
        f"in the library; this {ruling.part} has {section:.4g} mm{place}, "
        f"where the standard asks for {less}. Give {ruling.table}.ultimate_MPa and yield_MPa of the forging"
    )


def _proportion_remark(material: Material, used: Collection[str]) -> str:
    entry = material_library().get(material.name)
    if entry is None or material.ultimate_MPa in (None, entry["ultimate_MPa"]):
        return ""
    share = material.ultimate_MPa / entry["ultimate_MPa"]
    scaled = [
        f"{key} = {value:g}"
        for key in LIBRARY_STRENGTHS
        if key in used
        and (value := getattr(material, key)) is not None
        and isclose(value, entry[key] * share)
    ]
    if not scaled:
        return ""
    return f"{', '.join(scaled)}: those of {material.name} in proportion to ultimate_MPa"
