"""Random engines with everything that a crank may have, the same for the same seed."""

from __future__ import annotations

from typing import Any

import numpy as np

from cranktopo.base.errors import CranktopoError
from cranktopo.design.loading import scene_from_dict
from cranktopo.design.starting_point import FIRING
from tests.random_engines import random_engine

PROCESSES = ("free", "forged", "cast", "milled")
AT_MIDDLE = "where its half throw ends"
"""In the refusal of an outlet whose rim is too near to the middle of its journal."""


def featured_engine(seed: int) -> dict[str, Any]:
    """Return a random engine as plain data: drillings, counterweights, two webs, two banks among them.

    All have a flywheel, most a few of those features, some none; every process in turn.
    """
    data = random_engine(seed)
    draw = np.random.default_rng((seed, 47))
    size = data["throw"]["main_journal"]["outer_diameter_mm"]
    if draw.random() < 0.5:
        data["throw"]["drilling"] = [_drilling(draw, data["throw"], size)]
    if draw.random() < 0.4:
        data["web"]["counterweight"] = _counterweight(draw, data, size)
    if draw.random() < 0.25:
        data["second_web"] = data["web"] | {"thickness_mm": data["web"]["thickness_mm"] * 1.15}
    if ("V", data["engine"]["cylinders"]) in FIRING and draw.random() < 0.5:
        data["engine"] |= _v(data["engine"]["cylinders"])
    rods_kg_mm2 = data["engine"]["masses"]["rod_rotating_kg"] * data["throw"]["radius_mm"] ** 2
    data["shaft"] = {"flywheel": {"inertia_kg_m2": 30 * 1e-6 * rods_kg_mm2}}
    data["optimise"] = {"process": PROCESSES[seed % len(PROCESSES)]}
    _clear_middles(data)
    return data


def _clear_middles(data: dict[str, Any]) -> None:
    """Move an outlet 5 % toward the web where its rim is too near to the middle of its journal (seed 11)."""
    try:
        scene_from_dict(data, whole=True)
    except CranktopoError as refusal:
        for name in ("from", "to"):
            if f"{name}.place_mm" in refusal.message and AT_MIDDLE in refusal.message:
                data["throw"]["drilling"][0][name]["place_mm"] *= 1.05


def _drilling(draw: np.random.Generator, throw: dict[str, Any], size: float) -> dict[str, Any]:
    """A drilling from the main journal to the crankpin, through the web."""
    outlet = size * draw.uniform(0.05, 0.09)
    places = {
        name: {"on": name, "angle_deg": angle, "place_mm": 0.1 * throw[name]["length_mm"]}
        for name, angle in (("main_journal", 180.0), ("crankpin", 0.0))
    }
    return {
        "diameter_mm": outlet,
        "outlet_radius_mm": 0.25 * outlet,
        "from": places["main_journal"],
        "to": places["crankpin"],
    }


def _counterweight(draw: np.random.Generator, data: dict[str, Any], size: float) -> dict[str, Any]:
    """A counterweight within the envelope, which is made as large as it."""
    outer = size * draw.uniform(1.0, 1.4)
    envelope = data["envelope"]
    envelope["half_width_mm"] = max(envelope["half_width_mm"], 1.02 * outer)
    envelope["y_min_mm"] = min(envelope["y_min_mm"], -1.02 * outer)
    return {"outer_radius_mm": outer, "half_angle_deg": draw.uniform(40.0, 75.0)}


def _v(cylinders: int) -> dict[str, Any]:
    """Two banks, each pin with two rods."""
    firing = FIRING["V", cylinders]
    arrangement = {
        "layout": "V",
        "bank_angle_deg": firing.bank_deg,
        "throw_angles_deg": list(firing.throws_deg),
    }
    return {"firing_order": list(firing.order), "arrangement": arrangement}
