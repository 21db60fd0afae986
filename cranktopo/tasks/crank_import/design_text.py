"""The design of an imported half throw as commented TOML: what is known, and lines to fill in."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import tomlkit

from cranktopo.base.errors import CranktopoError
from cranktopo.base.notes import note
from cranktopo.design.crank import OWN_THROW
from cranktopo.design.loading import parse_scene
from cranktopo.design.schema import Scene
from cranktopo.tasks.crank_import.found_crank import FoundCrank, FoundStep
from cranktopo.tasks.crank_import.half_body import EXACT, Closeness
from cranktopo.tasks.crank_import.throw_designs import Throws, fillets_of, throw_keys


def design_text(
    scene: Scene,
    crank: FoundCrank,
    bodies: tuple[str, str | None],
    heading: tuple[str, ...],
    near: Closeness = EXACT,
    throws: Throws = (),
) -> str:
    """Return the text of a design; `bodies` are the files of its half throws, which are the original.

    It has the ends and main journals of the crank where they fit its throw.
    """
    own = crank_table(scene, crank, near, throws)
    text = _text(scene, crank, own, bodies, heading)
    if not own:
        return text
    try:
        parse_scene(text, scene.name)
    except CranktopoError as error:
        note(f"{scene.name}: ends and main journals of the crank are left out: {error.message}")
        return _text(scene, crank, {}, bodies, heading)
    return text


def throw_text(
    throw: tuple[Scene, Scene], crank: FoundCrank, own: dict[str, Any], name: str, heading: tuple[str, ...]
) -> str:
    """Return the text of a design of one throw of a crank, `own` its [crank], each web as it is."""
    scene = throw[0].model_copy(update={"name": name})
    return _text(scene, crank, own, None, heading, throw_keys(*throw))


def _text(
    scene: Scene,
    crank: FoundCrank,
    own: dict[str, Any],
    bodies: tuple[str, str | None] | None,
    heading: tuple[str, ...],
    keys: Mapping[str, Any] | None = None,
) -> str:
    data = scene.model_dump(
        mode="json", include={"name", "throw", "web", "material"}, exclude_none=True, exclude_defaults=True
    )
    head = {"schema_version": 1, "name": data.pop("name"), "description": f"Imported from {heading[0]}"}
    data["material"] = {"name": scene.material.name}
    tables = {**data, **(keys or {}), "envelope": _envelope(scene)}
    named = zip(("file", "second_file"), bodies or (), strict=False)
    tables |= {"original": {key: name for key, name in named if name}} if bodies else {}
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
    "crank": "# Cylinders, cones, flanges and keyways beyond the outer main journals. CAD does not tell the\n"
    "# free end: the lower one is taken.\n",
    "original": "# The web that gains are measured against: the body itself.\n",
}


_ALIKE = 4.0
"""Share, over that of dimensions, in which a main journal may differ from the design's and counts as one."""


def crank_table(
    scene: Scene, crank: FoundCrank, near: Closeness = EXACT, throws: Throws = (), names: Sequence[str] = ()
) -> dict[str, Any]:
    """Return throws, ends and main journals that differ from the design's; empty where there are none.

    Empty beside a flying web: the design says nothing of the crank then.
    """
    if crank.flying:
        return {}
    own = [
        {"number": number, **differing}
        for number, journal in enumerate(crank.journals)
        if (differing := _differing(scene, crank, number, near, throws))
    ]
    ends = [
        {"side": side, "step": [near.rounded(_step(step, crank)) for step in steps]}
        for side, steps in zip(("free", "output"), crank.ends, strict=True)
        if steps is not None
    ]
    several = own or names or (ends and len(crank.pins) > 1)
    order = {"throws": list(names) or [OWN_THROW] * len(crank.pins)} if several else {}
    return order | ({"main_journal": own} if own else {}) | ({"end": ends} if ends else {})


def _differing(
    scene: Scene, crank: FoundCrank, number: int, near: Closeness, throws: Throws
) -> dict[str, float]:
    """Return what a main journal of the crank has otherwise than the design's."""
    journal, usual = crank.journals[number], scene.throw.main_journal
    whole = crank.ends[number > 0] is not None if any(journal.free) else True
    found = {
        "outer_diameter_mm": 2 * journal.radius_mm,
        "bore_diameter_mm": journal.bore_mm,
        "length_mm": journal.length_mm if whole else usual.length_mm,
        "fillet_mm": next((fillet.radial_mm for fillet in fillets_of(throws, number)), usual.fillet_mm),
    }
    least = {key: _ALIKE * near.length * getattr(usual, key) for key in found}
    differing = {key: value for key, value in found.items() if abs(value - getattr(usual, key)) > least[key]}
    return dict(near.rounded(differing))


def _step(step: FoundStep, crank: FoundCrank) -> dict[str, Any]:
    sizes = {"diameter_mm": 2 * step.radius_mm, "length_mm": step.length_mm, "bore_diameter_mm": step.bore_mm}
    kind, keyway = "cylinder", step.keyway
    if step.outer_radius_mm is not None:
        kind, sizes["outer_end_diameter_mm"] = "cone", 2 * step.outer_radius_mm
    if keyway is not None:
        kind = "keyway"
        sizes |= {"width_mm": keyway.width_mm, "depth_mm": keyway.depth_mm}
        sizes["angle_deg"] = crank.turn_deg(keyway.direction)
    if step.bolts is not None:
        kind = "flange"
        sizes |= {
            "bolt_circle_mm": 2 * step.bolts.circle_radius_mm,
            "bolt_diameter_mm": 2 * step.bolts.radius_mm,
        }
        sizes |= {"bolts": step.bolts.count}
        sizes["first_bolt_deg"] = crank.turn_deg(step.bolts.direction) % (360 / step.bolts.count)
    return {"kind": kind, **sizes}


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
    arranged = _split_arrangement(crank) or f"throw_angles_deg = {angles}"
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
            *([f"# arrangement = {{ {arranged} }}"] if several else []),
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


def _split_arrangement(crank: FoundCrank) -> str:
    """Return the arrangement of a V whose pins are all split; empty for others."""
    if not crank.split or list(crank.split) != list(range(1, len(crank.pins), 2)):
        return ""
    splays = [crank.splay_deg(number) for number in crank.split]
    middles = [crank.angle_deg(crank.pins[n - 1]) + s / 2 for n, s in zip(crank.split, splays, strict=True)]
    angles = [round((middle - middles[0]) % 360, 3) % 360 for middle in middles]
    return f'layout = "V", pin_splay_deg = {round(splays[0], 3)}, throw_angles_deg = {angles}'
