"""Crank throws drawn at random, the same for the same seed: proportions of real engines, some lopsided."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from cranktopo.design.loading import scene_from_dict
from cranktopo.design.schema import Scene

OUTLINES = ("obround", "tapered", "rectangle", "ellipse")


def random_throw(seed: int) -> Scene:
    """A throw with journals, fillets, web and perhaps a hole beside its mirror plane, all from the seed."""
    return scene_from_dict(_throw(seed))


def random_variant(seed: int, number: int) -> Scene:
    """Another web on the journals of a random throw: 0 its own, 1 wider, 2 of any outline with a hole."""
    data = _throw(seed)
    if number:
        draw = np.random.default_rng((seed, number))
        web = _other_web(draw, data["web"]) if number == 1 else _new_web(draw, data)
        web["thickness_mm"] = data["web"]["thickness_mm"] * draw.uniform(0.94, 1.06)
        data = data | {"web": web, "name": f"{data['name']}-{number}"}
    return scene_from_dict(data)


def _other_web(draw: np.random.Generator, web: dict[str, Any]) -> dict[str, Any]:
    """The web with wider dimensions."""
    widths = ("width_mm", "main_radius_mm", "pin_radius_mm", "semi_axis_throw_mm", "semi_axis_lateral_mm")
    return web | {name: web[name] * draw.uniform(1.0, 1.12) for name in widths if name in web}


def _new_web(draw: np.random.Generator, data: dict[str, Any]) -> dict[str, Any]:
    """Another web of any outline with a hole through its middle, besides what pockets there are."""
    main, pin = (data["throw"][name] for name in ("main_journal", "crankpin"))
    journal, radius = max(main["outer_diameter_mm"], pin["outer_diameter_mm"]), data["throw"]["radius_mm"]
    hole = {"shape": "cylinder", "x_mm": 0.0, "y_mm": radius / 2}
    hole["diameter_mm"] = main["outer_diameter_mm"] * draw.uniform(0.1, 0.2)
    web = _web(draw, journal, radius, main["fillet_mm"])
    open_hole = [] if _covered(0.0, hole["diameter_mm"], radius, main, pin) else [hole]
    return web | {"pocket": [*data["web"].get("pocket", []), *open_hole]}


def _covered(x_mm: float, diameter_mm: float, throw_mm: float, *journals: dict[str, float]) -> bool:
    """Tell whether the journals cover a hole half-way between them, which no tool would reach."""
    reach = math.hypot(x_mm, throw_mm / 2) + diameter_mm / 2
    return all(reach < one["outer_diameter_mm"] / 2 + one["fillet_mm"] for one in journals)


def _throw(seed: int) -> dict[str, Any]:
    draw = np.random.default_rng(seed)
    main = draw.uniform(36.0, 90.0)
    pin = main * draw.uniform(0.8, 1.05)
    radius = main * draw.uniform(0.5, 1.1)
    fillet = 0.0 if draw.random() < 0.35 else main * draw.uniform(0.04, 0.08)
    room = 0.45 * min(radius, main)  # two bores of this diameter do not meet in the web
    bores = [0.0 if draw.random() < 0.3 else room * draw.uniform(0.6, 1.0) for _ in range(2)]
    thickness = main * draw.uniform(0.28, 0.45)
    throw: dict[str, Any] = {"radius_mm": radius}
    for name, diameter, bore in (("main_journal", main, bores[0]), ("crankpin", pin, bores[1])):
        throw[name] = {"outer_diameter_mm": diameter, "bore_diameter_mm": bore, "fillet_mm": fillet}
        throw[name]["length_mm"] = main * draw.uniform(0.45, 1.0)
    web = _web(draw, max(main, pin), radius, fillet) | {"thickness_mm": thickness}
    if draw.random() < 0.3:
        hole = {"shape": "cylinder", "x_mm": 0.3 * main, "y_mm": radius / 2, "diameter_mm": 0.15 * main}
        if not _covered(0.3 * main, 0.15 * main, radius, throw["main_journal"], throw["crankpin"]):
            web["pocket"] = [hole]
    supports = {"bearing_spring_N_per_mm": draw.uniform(0.3e6, 2e6)}
    return {
        "name": f"random-{seed}",
        "throw": throw,
        "web": web,
        "material": {"name": "42CrMo4"},
        "supports": supports,
    }


def _web(draw: np.random.Generator, journal: float, radius: float, fillet: float) -> dict[str, Any]:
    """An outline that holds both journals and their fillets."""
    half = journal / 2 + fillet + journal * draw.uniform(0.06, 0.25)
    outline = OUTLINES[draw.integers(len(OUTLINES))]
    if outline == "obround":
        return {"outline": outline, "width_mm": 2 * half}
    if outline == "tapered":
        return {"outline": outline, "main_radius_mm": half, "pin_radius_mm": half * draw.uniform(0.97, 1.2)}
    if outline == "rectangle":
        return {"outline": outline, "width_mm": 2 * half, "overhang_mm": half, "corner_radius_mm": 0.2 * half}
    lateral = half * draw.uniform(1.15, 1.4)
    along = radius / 2 + half * draw.uniform(1.25, 1.4)
    return {"outline": outline, "semi_axis_throw_mm": along, "semi_axis_lateral_mm": lateral}
