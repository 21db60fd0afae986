"""A design that begins with what is known of its engine: usual proportions, the rest assumed and told."""

from __future__ import annotations

import shlex
from collections.abc import Mapping
from functools import partial
from typing import Any, NamedTuple

from cranktopo.base.errors import CranktopoError, ExitCode
from cranktopo.design.loading import parse_scene
from cranktopo.design.reference import template
from cranktopo.design.schema import Scene
from cranktopo.design.starting_point import LayoutName, arrangement_line, sized_example, starting_values
from cranktopo.engine.performance import pressure_warnings
from cranktopo.engine.starting_gas import gas_for_power, gas_line

_BANK, _THROWS = "engine.arrangement.bank_angle_deg", "engine.arrangement.throw_angles_deg"
KNOWN: Mapping[str, str] = {
    "speed_rpm": "engine.speed_rpm",
    "rod_length_mm": "engine.rod_length_mm",
    "peak_pressure_MPa": "engine.gas.peak_pressure_MPa",
    "compression_ratio": "engine.gas.compression_ratio",
    "bank_angle_deg": _BANK,
    "material": "material.name",
}
"""Option of what may be known beside the size, and its key."""
_ORIGIN = (
    "Values of engine, throw and web are usual proportions for such an engine, all of them assumed: replace "
    "what is known. Their strength is not checked: `cranktopo fatigue` does, by --method m53 against a rule."
)


class Beginning(NamedTuple):
    """A design that began: its text, the scene of it, what was assumed and what is doubtful, a line each."""

    text: str
    scene: Scene
    assumed: tuple[str, ...]
    warnings: tuple[str, ...]


def begun(
    name: str,
    layout: LayoutName,
    cylinders: int,
    bore_mm: float,
    stroke_mm: float,
    known: Mapping[str, Any] | None = None,
) -> Beginning:
    """Return a design of usual proportions with what is known of it.

    Args:
        known: of the keys of `KNOWN` and power_kW.

    Raises:
        CranktopoError: no usual firing order, an angle of banks without banks, or a power that no gas gives
            such an engine.
    """
    figures = {key: value for key, value in (known or {}).items() if value is not None}
    values = starting_values(layout, cylinders, bore_mm, stroke_mm)
    if "bank_angle_deg" in figures:
        values |= _kept_throws(name, layout, values)
    values |= {key: figures[short] for short, key in KNOWN.items() if short in figures}
    scene = parse_scene(template(name, values), name)
    if "power_kW" in figures:
        peak, ratio = figures.get("peak_pressure_MPa"), figures.get("compression_ratio")
        found = gas_for_power(scene, figures["power_kW"], peak, ratio)
        values |= {f"engine.gas.{key}": value for key, value in found.items()}
        scene = parse_scene(template(name, values), name)
    assumed = (arrangement_line(scene), gas_line(scene))
    text = template(name, values, "\n".join([_ORIGIN, *assumed[1:]]), partial(sized_example, values))
    scene = parse_scene(text, name)
    return Beginning(text, scene, assumed, pressure_warnings(scene))


def _kept_throws(name: str, layout: LayoutName, values: Mapping[str, Any]) -> dict[str, Any]:
    """Return the throw angles of the usual banks: other banks fire unevenly on the same crank."""
    if layout != "V":
        raise CranktopoError(
            f"--bank-angle-deg: layout '{layout}' has no banks at one angle.",
            hint="Leave it out, or give --layout V; of a W edit bank_angles_deg of the file.",
            code=ExitCode.USAGE,
        )
    engine = parse_scene(template(name, values), name).engine
    assert engine is not None
    return {_THROWS: list(engine.throw_angles_deg)}


def begun_line(
    file: str,
    layout: LayoutName,
    cylinders: int,
    bore_mm: float,
    stroke_mm: float,
    known: Mapping[str, Any] | None = None,
) -> str:
    """Return the command that begins the same design."""
    words = ["cranktopo", "designs", "new", file, f"--layout={layout}", f"--cylinders={cylinders}"]
    sizes = {"bore_mm": bore_mm, "stroke_mm": stroke_mm, **(known or {})}
    for key, value in sizes.items():
        if value is not None:
            words.append(f"--{key.replace('_', '-')}={value if isinstance(value, str) else f'{value:.12g}'}")
    return shlex.join(words)
