"""The design of an imported half throw as commented TOML: what is known, and lines to fill in."""

from __future__ import annotations

from typing import Any

import tomlkit

from cranktopo.design.schema import Scene
from cranktopo.tasks.crank_import.found_crank import FoundCrank


def design_text(scene: Scene, crank: FoundCrank, body: str, heading: tuple[str, ...]) -> str:
    """Return the text of a design; `body` is the file of its half throw, which is the original."""
    data = scene.model_dump(
        mode="json", include={"name", "throw", "web", "material"}, exclude_none=True, exclude_defaults=True
    )
    head = {"schema_version": 1, "name": data.pop("name"), "description": f"Imported from {heading[0]}"}
    data["material"] = {"name": scene.material.name}
    tables = {**data, "envelope": _envelope(scene), "original": {"file": body}}
    comments = "".join(f"# {line}\n" for line in heading[1:])
    parts = [f"{comments}{tomlkit.dumps(head)}"]
    for name, table in tables.items():
        parts.append(_NOTES.get(name, "") + tomlkit.dumps({name: table}))
    return "\n".join([*parts, _engine_lines(scene, crank)])


_NOTES = {
    "material": "# CAD does not tell the material: confirm it, or take another.\n",
    "envelope": "# Space for the optimised web: as large as the present one.\n"
    "# Widen it to what piston and crankcase leave.\n",
    "original": "# The web that gains are measured against: the body itself.\n",
}


def _envelope(scene: Scene) -> dict[str, Any]:
    low, high = scene.web.y_range_mm(scene.throw.radius_mm)
    half = scene.web.largest_half_width_mm
    weight = scene.web.counterweight
    if weight is not None:
        low, half = min(low, -weight.outer_radius_mm), max(half, weight.outer_radius_mm)
    return {"shape": "box", "half_width_mm": half, "y_min_mm": low, "y_max_mm": high}


def _engine_lines(scene: Scene, crank: FoundCrank) -> str:
    """Return the table of the engine as lines to fill in: CAD knows the throws, not what loads them."""
    angles = [round((-crank.angle_deg(pin)) % 360, 3) for pin in crank.pins]
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
