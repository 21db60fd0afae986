"""The design of an imported half throw as commented TOML: what is known, and lines to fill in."""

from __future__ import annotations

from typing import Any

import tomlkit

from cranktopo.base.errors import CranktopoError
from cranktopo.base.notes import note
from cranktopo.design.crank import OWN_THROW
from cranktopo.design.loading import parse_scene
from cranktopo.design.schema import Scene
from cranktopo.tasks.crank_import.faces import DIGITS
from cranktopo.tasks.crank_import.found_crank import FoundCrank, FoundStep


def design_text(scene: Scene, crank: FoundCrank, body: str, heading: tuple[str, ...]) -> str:
    """Return the text of a design; `body` is the file of its half throw, which is the original.

    It has the ends and main journals of the crank where they fit its throw.
    """
    own = _crank(scene, crank)
    text = _text(scene, crank, own, body, heading)
    if not own:
        return text
    try:
        parse_scene(text, scene.name)
    except CranktopoError as error:
        note(f"{scene.name}: ends and main journals of the crank are left out: {error.message}")
        return _text(scene, crank, {}, body, heading)
    return text


def _text(scene: Scene, crank: FoundCrank, own: dict[str, Any], body: str, heading: tuple[str, ...]) -> str:
    data = scene.model_dump(
        mode="json", include={"name", "throw", "web", "material"}, exclude_none=True, exclude_defaults=True
    )
    head = {"schema_version": 1, "name": data.pop("name"), "description": f"Imported from {heading[0]}"}
    data["material"] = {"name": scene.material.name}
    tables = {**data, "envelope": _envelope(scene), "original": {"file": body}}
    tables |= {"crank": own} if own else {}
    comments = "".join(f"# {line}\n" for line in heading[1:])
    parts = [f"{comments}{tomlkit.dumps(head)}"]
    for name, table in tables.items():
        parts.append(_NOTES.get(name, "") + tomlkit.dumps({name: table}))
    return "\n".join([*parts, _engine_lines(scene, crank)])


_NOTES = {
    "material": "# CAD does not tell the material: confirm it, or take another.\n",
    "envelope": "# Space for the optimised web: as large as the present one.\n"
    "# Widen it to what piston and crankcase leave.\n",
    "crank": "# Cylinders, cones and keyways beyond the outer main journals. CAD does not tell the free\n"
    "# end: the lower one is taken. Holes in them are not read.\n",
    "original": "# The web that gains are measured against: the body itself.\n",
}


_ALIKE = 2e-3
"""Share in which a main journal may differ from the design's and counts as alike."""


def _crank(scene: Scene, crank: FoundCrank) -> dict[str, Any]:
    """Return ends and main journals that differ from the design's; empty where there are none."""
    own = []
    for number, journal in enumerate(crank.journals):
        whole = crank.ends[number > 0] is not None if any(journal.free) else True
        length = journal.length_mm if whole else scene.throw.main_journal.length_mm
        found = {
            "outer_diameter_mm": 2 * journal.radius_mm,
            "bore_diameter_mm": journal.bore_mm,
            "length_mm": length,
        }
        usual = scene.throw.main_journal.model_dump()
        differing = {k: round(v, DIGITS) for k, v in found.items() if abs(v - usual[k]) > _ALIKE * usual[k]}
        own += [{"number": number, **differing}] if differing else []
    ends = [
        {"side": side, "step": [_step(step, crank) for step in steps]}
        for side, steps in zip(("free", "output"), crank.ends, strict=True)
        if steps is not None
    ]
    throws = {"throws": [OWN_THROW] * len(crank.pins)} if own else {}
    return throws | ({"main_journal": own} if own else {}) | ({"end": ends} if ends else {})


def _step(step: FoundStep, crank: FoundCrank) -> dict[str, Any]:
    sizes = {"diameter_mm": 2 * step.radius_mm, "length_mm": step.length_mm, "bore_diameter_mm": step.bore_mm}
    kind, keyway = "cylinder", step.keyway
    if step.outer_radius_mm is not None:
        kind, sizes["outer_end_diameter_mm"] = "cone", 2 * step.outer_radius_mm
    if keyway is not None:
        kind = "keyway"
        sizes |= {"width_mm": keyway.width_mm, "depth_mm": keyway.depth_mm}
        sizes["angle_deg"] = crank.turn_deg(keyway.direction)
    return {"kind": kind, **{key: round(value, DIGITS) for key, value in sizes.items()}}


def _envelope(scene: Scene) -> dict[str, Any]:
    low, high = scene.web.y_range_mm(scene.throw.radius_mm)
    half = scene.web.largest_half_width_mm
    weight = scene.web.counterweight
    if weight is not None:
        low, half = min(low, -weight.outer_radius_mm), max(half, weight.outer_radius_mm)
    return {"shape": "box", "half_width_mm": half, "y_min_mm": low, "y_max_mm": high}


def _engine_lines(scene: Scene, crank: FoundCrank) -> str:
    """Return the table of the engine as lines to fill in: CAD knows the throws, not what loads them."""
    angles = [round(crank.angle_deg(pin), 3) for pin in crank.pins]
    stroke = 2 * scene.throw.radius_mm
    several = len(crank.pins) > 1
    return "\n".join(
        [
            "# CAD does not tell the engine either: fill in the values, and take away the '# ' of each line.",
            f"# The stroke is {stroke:g} mm; throws at {', '.join(f'{angle:g}' for angle in angles)} deg.",
            "# [engine]",
            "# bore_mm =            # cylinder bore",
            "# rod_length_mm =      # distance of the rod's eyes",
            "# speed_rpm =          # speed at which the loads are taken",
            f"# cylinders = {len(crank.pins)}",
            *(["# firing_order = []    # cylinder numbers in the order of firing"] if several else []),
            *([f"# arrangement = {{ throw_angles_deg = {angles} }}"] if several else []),
            "# [engine.gas]",
            "# peak_pressure_MPa =",
            "# peak_angle_deg =     # after firing top dead centre",
            "# [engine.masses]",
            "# piston_group_kg =",
            "# rod_kg =",
            "# rod_centre_from_big_end_mm =",
            "",
        ]
    )
