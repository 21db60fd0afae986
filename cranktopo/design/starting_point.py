"""Starting points of designs: proportions by the bore, and firing order and throws usual for a layout."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from itertools import pairwise
from typing import Any, Literal

from cranktopo.base.errors import CranktopoError, ExitCode
from cranktopo.base.units import stem_and_unit
from cranktopo.design.arrangement import banks_words
from cranktopo.design.schema import Scene
from cranktopo.design.starting_rod import starting_rod

LayoutName = Literal["single", "in-line", "V", "W", "boxer", "radial"]
USUAL_CYLINDERS: Mapping[LayoutName, int] = {
    "single": 1,
    "in-line": 4,
    "V": 8,
    "W": 12,
    "boxer": 4,
    "radial": 9,
}


@dataclass(frozen=True)
class Firing:
    """Firing order of a four-stroke engine, and its banks.

    Attributes:
        bank_deg: angle between the banks of a V.
        throws_deg: angles of the throws where no choice of them fires evenly, and of the rows of a radial.
        banks_deg: directions of the banks of a W.
    """

    order: tuple[int, ...]
    bank_deg: float | None = None
    throws_deg: tuple[float, ...] = ()
    banks_deg: tuple[float, ...] = ()


FIRING: Mapping[tuple[LayoutName, int], Firing] = {
    ("single", 1): Firing((1,)),
    ("in-line", 2): Firing((1, 2)),
    ("in-line", 3): Firing((1, 3, 2)),
    ("in-line", 4): Firing((1, 3, 4, 2)),
    ("in-line", 5): Firing((1, 2, 4, 5, 3)),
    ("in-line", 6): Firing((1, 5, 3, 6, 2, 4)),
    ("in-line", 8): Firing((1, 6, 2, 5, 8, 3, 7, 4)),
    ("V", 2): Firing((1, 2), 90.0, (0.0,)),
    ("V", 4): Firing((1, 2, 3, 4), 90.0, (0.0, 180.0)),
    ("V", 6): Firing((1, 4, 3, 6, 2, 5), 90.0, (0.0, 240.0, 120.0)),
    ("V", 8): Firing((1, 3, 7, 2, 6, 5, 4, 8), 90.0),
    ("V", 10): Firing((1, 6, 2, 7, 4, 9, 5, 10, 3, 8), 72.0),
    ("V", 12): Firing((1, 7, 5, 11, 3, 9, 6, 12, 2, 8, 4, 10), 60.0),
    ("W", 12): Firing((1, 5, 9, 3, 7, 11, 4, 8, 12, 2, 6, 10), banks_deg=(0.0, 60.0, 120.0)),
    ("W", 18): Firing(
        (1, 7, 13, 5, 11, 17, 3, 9, 15, 6, 12, 18, 2, 8, 14, 4, 10, 16), banks_deg=(0.0, 40.0, 80.0)
    ),
    ("radial", 3): Firing((1, 3, 2)),
    ("radial", 5): Firing((1, 3, 5, 2, 4)),
    ("radial", 7): Firing((1, 3, 5, 7, 2, 4, 6)),
    ("radial", 9): Firing((1, 3, 5, 7, 9, 2, 4, 6, 8)),
    ("radial", 14): Firing((1, 10, 5, 14, 9, 4, 13, 8, 3, 12, 7, 2, 11, 6), throws_deg=(0.0, 180.0)),
    ("radial", 18): Firing(
        (1, 12, 5, 16, 9, 2, 13, 6, 17, 10, 3, 14, 7, 18, 11, 4, 15, 8), throws_deg=(0.0, 180.0)
    ),
    ("boxer", 2): Firing((1, 2)),
    ("boxer", 4): Firing((1, 3, 2, 4)),
    ("boxer", 6): Firing((1, 6, 3, 2, 5, 4)),
}
"""Cylinders are numbered as in `[engine]`: of a V or W bank by bank, of a radial around the shaft, of a boxer
odd numbers are the first bank."""

_LENGTHS = {
    "throw.main_journal.outer_diameter_mm": 0.70,
    "throw.main_journal.length_mm": 0.33,
    "throw.main_journal.fillet_mm": 0.03,
    "throw.crankpin.outer_diameter_mm": 0.60,
    "throw.crankpin.length_mm": 0.33,
    "throw.crankpin.fillet_mm": 0.03,
    "web.thickness_mm": 0.22,
    "web.width_mm": 0.87,
}
"""Lengths over a bore of a car, within a quarter of those of the built-in `car-diesel`."""
_LENGTHS_OF: Mapping[str, Mapping[str, float]] = {
    "V": {"throw.crankpin.length_mm": 0.55, "web.thickness_mm": 0.26},
    "W": {"throw.crankpin.length_mm": 0.80, "web.thickness_mm": 0.28},
}
_LARGE_LENGTHS = {
    "throw.main_journal.outer_diameter_mm": 0.90,
    "throw.main_journal.length_mm": 0.44,
    "throw.main_journal.fillet_mm": 0.045,
    "throw.crankpin.outer_diameter_mm": 0.80,
    "throw.crankpin.length_mm": 0.44,
    "throw.crankpin.fillet_mm": 0.045,
    "web.thickness_mm": 0.36,
    "web.width_mm": 1.30,
}
"""Lengths over a large bore: charged medium-speed engines have 18 to 20 MPa and the rule's 1.15."""
_LARGE_LENGTHS_OF: Mapping[str, Mapping[str, float]] = {
    "V": {"throw.crankpin.length_mm": 0.80, "web.thickness_mm": 0.40},
    "W": {"throw.crankpin.length_mm": 1.15, "web.thickness_mm": 0.43},
}
_CAR_MM, _LARGE_MM = 130.0, 250.0
"""Bores up to which, and from which on, either set of lengths holds; between them they blend."""
_ROD = 3.5
"""Rod over throw radius."""
_MASSES_KG = {"piston_group_kg": 1.4e-6, "rod_reciprocating_kg": 0.4e-6, "rod_rotating_kg": 1.0e-6}
"""Masses over the cube of the bore in mm."""
_PISTON_SPEED_M_S = 10.0
_EXAMPLE_BORE_MM, _EXAMPLE_RPM = 95.0, 2100.0
"""Engine of the examples of all keys."""
_POWERS = {"mm": 1, "N/mm": 1, "N": 2, "kN": 2, "kW": 2, "N m": 3, "N m/rad": 3, "kg": 3, "kg mm": 4}
_POWERS |= {"kg m²": 5, "N m s/rad": 4}
"""By which quantities grow with the size of an engine at one piston speed and pressure."""
_EXAMPLE_WEB = {"web.width_mm": 50.0, "web.thickness_mm": 19.0, "throw.radius_mm": 48.0}
_WEB_LIKE = dict.fromkeys(("y_mm", "stations_mm", "length_mm"), "throw.radius_mm")
_WEB_LIKE |= dict.fromkeys(("thickness_mm", "depth_mm", "height_mm"), "web.thickness_mm")
"""Key with which lengths of a web grow; all others grow with its width."""
_OF_WIDTH = {
    "web.counterweight.outer_radius_mm": 0.6,
    "web.counterweight.plug.y_mm": -0.52,
    "web.counterweight.plug.diameter_mm": 0.12,
    "web.counterweight.hole.diameter_mm": 0.12,
}
"""Lengths over the width of the web: a counterweight reaches beyond it, and holds what is let in."""
_OF_NO_SIZE = ("bolt", "roller_bearing", "drawing", "published")
"""Tables whose examples are those of a standard part or of a print."""


def usual_firing(layout: LayoutName, cylinders: int) -> Firing:
    """Return the firing order proposed for a layout; raises CranktopoError where there is no usual one."""
    found = FIRING.get((layout, cylinders))
    if found is None:
        known = ", ".join(str(count) for name, count in FIRING if name == layout)
        raise CranktopoError(
            f"--cylinders {cylinders}: no firing order is known for layout '{layout}'; known: {known}.",
            hint="Take the nearest and edit [engine] of the file.",
            code=ExitCode.USAGE,
        )
    return found


def starting_values(layout: LayoutName, cylinders: int, bore_mm: float, stroke_mm: float) -> dict[str, Any]:
    """Return values of a design of usual proportions, by key path; all of them are assumptions."""
    firing, radius = usual_firing(layout, cylinders), stroke_mm / 2
    lengths = _lengths(layout, bore_mm)
    arranged: dict[str, Any] = (
        {} if layout in ("single", "in-line") else {"engine.arrangement.layout": layout}
    )
    if firing.bank_deg is not None:
        arranged["engine.arrangement.bank_angle_deg"] = firing.bank_deg
    if firing.banks_deg:
        arranged["engine.arrangement.bank_angles_deg"] = list(firing.banks_deg)
    if firing.throws_deg:
        arranged["engine.arrangement.throw_angles_deg"] = list(firing.throws_deg)
    return {
        "throw.radius_mm": radius,
        **lengths,
        **_design_space(lengths["web.width_mm"], radius),
        "engine.bore_mm": bore_mm,
        "engine.rod_length_mm": _rounded(_ROD * radius),
        "engine.speed_rpm": _rounded(30000 * _PISTON_SPEED_M_S / stroke_mm),
        "engine.cylinders": cylinders,
        "engine.firing_order": list(firing.order),
        "engine.gas.peak_pressure_MPa": 7.0,
        "engine.gas.peak_angle_deg": 12.0,
        **{f"engine.masses.{key}": _rounded(share * bore_mm**3) for key, share in _MASSES_KG.items()},
        **arranged,
    }


def _lengths(layout: LayoutName, bore_mm: float) -> dict[str, float]:
    """Return the lengths of throw and web, those of a car and of a large engine blended by the bore."""
    car = {**_LENGTHS, **_LENGTHS_OF.get(layout, {})}
    large = {**_LARGE_LENGTHS, **_LARGE_LENGTHS_OF.get(layout, {})}
    part = min(max((bore_mm - _CAR_MM) / (_LARGE_MM - _CAR_MM), 0.0), 1.0)
    return {key: _rounded(((1 - part) * car[key] + part * large[key]) * bore_mm) for key in car}


def _design_space(width_mm: float, radius_mm: float) -> dict[str, Any]:
    """Return a box that leaves room around the proposed web: 1.6 of its width, a fifth beyond its ends."""
    beyond = round(0.5 * width_mm + 0.2 * radius_mm, 1)
    return {
        "envelope.shape": "box",
        "envelope.half_width_mm": round(0.8 * width_mm, 1),
        "envelope.y_min_mm": -beyond,
        "envelope.y_max_mm": round(radius_mm + beyond, 1),
    }


def sized_example(values: Mapping[str, Any], path: str, name: str, example: Any) -> Any:
    """Return the example of a key of a table for an engine of the size of starting values."""
    width, unit = values["web.width_mm"], stem_and_unit(name)[1]
    if (of_rod := starting_rod(values).get(f"{path}.{name}")) is not None:
        return of_rod
    if (share := _OF_WIDTH.get(f"{path}.{name}")) is not None:
        return _rounded(share * width)
    if unit == "rpm":
        return _times(example, values["engine.speed_rpm"] / _EXAMPLE_RPM)
    if unit not in _POWERS or any(part in path for part in _OF_NO_SIZE):
        return example
    if path.partition(".")[0] in ("web", "second_web"):
        key = _WEB_LIKE.get(name, "web.width_mm")
        return _times(example, values[key] / _EXAMPLE_WEB[key])
    return _times(example, (values["engine.bore_mm"] / _EXAMPLE_BORE_MM) ** _POWERS[unit])


def _times(example: Any, factor: float) -> Any:
    if isinstance(example, list | tuple):
        return [_times(part, factor) for part in example]
    return float(f"{example * factor:.3g}") if isinstance(example, int | float) else example


def arrangement_line(scene: Scene) -> str:
    """Return firing order, throw angles and firing intervals of a scene's engine in one line."""
    engine = scene.engine
    assert engine is not None
    fires = sorted(engine.firing_angles_deg)
    gaps = [b - a for a, b in pairwise([*fires, fires[0] + engine.cycle_deg])]
    even = len({round(gap, 3) for gap in gaps}) == 1
    every = f"every {gaps[0]:g} deg" if even else f"after {', '.join(f'{gap:g}' for gap in gaps)} deg"
    order = "-".join(map(str, engine.order))
    angles = ", ".join(f"{angle:g}" for angle in engine.throw_angles_deg)
    placed = f"throws at {angles} deg{banks_words(engine.arranged.layout, engine.directions_deg)}"
    return f"assumed: firing order {order}, {every}; {placed}; lengths and masses by the bore"


def _rounded(value: float) -> float:
    return float(f"{value:.2g}")
