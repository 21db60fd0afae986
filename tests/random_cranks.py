"""Whole cranks drawn at random, the same for the same seed: random engines with ends and own journals."""

from __future__ import annotations

from typing import Any

import numpy as np

from cranktopo.design.loading import scene_from_dict
from cranktopo.design.schema import Scene
from tests.random_engines import random_engine


def random_crank(seed: int) -> Scene:
    """A random engine with both ends, up to four steps each, and one main journal of its own."""
    draw, data = np.random.default_rng((seed, 48)), random_engine(seed)
    main = data["throw"]["main_journal"]
    number = int(draw.integers(data["engine"]["cylinders"] + 1))
    own = {"number": number, "length_mm": main["length_mm"] * draw.uniform(1.0, 1.5)}
    own |= {
        "bore_diameter_mm": 0.0,
        "outer_diameter_mm": main["outer_diameter_mm"] * draw.uniform(0.93, 0.99),
    }
    ends = [
        {
            "side": side,
            "step": _opened([_step(draw, main["outer_diameter_mm"]) for _ in range(draw.integers(5))]),
        }
        for side in ("free", "output")
    ]
    data["crank"] = {"main_journal": [own], "end": ends}
    return scene_from_dict(data, f"crank-{seed}")


def _opened(steps: list[dict[str, Any]]) -> list[dict[str, Any]]:
    """Steps whose holes can be made: bores as far as they come from outside, bolt holes in the outermost."""
    bored = True
    for step in reversed(steps):
        bored = bored and "bore_diameter_mm" in step
        if not bored:
            step.pop("bore_diameter_mm", None)
        if step["kind"] == "flange" and step is not steps[-1]:
            step["kind"] = "cylinder"
            for key in ("bolts", "bolt_circle_mm", "bolt_diameter_mm", "first_bolt_deg"):
                del step[key]
    return steps


def _step(draw: np.random.Generator, size: float) -> dict[str, Any]:
    diameter = size * draw.uniform(0.5, 1.3)
    step = {"diameter_mm": diameter, "length_mm": size * draw.uniform(0.2, 0.8)}
    if draw.random() < 0.5:
        step["bore_diameter_mm"] = diameter * draw.uniform(0.1, 0.3)
    kind = str(draw.choice(["cylinder", "cone", "flange", "keyway", "gear_seat", "thread"]))
    more: dict[str, Any] = {
        "cone": {"outer_end_diameter_mm": diameter * draw.uniform(0.6, 1.2)},
        "flange": {
            "bolts": int(draw.integers(1, 7)),
            "bolt_circle_mm": 0.65 * diameter,
            "bolt_diameter_mm": 0.2 * diameter,
            "first_bolt_deg": draw.uniform(0.0, 359.0),
        },
        "keyway": {
            "width_mm": diameter * draw.uniform(0.15, 0.4),
            "depth_mm": diameter * draw.uniform(0.12, 0.2),
            "angle_deg": draw.uniform(0.0, 359.0),
        },
        "thread": {"thread": "M thread"},
    }
    return {"kind": kind, **step, **more.get(kind, {})}
